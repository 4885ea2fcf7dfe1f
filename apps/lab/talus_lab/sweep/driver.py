"""A sweep from its config to its table: what is there already, what is to do, and what becomes of it."""

from __future__ import annotations

import json
import queue
import subprocess
import time
from collections import Counter
from concurrent.futures import BrokenExecutor, CancelledError, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Mapping, Sequence

from talus_lab.errors import ResultError, nearest
from talus_lab.sweep.case import ELSEWHERE, FULL, RESULT, DiskError, KilledError, Record, Task, is_made, read_status, run_case
from talus_lab.sweep.cases import Case, cases_of
from talus_lab.sweep.config import Config
from talus_lab.sweep.engines import Engine, cores
from talus_lab.sweep.measures import MeasureError, history_of
from talus_lab.sweep.progress import Progress
from talus_lab.sweep.table import columns_of, write_tables

LOST = 3  # times that a case may lose its worker: once is chance, and what kills every worker is the case itself
WAIT = 1.0  # s between looks at a case that somebody else computes
SAVE = 30.0  # s between tables while it runs
SHOWN = 20  # failures that are told one by one


@dataclass
class Sweep:
    """Cases of a config, and what is known of them."""

    config: Config
    cases: Sequence[Case]
    tasks: Mapping[str, Task]  # by id
    records: dict[str, Record]  # by id, of earlier calls too

    def due(self) -> list[Task]:
        """What is missing or asked for again."""
        return [task for task in self.tasks.values() if not is_made(self.records[task.case], task)]

    def state(self, case: str) -> str:
        record = self.records[case]
        if not is_made(record, self.tasks[case]) and record.get("status") == "done":
            return "to measure" if (self.config.output / "cases" / case / RESULT).exists() else "to run again"
        return "to run again" if record and record.get("started") == self.tasks[case].redo else record.get("status", "missing")

    def again(self) -> str:
        """What was computed and will be once more, and why; or nothing."""
        cases = [case for case in self.tasks if self.state(case) == "to run again" and not self.tasks[case].redo]
        asked = [measure.name for measure in self.config.measures if any(measure.key not in self.records[case]["measures"] for case in cases)]
        return (f"{len(cases)} cases that are done run again for {', '.join(asked)}: their results were not kept (keep: results)") if cases else ""

    def counts(self) -> Counter:
        return Counter(self.records[name].get("status", "missing") for name in self.tasks)

    def write(self) -> None:
        """The table of what is known now, to others too. Raises DiskError."""
        for case, task in self.tasks.items():
            self.records[case] = self.records[case] or read_status(Path(task.folder))
        try:
            write_tables(self.config, columns_of(self.config, self.cases, self.records))
        except OSError as error:
            raise (DiskError if error.errno in FULL else ResultError)(f"{self.config.output}: {error.strerror}") from None


