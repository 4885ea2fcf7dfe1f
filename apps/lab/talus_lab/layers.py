"""What a picture is painted with: blocks, supports, joints, contact forces. Each function adds one layer to an axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection, PathCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path

from talus_lab.run import JOINT_STATES, Run, placed

OPEN = JOINT_STATES.index("open")
LIGHT = 0.01  # of the mean contact force
EDGE = "#262626"
HELD = dict(facecolor="#d9d9d9", edgecolor="#8c8c8c", hatch="////")
# Okabe and Ito's colours, which colour-blind people can tell apart
STATE_COLORS = dict(elastic="#9a9a9a", sliding="#d55e00", slipped="#e69f00", bonded="#0072b2", broken="#cc79a7")
NAME_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
PALE_COLORS = ("#e8dcc4", "#c9d8e6", "#d6e4c8", "#ead1dc", "#d9d2e9", "#f4e3b2", "#cfe5e2")


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

    @property
    def polygons(self) -> list[np.ndarray]:
        """[parts] of [corners, 2] m"""
        corners = placed(self.run.arm, self.position, self.angle, self.run.corner_block)
        return np.split(corners, self.run.first_corner[1:-1])

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


def draw_blocks(ax: Axes, run: Run, geometry: Geometry, colors: np.ndarray) -> None:
    """Blocks filled with colors [blocks, 4], held ones hatched, deleted ones left out; edges on top."""
    present = ~run.removed(geometry.frame)[run.part_block]
    held = run.blocks["held"].astype(bool)[run.part_block]
    polygons = geometry.polygons
    free_parts, held_parts = np.flatnonzero(present & ~held), np.flatnonzero(present & held)
    # An edge in the colour of the face closes the hairline between two parts of one block.
    _add(ax, PolyCollection([polygons[p] for p in free_parts], facecolors=colors[run.part_block[free_parts]],
                                     edgecolors="face", linewidths=0.3, zorder=1))
    _add(ax, PathCollection([_compound([polygons[p] for p in held_parts])], **HELD, linewidths=0, zorder=1))

    start = np.concatenate(polygons)
    after = np.arange(len(start)) + 1
    after[run.first_corner[1:] - 1] = run.first_corner[:-1]
    shown = ~run.internal & np.repeat(present, np.diff(run.first_corner))
    _add(ax, LineCollection(np.stack([start, start[after]], axis=1)[shown], colors=EDGE,
                                     linewidths=width(ax, run, 0.03, 0.12, 0.6), capstyle="round", zorder=2))


def _compound(polygons: list[np.ndarray]) -> Path:
    """All polygons as one path: hatching thousands of them one by one would take seconds."""
    codes = [np.r_[Path.MOVETO, np.full(len(polygon) - 1, Path.LINETO)] for polygon in polygons]
    return Path(np.concatenate(polygons), np.concatenate(codes)) if polygons else Path(np.empty((0, 2)))


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
        _add(ax, LineCollection(np.stack(ends, axis=1), colors=color, linewidths=0.4 * wide if plain else wide,
                                         zorder=3 if plain else 4))
        handles.append(Line2D([], [], color=color, linewidth=2.2, label=f"{name} ({rows.sum()})"))
    return handles


def _middles(run: Run, frame: int, contacts) -> np.ndarray:
    """[n, 2] m: middles of the stretches along which contacts touch. The point of a contact is its centre of pressure, which
    lies beside the middle where the stress is uneven: the line is moved until it lies between the ends of both parts."""
    point = _points(contacts)
    along = np.column_stack([-contacts["ny"], contacts["nx"]]).astype(float)
    start = run.corners(frame)
    after = np.arange(len(start)) + 1
    after[run.first_corner[1:] - 1] = run.first_corner[:-1]
    edge = start[after] - start
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


def draw_forces(ax: Axes, run: Run, geometry: Geometry) -> list[Line2D]:
    """Contact forces as lines through the point where they act, along the force, as wide as the force is large."""
    contacts = run.contacts(geometry.frame)
    if not contacts or not len(contacts["x"]):
        return []
    normal = np.column_stack([contacts["nx"], contacts["ny"]]).astype(float)
    force = normal * contacts["normal_force"][:, None]
    force += np.column_stack([-normal[:, 1], normal[:, 0]]) * contacts["shear_force"][:, None]
    size = np.hypot(*force.T)
    largest = size.max()
    if largest == 0:
        return []
    handles, widest = [], width(ax, run, 0.2, 1.0, 5.0)
    for label, color, pulls in (("contact force", "#a50026", False), ("tension", "#0072b2", True)):
        rows = (size > 0.01 * largest) & ((contacts["normal_force"] < 0) == pulls)
        if not rows.any():
            continue
        half = force[rows] / size[rows, None] * (0.35 * block_size(run))
        middle = geometry.carried(_points(contacts)[rows], contacts["block_a"][rows])
        _add(ax, LineCollection(np.stack([middle - half, middle + half], axis=1), colors=color,
                                         linewidths=widest * size[rows] / largest, zorder=5))
        handles.append(Line2D([], [], color=color, linewidth=widest * size[rows].max() / largest,
                              label=f"{label}, largest {quantity(size[rows].max(), 'N')}/m"))
    return handles


def mark(ax: Axes, points: np.ndarray, label: str) -> list[Line2D]:
    """Rings around places that deserve a look."""
    if not len(points):
        return []
    return ax.plot(*points.T, linestyle="none", marker="o", markersize=11, markerfacecolor="none", markeredgecolor="#d55e00",
                   markeredgewidth=1.4, zorder=6, label=label)


def prefix(value: float, unit: str) -> tuple[float, str]:
    """Factor and unit with which a value reads well: 2.5e-3 m -> (1e3, 'mm'). Times are in s down to a tenth of it."""
    steps: Sequence[tuple[float, str]] = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")]
    if unit in ("m", "m/s", "s", "deg"):
        steps = steps[3:] if unit != "deg" else [(1, "")]
    rounded = abs(float(f"{value:.4g}"))  # 0.99999 s is 1 s, not 1000 ms
    for size, letter in steps:
        if rounded >= (0.1 if unit == "s" and size == 1 else size):
            return 1 / size, letter + unit
    return 1.0, unit


def quantity(value: float, unit: str, digits: int = 3) -> str:
    factor, unit = prefix(value, unit)
    return f"{float(f'{value * factor:.{digits}g}'):.12g} {unit}"  # 1200, not 1.2e+03


def _add(ax: Axes, collection: Collection) -> None:
    """The limits of the axes are set already; leaving the collection out of them and of the layout saves half of the time."""
    collection.set_in_layout(False)
    ax.add_collection(collection, autolim=False)


def _points(contacts) -> np.ndarray:
    return np.column_stack([contacts["x"], contacts["y"]])
