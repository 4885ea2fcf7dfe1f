"""What a picture is painted with: blocks, supports, joints, outlines. Each function adds one layer to an axes; forces.py has more."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection, PathCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path

from talus_lab.arrays import placed
from talus_lab.run import JOINT_STATES, Run
from talus_lab.silhouette import silhouette
from talus_lab.style import EDGE, HELD, NAME_COLORS, STATE_COLORS

OPEN = JOINT_STATES.index("open")
LIGHT = 0.01  # of the mean contact force
BEFORE = "#000000"
TOGETHER = 500  # polygons or lines in one path: ten times as many take as long; the renderer refuses paths of a hundred thousand
OUTLINED = 30  # blocks: of so many each one's outline can be told apart, of more only that of the whole


@dataclass(frozen=True)
class Geometry:
    """A frame as it is drawn: where the blocks stand, with movements enlarged or not."""

    run: Run
    frame: int
    exaggerate: float  # displacements and rotations are drawn this many times as large

    @property
    def position(self) -> np.ndarray:
        """[blocks, 2] m"""
        return self.run.position(self.frame) + (self.exaggerate - 1) * self.run.displacement(self.frame)

    @property
    def angle(self) -> np.ndarray:
        """[blocks] rad"""
        return self.run.angle(self.frame) + (self.exaggerate - 1) * self.run.rotation(self.frame)

    @cached_property
    def corners(self) -> np.ndarray:
        """[corners, 2] m, of all parts"""
        return placed(self.run.arm, self.position, self.angle, self.run.corner_block)

    @property
    def polygons(self) -> list[np.ndarray]:
        """[parts] of [corners, 2] m"""
        return np.split(self.corners, self.run.first_corner[1:-1])

    def carried(self, points: np.ndarray, block: np.ndarray) -> np.ndarray:
        """[n, 2] m: points that belong to blocks [n], moved from where they are to where they are drawn."""
        if self.exaggerate == 1:
            return points
        from_centroid = points - self.run.position(self.frame)[block]
        return placed(from_centroid, self.position, (self.exaggerate - 1) * self.run.rotation(self.frame), block)


def block_size(run: Run) -> float:
    """m, side of a square as large as the median free block."""
    free = ~run.blocks["held"].astype(bool)
    return float(np.sqrt(np.median(run.blocks["area"][free] if free.any() else run.blocks["area"])))


def width(ax: Axes, run: Run, share: float, least: float, most: float) -> float:
    """Points: a line as wide as this share of a block, so that thousands of small blocks do not drown in lines."""
    low, high = ax.get_xlim()
    axes_width = 72 * 0.85 * ax.figure.get_figwidth() / ax.get_gridspec().ncols
    return float(np.clip(share * block_size(run) / (high - low) * axes_width, least, most))


def draw_blocks(ax: Axes, run: Run, geometry: Geometry, colors: np.ndarray, hatches: Mapping[str, np.ndarray] = {}) -> list[Collection]:
    """Blocks filled with colors [blocks, 4], hatched where told so (hatch -> blocks), held ones hatched, deleted ones left out; edges
    on top."""
    present = ~run.removed(geometry.frame)[run.part_block]
    held = run.blocks["held"].astype(bool)[run.part_block]
    free = np.flatnonzero(present & ~held)
    color, of = np.unique(colors[run.part_block[free]], axis=0, return_inverse=True)
    filled = [(path, k) for k in range(len(color)) for path in _polygons(run, geometry, free[of.ravel() == k])]
    # An edge in the colour of the face closes the hairline between two parts of one block.
    drawn = [PathCollection([path for path, _ in filled], facecolors=[color[k] for _, k in filled], edgecolors="face", linewidths=0.3,
                            zorder=1),
             PathCollection(_polygons(run, geometry, np.flatnonzero(present & held)), **HELD, linewidths=0, zorder=1)]
    for pattern, blocks in hatches.items():
        parts = np.flatnonzero(present & np.isin(run.part_block, blocks))
        drawn.append(PathCollection(_polygons(run, geometry, parts), facecolor="none", edgecolor="#606060", hatch=pattern, linewidths=0,
                                    zorder=1.5))
    start, end, shown = _edges(run, geometry)
    drawn.append(PathCollection(_segments(start[shown], end[shown]), facecolor="none", edgecolors=EDGE, capstyle="round",
                                linewidths=width(ax, run, 0.03, 0.12, 0.6), zorder=2))
    for collection in drawn:
        add(ax, collection)
    return drawn


def _polygons(run: Run, geometry: Geometry, parts: np.ndarray) -> list[Path]:
    """Convex parts as a few paths of many polygons: of as many paths as polygons, matplotlib would take ten times as long."""
    paths = []
    for some in np.split(parts, range(TOGETHER, len(parts), TOGETHER)):
        first, count = run.first_corner[some], np.diff(run.first_corner)[some]
        begin = np.cumsum(count + 1) - count - 1  # of each ring, which ends where it begins
        corner = np.arange((count + 1).sum()) - np.repeat(begin, count + 1)
        corner = np.repeat(first, count + 1) + np.where(corner == np.repeat(count, count + 1), 0, corner)
        codes = np.full(len(corner), Path.LINETO, Path.code_type)
        codes[begin] = Path.MOVETO
        paths.append(Path(geometry.corners[corner], codes))
    return paths


def _segments(start: np.ndarray, end: np.ndarray) -> list[Path]:
    """Straight lines from start to end [n, 2] m as a few paths."""
    points = np.stack([start, end], axis=1).reshape(-1, 2)
    codes = np.tile(np.array([Path.MOVETO, Path.LINETO], Path.code_type), len(start))
    return [Path(some, code) for some, code in zip(np.split(points, range(2 * TOGETHER, len(points), 2 * TOGETHER)),
                                                   np.split(codes, range(2 * TOGETHER, len(codes), 2 * TOGETHER)))]


def held_handle() -> Patch:
    return Patch(**HELD, linewidth=0.5, label="held")


def draw_joints(ax: Axes, run: Run, geometry: Geometry, by: str) -> list[Line2D]:
    """Contacts as lines along the joint, coloured by `state` or by the `name` of the joint; not those that are open: they have
    no length, and gaps show by themselves. Returns the legend's entries."""
    contacts = run.contacts(geometry.frame)
    if not contacts or not len(contacts["x"]):
        return []
    if by == "state":
        kind, names, colors = shown_state(contacts), JOINT_STATES, list(STATE_COLORS.values())
    else:
        kind, names = contacts["joint"], run.joint_names
        colors = [NAME_COLORS[k % len(NAME_COLORS)] for k in range(len(names))]
    along = np.column_stack([-contacts["ny"], contacts["nx"]]) * (contacts["length"] / 2)[:, None]
    middles = _middles(run, geometry.frame, contacts)
    handles, wide = [], width(ax, run, 0.08, 0.5, 2.2)
    for k, (name, color) in enumerate(zip(names, colors)):
        rows = (kind == k) & (contacts["state"] != OPEN)
        if not rows.any():
            continue
        middle, half, block = middles[rows], along[rows], contacts["block_a"][rows]
        ends = [geometry.carried(middle + sign * half, block) for sign in (-1, 1)]
        plain = by == "state" and name == "elastic"  # the usual case stays in the background
        add(ax, LineCollection(np.stack(ends, axis=1), colors=color, linewidths=0.4 * wide if plain else wide,
                                         zorder=3 if plain else 4))
        handles.append(Line2D([], [], color=color, linewidth=2.2, label=f"{name} ({rows.sum()})"))
    return handles


