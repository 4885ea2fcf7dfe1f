"""Sections of a config as dataclasses. Faults are collected, so that one report has all of them."""

from __future__ import annotations

from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any, Iterator, Mapping

import yaml

from talus_lab.errors import ResultError, nearest

TYPES = {"str": (str, "a text"), "int": (int, "a whole number"), "float": ((int, float), "a number"), "bool": (bool, "true or false"),
         "list": (list, "a list"), "dict": (dict, "a mapping"), "Any": (object, "")}


def read_yaml(path: Path) -> dict:
    """The top of the file, a mapping. Raises ResultError if it is none, no YAML, or has a key twice, of which YAML would take the last."""
    try:
        twice = [(line, key) for key, line, again in _keys(path) if again]
        given = yaml.safe_load(path.read_text(encoding="utf-8"))
    except UnicodeDecodeError:
        raise ResultError(f"{path}: is no text in UTF-8") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        said = getattr(error, "problem", None) or " ".join(str(error).split())
        raise ResultError(f"{path}:{mark.line + 1 if mark else ''} no YAML: {said}") from None
    if twice:
        raise ResultError("\n".join(f"{path}:{line} {key}: stands here for a second time" for line, key in twice))
    if not isinstance(given, dict):
        raise ResultError(f"{path}: is no config, which has keys with values: `key: value`")
    return given


def read_lines(path: Path) -> dict[str, int]:
    """Line of every key of a file that read_yaml has read: `scenes.arch.errors[0]` -> 7."""
    return {key: line for key, line, _ in _keys(path)}


def _keys(path: Path) -> Iterator[tuple[str, int, bool]]:
    """Every key, its line, and whether the same mapping has had it before."""

    def look(node: yaml.Node | None, where: str, above: tuple[int, ...]) -> Iterator[tuple[str, int, bool]]:
        if id(node) in above:
            raise yaml.MarkedYAMLError(problem="an alias that stands within itself", problem_mark=node.start_mark)
        inside = (*above, id(node))
        if isinstance(node, yaml.MappingNode):
            seen = set()
            for key, value in node.value:
                inner = f"{where}.{key.value}" if where else str(key.value)
                yield inner, key.start_mark.line + 1, inner in seen
                seen.add(inner)
                yield from look(value, inner, inside)
        elif isinstance(node, yaml.SequenceNode):
            for k, item in enumerate(node.value):
                yield f"{where}[{k}]", item.start_mark.line + 1, False
                yield from look(item, f"{where}[{k}]", inside)

    return look(yaml.compose(path.read_text(encoding="utf-8"), yaml.SafeLoader), "", ())


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
    told = False
    for key in given:
        if key not in known:
            ending = nearest(key, known)
            faults.append(f"{where}{key}: unknown key{'' if told and ending.startswith('; there are') else ending}")
            told = told or ending.startswith("; there are")  # all there are need not be said of every key


def strangers(names: Any, known: Any, where: str) -> list[str]:
    """A fault for each name that is not known."""
    return [f"{where}: unknown {name}{nearest(name, known)}" for name in names if name not in known]
