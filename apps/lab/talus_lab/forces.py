"""Forces and stresses as layers of a picture."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from talus_lab.layers import Geometry, add, block_size, points_of, width
from talus_lab.run import Run
from talus_lab.stress import block_stress, contact_force, principal
from talus_lab.units import quantity

PRESSED, PULLED = "#a50026", "#0072b2"
MOST = 98  # per cent of the arms that are as long as the stress is large; with 100 one nipped block shrinks all others to dots


def largest_force(run: Run, frame: int) -> float:
    """N per m, of the contacts of a frame."""
    contacts = run.contacts(frame)
    return float(np.hypot(*contact_force(contacts).T).max(initial=0.0)) if contacts else 0.0


def draw_forces(ax: Axes, run: Run, geometry: Geometry, largest: float | None = None) -> list[Line2D]:
    """Contact forces as lines through the point where they act, along the force, as wide as the force is large. largest: N per m, that
    of the widest line; default: the largest of this frame."""
    contacts = run.contacts(geometry.frame)
    if not contacts or not len(contacts["x"]):
        return []
    force = contact_force(contacts)
    size = np.hypot(*force.T)
    largest = largest or size.max()
    if largest == 0:
        return []
    handles, widest = [], width(ax, run, 0.2, 1.0, 5.0)
    for label, color, pulls in (("contact force", PRESSED, False), ("tension", PULLED, True)):
        rows = (size > 0.01 * largest) & ((contacts["normal_force"] < 0) == pulls)
        if not rows.any():
            continue
        half = force[rows] / size[rows, None] * (0.35 * block_size(run))
        middle = geometry.carried(points_of(contacts)[rows], contacts["block_a"][rows])
        add(ax, LineCollection(np.stack([middle - half, middle + half], axis=1), colors=color,
                                         linewidths=widest * size[rows] / largest, zorder=5))
        handles.append(Line2D([], [], color=color, linewidth=widest * size[rows].max() / largest,
                              label=f"{label}, largest {quantity(size[rows].max(), 'N')}/m"))
    return handles


def largest_stress(run: Run, frame: int) -> float:
    """Pa, of the principal stresses of the blocks of a frame, but for the largest few, as with colours."""
    size = np.abs(np.concatenate(principal(block_stress(run, frame))[:2]))
    return float(np.percentile(size[~np.isnan(size)], MOST, method="higher")) if not np.isnan(size).all() else 0.0


def draw_stress(ax: Axes, run: Run, geometry: Geometry, largest: float | None = None) -> list[Line2D]:
    """Principal stresses of each block as a cross at its centroid, arms as long as the stress is large, tension in another
    colour. largest: Pa, that of the longest arm; default: that of this frame, but for a few of the arms, so that blocks
    that are nipped between two corners do not shrink all others."""
    stress = block_stress(run, geometry.frame)
    known = np.flatnonzero(~np.isnan(stress[:, 0, 0]))
    major, minor, angle = principal(stress[known])
    size, turned = np.concatenate([major, minor]), np.concatenate([angle, angle + np.pi / 2])
    turned = turned + np.tile((geometry.angle - run.angle(geometry.frame))[known], 2)
    longest = largest or largest_stress(run, geometry.frame)
    if longest == 0:
        return []
    arm = np.clip(np.abs(size) / longest, 0, 1) * 0.55 * np.tile(np.sqrt(run.blocks["area"][known]), 2)
    half = np.column_stack([np.cos(turned), np.sin(turned)]) * arm[:, None]
    middle, handles, wide = np.tile(geometry.position[known], (2, 1)), [], width(ax, run, 0.05, 0.35, 1.4)
    for label, color, rows in (("compression", PRESSED, size > 0), ("tension", PULLED, size < 0)):
        rows = rows & (np.abs(size) > 0.01 * longest)
        if rows.any():
            arms = np.stack([middle - half, middle + half], axis=1)[rows]
            add(ax, LineCollection(arms, colors="white", linewidths=2.5 * wide, alpha=0.8, zorder=4.9))  # seen on dark blocks too
            add(ax, LineCollection(arms, colors=color, linewidths=wide, zorder=5))
            most = float(np.abs(size[rows]).max())
            words = f"longest {quantity(longest, 'Pa')} and more" if most > 1.001 * longest else f"largest {quantity(most, 'Pa')}"
            handles.append(Line2D([], [], color=color, linewidth=1.4, label=f"{label}, {words}"))
    return handles
