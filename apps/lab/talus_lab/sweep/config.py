"""A sweep as its config describes it: a scenario, what varies, what is measured. Every fault of a config is found at once."""

from __future__ import annotations

import json
import os
import re
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Mapping

from talus_lab.errors import ResultError, nearest
from talus_lab.study.entries import TYPES, entry, read_lines, read_yaml, report, section, top
from talus_lab.sweep.measures import DEFAULT, Measure, measure_of
from talus_lab.sweep.ranges import MOST, is_drawn, levels_of

PICTURES = "pictures"  # read by talus_lab.diagrams
KEYS = ("title", "scenario", "output", "set", "parameters", "where", "sample", "repetitions", "measures", "keep", "limit_s", "cluster", "parquet",
        PICTURES)
NEEDED = ["scenario", "output", "parameters"]
COLUMNS = ("case", "status", "wall_time", "talus_version", "scenario_hash", "host", "started")  # of every table
OF_SCENARIOS = {"materials", "blocks", "rock", "run", "gravity"}  # keys that no config has
QUEUES = {"slurm": "SLURMCluster", "pbs": "PBSCluster"}  # of dask-jobqueue
METHODS = ("latin hypercube", "random")
KEPT = ("measures", "results")
REPETITION = "repetition"


@dataclass(frozen=True)
class Parameter:
    """A quantity that varies. Its values: a list; named sets of keys; a range with count or step; or drawn, from a range or a normal
    distribution."""

    set: Any = None  # key of the scenario, list of keys that all get the value, or mapping of key: value with formulas
    values: list = field(default_factory=list)
    levels: dict = field(default_factory=dict)  # name: {key of the scenario: value}
    from_: Any = None
    to: Any = None
    count: int = 0  # with both ends
    step: Any = None
    scale: str = "linear"  # or log
    mean: Any = None
    deviation: Any = None
    unit: str = ""
    label: str = ""


@dataclass(frozen=True)
class Sample:
    """How parameters without count and step are drawn, all at once."""

    count: int
    seed: int = 1
    method: str = METHODS[0]


@dataclass(frozen=True)
class Repetitions:
    """Every combination so many times, with the seeds seed, seed + 1, ... of random joint networks."""

    count: int
    set: Any  # key of the scenario, or list of keys
    seed: int = 1


@dataclass(frozen=True)
class Config:
    path: Path
    title: str
    scenario: Path
    output: Path
    parameters: Mapping[str, Parameter]
    measures: tuple[Measure, ...]
    lines: Mapping[str, int]  # of keys of the file
    set: Mapping[str, Any]  # keys of the scenario for all cases; formulas know the parameters
    where: tuple[str, ...] = ()  # conditions; a combination for which one does not hold is left out
    sample: Sample | None = None
    repetitions: Repetitions | None = None
    keep: str = KEPT[0]  # or results: the result file of every case
    limit_s: float | None = None  # a case that takes longer has failed
    cluster: Mapping[str, Any] = field(default_factory=dict)  # of dask-jobqueue
    parquet: bool = False  # the table as table.parquet too
    pictures: bool = False  # whether there are any

    def fault(self, *faults: str) -> None:
        """Raises ResultError with the lines of what the faults begin with."""
        report(self.path, list(faults), self.lines)


def read_config(path: Path) -> Config:
    """Raises ResultError with every fault, one per line."""
    given = read_yaml(path)
    lines = read_lines(path)
    if len(OF_SCENARIOS & given.keys()) > 1:
        raise ResultError(f"{path}: is a scenario, which `talus run` computes; a config of a sweep names one under `scenario`")
    faults: list[str] = []
    config = _config(path, given, lines, faults)
    if not faults:
        faults += _contradictions(config)
    report(path, faults, lines)
    return config


def _config(path: Path, given: dict, lines: Mapping[str, int], faults: list[str]) -> Config:
    top(given, list(KEYS), faults, NEEDED)

    def plain(name: str, kind: str, default: Any) -> Any:
        expected, words = TYPES[kind]
        if name in given and not isinstance(given[name], expected):
            faults.append(f"{name}: is not {words}")
            return default
        return given.get(name, default)

    def part(kind: type, name: str) -> Any:
        return entry(kind, given[name], name, faults) if name in given else None

    folder = path.parent
    return Config(path, plain("title", "str", path.stem), (folder / plain("scenario", "str", "")).resolve(),
                  (folder / plain("output", "str", "")).resolve(), section(Parameter, given.get("parameters", {}), "parameters", faults),
                  _measures(given.get("measures", list(DEFAULT)), faults), lines, plain("set", "dict", {}),
                  tuple(str(text) for text in plain("where", "list", [])), part(Sample, "sample"), part(Repetitions, "repetitions"),
                  plain("keep", "str", KEPT[0]), plain("limit_s", "float", None), plain("cluster", "dict", {}), plain("parquet", "bool", False),
                  PICTURES in given)


