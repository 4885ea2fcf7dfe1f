"""A study of contact searches as its config describes it. Every fault of a config is found at once."""

from __future__ import annotations

import difflib
from dataclasses import MISSING, dataclass, field, fields
from pathlib import Path
from typing import Any, Mapping

import yaml

from talus_lab.bench.formulas import FormulaError, filled
from talus_lab.run import ResultError

# In the order of charts and tables.
METHODS = ("dess", "dess-fused", "isu", "isu-separated", "isu-parallel", "grid", "direct", "direct-simd", "auto")
COMMANDS = ("search", "step", "peers")
CHARTS = ("methods", "parts", "shares")
TABLES = ("values", "totals", "ratios", "spread", "growth")
TYPES = {"str": (str, "a text"), "int": (int, "a whole number"), "bool": (bool, "true or false"), "list": (list, "a list"),
         "dict": (dict, "a mapping"), "Any": (object, "")}


@dataclass(frozen=True)
class Scene:
    """What is measured. `set` has, for each quantity that can be varied, what to change in the scenario: path -> text with formulas."""

    scenario: str  # file, from the folder of the config
    name: str
    set: dict
    start: str = ""  # when measuring begins, as --from; with formulas


@dataclass(frozen=True)
class Study:
    """Runs of one command: every scene with every value of the quantity that is varied."""

    command: str
    scenes: list
    vary: dict  # one quantity: its values
    methods: list
    fixed: dict = field(default_factory=dict)  # other quantities: their value
    threads: list = field(default_factory=lambda: [1])
    skins: list = field(default_factory=lambda: [0])  # m, or auto where command is step
    steps: Any = 60  # may be a formula
    repeat: int = 3
    rounds: int = 1  # command step: all methods in turn, so many times; the fastest counts
    axes: Any = ""  # degrees from x and y, of the boxes that are searched; as in a run if empty
    check: bool = False  # compare the pairs of every step with a reference
    long: bool = False  # measured only when asked for

    @property
    def varied(self) -> str:
        return next(iter(self.vary))

    @property
    def values(self) -> list:
        return self.vary[self.varied]


@dataclass(frozen=True)
class Chart:
    """A picture with one panel for each entry: study, scene, title, and for `methods` the column that is drawn."""

    kind: str
    panels: list
    columns: int = 2  # panels side by side
    series: list = field(default_factory=list)  # methods; all if empty


@dataclass(frozen=True)
class Table:
    """A table of the page. ratios: `pairs` of [numerator, denominator]; the others: `series`, such as isu, or isu@2
    for two threads; totals need them, the others show all without."""

    kind: str
    studies: list
    column: str = "ns_per_box_median"
    series: list = field(default_factory=list)
    pairs: list = field(default_factory=list)
    between: list = field(default_factory=list)  # growth: from this value to that one
    where: dict = field(default_factory=dict)  # columns and their value


@dataclass(frozen=True)
class Quantity:
    """Something that studies vary, or a column of the results, as axes and tables call it."""

    label: str
    log: bool = True
    short: str = ""


@dataclass(frozen=True)
class Config:
    path: Path
    output: Path
    page: Path
    images: Path
    quantities: Mapping[str, Quantity]
    largest: Mapping[str, float]  # method -> blocks above which it is left out
    scenes: Mapping[str, Scene]
    studies: Mapping[str, Study]
    charts: Mapping[str, Chart]
    tables: Mapping[str, Table]


def read_config(path: Path) -> Config:
    """Raises ResultError with every fault, one per line."""
    try:
        given = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise ResultError(f"{path}: no YAML: {' '.join(str(error).split())}") from None
    faults: list[str] = []
    config = _config(path, given if isinstance(given, dict) else {}, faults)
    if not faults:
        faults = _contradictions(config)
    if faults:
        raise ResultError("\n".join(f"{path}: {fault}" for fault in faults))
    return config


def _config(path: Path, given: dict, faults: list[str]) -> Config:
    known = [f.name for f in fields(Config) if f.name != "path"]
    _unknown(given, known, "", faults)
    for name in known:
        if name not in given:
            faults.append(f"{name}: is missing")
    files = {name: (path.parent / str(given.get(name, "."))).resolve() for name in ("output", "page", "images")}
    sections = {"quantities": Quantity, "scenes": Scene, "studies": Study, "charts": Chart, "tables": Table}
    parts = {name: _section(kind, given.get(name, {}), name, faults) for name, kind in sections.items()}
    largest = given.get("largest", {})
    if not isinstance(largest, dict):
        faults.append("largest: is not a mapping")
        largest = {}
    return Config(path, **files, largest=largest, **parts)


