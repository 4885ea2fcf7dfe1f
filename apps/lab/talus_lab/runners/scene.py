"""What the runners share: reading a scene, stepping through it, and the states that are looked at. Needs nothing but Python."""

from __future__ import annotations

import json
import math
import sys
import time
from bisect import bisect_right
from collections import Counter
from pathlib import Path
from typing import Any, Callable, Iterator


def main(compute: Callable[[dict], dict]) -> None:
    """Reads the scene named first on the command line and writes what `compute` returns to the file named second."""
    scene = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    Path(sys.argv[2]).write_text(json.dumps(compute(scene)), encoding="utf-8")


def drive(scene: dict, rate: float, step: Callable[[float], None], look: Callable[[], tuple[list, list]],
          pull: Callable[[float, float], None]) -> dict:
    """Steps to the end; returns the result. step(dt); look() -> positions in m, angles in rad; pull(x, y) sets gravity in m/s2."""
    count = max(1, math.ceil(scene["end"] * rate - 1e-9))
    frames = min(scene["frames"], count)
    looked_at = {round(k * count / frames) for k in range(1, frames + 1)}
    dt = scene["end"] / count
    states = [(0.0, *look())]
    steady = len(scene["gravity"]["time"]) == 1
    pull(*gravity(scene, 0.0))
    cpu, begun = 0.0, time.process_time()
    for k in range(1, count + 1):
        if not steady:
            pull(*gravity(scene, (k - 0.5) * dt))
        step(dt)
        if k in looked_at:
            cpu += time.process_time() - begun
            states.append((k * dt, *look()))
            begun = time.process_time()
    return {"cpu_time": cpu, "time": [s[0] for s in states], "position": [s[1] for s in states], "angle": [s[2] for s in states]}


def gravity(scene: dict, t: float) -> tuple[float, float]:
    """m/s2, at a time."""
    table = scene["gravity"]
    times = table["time"]
    k = bisect_right(times, t)
    if k == 0 or k == len(times):
        return table["x"][max(0, k - 1)], table["y"][max(0, k - 1)]
    share = (t - times[k - 1]) / (times[k] - times[k - 1])
    return tuple(table[axis][k - 1] + share * (table[axis][k] - table[axis][k - 1]) for axis in "xy")


def welds(scene: dict) -> Iterator[dict[str, Any]]:
    """Bonded contacts of two blocks of which one at least is free."""
    for contact in scene["contacts"]:
        if contact["bonded"] and not (scene["blocks"][contact["a"]]["held"] and scene["blocks"][contact["b"]]["held"]):
            yield contact


def common_friction(scene: dict) -> float:
    """Of the contacts that can slip, where all have the same; else this program cannot compute the scene."""
    found = Counter(contact["friction"] for contact in scene["contacts"] if not contact["bonded"])
    if len(found) > 1:
        sys.exit(f"one friction for all contacts, not {len(found)}")
    return next(iter(found), scene["friction"])
