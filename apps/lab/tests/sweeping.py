"""What the tests of sweeps share: a block on an incline that takes a few milliseconds, and a talus that says when it was asked to run."""

from __future__ import annotations

import csv
import json
import multiprocessing
import os
import signal
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Iterator, Mapping

import pytest
import yaml

from talus_lab.cli import main
from talus_lab.errors import ResultError
from talus_lab.program import find_talus
from talus_lab.sweep.engines import Engine, engine_of

SCENARIO = """\
title: Block on an incline
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {base: {normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle_deg: 20}}
blocks:
  - {name: plane, held: true, outline: [[0, 0], [10, 0], [10, 5]]}
  - {name: block, outline: [[6, 3], [8, 4], [7.5, 5], [5.5, 4]]}
run: {until: {time: 0.05}}
record: {frames: {count: 1}, history: [{name: block, point: [6.75, 4], quantity: displacement, component: magnitude}]}
"""
# Stands before talus: notes every run and the folder of its case, then does what the file `first` says, once, or `always`.
STAND_IN = """\
#!/bin/sh
if [ "$1" = run ]; then
    echo "$4" >> "{here}/runs"
    . "{here}/always"
fi
exec "{talus}" "$@"
"""


def config(folder: Path, **changes: object) -> Path:
    """A sweep of nine cases with these keys of its config changed; None takes one away."""
    given = {"scenario": "incline.yaml", "output": "out",
             "parameters": {"friction_deg": {"set": "joints.base.friction_angle_deg", "values": [10, 20, 30]},
                            "density": {"set": "materials.rock.density", "from": 2400, "to": 2600, "step": 100, "unit": "kg/m3"}},
             "measures": ["max_displacement", {"name": "way", "history": "block", "at": "max"}]} | changes
    (folder / "incline.yaml").write_text(SCENARIO)
    path = folder / "sweep.yaml"
    path.write_text(yaml.safe_dump({key: value for key, value in given.items() if value is not None}, sort_keys=False))
    return path


@contextmanager
def in_this_process(name: str, workers: int, scheduler: str = "", cluster: Mapping = {}) -> Iterator[Engine]:
    """In the place of local workers, one case at a time: a worker takes longer to start than many cases do."""
    if name != "local" or scheduler:
        with engine_of(name, workers, scheduler, cluster) as engine:
            yield engine
    else:
        with ThreadPoolExecutor(1) as pool:
            yield Engine(pool, lambda: 1)


def stand_in(folder: Path, monkeypatch: pytest.MonkeyPatch, always: str = "", workers: bool = True) -> Path:
    """Puts a program that notes its runs in the place of talus. workers: cases are computed by processes of their own, as ever."""
    try:
        talus = find_talus()
    except ResultError as error:
        pytest.skip(str(error))
    here = folder / "bin"
    here.mkdir()
    (here / "always").write_text(always + "\n")
    program = here / "talus"
    program.write_text(STAND_IN.format(here=here, talus=Path(talus).resolve()))
    program.chmod(0o755)
    monkeypatch.setenv("TALUS", str(program))
    monkeypatch.setattr("talus_lab.sweep.cores", lambda: 1)  # a worker takes longer to start than a case does
    if not workers:
        monkeypatch.setattr("talus_lab.sweep.engine_of", in_this_process)
    return here


def runs(here: Path) -> list[str]:
    """The case of every run of talus so far, by its id."""
    path = here / "runs"
    return [line.split("/")[-3] for line in path.read_text().splitlines()] if path.exists() else []


def table(folder: Path) -> list[dict[str, str]]:
    with open(folder / "out" / "table.csv", newline="") as file:
        return list(csv.DictReader(file))


def status(folder: Path, case: str) -> dict:
    return json.loads((folder / "out" / "cases" / case / "status.json").read_text())


class Driver:
    """`talus-lab sweep` as a process of its own, forked: what this one has loaded need not be loaded again."""

    def __init__(self, path: Path, *options: str):
        self.said = path.parent / f"said-{time.monotonic_ns()}.txt"
        self.process = multiprocessing.get_context("fork").Process(target=self._call, args=(["sweep", str(path), *options],))
        self.process.start()
        assert self.process.pid
        self.pid = self.process.pid

    def _call(self, arguments: list[str]) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where tests run in the background of a shell
        file = os.open(self.said, os.O_WRONLY | os.O_CREAT)
        os.dup2(file, 1), os.dup2(file, 2)
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
        sys.exit(main(arguments))

    def running(self) -> bool:
        return self.process.is_alive()

    def end(self) -> tuple[int | None, str]:
        """Exit code and what it said."""
        self.process.join(60)
        return self.process.exitcode, self.said.read_text()
