"""Runs the scenes of a config with every method and setting, and keeps errors and times in one CSV from which an interrupted study
goes on."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Callable, Iterator

from talus_lab.chart.config import REFERENCE, Config, Setting, figure_of, keys_of, scale_of, settings_of
from talus_lab.chart.methods import Done, Prepared, command_of
from talus_lab.chart.values import VALUES
from talus_lab.errors import ResultError
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
            ready = Prepared(config, scene, talus, folder)
            for row in _scene(ready, due, {} if again else rows, say):
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


def _scene(ready: Prepared, due: list[Cell], known: dict[tuple, Row], say: Callable[[str], None]) -> Iterator[Row]:
    """Every setting once, then all of them again, in turn: a machine that changes its speed meanwhile changes it for all."""
    tasks = {cell.name: _task(ready, cell) for cell in due}
    rows = {cell.name: known[cell.name] for cell in due if cell.name in known and known[cell.name]["task"] == tasks[cell.name]}
    exact = None
    for turn in range(ready.config.repeat):
        for k, cell in enumerate(due, 1):
            row = rows.get(cell.name)
            if row and (int(row["repeat"]) > turn or row["said"] or float(row["cpu_time"]) * ready.seconds > LONG):
                continue
            try:
                exact = exact or _exact(ready, say)
            except ResultError as error:  # another machine, or another day, may have what the reference needs
                say(f"{ready.name}: left out, no reference: {error}")
                return
            row = _first(ready, cell, exact) if row is None else _again(ready, cell, row)
            rows[cell.name] = {**row, "task": tasks[cell.name]}
            say(f"{cell.scene}, {turn + 1} of {ready.config.repeat}, [{k}/{len(due)}] {cell.method}, {setting_text(cell.setting)}: "
                + (row["said"] or f"error {float(row['error']):.2e}, {float(row['cpu_time']):.2e} s per s"))
            yield rows[cell.name]


def _first(ready: Prepared, cell: Cell, exact: dict[str, tuple[float, float]]) -> Row:
    row = _empty(cell) | {"repeat": "1"}
    try:
        done = ready.run(cell.method, cell.setting)
        errors = {name: abs(value - exact[name][0]) / _scale(ready, name, exact) for name, value in values(ready, done).items()}
    except ResultError as error:
        return {**row, "said": str(error)}
    if ready.scene.frames > 1 and ready.config.methods[cell.method].ours:
        done = ready.run(cell.method, cell.setting, states=False)
    largest = max(errors, key=lambda name: errors[name])
    return {**row, "cpu_time": f"{done.cpu_time:.4g}", "error": f"{errors[largest]:.4g}", "unsure": f"{exact[largest][1]:.2g}",
            "errors": "; ".join(f"{name}={value:.4g}" for name, value in errors.items())}


def _empty(cell: Cell) -> Row:
    return {name: "" for name in COLUMNS} | {"scene": cell.scene, "method": cell.method, "setting": setting_text(cell.setting), "repeat": "0"}


def _again(ready: Prepared, cell: Cell, row: Row) -> Row:
    """A run that fails here, as one does that takes a little longer than it may, changes nothing."""
    row = {**row, "repeat": str(int(row["repeat"]) + 1)}
    try:
        done = ready.run(cell.method, cell.setting, states=False)
    except ResultError:
        return row
    return {**row, "cpu_time": f"{min(float(row['cpu_time']), done.cpu_time):.4g}"}


def values(ready: Prepared, done: Done) -> dict[str, float]:
    return {name: VALUES[error.value](done.motion, ready.look(error)) for name, error in ready.scene.errors.items()}


def _scale(ready: Prepared, name: str, exact: dict[str, tuple[float, float]]) -> float:
    return scale_of(ready.scene.errors[name], exact[name][0])


def _exact(ready: Prepared, say: Callable[[str], None]) -> dict[str, tuple[float, float]]:
    """The exact value of each error, and what the error of a row may be due to it."""
    found = {name: (figure_of(error.exact), 0.0) for name, error in ready.scene.errors.items() if error.exact != REFERENCE}
    if len(found) == len(ready.scene.errors):
        return found
    levels = list(_reference_levels(ready, say))
    for name, error in ready.scene.errors.items():
        if error.exact == REFERENCE:
            before, finest = (level[name] for level in levels[-2:])
            found[name] = finest, abs(finest - before) / scale_of(error, finest)
    return found


def _reference_levels(ready: Prepared, say: Callable[[str], None]) -> Iterator[dict[str, float]]:
    """Values of the reference runs, from coarse to fine; kept, too."""
    table = ready.config.output / "references.csv"
    method = ready.scene.reference["method"]
    settings = ready.scene.reference["settings"]
    names = {f"{method}, {setting_text(setting)}" for setting in settings}
    for setting in settings:
        cell = Cell(ready.name, method, setting)
        task = _task(ready, cell)
        rows = references(ready.config)
        row = next((row for row in rows if row["task"] == task), None)
        if row is None:
            say(f"{ready.name}, reference: {method}, {setting_text(setting)}")
            found = values(ready, ready.run(method, setting))
            row = {"scene": ready.name, "setting": f"{method}, {setting_text(setting)}", "task": task,
                   "values": "; ".join(f"{name}={value:.10g}" for name, value in found.items())}
            others = [old for old in rows if old["scene"] != ready.name or old["setting"] in names - {row["setting"]}]
            write_rows(table, REFERENCE_COLUMNS, [*others, row])
        yield parts(row["values"])


def parts(text: str) -> dict[str, float]:
    """`a=1; b=2` as numbers."""
    return {name: float(value) for name, _, value in (part.partition("=") for part in text.split("; ") if part)}


def _task(ready: Prepared, cell: Cell) -> str:
    """What a row depends on. Other programs depend on what they are told, not on the build of talus."""
    config, method = ready.config, ready.config.methods[cell.method]
    about = (ready.scene.errors, ready.scene.frames, config.share, config.limit_s, ready.scene.reference, cell.setting)
    if method.ours:
        return digest(about, keys_of(config, cell.scene, cell.method, cell.setting), config.scenario(cell.scene), Path(ready.talus))
    files = [Path(word) for word in command_of(method, ready.talus) if Path(word).is_file()]
    ours = [Path(__file__).parents[1] / f"runners/{str(word).rpartition('.')[2]}.py" for word in method.command]
    modules = [path for own in ours if own.is_file() for path in (own, own.with_name("scene.py"))]
    return digest(about, ready.as_json(cell.setting), *sorted({*files, *modules}))


def _name(row: Row) -> tuple[str, str, str]:
    return row["scene"], row["method"], row["setting"]
