"""Which diagrams are drawn of a sweep: as a config lists them under `pictures`, as the command line says, or those that fit its table."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from talus_lab.diagrams.boundaries import Curve
from talus_lab.diagrams.maps import failing, probability, value_map
from talus_lab.diagrams.modes import modes
from talus_lab.diagrams.ranking import scatter, tornado
from talus_lab.diagrams.table import REPETITION, Table
from talus_lab.errors import ResultError, nearest
from talus_lab.study.entries import entry, read_lines, read_yaml, report, section, strangers
from talus_lab.style import WIDTH_CM

KINDS = ("modes", "map", "probability", "tornado", "scatter")


@dataclass(frozen=True)
class Picture:
    """What an entry of `pictures` may say. What is left out is chosen to fit the table."""

    kind: str
    x: str = ""
    y: str = ""
    panel: str = ""
    value: str = ""
    limit: Any = None
    by: str = "rank"
    only: dict = field(default_factory=dict)  # parameter: value or list of values; other cases are left out
    curves: list = field(default_factory=list)
    title: str = ""
    width_cm: float = WIDTH_CM


def lists_pictures(path: Path) -> bool:
    """Whether there is a config with a section `pictures`."""
    return path.is_file() and "pictures" in read_yaml(path)


def read_pictures(path: Path) -> Mapping[str, Picture]:
    """The section `pictures` of a config. Raises ResultError with every fault, one per line."""
    given = read_yaml(path).get("pictures")
    faults: list[str] = []
    if not given:
        raise ResultError(f"{path}: pictures: is missing")
    found = section(Picture, given, "pictures", faults)
    for name, picture in found.items():
        faults += picture_faults(picture, f"pictures.{name}")
        curves = [entry(Curve, _typed(curve), f"pictures.{name}.curves[{k}]", faults) for k, curve in enumerate(picture.curves)]
        found[name] = replace(picture, curves=curves)
    report(path, faults, read_lines(path))
    return found


def unknown_names(pictures: Mapping[str, Picture], parameters: Sequence[str], columns: Sequence[str]) -> list[str]:
    """Faults of pictures of a table that does not exist yet. columns: all of the table, with its parameters."""
    faults = []
    for name, picture in pictures.items():
        where = f"pictures.{name}"
        for role in ("x", "y", "panel"):
            faults += strangers(filter(None, [getattr(picture, role)]), parameters, f"{where}.{role}")
        faults += strangers(filter(None, [picture.value]), columns, f"{where}.value") + strangers(picture.only, columns, f"{where}.only")
        for k, curve in enumerate(picture.curves):
            faults += [f"{where}.curves[{k}]: {fault}" for fault in curve.faults(dict.fromkeys(columns))]
    return faults


def _typed(curve: Any) -> Any:
    """YAML reads `y: 30` as a number; a formula is a text."""
    return {key: str(value) if key == "y" else value for key, value in curve.items()} if isinstance(curve, dict) else curve


def picture_faults(picture: Picture, where: str) -> list[str]:
    faults = [] if picture.kind in KINDS else [f"{where}.kind: unknown {picture.kind}{nearest(picture.kind, KINDS)}"]
    if picture.limit is not None and not isinstance(picture.limit, (int, float)):
        faults.append(f"{where}.limit: is not a number")
    return faults if 4 <= picture.width_cm <= 100 else faults + [f"{where}.width_cm: is from 4 to 100"]


def draw(table: Table, picture: Picture) -> Figure:
    """Raises ResultError for what the table does not have."""
    for name, values in picture.only.items():
        values = values if isinstance(values, list) else [values]
        rows = [value in values for value in table.column(name).tolist()]
        if not any(rows):
            raise ResultError(f"{table.path}: no case has {name} = {', '.join(map(str, values))}")
        table = table.only(rows)
    if picture.title:
        table = replace(table, title=picture.title)
    for curve in picture.curves:
        faults = curve.faults(table.columns)
        if faults:
            raise ResultError(f"{table.path}: curve {curve.theory or curve.y}: {faults[0]}")
    x, y, panel = _axes(table, picture)
    if picture.kind == "modes":
        return modes(table, x, y, panel, picture.curves, picture.width_cm)
    if picture.kind == "probability":
        return probability(table, x, y, panel, picture.value or None, picture.limit, picture.curves, picture.width_cm)
    value = picture.value or next(iter(table.numeric), "")
    if not value:
        raise ResultError(f"{table.path}: no measure is a number")
    if picture.kind == "map":
        return value_map(table, x, y, value, panel, picture.limit, picture.curves, picture.width_cm)
    return tornado(table, value, picture.by, picture.width_cm) if picture.kind == "tornado" else scatter(table, value, picture.width_cm)


def _axes(table: Table, picture: Picture) -> tuple[str, str | None, str | None]:
    """x, y and panel: those that are given, and for the others what varies, in the order of the config. The two with most values become
    x and y, words if there are not enough numbers."""
    given = [name for name in (picture.x, picture.y, picture.panel) if name]
    free = [name for name in table.varied() if name not in given]
    most = sorted(free, key=lambda name: (bool(table.words(name)), -len(set(table.columns[name].tolist()))))[:2 - bool(picture.x) - bool(picture.y)]
    free = sorted((name for name in free if name in most), key=lambda name: bool(table.words(name)))  # words have more room beside y
    x = picture.x or (free.pop(0) if free else "")
    alone = picture.kind == "probability" and not picture.y and (picture.x or not free)  # a curve over x
    y = picture.y or (free.pop(0) if free and not alone else "")
    if picture.kind in ("modes", "map") and not (x and y):
        there = ", ".join(table.varied()) or "none"
        raise ResultError(f"{table.path}: a picture of {picture.kind} needs two parameters that vary; there are {there}")
    if picture.kind == "probability" and not x:
        raise ResultError(f"{table.path}: nothing varies")
    words = [name for name in table.varied() if name not in (x, y)]
    few = [name for name in words if len(set(table.columns[name].tolist())) <= 6]
    panel = picture.panel or (few[0] if len(words) == 1 and few else None)
    return x, y or None, panel


def fitting(table: Table) -> dict[str, Picture]:
    """What is drawn when nothing is said."""
    told = {"verdict", "mechanism"} & set(table.columns)
    if any(table.parameters[name].kind == "drawn" for name in table.varied()) or len(table.varied()) > 3:
        return {"tornado": Picture("tornado"), "scatter": Picture("scatter")}
    if told and table.varied(REPETITION) and table.varied() and not np.isnan(failing(table, None, None)).all():
        return {"probability": Picture("probability")}
    if len(table.varied()) < 2:
        return {"scatter": Picture("scatter")}
    return ({"modes": Picture("modes")} if told else {}) | ({"map": Picture("map")} if table.numeric else {})
