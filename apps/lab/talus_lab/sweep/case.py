"""One case: runs talus in a folder of its own, measures the result, and says what came of it in `status.json`."""

from __future__ import annotations

import errno
import json
import os
import re
import select
import shutil
import signal
import socket
import subprocess
import time
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from talus_lab.errors import ResultError
from talus_lab.run import open_run
from talus_lab.sweep.lifetime import end_with_parent
from talus_lab.sweep.lock import BEAT, OWNER, Lock
from talus_lab.sweep.measures import measured, units

Record = dict[str, Any]  # what status.json holds
RESULT, STATUS, LOG = "out.h5", "status.json", "log.txt"
ELSEWHERE: Record = {"status": "elsewhere"}  # somebody else computes it now
SAID = {2: "refused", 3: "diverged", 5: "failed"}  # by exit code of talus; 0 and 1, an expectation not met or no equilibrium, are done
DISK, INTERRUPTED = 4, 130
COMPLAINT = re.compile(r"diverged: |output failed: |out of memory|a fault of talus|--set |\S+\.ya?ml:\d+ ")
FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class DiskError(ResultError):
    """Results cannot be written; the case has not been computed."""


class KilledError(Exception):
    """Somebody stopped talus from outside; the case has not been computed."""


@dataclass(frozen=True)
class Task:
    """All that a worker needs to know of a case, on whatever machine."""

    case: str
    folder: str
    scenario: str
    overrides: tuple[str, ...]
    talus: str
    version: str
    keys: tuple[str, ...]  # of measures
    threads: int = 1
    limit_s: float | None = None
    keep: bool = False  # the result file
    redo: str = ""  # `started` of the record that does not count


def run_case(task: Task) -> Record:
    """The record, which somebody else may have made; ELSEWHERE if that is going on. Raises DiskError, KilledError, MeasureError, and
    ResultError if it cannot be computed here at all: the case is then as if it had never begun."""
    folder = Path(task.folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = Lock(folder)
        if not lock.take():
            return ELSEWHERE
        try:
            known = read_status(folder)
            return known if is_made(known, task) else _again(task, known, lock)
        finally:
            lock.release()
    except OSError as error:
        kind = DiskError if error.errno in FULL else ResultError
        raise kind(f"{error.filename or folder}: {error.strerror}") from None


def read_status(folder: Path) -> Record:
    """Empty if there is none, or it was not written to its end when the machine stopped."""
    try:
        return json.loads((folder / STATUS).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def is_made(record: Record, task: Task) -> bool:
    """Whether the record has all that is asked for."""
    if not record or record["started"] == task.redo:
        return False
    return record["status"] != "done" or all(key in record["measures"] for key in task.keys)


def _again(task: Task, known: Record, lock: Lock) -> Record:
    """Measures a result that was kept, or runs."""
    folder = Path(task.folder)
    kept = known.get("status") == "done" and known["started"] != task.redo and (folder / RESULT).exists()
    record = known | _measures(task, folder / RESULT) if kept else _run(task, lock)
    write_status(folder, record)
    return record


def write_status(folder: Path, record: Record) -> None:
    beside = folder / f"{STATUS}.part"
    try:
        beside.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        beside.replace(folder / STATUS)
    except OSError:
        beside.unlink(missing_ok=True)
        raise


def _run(task: Task, lock: Lock) -> Record:
    folder = Path(task.folder)
    for left in folder.glob("part-*"):  # by those who were killed
        shutil.rmtree(left, ignore_errors=True)
    for left in folder.glob(f"{OWNER}*"):  # who is about to ask gets the answer that somebody is here
        left.unlink(missing_ok=True)
    part = folder / f"part-{os.getpid()}"
    part.mkdir()
    record: Record = {"case": task.case, "status": "done", "said": "", "measures": {}, "units": {}, "wall_time": 0.0, "threads": task.threads,
                      "talus_version": task.version, "scenario_hash": task.case, "host": socket.gethostname(),
                      "started": datetime.now(timezone.utc).isoformat(timespec="microseconds"), "scenario": task.scenario,
                      "overrides": list(task.overrides)}
    try:
        began = time.monotonic()
        code = _talus(task, part / RESULT, folder / LOG, lock)
        record["wall_time"] = round(time.monotonic() - began, 4)
        record |= _outcome(task, code, folder / LOG)
        if record["status"] == "done":
            record |= _measures(task, part / RESULT)
        if task.keep and (part / RESULT).exists():
            (part / RESULT).replace(folder / RESULT)
        return record
    finally:
        shutil.rmtree(part, ignore_errors=True)


def _talus(task: Task, result: Path, log: Path, lock: Lock) -> int | None:
    """Exit code; negative for a signal, None if it took longer than it may."""
    sets = [word for change in task.overrides for word in ("--set", change)]
    command = [task.talus, "run", task.scenario, "-o", str(result), "--threads", str(task.threads), *sets]
    with log.open("wb") as said:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.STDOUT, preexec_fn=_die_with_worker)
    try:
        return _wait(process, task.limit_s, lock)
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()


def _wait(process: subprocess.Popen, limit: float | None, lock: Lock) -> int | None:
    end = time.monotonic() + (limit or float("inf"))
    ended = os.pidfd_open(process.pid)  # Popen.wait with a limit looks only every 50 ms
    try:
        while time.monotonic() < end:
            ready, _, _ = select.select([ended], [], [], max(0.0, min(BEAT, end - time.monotonic())))
            if ready:
                return process.wait()
            lock.beat()
        return None
    finally:
        os.close(ended)


def _outcome(task: Task, code: int | None, log: Path) -> Record:
    if code is None:
        return {"status": "timed out", "said": f"takes longer than {task.limit_s:g} s"}
    if code in (0, 1):
        return {}
    said = _complaint(log) or f"exit code {code}"
    if code == DISK or os.strerror(errno.ENOSPC) in said:
        raise DiskError(f"{task.folder}: {said}")
    if code == INTERRUPTED or -code in FROM_OUTSIDE:
        raise KilledError(f"case {task.case}: talus was killed")
    if code < 0:
        return {"status": "crashed", "said": signal.Signals(-code).name}
    return {"status": SAID.get(code, "failed"), "said": said}


def _complaint(log: Path) -> str:
    """What talus says of its fault, which need not be the last line of its log."""
    lines = [line.strip() for line in log.read_text(encoding="utf-8", errors="replace").splitlines() if line.strip()]
    return next((line for line in reversed(lines) if COMPLAINT.match(line)), lines[-1] if lines else "")


def _measures(task: Task, result: Path) -> Record:
    run = open_run(result)
    return {"measures": measured(run, task.keys), "units": units(run, task.keys)}


def _die_with_worker() -> None:
    """In the process that becomes talus: nobody would take its result when its worker is killed."""
    end_with_parent(signal.SIGKILL)