def _section(kind: type, given: object, where: str, faults: list[str]) -> dict:
    if not isinstance(given, dict):
        faults.append(f"{where}: is not a mapping")
        return {}
    made = {str(name): _entry(kind, entry, f"{where}.{name}", faults) for name, entry in given.items()}
    return {name: entry for name, entry in made.items() if entry}


def _entry(kind: type, given: object, where: str, faults: list[str]) -> Any:
    if not isinstance(given, dict):
        faults.append(f"{where}: is not a mapping")
        return None
    before = len(faults)
    _unknown(given, [f.name for f in fields(kind)], where + ".", faults)
    for f in fields(kind):
        if f.name not in given:
            if f.default is MISSING and f.default_factory is MISSING:
                faults.append(f"{where}.{f.name}: is missing")
            continue
        expected, words = TYPES[f.type]
        if not isinstance(given[f.name], expected) or (expected is int and isinstance(given[f.name], bool)):
            faults.append(f"{where}.{f.name}: is not {words}")
    return kind(**given) if len(faults) == before else None


def _unknown(given: dict, known: list[str], where: str, faults: list[str]) -> None:
    faults += [f"{where}{key}: unknown key{_nearest(key, known)}" for key in given if key not in known]


def _nearest(name: object, known: Any) -> str:
    close = difflib.get_close_matches(str(name), list(known), 1)
    return f"; did you mean {close[0]}?" if close else f"; there are {', '.join(known)}"


def _contradictions(config: Config) -> list[str]:
    """What the parts of a config say about each other."""
    faults: list[str] = []
    for name, scene in config.scenes.items():
        if not (config.path.parent / scene.scenario).is_file():
            faults.append(f"scenes.{name}.scenario: there is no file {scene.scenario}")
        faults += _strangers(scene.set, config.quantities, f"scenes.{name}.set")
    for name, study in config.studies.items():
        faults += _study_faults(config, study, f"studies.{name}")
    for name, chart in config.charts.items():
        faults += _strangers([chart.kind], CHARTS, f"charts.{name}.kind")
        for k, panel in enumerate(chart.panels):
            faults += _panel_faults(config, panel, f"charts.{name}.panels[{k}]")
    for name, table in config.tables.items():
        faults += _strangers([table.kind], TABLES, f"tables.{name}.kind")
        faults += _strangers(table.studies, config.studies, f"tables.{name}.studies")
        faults += _strangers([table.column], config.quantities, f"tables.{name}.column")
    return faults


def _strangers(names: Any, known: Any, where: str) -> list[str]:
    return [f"{where}: unknown {name}{_nearest(name, known)}" for name in names if name not in known]


def _study_faults(config: Config, study: Study, where: str) -> list[str]:
    faults = _strangers([study.command], COMMANDS, f"{where}.command") + _strangers(study.scenes, config.scenes, f"{where}.scenes")
    if study.command != "peers":
        faults += _strangers(study.methods, (*METHODS, "read"), f"{where}.methods")
    if len(study.vary) != 1 or not isinstance(study.values, list) or not study.values:
        return faults + [f"{where}.vary: is not one quantity with a list of values"]
    if study.axes != "" and (study.command == "step" or not isinstance(study.axes, (int, float))):
        faults.append(f"{where}.axes: is a number of degrees, and not for the command step")
    for scene in study.scenes:
        if scene in config.scenes:
            faults += _strangers([study.varied, *study.fixed], config.scenes[scene].set, f"{where}, scene {scene}")
            faults += [f"{where}, scene {scene}: {fault}" for fault in _formula_faults(config, scene, study)]
    return faults


def _panel_faults(config: Config, panel: object, where: str) -> list[str]:
    if not isinstance(panel, dict) or not panel.get("studies") or "scene" not in panel:
        return [f"{where}: has no studies or no scene"]
    return (_strangers(panel, ("studies", "scene", "title", "column", "where"), where)
            + _strangers(panel["studies"], config.studies, f"{where}.studies")
            + _strangers([panel["scene"]], config.scenes, f"{where}.scene")
            + _strangers([panel.get("column", "ns_per_box_median")], config.quantities, f"{where}.column"))


def _formula_faults(config: Config, scene: str, study: Study) -> list[str]:
    try:
        for value in study.values:
            overrides(config, scene, study, value)
    except FormulaError as error:
        return [str(error)]
    except TypeError:
        return [f"{study.varied}: {value!r} is not a number"]
    return []


def overrides(config: Config, scene: str, study: Study, value: float) -> tuple[dict[str, str], str, int]:
    """For one point of a study: keys of the scenario and their values, when measuring begins, and the number of steps."""
    values = {**study.fixed, study.varied: value}
    if not all(isinstance(v, (int, float)) for v in values.values()):
        raise TypeError
    described = config.scenes[scene]
    keys = {path: filled(text, values) for name in values if name in described.set for path, text in described.set[name].items()}
    return keys, filled(described.start, values), int(float(filled(study.steps, values)))
