"""A study of contact searches as its config describes it. Every fault of a config is found at once."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Mapping

from talus_lab.study.entries import read_yaml, report, section, strangers, top
from talus_lab.study.formulas import FormulaError, filled

# In the order of charts and tables.
METHODS = ("dess", "dess-fused", "isu", "isu-separated", "isu-parallel", "grid", "direct", "direct-simd", "auto")
COMMANDS = ("search", "step", "peers")
CHARTS = ("methods", "parts", "shares")
TABLES = ("values", "totals", "ratios", "spread", "growth")


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
    faults: list[str] = []
    config = _config(path, read_yaml(path), faults)
    report(path, faults or _contradictions(config))
    return config


def _config(path: Path, given: dict, faults: list[str]) -> Config:
    top(given, [f.name for f in fields(Config) if f.name != "path"], faults)
    files = {name: (path.parent / str(given.get(name, "."))).resolve() for name in ("output", "page", "images")}
    sections = {"quantities": Quantity, "scenes": Scene, "studies": Study, "charts": Chart, "tables": Table}
    parts = {name: section(kind, given.get(name, {}), name, faults) for name, kind in sections.items()}
    largest = given.get("largest", {})
    if not isinstance(largest, dict):
        faults.append("largest: is not a mapping")
        largest = {}
    return Config(path, **files, largest=largest, **parts)


def _contradictions(config: Config) -> list[str]:
    """What the parts of a config say about each other."""
    faults: list[str] = []
    for name, scene in config.scenes.items():
        if not (config.path.parent / scene.scenario).is_file():
            faults.append(f"scenes.{name}.scenario: there is no file {scene.scenario}")
        faults += strangers(scene.set, config.quantities, f"scenes.{name}.set")
    for name, study in config.studies.items():
        faults += _study_faults(config, study, f"studies.{name}")
    for name, chart in config.charts.items():
        faults += strangers([chart.kind], CHARTS, f"charts.{name}.kind")
        for k, panel in enumerate(chart.panels):
            faults += _panel_faults(config, panel, f"charts.{name}.panels[{k}]")
    for name, table in config.tables.items():
        faults += strangers([table.kind], TABLES, f"tables.{name}.kind")
        faults += strangers(table.studies, config.studies, f"tables.{name}.studies")
        faults += strangers([table.column], config.quantities, f"tables.{name}.column")
    return faults


def _study_faults(config: Config, study: Study, where: str) -> list[str]:
    faults = strangers([study.command], COMMANDS, f"{where}.command") + strangers(study.scenes, config.scenes, f"{where}.scenes")
    if study.command != "peers":
        faults += strangers(study.methods, (*METHODS, "read"), f"{where}.methods")
    if len(study.vary) != 1 or not isinstance(study.values, list) or not study.values:
        return faults + [f"{where}.vary: is not one quantity with a list of values"]
    if study.axes != "" and (study.command == "step" or not isinstance(study.axes, (int, float))):
        faults.append(f"{where}.axes: is a number of degrees, and not for the command step")
    for scene in study.scenes:
        if scene in config.scenes:
            faults += strangers([study.varied, *study.fixed], config.scenes[scene].set, f"{where}, scene {scene}")
            faults += [f"{where}, scene {scene}: {fault}" for fault in _formula_faults(config, scene, study)]
    return faults


def _panel_faults(config: Config, panel: object, where: str) -> list[str]:
    if not isinstance(panel, dict) or not panel.get("studies") or "scene" not in panel:
        return [f"{where}: has no studies or no scene"]
    return (strangers(panel, ("studies", "scene", "title", "column", "where"), where)
            + strangers(panel["studies"], config.studies, f"{where}.studies")
            + strangers([panel["scene"]], config.scenes, f"{where}.scene")
            + strangers([panel.get("column", "ns_per_box_median")], config.quantities, f"{where}.column"))


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
