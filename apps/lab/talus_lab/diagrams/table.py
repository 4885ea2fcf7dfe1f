"""The table of a sweep: its folder holds sweep.json, which says what the columns are, and table.h5 or table.csv."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Iterable, Mapping

import h5py
import numpy as np

from talus_lab.errors import ResultError, nearest
from talus_lab.style import MODES
from talus_lab.units import axis_label

DONE = "done"
REPETITION = "repetition"


@dataclass(frozen=True)
class Parameter:
    """What varies. kind: grid, drawn (at random) or repetition (of the same with another seed)."""

    name: str
    unit: str
    label: str
    kind: str = "grid"
    log: bool = False  # drawn so that equal ratios are equally likely
    order: tuple[str, ...] = ()  # of values that are words, as the config has them


@dataclass(frozen=True)
class Table:
    """One row for each case. Columns are arrays [cases] of numbers (nan where there is none) or texts."""

    path: Path
    title: str
    columns: Mapping[str, np.ndarray]
    parameters: Mapping[str, Parameter]
    measures: tuple[str, ...]
    units: Mapping[str, str]
    labels: Mapping[str, str]
    config: Path | None = None

    def column(self, name: str) -> np.ndarray:
        """Raises ResultError with the nearest right name."""
        if name not in self.columns:
            raise ResultError(f"{self.path}: no column {name}{nearest(name, self.columns)}")
        return self.columns[name]

    def numbers(self, name: str) -> np.ndarray:
        """[cases]; nan for cases that are not done, and where a number is not finite. Of a parameter whose values are words: their places in `words`.
        Raises ResultError if a measure holds words."""
        column = self.column(name)
        if name in self.parameters and column.dtype.kind not in "fiub":
            return np.array([self.words(name).index(value) for value in column.tolist()], float)
        if column.dtype.kind not in "fiub":
            raise ResultError(f"{self.path}: {name} holds words, not numbers; numbers are in {', '.join(self.numeric)}")
        return column.astype(float) if name in self.parameters else np.where(self.done & np.isfinite(column), column.astype(float), np.nan)

    def words(self, name: str) -> list[str]:
        """Values of a parameter that are words, in the order of the config; empty if they are numbers."""
        there = set(self.columns[name].tolist()) if self.columns[name].dtype.kind not in "fiub" else set()
        order = self.parameters[name].order
        return sorted(there, key=lambda value: (order.index(value) if value in order else len(order), value))

    @property
    def numeric(self) -> list[str]:
        """Measures that are numbers, and known for at least one case."""
        numbers = [name for name in self.measures if self.columns[name].dtype.kind in "fiub"]
        return [name for name in numbers if np.isfinite(self.columns[name].astype(float)).any()]

    @cached_property
    def done(self) -> np.ndarray:
        return self.columns["status"] == DONE if "status" in self.columns else np.ones(len(self), bool)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()))) if self.columns else 0

    def varied(self, kind: str | None = None) -> list[str]:
        """Parameters with more than one value, of one kind or but for repetitions."""
        return [name for name, p in self.parameters.items()
                if (p.kind == kind if kind else p.kind != REPETITION) and len(set(self.columns[name].tolist())) > 1]

    def label(self, name: str) -> str:
        return axis_label(self.labels.get(name, name), self.units.get(name, ""))

    @cached_property
    def mode(self) -> np.ndarray:
        """[cases] key of style.MODES: stable, the mechanism of unstable ones, undecided, failed; empty for cases not computed yet."""
        if "verdict" not in self.columns and "mechanism" not in self.columns:
            raise ResultError(f"{self.path}: has neither verdict nor mechanism among its measures")
        count = len(self)
        verdict = self.columns.get("verdict", np.full(count, ""))
        mechanism = self.columns.get("mechanism", np.full(count, ""))
        return np.array([_mode(*row) for row in zip(self.columns.get("status", np.full(count, DONE)), verdict, mechanism)], dtype=object)

    def only(self, rows: np.ndarray) -> Table:
        """The same with the rows [cases] for which it is true."""
        return Table(self.path, self.title, {name: column[rows] for name, column in self.columns.items()}, self.parameters, self.measures,
                     self.units, self.labels, self.config)


def _mode(status: str, verdict: str, mechanism: str) -> str:
    if status in ("", "missing", "running"):
        return ""
    if status != DONE:
        return "failed"
    if verdict in ("stable", "undecided"):
        return str(verdict)
    if not verdict and mechanism in ("none", ""):
        return "stable"
    return str(mechanism) if mechanism in MODES and mechanism != "none" else "unstable"


def read_table(folder: str | Path) -> Table:
    """The table of a sweep's folder, or of the sweep.json in it. Raises ResultError."""
    folder = Path(folder)
    folder = folder.parent if folder.name == "sweep.json" else folder
    if not folder.is_dir():
        raise ResultError(f"{folder}: no such folder")
    try:
        about = json.loads((folder / "sweep.json").read_text(encoding="utf-8"))
        columns = _from_h5(folder / "table.h5") if (folder / "table.h5").exists() else _from_csv(folder / "table.csv")
        parameters = {p["name"]: Parameter(p["name"], p.get("unit", ""), _words(p), p.get("kind", "grid"), p.get("scale") == "log",
                                           tuple(value if isinstance(value, str) else json.dumps(value) for value in p.get("values", ())))
                      for p in about["parameters"]}
        measures = {m["name"]: m for m in about["measures"]}
        lost = [name for name in (*parameters, *measures) if name not in columns]
    except FileNotFoundError as error:
        raise ResultError(f"{folder}: is not the folder of a sweep, it has no {Path(error.filename).name}") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ResultError(f"{folder}: its table or sweep.json is damaged ({error})") from None
    if lost:
        raise ResultError(f"{folder}: the table has no column {', '.join(lost)}, which sweep.json names")
    about_all = {**{name: (p.unit, p.label) for name, p in parameters.items()},
                 **{name: (m.get("unit", ""), _words(m)) for name, m in measures.items()},
                 "wall_time": ("s", "computing time")}
    return Table(folder, about.get("title") or folder.name, columns, parameters, tuple(measures), {n: u for n, (u, _) in about_all.items()},
                 {n: label for n, (_, label) in about_all.items()}, Path(about["config"]) if about.get("config") else None)


def _words(described: dict) -> str:
    """The label, or the name as words."""
    name, label = described["name"], described.get("label")
    return label if label and label != name else name.removesuffix("_deg").replace("_", " ")


def _from_h5(path: Path) -> dict[str, np.ndarray]:
    with h5py.File(path, "r", locking=False) as file:
        columns = {name: data[()] for name, data in file.items()}
    return {name: np.char.decode(column, "utf-8") if column.dtype.kind == "S" else column for name, column in columns.items()}


def _from_csv(path: Path) -> dict[str, np.ndarray]:
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: _column([row[name] for row in rows]) for name in (rows[0] if rows else {})}


def _column(texts: Iterable[Any]) -> np.ndarray:
    texts = list(texts)
    try:
        return np.array([float(text) if text else np.nan for text in texts])
    except ValueError:
        return np.array(texts)
