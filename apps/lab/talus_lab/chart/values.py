"""Numbers that a motion is judged by: `f(Motion, Look) -> number`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable

import numpy as np

from talus_lab.chart.motion import Motion
from talus_lab.errors import ResultError


@dataclass(frozen=True)
class Look:
    """What of a motion is looked at."""

    blocks: np.ndarray  # indices
    mass: np.ndarray    # kg, of all blocks
    inertia: np.ndarray  # kg m2
    velocity: np.ndarray  # [n, 2] m/s, at the start
    direction: np.ndarray | None = None  # unit vector; None: whatever the direction
    tilt: float = 0.0  # rad, of the first block at the start


def travel(motion: Motion, look: Look) -> float:
    """m, mean way."""
    moved = motion.displacement()[look.blocks]
    return float(np.mean(moved @ look.direction) if look.direction is not None else np.linalg.norm(moved.mean(axis=0)))


def scatter(motion: Motion, look: Look) -> float:
    """m, root of the mean square distance of each block from where their mean way would have taken it."""
    moved = motion.displacement()[look.blocks]
    return float(np.sqrt(np.mean(np.sum((moved - moved.mean(axis=0)) ** 2, axis=1))))


def mean_motion(motion: Motion, look: Look) -> float:
    """m, mean of the ways, whatever their direction."""
    return float(np.mean(_ways(motion, look)))


def largest_motion(motion: Motion, look: Look) -> float:
    """m, largest of the ways."""
    return float(np.max(_ways(motion, look)))


def energy_change(motion: Motion, look: Look) -> float:
    """1, largest change of the kinetic energy of a block that starts without spin, in parts of what it was. At the end blocks are
    taken to fly freely between the last two states."""
    dt = motion.time[-1] - motion.time[-2]
    speed = np.linalg.norm(motion.position[-1] - motion.position[-2], axis=1) / dt
    spin = (motion.angle[-1] - motion.angle[-2]) / dt
    before = look.mass * np.sum(look.velocity**2, axis=1)
    after = look.mass * speed**2 + look.inertia * spin**2
    return float(np.max(np.abs(after[look.blocks] / before[look.blocks] - 1.0)))


def impact_time(motion: Motion, look: Look) -> float:
    """s, when a block that rocks first stands upright, from the last three states before."""
    turn, k = _rocking(motion, look)
    time = motion.time[k - 3 : k]
    curve = np.polynomial.Polynomial.fit(time, turn[k - 3 : k], 2)
    roots = [root.real for root in curve.roots() if abs(root.imag) < 1e-9 and root.real >= time[-1]]
    if not roots:
        raise ResultError("the block never stands upright")
    return min(roots)


def amplitude(motion: Motion, look: Look) -> float:
    """rad, how far a block that rocks goes to the other side: summit of the parabola through three states."""
    turn, k = _rocking(motion, look)
    other = -turn[k:]
    top = int(np.argmax(other))
    if top == 0 or top == len(other) - 1:
        raise ResultError("the block does not come to rest on its other side")
    a, b, c = other[top - 1 : top + 2]
    return float(b + (c - a) ** 2 / (8.0 * (2.0 * b - a - c)))  # states at equal times


def _ways(motion: Motion, look: Look) -> np.ndarray:
    moved = motion.displacement()[look.blocks]
    return np.abs(moved @ look.direction) if look.direction is not None else np.linalg.norm(moved, axis=1)


def _rocking(motion: Motion, look: Look) -> tuple[np.ndarray, int]:
    """[k] rad, tilt of the first block, positive at the start; and the first state at which it has gone over to its other side."""
    turn = look.tilt + motion.angle[:, look.blocks[0]]
    if turn[0] < 0:
        turn = -turn
    over = np.flatnonzero(turn < 0)
    if not len(over) or over[0] < 3:
        raise ResultError("the block does not rock")
    return turn, int(over[0])


VALUES: dict[str, Callable[[Motion, Look], float]] = {
    f.__name__: f for f in (travel, scatter, mean_motion, largest_motion, energy_change, impact_time, amplitude)}
