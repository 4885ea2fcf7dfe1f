"""Picks numbers out of the rows of a study."""

from __future__ import annotations

import math
from typing import Any, Iterable, Mapping

from talus_lab.bench.config import METHODS

Rows = Iterable[Mapping[str, str]]


def series(rows: Rows, column: str, studies: list[str], scene: str, where: Mapping[str, Any] | None = None) -> dict[str, dict[float, float]]:
    """By method, as `isu` or `isu@2` for two threads: the value of the quantity varied -> the number in this column. Of numbers for
    one value the first counts. Empty where nothing was measured."""
    found: dict[str, dict[float, float]] = {}
    for row in rows:
        if row["study"] in studies and row["scene"] == scene and row[column] and all(_same(row[k], v) for k, v in (where or {}).items()):
            found.setdefault(label(row), {}).setdefault(float(row["value"]), float(row[column]))
    return {name: dict(sorted(found[name].items())) for name in sorted(found, key=_place)}


def totals(rows: Rows, column: str, study: str, scene: str) -> dict[str, dict[float, float]]:
    """By method: the value of the quantity varied -> the sum of this column over all numbers of threads and skins."""
    found: dict[str, dict[float, float]] = {}
    for row in rows:
        if row["study"] == study and row["scene"] == scene and row[column]:
            line = found.setdefault(row["method"], {})
            line[float(row["value"])] = line.get(float(row["value"]), 0.0) + float(row[column])
    return found


def label(row: Mapping[str, str]) -> str:
    return row["method"] if row["threads"] in ("", "1") else f"{row['method']}@{row['threads']}"


def words(name: str) -> str:
    """`isu@2` as people read it."""
    method, _, threads = name.partition("@")
    return f"{method}, {threads} threads" if threads else method


def growth(line: Mapping[float, float], low: float, high: float) -> float:
    """The exponent p of a power law through the values at low and high."""
    if low not in line or high not in line:
        return math.nan
    return math.log(line[high] / line[low]) / math.log(high / low)


def _same(given: str, wanted: Any) -> bool:
    try:
        return float(given) == float(wanted)
    except ValueError:
        return given == str(wanted)


def _place(name: str) -> tuple:
    method = name.partition("@")[0]
    return (METHODS.index(method) if method in METHODS else len(METHODS), method, name)
