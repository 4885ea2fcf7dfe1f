"""Runs the studies of a config, point by point, and keeps what was measured in one CSV from which an interrupted study goes on."""

from __future__ import annotations

import subprocess
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable, Iterator

from talus_lab.bench.config import Config, Study, overrides
from talus_lab.program import find_peers
from talus_lab.errors import ResultError
from talus_lab.study.kept import Row, digest, read_rows, write_rows

# Beside those of the point: the columns of `talus bench search`, and then those of `talus bench step` that it lacks (docs/benchmarks.md).
COLUMNS = ("study", "scene", "varied", "value", "method", "threads", "skin", "boxes", "steps", "ns_per_box_median", "ns_per_box_q1",
           "ns_per_box_q3", "ns_per_box_mean", "ns_per_box_max", "first_ns_per_box", "list_ns_per_box", "exchanges_per_box",
           "pairs_per_box", "bytes_per_box", "wrong_steps", "blocks", "parts", "contacts", "ns_per_block_and_step", "move", "place",
           "search", "contacts_part", "sum", "account", "refreshes", "bytes_per_block", "build_s", "task")
QUICK_BLOCKS = 300


@dataclass(frozen=True)
class Point:
    """One study, scene and value: what is measured, and kept or lost, as a whole."""

    study: str
    scene: str
    value: float

    @property
    def name(self) -> tuple[str, str, str]:
        return self.study, self.scene, format(self.value, "g")


@dataclass(frozen=True)
class Programs:
    talus: str
    peers: str | None


def measure(config: Config, talus: str, long: bool = False, again: bool = False, say: Callable[[str], None] = print) -> list[Row]:
    """All rows of the study, those of earlier, interrupted runs among them. long: measures also what is marked so.
    again: measures even what is there already. Rows measured with another build of the program are measured anew."""
    programs = Programs(talus, find_peers(talus))
    table = config.output / "results.csv"
    everything = [Point(name, scene, value) for name, study in config.studies.items() for scene in study.scenes for value in study.values]
    names = {point.name for point in everything}
    rows = [row for row in measured(config) if _name(row) in names]
    missing = [name for name, study in config.studies.items() if study.command == "peers" and not programs.peers]
    if missing:
        say(f"left out, talus_bench_peers is not built: {', '.join(missing)}")
    due = [point for point in everything if point.study not in missing and (long or not config.studies[point.study].long)]
    for k, point in enumerate(due, 1):
        where = f"[{k}/{len(due)}] {point.study}, {point.scene}, {config.studies[point.study].varied} {point.value:g}"
        task = _digest(config, point, programs)
        if not again and any(row["task"] == task for row in rows):
            say(f"{where}: is there")
            continue
        started = time.monotonic()
        found = [{**row, "task": task} for row in measure_point(config, point, programs)]
        rows = [row for row in rows if _name(row) != point.name] + found
        write_rows(table, COLUMNS, rows)
        say(f"{where}: {time.monotonic() - started:.1f} s")
    order = {point.name: k for k, point in enumerate(everything)}
    return sorted(rows, key=lambda row: order[_name(row)])


def measured(config: Config) -> list[Row]:
    """The rows that are there already."""
    return read_rows(config.output / "results.csv", COLUMNS)


def quick(config: Config) -> Config:
    """The same studies in their shortest form, to see that everything works: two values, few blocks, few steps."""
    def short(name: str, values: list) -> list:
        ends = [values[0], values[-1]]
        return sorted({min(value, QUICK_BLOCKS) for value in ends}) if name == "blocks" else sorted(set(ends))

    def shortest(study: Study) -> Study:
        fixed = {name: short(name, [value])[0] for name, value in study.fixed.items()}
        return replace(study, vary={study.varied: short(study.varied, study.values)}, fixed=fixed, steps=3, repeat=1, rounds=1, threads=[1])

    return replace(config, output=config.output / "quick", images=config.output / "quick",
                   studies={name: shortest(study) for name, study in config.studies.items()})


