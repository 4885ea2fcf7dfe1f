"""What of a case goes into the table: measures of talus_lab.measures, with their options."""

from __future__ import annotations

import inspect
import json
import math
from dataclasses import dataclass
from typing import Any, Callable, Mapping

import h5py
import numpy as np

from talus_lab.errors import ResultError, nearest
from talus_lab.measures import AT, MEASURES, evaluate, unit
from talus_lab.run import Run
from talus_lab.sweep.ranges import is_finite

DEFAULT = ("verdict", "mechanism", "moving_blocks", "max_displacement")
ALWAYS = ("verdict", "mechanism", "moving_blocks", "detached_blocks", "moving_area", "moving_share")  # cost nothing, and may be asked for later
NAMED = ("history", "energy")  # measures that a config gives as `history: NAME`
FORM = "is neither the name of a measure nor {name: COLUMN, measure: ...}, {name: COLUMN, history: ...} or {name: COLUMN, energy: ...}"

# By how an option is annotated: what it must be, and how that is called
KINDS: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "float": (is_finite, "a number"), "int": (lambda value: isinstance(value, int), "a whole number"),
    "str": (lambda value: isinstance(value, str), "a word"), "str | None": (lambda value: isinstance(value, str), "a word"),
    "Sequence[float]": (lambda value: isinstance(value, list) and len(value) == 2 and all(map(is_finite, value)), "a point [x, y]"),
}


class MeasureError(ResultError):
    """What a measure looks at is not in the results: its key, and what is wrong."""

    def __str__(self) -> str:
        return str(self.args[-1])


@dataclass(frozen=True)
class Measure:
    """What is measured, and the column of the table that it becomes."""

    name: str
    key: str  # the measure and its options in one text
    label: str = ""


def measure_of(given: Any, where: str, faults: list[str]) -> Measure | None:
    """From an entry of a config."""
    if isinstance(given, str):
        given = {"name": given, "measure": given}
    if not isinstance(given, dict) or not given.get("name"):
        faults.append(f"{where}: {FORM}")
        return None
    options = {key: value for key, value in given.items() if key not in ("name", "measure", "label")}
    chosen = [name for name in NAMED if name in options] + [str(given[word]) for word in ("measure",) if word in given]
    if len(chosen) != 1:
        faults.append(f"{where}: {FORM}")
        return None
    measure = chosen[0]
    if measure in options:
        options["name"] = options.pop(measure)
    wrong = _wrong(measure, options)
    if wrong:
        faults.append(f"{where}: {wrong}")
        return None
    return Measure(str(given["name"]), json.dumps([measure, options], sort_keys=True) if options else measure, str(given.get("label", "")))


def _wrong(measure: str, options: dict[str, Any]) -> str:
    if measure not in MEASURES:
        return f"unknown measure {measure}{nearest(measure, MEASURES)}"
    known = dict(list(inspect.signature(MEASURES[measure].function).parameters.items())[1:])
    for option, value in options.items():
        if option not in known:
            return f"measure {measure}: unknown option {option}{nearest(option, known)}"
        fits, words = KINDS[known[option].annotation]
        if not fits(value):
            return f"measure {measure}: {option} is not {words}"
    for option, parameter in known.items():
        if option not in options and parameter.default is inspect.Parameter.empty:
            return f"measure {measure}: needs {option}"
    if options.get("at", "end") not in AT:
        return f"at: {options['at']}{nearest(options['at'], AT)}"
    return ""


def measured(run: Run, keys: tuple[str, ...]) -> dict[str, Any]:
    """Values by key; None where the result does not say. Raises MeasureError."""
    with h5py.File(run.path, "r", locking=False):  # as long as it is open, a Run opens it in a tenth of the time
        return {key: _value(run, key) for key in dict.fromkeys((*ALWAYS, *keys))}


def units(run: Run, keys: tuple[str, ...]) -> dict[str, str]:
    """SI; "-" for words. Of a history only a result knows it."""
    return {key: unit(run, name, **options) for key, (name, options) in zip(keys, map(parts, keys))}


def parts(key: str) -> tuple[str, dict[str, Any]]:
    """Measure and options."""
    return tuple(json.loads(key)) if key.startswith("[") else (key, {})


def history_of(key: str) -> str:
    """The history that a measure looks at, or nothing."""
    name, options = parts(key)
    return str(options["name"]) if name == "history" else ""


def known_unit(key: str) -> str:
    """Before there is a result; empty where only a result knows it."""
    name = parts(key)[0]
    return "" if name == "history" else MEASURES[name].unit


def said(key: str) -> str:
    """A measure without options in words; with options its name in the config says more."""
    return MEASURES[key].label if key in MEASURES else ""


def _value(run: Run, key: str) -> Any:
    name, options = parts(key)
    try:
        value = evaluate(run, name, **options)
    except ResultError as error:
        raise MeasureError(key, str(error).removeprefix(f"{run.path}: ")) from None
    value = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(value, float) and not math.isfinite(value) else value