def prepare(config: Config, talus: str, workers: int, retry: str = "") -> Sweep:
    """Raises ResultError with every fault of the config that only the engine can see."""
    version = _version(talus)
    cases = cases_of(config, talus)
    keys = tuple(measure.key for measure in config.measures)
    threads = max(1, cores() // workers)
    folder = config.output / "cases"
    records = {case.id: read_status(folder / case.id) for case in cases}

    def redo(record: Record) -> str:
        again = retry == "all" or (retry == "failed" and record.get("status") != "done")
        return record.get("started", "") if again else ""

    tasks = {case.id: Task(case.id, str(folder / case.id), str(config.scenario), case.overrides, talus, version, keys, threads, config.limit_s,
                           config.keep == "results", redo(records[case.id])) for case in cases}
    found = Sweep(config, cases, tasks, records)
    _check_histories(found, talus)
    return found


def _version(talus: str) -> str:
    said = subprocess.run([talus, "--version"], capture_output=True, text=True)
    if said.returncode != 0 or not said.stdout.startswith("talus "):
        raise ResultError(f"{talus}: is not talus, which says its version when asked for --version")
    return said.stdout.split()[-1]


def _check_histories(sweep: Sweep, talus: str) -> None:
    """Whether the scenario records what measures look at: of the first case alone, for only a result knows all, but before hours of computing."""
    wanted = {k: history_of(measure.key) for k, measure in enumerate(sweep.config.measures) if history_of(measure.key)}
    if not wanted or not sweep.due():
        return
    task = sweep.due()[0]
    sets = [word for change in task.overrides for word in ("--set", change)]
    resolved = subprocess.run([talus, "check", task.scenario, "--resolved", *sets], capture_output=True, text=True, encoding="utf-8")
    if resolved.returncode == 0:
        there = [history["name"] for history in json.loads(resolved.stdout)["record"].get("history", [])]
        sweep.config.fault(*(f"measures[{k}]: no history {name}{nearest(name, there)}" for k, name in wanted.items() if name not in there))


def compute(sweep: Sweep, engine: Engine, wait: bool = True, progress: Progress | None = None) -> None:
    """All that is due. wait: also for what others compute, until they have or are gone. The table is written however it ends. Raises
    DiskError if nothing more can be written, ResultError for a measure that does not exist."""
    due = sweep.due()
    counts = Counter(sweep.records[name]["status"] for name in set(sweep.tasks) - {task.case for task in due})
    progress = progress or Progress(len(sweep.tasks), counts["done"], sum(counts.values()) - counts["done"])
    if sweep.again():
        progress.say(sweep.again())
    try:
        _Round(sweep, engine, wait, progress).run(due)
    except MeasureError as error:
        sweep.config.fault(*(f"measures[{k}]: {error}" for k, measure in enumerate(sweep.config.measures) if measure.key == error.args[0]))
    except KeyboardInterrupt:
        progress.say(f"interrupted: {summary(sweep)}; the same command goes on")
        raise
    finally:
        progress.close()
        sweep.write()


class _Round:
    """The calls that are out, and those that come back."""

    def __init__(self, sweep: Sweep, engine: Engine, wait: bool, progress: Progress):
        self.sweep, self.engine, self.wait, self.progress = sweep, engine, wait, progress
        self.back: queue.SimpleQueue[tuple[Task, Future]] = queue.SimpleQueue()
        self.out = 0
        self.elsewhere: dict[str, tuple[float, Task]] = {}  # when to look again
        self.lost: Counter = Counter()
        self.told = 0
        self.saved = time.monotonic()

    def run(self, due: Sequence[Task]) -> None:
        for task in due:
            self._call(task)
        while self.out or self.elsewhere:
            try:
                task, future = self.back.get(timeout=0.1)
                self.out -= 1
                self._take(task, future)
            except queue.Empty:
                pass
            self._look_elsewhere()
            self.progress.show(lambda: min(self.out, self.engine.workers()))
            if time.monotonic() - self.saved > SAVE:
                self.saved = time.monotonic()
                self.sweep.write()

    def _call(self, task: Task) -> None:
        self.out += 1
        self.engine.executor.submit(run_case, task).add_done_callback(lambda future: self.back.put((task, future)))

    def _take(self, task: Task, future: Future) -> None:
        try:
            record = future.result()
        except KilledError as error:
            self._tell(str(error))
        except (ResultError, CancelledError):
            raise
        except Exception as error:
            self.lost[task.case] += 1
            if not _is_loss(error):
                self._tell(f"case {task.case}: cannot be computed or measured: {type(error).__name__}: {error}")
            elif self.lost[task.case] < LOST:
                self._call(task)
            else:
                self._tell(f"case {task.case}: lost its worker {LOST} times, the last time because: {error}")
        else:
            if record["status"] != ELSEWHERE["status"]:
                self._keep(task, record)
            elif self.wait:
                self.elsewhere[task.case] = time.monotonic() + WAIT, task

    def _keep(self, task: Task, record: Record) -> None:
        self.sweep.records[task.case] = record
        self.progress.count(record["status"])
        if record["status"] != "done":
            self._tell(f"case {task.case}: {record['status']}: {record['said']}; see {task.folder}/log.txt")

    def _tell(self, text: str) -> None:
        self.told += 1
        if self.told <= SHOWN:
            self.progress.say(text if self.told < SHOWN else f"{text}\nfurther failures stand in the table")

    def _look_elsewhere(self) -> None:
        for name, (when, task) in list(self.elsewhere.items()):
            if when <= time.monotonic():
                del self.elsewhere[name]
                self._call(task)


def _is_loss(error: Exception) -> bool:
    """Of the worker, not of the case: Dask has its own words for it."""
    return isinstance(error, BrokenExecutor) or type(error).__module__.startswith("distributed")


def listing(sweep: Sweep) -> str:
    """A line for each case: id, state, parameters."""
    lines = [f"{case.id}  {sweep.state(case.id):<12}  {', '.join(f'{name} {value}' for name, value in case.values.items())}" for case in sweep.cases]
    return "\n".join([*lines, *filter(None, [sweep.again()]), f"{summary(sweep)}; {len(sweep.due())} to compute"])


def summary(sweep: Sweep) -> str:
    """300 cases: 296 done, 4 diverged"""
    twins = len(sweep.cases) - len(sweep.tasks)
    counts = ", ".join(f"{count} {status}" for status, count in sweep.counts().most_common())
    return f"{len(sweep.cases)} cases: {counts}" + (f"; {twins} have the same scenario as another one" if twins else "")