def _measures(given: Any, faults: list[str]) -> tuple[Measure, ...]:
    if not isinstance(given, list) or not given:
        faults.append("measures: is not a list of measures")
        return ()
    made = [measure_of(described, f"measures[{k}]", faults) for k, described in enumerate(given)]
    return tuple(measure for measure in made if measure)


def _contradictions(config: Config) -> list[str]:
    faults: list[str] = []
    if not config.scenario.is_file():
        faults.append(f"scenario: there is no file {config.scenario}")
    faults += [f"output: {said}" for said in [_unfit(config.output, config.path.resolve().parent)] if said]
    if config.cluster and config.cluster.get("kind") not in QUEUES:
        faults.append(f"cluster.kind: is not {config.cluster.get('kind')}{nearest(config.cluster.get('kind'), QUEUES)}")
    for name, choice, words in (("keep", config.keep, KEPT), ("sample.method", config.sample and config.sample.method, METHODS)):
        if choice and choice not in words:
            faults.append(f"{name}: is not {choice}{nearest(choice, words)}")
    if config.limit_s is not None and not config.limit_s > 0:
        faults.append("limit_s: is not above 0")
    if config.parquet and not find_spec("pyarrow"):
        faults.append("parquet: needs the package pyarrow: pip install 'talus-lab[parquet]'")
    faults += _settings(config)
    empty = set()
    for name, parameter in config.parameters.items():
        found = levels_of(parameter, f"parameters.{name}")[1]
        empty |= {name} if found else set()
        faults += found
    said = json.dumps([config.set, *([parameter.set, parameter.levels] for parameter in config.parameters.values())], default=str)
    for name, parameter in config.parameters.items():
        if name not in empty and not parameter.set and not parameter.levels and not re.search(rf"\{{[^{{}}]*\b{re.escape(name)}\b", said):
            faults.append(f"parameters.{name}: sets no key of the scenario, and no formula knows it; give it `set`")
    drawn = [name for name, parameter in config.parameters.items() if name not in empty and is_drawn(parameter)]
    if drawn and not config.sample:
        faults.append(f"parameters.{drawn[0]}: has neither values nor count nor step; to draw it, say under `sample` how many")
    if config.sample and not drawn and not empty:
        faults.append("sample: every parameter has values, so there is nothing to draw")
    for part in ("sample", "repetitions"):
        if getattr(config, part) and not 1 <= getattr(config, part).count <= MOST:
            faults.append(f"{part}.count: is not from 1 to {MOST}")
    return faults + _names(config)


def _settings(config: Config) -> list[str]:
    """What is wrong with the keys that are set."""
    faults, keys = [], {"set": list(config.set)}
    for name, parameter in config.parameters.items():
        if parameter.set and parameter.levels:
            faults.append(f"parameters.{name}.set: levels say what they set themselves")
        if parameter.set is not None and not isinstance(parameter.set, (str, list, dict)):
            faults.append(f"parameters.{name}.set: is neither a key of the scenario nor a list or a mapping of them")
        else:
            keys[f"parameters.{name}.set"] = [parameter.set] if isinstance(parameter.set, str) else list(parameter.set or ())
        keys |= {f"parameters.{name}.levels.{level}": list(given) for level, given in parameter.levels.items() if isinstance(given, dict)}
    if config.repetitions:
        given = config.repetitions.set
        keys["repetitions.set"] = [given] if isinstance(given, str) else given if isinstance(given, list) else []
        faults += [] if keys["repetitions.set"] else ["repetitions.set: is neither a key of the scenario nor a list of them"]
    return faults + [f"{where}: {key} is no key of a scenario, such as joints.bedding.friction_angle_deg" for where, given in keys.items() for key in given
                     if not isinstance(key, str) or not key.strip() or "=" in key]


def _unfit(folder: Path, here: Path) -> str:
    """Why nothing can be written to a folder, or nothing."""
    if folder == here:
        return "is the folder of the config; give the results one of their own"
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not there.is_dir():
        return f"{there} is no folder"
    return "" if os.access(there, os.W_OK | os.X_OK) else f"{there} cannot be written to"


def _names(config: Config) -> list[str]:
    """Columns of the table, each once."""
    faults, seen = [], dict.fromkeys(COLUMNS, "a column of every table")
    columns = [(name, f"parameters.{name}") for name in config.parameters]
    columns += [(REPETITION, "repetitions")] if config.repetitions else []
    columns += [(measure.name, f"measures[{k}]") for k, measure in enumerate(config.measures)]
    for name, where in columns:
        if name in seen:
            faults.append(f"{where}: {name} is {seen[name]} already")
        if not name.isidentifier():
            faults.append(f"{where}: {name} is no name of letters, digits and _")
        seen[name] = where
    return faults
