"""How the blocks of a scene moved, whoever computed it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping

import numpy as np

from talus_lab.run import ResultError, Run


@dataclass(frozen=True)
class Motion:
    """[k] states of [n] blocks, the first of them the start."""

    time: np.ndarray      # [k] s
    position: np.ndarray  # [k, n, 2] m, centroids
    angle: np.ndarray     # [k, n] rad, turned since the start

    def displacement(self) -> np.ndarray:
        """[n, 2] m, from the start to the end."""
        return self.position[-1] - self.position[0]


def motion_of_run(run: Run) -> Motion:
    frames = range(run.frame_count)
    start = run.angle(0)
    return Motion(run.times, np.stack([run.position(k) for k in frames]), np.stack([run.angle(k) - start for k in frames]))


def motion_of_json(result: Mapping[str, Any], blocks: int) -> Motion:
    """Raises ResultError if it is not what docs/runners.md says, or a number of it is none."""
    try:
        arrays = {name: np.atleast_1d(np.asarray(result[name], dtype=float)) for name in ("time", "position", "angle")}
    except (KeyError, TypeError, ValueError) as error:
        raise ResultError(f"no result: {error}") from None
    states = len(arrays["time"])
    for name, array in arrays.items():
        shape = {"time": (states,), "angle": (states, blocks), "position": (states, blocks, 2)}[name]
        if array.shape != shape:
            raise ResultError(f"no result: {name} has the shape {array.shape} in place of {shape}")
        if not np.isfinite(array).all():
            raise ResultError(f"{name} is no longer a number")
    return Motion(**arrays)
