"""Runs the scenes of a config with every method and setting, and keeps errors and times in one CSV from which an interrupted study
goes on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Callable, Iterator

from talus_lab.chart.config import REFERENCE, Config, Setting, figure_of, keys_of, scale_of, settings_of
from talus_lab.chart.methods import Done, Stage, command_of
from talus_lab.chart.values import VALUES
from talus_lab.run import ResultError
from talus_lab.study.kept import Row, digest, read_rows, write_rows

# errors: `name=value` of each error of the scene. unsure: how much of `error` may be that of the reference. said: why there is no
# error. repeat: runs so far.
COLUMNS = ("scene", "method", "setting", "cpu_time", "error", "errors", "unsure", "repeat", "said", "task")
REFERENCE_COLUMNS = ("scene", "setting", "values", "task")
NOT_THERE = "is not there"
LONG = 10.0  # s of CPU: what takes longer is not repeated, for what else the machine does evens out


@dataclass(frozen=True)
class Cell:
    """One scene, method and setting."""

    scene: str
    method: str
    setting: Setting

    @property
    def name(self) -> tuple[str, str, str]:
        return self.scene, self.method, setting_text(self.setting)


def measure(config: Config, talus: str, long: bool = False, again: bool = False, say: Callable[[str], None] = print) -> list[Row]:
    """All rows of the study, those of earlier, interrupted runs among them. long: measures also the scenes that are marked so.
    again: measures even what is there already. What was measured with another build of its program is measured anew."""
    table = config.output / "results.csv"
    everything = list(cells(config))
    names = {cell.name for cell in everything}
    rows = {_name(row): row for row in measured(config) if _name(row) in names}
    absent = {name: method for name, method in config.methods.items() if not method.ours and command_of(method, talus) is None}
    for name, method in absent.items():
        say(f"{name}: left out, {method.command[0]} is not there. {method.missing}")
    for cell in everything:
        if cell.method in absent and cell.name not in rows:
            rows[cell.name] = {**_empty(cell), "said": f"{absent[cell.method].command[0]} {NOT_THERE}"}
    for scene in config.scenes:
        if config.scenes[scene].long and not long:
            continue
        due = [cell for cell in everything if cell.scene == scene and cell.method not in absent]
        with TemporaryDirectory() as folder:
            stage = Stage(config, scene, talus, folder)
            for row in _scene(stage, due, {} if again else rows, say):
                rows[_name(row)] = row
                write_rows(table, COLUMNS, list(rows.values()))
    return [rows[cell.name] for cell in everything if cell.name in rows]


def measured(config: Config) -> list[Row]:
    """The rows that are there already."""
    return read_rows(config.output / "results.csv", COLUMNS)


def references(config: Config) -> list[Row]:
    return read_rows(config.output / "references.csv", REFERENCE_COLUMNS)


def cells(config: Config) -> Iterator[Cell]:
    for name, scene in config.scenes.items():
        for method, given in scene.methods.items():
            for setting in settings_of(given):
                yield Cell(name, method, setting)


def setting_text(setting: Setting) -> str:
    return ", ".join(f"{name} {value:g}" if isinstance(value, (int, float)) else f"{name} {value}" for name, value in setting.items())


def _scene(stage: Stage, due: list[Cell], known: dict[tuple, Row], say: Callable[[str], None]) -> Iterator[Row]:
    """Every setting once, then all of them again, in turn: a machine that changes its speed meanwhile changes it for all."""
    tasks = {cell.name: _task(stage, cell) for cell in due}
    rows = {cell.name: known[cell.name] for cell in due if cell.name in known and known[cell.name]["task"] == tasks[cell.name]}
    exact = None
    for turn in range(stage.config.repeat):
        for k, cell in enumerate(due, 1):
            row = rows.get(cell.name)
            if row and (int(row["repeat"]) > turn or row["said"] or float(row["cpu_time"]) * stage.seconds > LONG):
                continue
            try:
                exact = exact or _exact(stage, say)
            except ResultError as error:  # another machine, or another day, may have what the reference needs
                say(f"{stage.name}: left out, no reference: {error}")
                return
            row = _first(stage, cell, exact) if row is None else _again(stage, cell, row)
            rows[cell.name] = {**row, "task": tasks[cell.name]}
            say(f"{cell.scene}, {turn + 1} of {stage.config.repeat}, [{k}/{len(due)}] {cell.method}, {setting_text(cell.setting)}: "
                + (row["said"] or f"error {float(row['error']):.2e}, {float(row['cpu_time']):.2e} s per s"))
            yield rows[cell.name]


def _first(stage: Stage, cell: Cell, exact: dict[str, tuple[float, float]]) -> Row:
    row = _empty(cell) | {"repeat": "1"}
    try:
        done = stage.run(cell.method, cell.setting)
        errors = {name: abs(value - exact[name][0]) / _scale(stage, name, exact) for name, value in values(stage, done).items()}
    except ResultError as error:
        return {**row, "said": str(error)}
    if stage.scene.frames > 1 and stage.config.methods[cell.method].ours:
        done = stage.run(cell.method, cell.setting, states=False)
    largest = max(errors, key=lambda name: errors[name])
    return {**row, "cpu_time": f"{done.cpu_time:.4g}", "error": f"{errors[largest]:.4g}", "unsure": f"{exact[largest][1]:.2g}",
            "errors": "; ".join(f"{name}={value:.4g}" for name, value in errors.items())}


def _empty(cell: Cell) -> Row:
    return {name: "" for name in COLUMNS} | {"scene": cell.scene, "method": cell.method, "setting": setting_text(cell.setting), "repeat": "0"}


def _again(stage: Stage, cell: Cell, row: Row) -> Row:
    done = stage.run(cell.method, cell.setting, states=False)
    return {**row, "repeat": str(int(row["repeat"]) + 1), "cpu_time": f"{min(float(row['cpu_time']), done.cpu_time):.4g}"}


def values(stage: Stage, done: Done) -> dict[str, float]:
    return {name: VALUES[error.value](done.motion, stage.look(error)) for name, error in stage.scene.errors.items()}


def _scale(stage: Stage, name: str, exact: dict[str, tuple[float, float]]) -> float:
    return scale_of(stage.scene.errors[name], exact[name][0])


def _exact(stage: Stage, say: Callable[[str], None]) -> dict[str, tuple[float, float]]:
    """The exact value of each error, and what the error of a row may be due to it."""
    found = {name: (figure_of(error.exact), 0.0) for name, error in stage.scene.errors.items() if error.exact != REFERENCE}
    if len(found) == len(stage.scene.errors):
        return found
    levels = list(_reference_levels(stage, say))
    for name, error in stage.scene.errors.items():
        if error.exact == REFERENCE:
            before, finest = (level[name] for level in levels[-2:])
            found[name] = finest, abs(finest - before) / scale_of(error, finest)
    return found


def _reference_levels(stage: Stage, say: Callable[[str], None]) -> Iterator[dict[str, float]]:
    """Values of the reference runs, from coarse to fine; kept, too."""
    table = stage.config.output / "references.csv"
    method = stage.scene.reference["method"]
    settings = stage.scene.reference["settings"]
    names = {f"{method}, {setting_text(setting)}" for setting in settings}
    for setting in settings:
        cell = Cell(stage.name, method, setting)
        task = _task(stage, cell)
        rows = references(stage.config)
        row = next((row for row in rows if row["task"] == task), None)
        if row is None:
            say(f"{stage.name}, reference: {method}, {setting_text(setting)}")
            found = values(stage, stage.run(method, setting))
            row = {"scene": stage.name, "setting": f"{method}, {setting_text(setting)}", "task": task,
                   "values": "; ".join(f"{name}={value:.10g}" for name, value in found.items())}
            others = [old for old in rows if old["scene"] != stage.name or old["setting"] in names - {row["setting"]}]
            write_rows(table, REFERENCE_COLUMNS, [*others, row])
        yield parts(row["values"])


def parts(text: str) -> dict[str, float]:
    """`a=1; b=2` as numbers."""
    return {name: float(value) for name, _, value in (part.partition("=") for part in text.split("; ") if part)}


def _task(stage: Stage, cell: Cell) -> str:
    """What a row depends on. Other programs depend on what they are told, not on the build of talus."""
    config, method = stage.config, stage.config.methods[cell.method]
    about = (stage.scene.errors, stage.scene.frames, config.share, config.limit_s, stage.scene.reference, cell.setting)
    if method.ours:
        return digest(about, keys_of(config, cell.scene, cell.method, cell.setting), config.scenario(cell.scene), Path(stage.talus))
    files = [Path(word) for word in command_of(method, stage.talus) if Path(word).is_file()]
    modules = [path for word in method.command for path in Path(__file__).parents[1].glob(f"runners/{str(word).rpartition('.')[2]}.py")]
    return digest(about, stage.as_json(cell.setting), *sorted({*files, *modules}))


def _name(row: Row) -> tuple[str, str, str]:
    return row["scene"], row["method"], row["setting"]
