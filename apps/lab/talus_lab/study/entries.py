"""Sections of a config as dataclasses. Faults are collected, so that one report has all of them."""

from __future__ import annotations

from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, Mapping

import yaml

from talus_lab.errors import ResultError, nearest

TYPES = {"str": (str, "a text"), "int": (int, "a whole number"), "float": ((int, float), "a number"), "bool": (bool, "true or false"),
         "list": (list, "a list"), "dict": (dict, "a mapping"), "Any": (object, "")}


def read_yaml(path: Path) -> dict:
    """The top of the file; empty if it is no mapping. Raises ResultError if it is no YAML."""
    try:
        given = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ResultError(f"{path}: no YAML: {' '.join(str(error).split())}") from None
    return given if isinstance(given, dict) else {}


def read_lines(path: Path) -> dict[str, int]:
    """Line of every key of a file that read_yaml has read: `scenes.arch.errors[0]` -> 7."""
    lines: dict[str, int] = {}

    def look(node: yaml.Node | None, where: str) -> None:
        if isinstance(node, yaml.MappingNode):
            for key, value in node.value:
                inner = f"{where}.{key.value}" if where else str(key.value)
                lines[inner] = key.start_mark.line + 1
                look(value, inner)
        elif isinstance(node, yaml.SequenceNode):
            for k, item in enumerate(node.value):
                lines[f"{where}[{k}]"] = item.start_mark.line + 1
                look(item, f"{where}[{k}]")

    look(yaml.compose(path.read_text(encoding="utf-8"), yaml.SafeLoader), "")
    return lines


def report(path: Path, faults: list[str], lines: Mapping[str, int] = {}) -> None:
    """Raises ResultError with every fault, one per line, if there are any; behind the file the line of what a fault begins with."""
    if faults:
        raise ResultError("\n".join(f"{path}{_line(fault, lines)} {fault}" if lines else f"{path}: {fault}" for fault in faults))


def _line(fault: str, lines: Mapping[str, int]) -> str:
    where = fault.partition(": ")[0]
    while where and where not in lines:
        where = where[: max(where.rfind("."), where.rfind("["), 0)]
    return f":{lines[where]}" if where else ":"


def section(kind: type, given: object, where: str, faults: list[str]) -> dict:
    """name -> dataclass, of the entries that are right."""
    if not isinstance(given, dict):
        faults.append(f"{where}: is not a mapping")
        return {}
    made = {str(name): entry(kind, described, f"{where}.{name}", faults) for name, described in given.items()}
    return {name: described for name, described in made.items() if described}


def entry(kind: type, given: object, where: str, faults: list[str]) -> Any:
    if not isinstance(given, dict):
        faults.append(f"{where}: is not a mapping")
        return None
    before = len(faults)
    names = {f.name.rstrip("_"): f for f in fields(kind)}  # `from_` is the key `from`
    unknown_keys(given, list(names), where + ".", faults)
    for name, f in names.items():
        if name not in given:
            if f.default is MISSING and f.default_factory is MISSING:
                faults.append(f"{where}.{name}: is missing")
            continue
        expected, words = TYPES[f.type]
        if not isinstance(given[name], expected) or (f.type in ("int", "float") and isinstance(given[name], bool)):
            faults.append(f"{where}.{name}: is not {words}")
    return kind(**{names[name].name: value for name, value in given.items()}) if len(faults) == before else None


def top(given: dict, known: list[str], faults: list[str], needed: list[str] | None = None) -> None:
    """Keys of the top level: unknown ones, and those that are missing."""
    unknown_keys(given, known, "", faults)
    faults += [f"{name}: is missing" for name in (known if needed is None else needed) if name not in given]


def unknown_keys(given: dict, known: list[str], where: str, faults: list[str]) -> None:
    faults += [f"{where}{key}: unknown key{nearest(key, known)}" for key in given if key not in known]


def strangers(names: Any, known: Any, where: str) -> list[str]:
    """A fault for each name that is not known."""
    return [f"{where}: unknown {name}{nearest(name, known)}" for name in names if name not in known]