def _middles(run: Run, frame: int, contacts) -> np.ndarray:
    """[n, 2] m: middles of the stretches along which contacts touch. The point of a contact is its centre of pressure, which
    lies beside the middle where the stress is uneven: the line is moved until it lies between the ends of both parts."""
    point = points_of(contacts)
    along = np.column_stack([-contacts["ny"], contacts["nx"]]).astype(float)
    start = run.corners(frame)
    edge = start[run.next_corner] - start
    outward = np.column_stack([edge[:, 1], -edge[:, 0]]) / np.hypot(*edge.T)[:, None]
    low, high = np.full(len(point), -np.inf), np.full(len(point), np.inf)
    for part in (contacts["part_a"], contacts["part_b"]):
        count = np.diff(run.first_corner)[part]
        row = np.repeat(np.arange(len(part)), count)
        k = np.arange(len(row)) + np.repeat(run.first_corner[part] - np.cumsum(count) + count, count)
        slope = np.sum(outward[k] * along[row], axis=1)
        across = np.abs(slope) > 0.1  # the edge that touches runs along the joint and ends nothing
        end = np.sum(outward[k] * (start[k] - point[row]), axis=1)[across] / slope[across]
        up = slope[across] > 0
        np.minimum.at(high, row[across][up], end[up])
        np.maximum.at(low, row[across][~up], end[~up])
    half = np.minimum(contacts["length"], high - low) / 2
    return point + along * np.clip(0.0, low + half, high - half)[:, None]


