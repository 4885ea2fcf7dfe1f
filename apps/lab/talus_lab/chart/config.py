"""A study of error against CPU time as its config describes it. Every fault of a config is found at once."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, Mapping

from talus_lab.chart.theory import THEORY
from talus_lab.chart.values import VALUES
from talus_lab.study.entries import nearest, read_yaml, report, section, strangers, top
from talus_lab.study.formulas import FormulaError, evaluate, filled

REFERENCE = "reference"  # as an exact value: that of the scene's reference runs
LARGEST = "largest"      # as an error: the largest of those of the scene
Setting = dict[str, float]


@dataclass(frozen=True)
class Method:
    """A way to compute scenes: talus with some keys set, or another program, see docs/runners.md."""

    label: str
    set: dict = field(default_factory=dict)  # keys of the scenario; formulas know the setting
    command: list = field(default_factory=list)  # of another program
    missing: str = ""  # where to get it

    @property
    def ours(self) -> bool:
        return not self.command


@dataclass(frozen=True)
class Error:
    """|value - exact| / scale, of the motion at the end of a scene or along it."""

    label: str
    value: str  # one of VALUES
    exact: Any = 0  # a number, a formula in braces, or `reference`
    scale: Any = None  # as exact; the size of the exact value if none is given
    unit: str = ""  # of the value
    blocks: str = "free"  # all that can move, a region, or the name of a block or of repeated ones
    direction_deg: Any = None  # only the motion along it; from +x
    tilt: Any = 0  # rad, of a block that rocks, at the start; as exact


@dataclass(frozen=True)
class Scene:
    title: str
    scenario: str  # file, from the folder of the config
    errors: dict  # name: Error
    methods: dict  # name: its settings, a mapping of quantity: values, of which all combinations run; or a list of such
    keys: dict = field(default_factory=dict)  # of the scenario, for all methods
    set: dict = field(default_factory=dict)  # quantity: keys of the scenario that talus gets, with formulas
    given: dict = field(default_factory=dict)  # settings that every other program gets
    frames: int = 1  # states that are looked at, beside that of the start
    reference: dict = field(default_factory=dict)  # method, and settings: the last is the reference
    long: bool = False  # measured only when asked for


@dataclass(frozen=True)
class Chart:
    panels: list  # of scene, title, and the error drawn: the largest of the scene if none is named
    columns: int = 2


@dataclass(frozen=True)
class Config:
    path: Path
    output: Path
    page: Path
    images: Path
    repeat: int  # runs of each setting; the least CPU time counts
    limit_s: float  # a run that takes longer has failed
    levels: list  # of error, for the tables
    settings: Mapping[str, Any]  # quantity: how to say it, and for talus its keys in every scene
    methods: Mapping[str, Method]
    scenes: Mapping[str, Scene]
    charts: Mapping[str, Chart]
    share: float = 1.0  # of the time that scenes are run for; less when only trying

    def scenario(self, scene: str) -> Path:
        return (self.path.parent / self.scenes[scene].scenario).resolve()


def read_config(path: Path) -> Config:
    """Raises ResultError with every fault, one per line."""
    faults: list[str] = []
    config = _config(path, read_yaml(path), faults)
    report(path, faults or _contradictions(config))
    return config


def quick(config: Config) -> Config:
    """The first setting of every method, once, for a fiftieth of the time, without scenes that take long: does everything work?"""
    def shortest(scene: Scene) -> Scene:
        first = {name: {key: values[:1] for key, values in grids(given)[0].items()} for name, given in scene.methods.items()}
        reference = scene.reference and {**scene.reference, "settings": scene.reference["settings"][:2]}
        return replace(scene, methods=first, reference=reference)

    return replace(config, output=config.output / "quick", images=config.output / "quick", repeat=1, share=0.02,
                   scenes={name: shortest(scene) for name, scene in config.scenes.items()})


def settings_of(given: Any) -> list[Setting]:
    """All combinations, in the order of the config."""
    return [dict(zip(grid, values)) for grid in grids(given) for values in itertools.product(*grid.values())]


def grids(given: Any) -> list[dict]:
    return given if isinstance(given, list) else [given]


def keys_of(config: Config, scene: str, method: str, setting: Setting) -> dict[str, str]:
    """Keys of the scenario and their values, for talus: those of the scene, of the setting, then of the method."""
    described = config.scenes[scene]
    keys = dict(described.keys)
    for quantity in setting:
        keys |= config.settings[quantity].get("set", {}) | described.set.get(quantity, {})
    return {path: key_text(value, setting) for path, value in (keys | config.methods[method].set).items()}


def key_text(value: Any, setting: Setting) -> str:
    """A value as --set takes it. Formulas stand in texts, those of lists and mappings too."""
    def fill(part: Any) -> Any:
        if isinstance(part, dict):
            return {key: fill(inner) for key, inner in part.items()}
        if isinstance(part, list):
            return [fill(inner) for inner in part]
        return filled(part, setting) if isinstance(part, str) else part

    return str(fill(value)) if isinstance(value, str) else json.dumps(fill(value))


def figure_of(given: Any) -> float:
    """The number that a text with a formula in braces stands for; a number is itself."""
    text = str(given).strip()
    return evaluate(text[1:-1], {}, THEORY) if text.startswith("{") else float(text)


def _config(path: Path, given: dict, faults: list[str]) -> Config:
    top(given, [f.name for f in fields(Config) if f.name not in ("path", "share")], faults)
    files = {name: (path.parent / str(given.get(name, "."))).resolve() for name in ("output", "page", "images")}
    methods = section(Method, given.get("methods", {}), "methods", faults)
    scenes = section(Scene, given.get("scenes", {}), "scenes", faults)
    scenes = {name: replace(scene, errors=section(Error, scene.errors, f"scenes.{name}.errors", faults)) for name, scene in scenes.items()}
    plain = {}
    for name, kind, words in (("repeat", int, "a whole number above 0"), ("limit_s", (int, float), "a number above 0")):
        plain[name] = given.get(name, 1)
        if not isinstance(plain[name], kind) or isinstance(plain[name], bool) or plain[name] <= 0:
            faults.append(f"{name}: is not {words}")
    levels = given.get("levels", [])
    if not isinstance(levels, list) or not all(isinstance(level, float) and 0 < level for level in levels):
        faults.append("levels: is not a list of numbers above 0, such as 1.0e-3")
    settings = given.get("settings", {})
    if not isinstance(settings, dict) or not all(isinstance(how, dict) for how in settings.values()):
        faults.append("settings: is not a mapping of quantities to mappings")
    return Config(path, **files, **plain, levels=levels, settings=settings, methods=methods, scenes=scenes,
                  charts=section(Chart, given.get("charts", {}), "charts", faults))


def _contradictions(config: Config) -> list[str]:
    """What the parts of a config say about each other."""
    faults: list[str] = []
    for name in config.settings:
        faults += strangers(config.settings[name], ("label", "set"), f"settings.{name}")
    for name, scene in config.scenes.items():
        faults += _scene_faults(config, scene, f"scenes.{name}")
        if not config.scenario(name).is_file():
            faults.append(f"scenes.{name}.scenario: there is no file {scene.scenario}")
        elif not faults:
            faults += _formula_faults(config, name)
    for name, chart in config.charts.items():
        for k, panel in enumerate(chart.panels):
            faults += _panel_faults(config, panel, f"charts.{name}.panels[{k}]")
    return faults


def _scene_faults(config: Config, scene: Scene, where: str) -> list[str]:
    faults = strangers(scene.methods, config.methods, f"{where}.methods") + strangers(scene.set, config.settings, f"{where}.set")
    runs = dict(scene.methods)
    if not scene.errors:
        faults.append(f"{where}.errors: there are none")
    for name, error in scene.errors.items():
        faults += strangers([error.value], VALUES, f"{where}.errors.{name}.value")
        if error.exact == REFERENCE and not scene.reference:
            faults.append(f"{where}.errors.{name}.exact: the scene has no reference")
    if scene.reference:
        faults += strangers(scene.reference, ("method", "settings"), f"{where}.reference")
        faults += strangers([scene.reference.get("method")], config.methods, f"{where}.reference.method")
        levels = scene.reference.get("settings")
        if not isinstance(levels, list) or len(levels) < 2:
            faults.append(f"{where}.reference.settings: is not a list of two settings or more, the finest last")
        else:
            runs["reference"] = [{name: [value] for name, value in level.items()} for level in levels]
    for method, given in runs.items():
        for grid in grids(given):
            if not isinstance(grid, dict) or not all(isinstance(values, list) and values for values in grid.values()):
                faults.append(f"{where}.methods.{method}: is not a mapping of quantities to lists of values")
            else:
                faults += strangers(grid, config.settings, f"{where}.methods.{method}")
    return faults


def _formula_faults(config: Config, name: str) -> list[str]:
    scene = config.scenes[name]
    try:
        for method, given in scene.methods.items():
            for setting in settings_of(given):
                if config.methods[method].ours:
                    keys_of(config, name, method, setting)
        for error in scene.errors.values():
            if error.exact != REFERENCE:
                scale_of(error)
    except (FormulaError, ValueError) as error:
        return [f"scenes.{name}: {error}"]
    return []


def scale_of(error: Error, exact: float | None = None) -> float:
    """What the error is divided by. Raises ValueError if it is none."""
    given = error.scale if error.scale is not None else (error.exact if exact is None else exact)
    scale = abs(figure_of(given))
    if not scale > 0:
        raise ValueError(f"error {error.label}: needs a scale above 0")
    return scale


def _panel_faults(config: Config, panel: object, where: str) -> list[str]:
    if not isinstance(panel, dict) or "scene" not in panel:
        return [f"{where}: has no scene"]
    if panel["scene"] not in config.scenes:
        return [f"{where}.scene: unknown {panel['scene']}{nearest(panel['scene'], config.scenes)}"]
    return (strangers(panel, ("scene", "title", "error"), where)
            + strangers([panel.get("error", LARGEST)], [LARGEST, *config.scenes[panel["scene"]].errors], f"{where}.error"))
