"""The outline of all free blocks together."""

from __future__ import annotations

import contourpy
import numpy as np
from PIL import Image, ImageDraw

PIXELS = 2000  # along the longer side: a step of the outline is then a tenth of a mm in print. At half, steps show; at twice, 4 x slower


def silhouette(polygons: list[np.ndarray], least: float) -> list[np.ndarray]:
    """Closed lines [n, 2] m around what polygons [corners, 2] m cover together, and around holes; not around less than `least` m2. They
    are painted into a grid, whose edge is followed: neighbours that share an edge melt together whatever their rounding."""
    points = np.concatenate(polygons)
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    scale = (PIXELS - 8) / extent.max()
    image = Image.new("L", tuple(int(np.ceil(side * scale)) + 8 for side in extent))
    draw = ImageDraw.Draw(image)
    for polygon in polygons:
        draw.polygon([tuple(point) for point in (polygon - low) * scale + 4], fill=255, outline=255)
    lines = contourpy.contour_generator(z=np.asarray(image), line_type="Separate").lines(127.5)
    return [(line - 4) / scale + low for line in lines if _area(line) > least * scale**2]


def _area(line: np.ndarray) -> float:
    x, y = (line - line[0]).T
    return abs(float(np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]))) / 2
