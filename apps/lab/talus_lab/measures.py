"""Numbers of a run: each measure is a function of a Run and gives one number or word, or a few arrays. None changes anything.

>>> measures.run_out(run)
3.25
>>> measures.evaluate(run, "max_displacement"), measures.MEASURES["max_displacement"].unit
(0.04, 'm')
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from talus_lab.errors import ResultError, nearest
from talus_lab.run import Run

AT = {"end": lambda values: values[-1], "start": lambda values: values[0], "max": np.max, "min": np.min, "mean": np.mean,
      "largest": lambda values: np.max(np.abs(values))}
UNTOLD = "undecided"  # of a run that ended before anything could be said


@dataclass(frozen=True)
class Measure:
    """function(run, **options) -> number or word; unit "-" for words."""

    function: Callable[..., Any]
    unit: str
    label: str


# What the engine has said
def verdict(run: Run) -> str:
    """stable | unstable | undecided, also undecided if the run ended before anything could be said."""
    return str(run.verdict.get("verdict", UNTOLD))


def mechanism(run: Run) -> str:
    """none | slide | topple | slide and topple | fall | rotation, of the whole moving mass."""
    return str(run.verdict.get("mechanism", "none"))


def moving_blocks(run: Run) -> float:
    """Number of blocks that move, by the verdict; nan without one."""
    return _told(run, "moving_blocks")


def detached_blocks(run: Run) -> float:
    """Number of blocks that have come off, by the verdict; nan without one."""
    return _told(run, "detached_blocks")


def moving_area(run: Run) -> float:
    """m2, of the blocks that move, by the verdict; nan without one."""
    return _told(run, "moving_area")


def moving_share(run: Run) -> float:
    """Their share of the area of all free blocks, by the verdict; nan without one."""
    return _told(run, "moving_share")


def _told(run: Run, name: str) -> float:
    return float(run.verdict.get(name, np.nan))


# Motion
def max_displacement(run: Run, frame: int = -1) -> float:
    """m, largest displacement of a block that is neither held nor deleted, since the last reset."""
    return float(np.hypot(*run.displacement(frame)[_free(run, frame)].T).max(initial=0.0))


def max_rotation_deg(run: Run, frame: int = -1) -> float:
    """deg, largest rotation either way, of the same blocks."""
    return float(np.degrees(np.abs(run.rotation(frame)[_free(run, frame)]).max(initial=0.0)))


def max_speed(run: Run, frame: int = -1) -> float:
    """m/s, of the same blocks."""
    return float(np.hypot(*run.velocity(frame)[_free(run, frame)].T).max(initial=0.0))


def moved_blocks(run: Run, limit: float = 0.1, frame: int = -1) -> int:
    """Number of blocks displaced by more than `limit` m."""
    return int(_moved(run, limit, frame).sum())


def moved_area(run: Run, limit: float = 0.1, frame: int = -1) -> float:
    """m2, of the blocks displaced by more than `limit` m."""
    return float(run.blocks["area"][_moved(run, limit, frame)].sum())


def displacement(run: Run, point: Sequence[float], component: str = "magnitude", frame: int = -1) -> float:
    """m, of the centroid of the block that was at `point` (x, y in m) when the scene was built, or nearest to it.
    component: x, y or magnitude."""
    if component not in ("x", "y", "magnitude"):
        raise ResultError(f"component: {component}{nearest(component, ('x', 'y', 'magnitude'))}")
    moved = run.displacement(frame)[block_at(run, point)]
    return float(np.hypot(*moved) if component == "magnitude" else moved["xy".index(component)])


def run_out(run: Run, frame: int = -1, limit: float = 0.1) -> float:
    """m, by how much the blocks that have moved by more than `limit` m reach farther to the right than all of them together did in the first
    frame, or to the left if that is more."""
    moved = _moved(run, limit, frame)[run.corner_block]
    if not moved.any():
        return 0.0
    before = run.corners(0)[moved, 0]
    after = run.corners(frame)[moved, 0]
    return float(max(after.max() - before.max(), before.min() - after.min(), 0.0))


def _free(run: Run, frame: int) -> np.ndarray:
    return ~run.blocks["held"].astype(bool) & ~run.removed(frame)


def _moved(run: Run, limit: float, frame: int) -> np.ndarray:
    return _free(run, frame) & (np.hypot(*run.displacement(frame).T) > limit)


def block_at(run: Run, point: Sequence[float]) -> int:
    """The block in which a point (x, y in m) lay in the first frame, or the one whose centroid was nearest to it."""
    start = run.corners(0) - np.asarray(point, float)
    edge = start[run.next_corner] - start
    left = edge[:, 1] * start[:, 0] - edge[:, 0] * start[:, 1] >= 0  # the point is to the left of every edge of a convex part around it
    inside = np.flatnonzero(np.logical_and.reduceat(left, run.first_corner[:-1]))
    if len(inside):
        return int(run.part_block[inside[0]])
    return int(np.argmin(np.hypot(*(run.position(0) - point).T)))


# Histories, energies, the run itself
def history(run: Run, name: str, column: str | None = None, at: str = "end") -> float:
    """In the unit of the column: a value of a history. column: may be left out if there is but one beside the time; `displacement.x` may
    stand for `displacement.x of block`. at: end | start | max | min | mean | largest (of the absolute values)."""
    return _at(run.history(name)[_column(run, name, column)], at)


def _column(run: Run, name: str, column: str | None) -> str:
    columns = [word for word in run.history(name) if word != "time"]
    meant = [word for word in columns if column is None or word == column or word.startswith(f"{column} ")]
    if len(meant) > 1:
        raise ResultError(f"{run.path}: history {name}: say which column of {', '.join(meant)}")
    if not meant:
        raise ResultError(f"{run.path}: history {name}: no column {column}{nearest(column, columns)}")
    return meant[0]


def energy(run: Run, name: str = "kinetic", at: str = "end") -> float:
    """J per m: kinetic, friction, ... of the frames; at as in `history`."""
    if name not in run.energies:
        raise ResultError(f"{run.path}: no energy {name}{nearest(name, run.energies)}")
    return _at(run.energies[name], at)


def _at(values: np.ndarray, at: str) -> float:
    if at not in AT:
        raise ResultError(f"at: {at}{nearest(at, AT)}")
    return float(AT[at](values)) if len(values) else float("nan")


def end_time(run: Run) -> float:
    """s, time of the last frame."""
    return float(run.times[-1]) if run.frame_count else float("nan")


def wall_time(run: Run) -> float:
    """s, that the run took since it was resumed last; nan if it was killed."""
    return float(run.attributes.get("wall_time", np.nan))


def steps(run: Run) -> float:
    """Number of steps; nan if the run was killed."""
    return float(run.attributes.get("steps", np.nan))


# Contacts
def stress_along(run: Run, start: Sequence[float], end: Sequence[float], frame: int = -1,
                 reach: float | None = None) -> Mapping[str, np.ndarray]:
    """Stresses on the joints along a straight line from `start` to `end` (x, y in m): [n] each, in the order of `distance` [m] from the
    start: normal_stress and shear_stress [Pa], opening and slip [m], utilisation [1], length [m], state.
    Contacts within `reach` m of the line (default: a hundredth of its length) whose joint runs along it, within 10 degrees."""
    start, along = np.asarray(start, float), np.asarray(end, float) - start
    length = float(np.hypot(*along))
    if length == 0:
        raise ResultError("a line needs two different points")
    along /= length
    contacts = run.contacts(frame)
    if not contacts:
        raise ResultError(f"{run.path}: has no contacts; the scenario says record: {{contacts: false}}")
    from_start = np.column_stack([contacts["x"], contacts["y"]]) - start
    distance = from_start @ along
    beside = np.abs(from_start @ [-along[1], along[0]])
    slant = np.abs(contacts["nx"] * along[0] + contacts["ny"] * along[1])  # 0 where the normal stands upright on the line
    on = (beside <= (0.01 * length if reach is None else reach)) & (distance >= 0) & (distance <= length) & (slant < np.sin(np.radians(10)))
    order = np.flatnonzero(on)[np.argsort(distance[on], kind="stable")]
    columns = ("normal_stress", "shear_stress", "opening", "slip", "utilisation", "length", "state")
    return {"distance": distance[order], **{name: contacts[name][order] for name in columns if name in contacts}}


MEASURES: Mapping[str, Measure] = {
    "verdict": Measure(verdict, "-", "verdict"),
    "mechanism": Measure(mechanism, "-", "mechanism"),
    "moving_blocks": Measure(moving_blocks, "1", "moving blocks"),
    "detached_blocks": Measure(detached_blocks, "1", "detached blocks"),
    "moving_area": Measure(moving_area, "m2", "moving area"),
    "moving_share": Measure(moving_share, "1", "moving share of the area"),
    "max_displacement": Measure(max_displacement, "m", "largest displacement"),
    "max_rotation_deg": Measure(max_rotation_deg, "deg", "largest rotation"),
    "max_speed": Measure(max_speed, "m/s", "largest speed"),
    "moved_blocks": Measure(moved_blocks, "1", "moved blocks"),
    "moved_area": Measure(moved_area, "m2", "area moved"),
    "displacement": Measure(displacement, "m", "displacement"),
    "run_out": Measure(run_out, "m", "run-out"),
    "history": Measure(history, "as recorded", "history"),
    "energy": Measure(energy, "J", "energy"),
    "end_time": Measure(end_time, "s", "simulated time"),
    "wall_time": Measure(wall_time, "s", "computing time"),
    "steps": Measure(steps, "1", "steps"),
}


def evaluate(run: Run, name: str, /, **options: Any) -> Any:
    """The measure of this name. Raises ResultError if there is none, or none with such options."""
    if name not in MEASURES:
        raise ResultError(f"no measure is called {name}{nearest(name, MEASURES)}")
    try:
        return MEASURES[name].function(run, **options)
    except TypeError as error:
        raise ResultError(f"measure {name}: {error}") from None


def unit(run: Run, name: str, /, **options: Any) -> str:
    """The unit of a measure; that of a history is what its column says."""
    if name == "history":
        return run.unit(f"histories/{options['name']}/{_column(run, options['name'], options.get('column'))}")
    return MEASURES[name].unit
