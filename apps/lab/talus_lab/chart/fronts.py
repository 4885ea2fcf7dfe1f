"""What a method can do: for each error the least CPU time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Iterable, Mapping

from talus_lab.chart.config import LARGEST, Config
from talus_lab.chart.measure import parts

Rows = Iterable[Mapping[str, str]]

# Errors change their sign on the way from coarse to fine settings, and are small where they do: an error counts where a dearer setting
# of the method has at most so many times of it, or there is none. With 1 hardly anything would count but lines that fall all the way,
# with 10 the sign changes would.
CONFIRMED = 3.0
# Dearer by more than this: times of the same work differ by a quarter from run to run, and the static solver gets finer at no cost.
DEARER = 1.5
NOTHING = 1e-9  # smaller errors are the same


@dataclass(frozen=True)
class Point:
    cpu_time: float  # s per second of the scene
    error: float
    setting: str


def points(rows: Rows, scene: str, error: str = LARGEST) -> dict[str, list[Point]]:
    """By method: all settings that gave a result, in the order of their CPU time. An error below what the reference knows counts as
    that."""
    found: dict[str, list[Point]] = {}
    for row in rows:
        if row["scene"] == scene and row["error"]:
            size = float(row["error"]) if error == LARGEST else parts(row["errors"])[error]
            found.setdefault(row["method"], []).append(Point(float(row["cpu_time"]), max(size, float(row["unsure"])), row["setting"]))
    return {method: sorted(line, key=lambda point: (point.cpu_time, point.error)) for method, line in found.items()}


def confirmed(line: list[Point]) -> list[Point]:
    """Those of the points whose error is no accident. line: in the order of the CPU time."""
    return [point for k, point in enumerate(line)
            if line[-1].cpu_time <= DEARER * point.cpu_time
            or min(later.error for later in line[k + 1:]) <= CONFIRMED * max(point.error, NOTHING)]


def front(line: Iterable[Point]) -> list[Point]:
    """Those of the points that no other one beats in time and error."""
    best: list[Point] = []
    for point in line:
        if not best or point.error < best[-1].error:
            best.append(point)
    return best


def least(line: Iterable[Point], level: float) -> Point | None:
    """The cheapest point with an error of at most this."""
    return next((point for point in line if point.error <= level), None)


def best(config: Config, rows: Rows, scene: str, level: float, ours: bool) -> tuple[str, Point] | None:
    """Of our methods or of the other programs: the cheapest, and its point."""
    found = {method: point for method, line in points(rows, scene).items()
             if config.methods[method].ours == ours and (point := least(confirmed(line), level))}
    return min(found.items(), key=lambda item: item[1].cpu_time, default=None)