def measure_point(config: Config, point: Point, programs: Programs) -> list[Row]:
    study = config.studies[point.study]
    keys, start, steps = overrides(config, point.scene, study, point.value)
    scenario = str((config.path.parent / config.scenes[point.scene].scenario).resolve())
    sets = [word for key, value in keys.items() for word in ("--set", f"{key}={value}")]
    axes = ["--axes", str(study.axes)] if study.axes != "" else []
    begin = [*sets, *(["--from", start] if start else []), *axes, "--steps", str(steps)]
    methods = _within_reach(config, study, point)
    with tempfile.TemporaryDirectory() as folder:
        run = {"search": _search, "step": _step, "peers": _peers}[study.command]
        rows = list(run(programs, study, scenario, begin, methods, Path(folder)))
    known = {"study": point.study, "scene": point.scene, "varied": study.varied, "value": format(point.value, "g")}
    return [{**row, **known} for row in rows]


def _search(programs: Programs, study: Study, scenario: str, begin: list[str], methods: list[str], folder: Path) -> Iterator[Row]:
    out = folder / "search.csv"
    _call([programs.talus, "bench", "search", scenario, *begin, "--repeat", str(study.repeat), "--methods", ",".join(methods),
           "--threads", _list(study.threads), "--skin", _list(study.skins), *([] if study.check else ["--no-check"]), "-o", str(out)])
    yield from read_rows(out)


def _step(programs: Programs, study: Study, scenario: str, begin: list[str], methods: list[str], folder: Path) -> Iterator[Row]:
    fastest: dict[tuple, Row] = {}
    for _ in range(study.rounds):
        for skin in study.skins:
            for method in methods:
                out = folder / "step.csv"
                _call([programs.talus, "bench", "step", scenario, *begin, "--set", f"run.search={method}", "--set", f"run.skin={skin}",
                       "--repeat", str(study.repeat), "--threads", _list(study.threads), "-o", str(out), "--force"])
                for row in read_rows(out):
                    key = method, skin, row["threads"]
                    if key not in fastest or float(row["ns_per_block_and_step"]) < float(fastest[key]["ns_per_block_and_step"]):
                        fastest[key] = {**row, "method": method, "skin": str(skin)}
    yield from fastest.values()


def _peers(programs: Programs, study: Study, scenario: str, begin: list[str], methods: list[str], folder: Path) -> Iterator[Row]:
    motion, out = folder / "motion.bpt", folder / "peers.csv"
    _call([programs.talus, "bench", "search", scenario, *begin, "--record", str(motion), "--methods", "none"])
    _call([str(programs.peers), str(motion), "--repeat", str(study.repeat), "--methods", ",".join(methods),
           *([] if study.check else ["--no-check"]), "-o", str(out)])
    yield from read_rows(out)


def _call(command: list[str]) -> None:
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        said = [line for line in done.stderr.splitlines() if line.strip()] or [f"exit code {done.returncode}"]
        raise ResultError(f"{' '.join(command)}\nfailed: {said[-1].strip()}\nWhat was measured is kept; the same command goes on from here.")


def _within_reach(config: Config, study: Study, point: Point) -> list[str]:
    blocks = {**study.fixed, study.varied: point.value}.get("blocks", 0)
    return [method for method in study.methods if blocks <= config.largest.get(method, blocks)]


def _list(values: list) -> str:
    return ",".join(str(value) for value in values)


def _digest(config: Config, point: Point, programs: Programs) -> str:
    """What a result depends on: the programs, the scenario, and all that the config says about this point."""
    study = config.studies[point.study]
    scenario = config.path.parent / config.scenes[point.scene].scenario
    used = [Path(programs.talus)] + ([Path(programs.peers)] if study.command == "peers" and programs.peers else [])
    return digest(replace(study, scenes=[], vary={study.varied: []}, long=False), overrides(config, point.scene, study, point.value),
                  _within_reach(config, study, point), point.name, scenario, *used)


def _name(row: Row) -> tuple[str, str, str]:
    return row["study"], row["scene"], row["value"]