def shown_state(contacts) -> np.ndarray:
    """States for a picture: contacts that carry next to nothing tremble about zero and count as slipped, not as sliding. The
    limit is that of the summary of `talus run`."""
    force = np.hypot(contacts["normal_force"], contacts["shear_force"])
    touching = contacts["state"] != OPEN
    light = force <= LIGHT * (force[touching].mean() if touching.any() else 0.0)
    sliding, slipped = JOINT_STATES.index("sliding"), JOINT_STATES.index("slipped")
    return np.where(light & (contacts["state"] == sliding), slipped, contacts["state"])


def draw_outline(ax: Axes, run: Run, geometry: Geometry, label: str) -> list[Line2D]:
    """Where the free blocks stand, as a dashed line: around each of a few, around all of many."""
    free = np.flatnonzero(~run.removed(geometry.frame)[run.part_block] & ~run.blocks["held"].astype(bool)[run.part_block])
    if not len(free):
        return []
    if len(np.unique(run.part_block[free])) <= OUTLINED:
        start, after, shown = _edges(run, geometry)
        lines = np.stack([start, after], axis=1)[shown & np.isin(run.corner_block, run.part_block[free])]
    else:
        polygons = geometry.polygons
        lines = silhouette([polygons[p] for p in free], 0.5 * block_size(run) ** 2)
    add(ax, LineCollection(lines, colors=BEFORE, linewidths=1.0, linestyles=(0, (4, 2)), zorder=6))
    return [Line2D([], [], color=BEFORE, linewidth=1.0, linestyle=(0, (4, 2)), label=label)]


def _edges(run: Run, geometry: Geometry) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Ends [corners, 2] m of the edge that starts at each corner, and whether [corners] it is seen."""
    start = geometry.corners
    return start, start[run.next_corner], ~run.internal & ~run.removed(geometry.frame)[run.corner_block]


def mark(ax: Axes, points: np.ndarray, label: str) -> list[Line2D]:
    """Rings around places that deserve a look."""
    if not len(points):
        return []
    return ax.plot(*points.T, linestyle="none", marker="o", markersize=11, markerfacecolor="none", markeredgecolor="#d55e00",
                   markeredgewidth=1.4, zorder=6, label=label)


def add(ax: Axes, collection: Collection) -> None:
    """The limits of the axes are set already; leaving the collection out of them and of the layout saves half of the time."""
    collection.set_in_layout(False)
    ax.add_collection(collection, autolim=False)


def points_of(contacts) -> np.ndarray:
    """[n, 2] m, where contacts act."""
    return np.column_stack([contacts["x"], contacts["y"]])
