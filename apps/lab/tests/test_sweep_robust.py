"""Sweeps whose workers, drivers, cases and disks fail: every case is done in the end, and none that was done is done again."""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Callable

import pytest
from sweeping import Driver, config, runs, stand_in, status, table

from talus_lab import sweep
from talus_lab.cli import main
from talus_lab.sweep.engines import _queue, engine_of
from talus_lab.sweep.lock import Lock, began, owner
from talus_lab.sweep.pool import LocalPool, WorkerLostError
from talus_lab.sweep.progress import Progress, duration


def workers_of(pid: int) -> list[int]:
    return [child for task in Path(f"/proc/{pid}/task").iterdir() for child in map(int, (task / "children").read_text().split())]


def forked(call: Callable[[], bool], processes: int = 1) -> list[bool]:
    """What calls in processes of their own give; these have ended afterwards."""
    ids = []
    for _ in range(processes):
        ids.append(os.fork())
        if ids[-1] == 0:
            os._exit(int(call()))
    return [os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]) == 1 for pid in ids]


def done(folder: Path) -> set[str]:
    return {path.parent.name for path in (folder / "out/cases").glob("*/status.json") if '"done"' in path.read_text()}


def wait_until(what, limit: float = 30.0) -> None:
    end = time.monotonic() + limit
    while not what():
        assert time.monotonic() < end, "nothing happens"
        time.sleep(0.005)


def many(folder: Path, count: int, **changes: object) -> Path:
    return config(folder, parameters={"density": {"set": "materials.rock.density", "from": 2001, "to": 2000 + count, "step": 1}}, **changes)


def clean(folder: Path) -> bool:
    """Nothing but results: no locks, nothing half-written."""
    left = {path.name for path in (folder / "out/cases").glob("*/*")} | {path.name for path in (folder / "out").glob("*")}
    return left == {"cases", "sweep.json", "table.csv", "table.h5", "log.txt", "status.json"}


# The pool
def test_a_worker_that_is_killed_costs_one_call():
    pool = LocalPool(2)
    calls = [pool.submit(os.getpid) for _ in range(4)]
    assert len({call.result() for call in calls} | {os.getpid()}) >= 2
    lost = pool.submit(os.kill, calls[0].result(), signal.SIGKILL)
    with pytest.raises(WorkerLostError):
        while True:  # whoever makes the call kills the other or itself
            lost.result()
            lost = pool.submit(os._exit, 1)
    wait_until(lambda: not began(calls[0].result()))  # who is about to die may be given a call, and the driver gives it again
    assert pool.submit(sum, [1, 2]).result() == 3
    with pytest.raises(ZeroDivisionError):
        pool.submit(divmod, 1, 0).result()
    pool.shutdown()


def test_a_pool_that_is_shut_down_ends_its_workers():
    pool = LocalPool(1)
    worker = pool.submit(os.getpid).result()
    pool.shutdown()
    assert not Path(f"/proc/{worker}").exists()
    pool = LocalPool(1)
    calls = [pool.submit(time.sleep, 60) for _ in range(3)]
    wait_until(calls[0].running)
    began = time.monotonic()
    pool.shutdown(cancel_futures=True)
    assert time.monotonic() - began < 5 and all(call.done() for call in calls)


# Locks
def test_a_lock_is_for_one_and_that_of_the_dead_is_taken_over(tmp_path):
    first, second = Lock(tmp_path), Lock(tmp_path)
    assert first.take() and not second.take()
    first.release()
    assert list(tmp_path.iterdir()) == [] and second.take()
    second.release()
    forked(lambda: Lock(tmp_path).take())
    assert len(list(tmp_path.iterdir())) == 1
    assert first.take() and not second.take()
    first.release()
    assert list(tmp_path.iterdir()) == []


def test_a_lock_of_another_host_holds_as_long_as_it_is_touched(tmp_path):
    lock = tmp_path / "lock.3"
    lock.write_text(owner().replace(os.uname().nodename, "elsewhere"))
    assert not Lock(tmp_path).take()
    os.utime(lock, (time.time() - 1000,) * 2)
    assert Lock(tmp_path).take()
    assert (tmp_path / "lock.4").exists()


def test_a_process_of_the_same_number_is_not_taken_for_the_owner(tmp_path):
    (tmp_path / "lock.1").write_text(owner().replace('"began": "', '"began": "1'))
    assert Lock(tmp_path).take()


def test_of_many_who_take_over_one_lock_one_succeeds(tmp_path):
    for turn in range(5):
        folder = tmp_path / str(turn)
        folder.mkdir()
        (folder / "lock.1").write_text(owner().replace('"began": "', '"began": "1'))
        at = time.monotonic() + 0.1

        def race() -> bool:
            while time.monotonic() < at:
                pass
            taken = Lock(folder).take()
            time.sleep(0.3)  # the dead lose what they have
            return taken

        assert sum(forked(race, 4)) == 1


# Cases that fail
def test_cases_that_crash_hang_diverge_or_are_refused_cost_nothing_but_themselves(tmp_path, monkeypatch, capsys):
    here = stand_in(tmp_path, monkeypatch, 'case "$*" in *density=2001*) kill -SEGV $$;; *density=2002*) sleep 60;; *density=2003*) exit 3;; esac')
    path = many(tmp_path, 6, limit_s=4, where=["density != 2005"])
    assert main(["sweep", str(path), "--workers", "2"]) == 1
    said = capsys.readouterr()
    rows = {row["density"]: row for row in table(tmp_path)}
    assert {name: row["status"] for name, row in rows.items()} == {"2001": "crashed", "2002": "timed out", "2003": "diverged", "2004": "done", "2006": "done"}
    assert rows["2002"]["max_displacement"] == "" and status(tmp_path, rows["2001"]["case"])["said"] == "SIGSEGV"
    assert f"case {rows['2002']['case']}: timed out: takes longer than 4 s; see " in said.err and "log.txt" in said.err
    assert "5 cases: 2 done, 1 crashed" in said.out or "5 cases: 2 done" in said.out
    assert clean(tmp_path)
    (here / "always").write_text("\n")
    assert main(["sweep", str(path)]) == 1 and len(runs(here)) == 5  # what failed is known, and not tried again
    assert main(["sweep", str(path), "--retry", "failed"]) == 0
    assert len(runs(here)) == 8 and {row["status"] for row in table(tmp_path)} == {"done"}
    assert main(["sweep", str(path), "--retry", "all"]) == 0 and len(runs(here)) == 13


def test_talus_killed_from_outside_leaves_its_case_to_the_next_call(tmp_path, monkeypatch, capsys):
    here = stand_in(tmp_path, monkeypatch, 'case "$*" in *density=2002*) kill -KILL $$;; esac')
    path = many(tmp_path, 3)
    assert main(["sweep", str(path)]) == 1
    assert "talus was killed" in capsys.readouterr().err
    assert sorted(row["status"] for row in table(tmp_path)) == ["done", "done", "missing"]
    (here / "always").write_text("\n")
    assert main(["sweep", str(path)]) == 0 and len(runs(here)) == 4


def test_a_status_that_was_not_written_to_its_end_counts_for_nothing(tmp_path, monkeypatch):
    here = stand_in(tmp_path, monkeypatch)
    found = sweep.sweep(many(tmp_path, 2))
    file = tmp_path / "out/cases" / found.cases[1].id / "status.json"
    file.write_bytes(file.read_bytes()[:100])
    sweep.sweep(many(tmp_path, 2))
    assert Counter(runs(here)) == {found.cases[0].id: 1, found.cases[1].id: 2}


# Kills
def trial(folder: Path, here: Path, chance: random.Random, count: int = 24) -> dict[str, int]:
    """Kills a worker, then the driver, both at random times, and calls again."""
    path = many(folder, count)
    first = Driver(path, "--workers", "2")
    when = sorted(chance.sample(range(1, count - 2), 2))  # so many cases done
    wait_until(lambda: len(done(folder)) >= when[0])
    time.sleep(chance.uniform(0.0, 0.1))
    worker = chance.choice(workers_of(first.pid))
    os.kill(worker, signal.SIGKILL)
    wait_until(lambda: len(done(folder)) >= when[1])
    time.sleep(chance.uniform(0.0, 0.1))
    family = workers_of(first.pid)
    first.process.kill()
    first.end()
    wait_until(lambda: not any(Path(f"/proc/{process}").exists() for process in family))
    before, runs_before = done(folder), Counter(runs(here))
    code, out = Driver(path, "--workers", "1").end()
    assert code == 0, out
    after = Counter(runs(here))
    return {"finished before": len(before), "of them run again": sum(after[case] != runs_before[case] for case in before),
            "complete": len(done(folder)), "runs": sum(after.values())}


def test_all_is_done_and_nothing_twice_when_workers_and_drivers_are_killed(tmp_path, monkeypatch):
    here = stand_in(tmp_path, monkeypatch)
    chance = random.Random(5)
    for _ in range(int(os.environ.get("TALUS_TRIALS", "1"))):
        shutil.rmtree(tmp_path / "out", ignore_errors=True)
        (here / "runs").unlink(missing_ok=True)
        found = trial(tmp_path, here, chance)
        print(found)
        assert found["complete"] == 24 and found["of them run again"] == 0 and clean(tmp_path)
        assert found["runs"] <= 24 + 3  # those under way when they were killed: one with the worker, two with the driver


def test_two_drivers_of_one_folder_share_the_cases(tmp_path, monkeypatch):
    here = stand_in(tmp_path, monkeypatch, "sleep 0.05")
    path = many(tmp_path, 16)
    both = [Driver(path, "--workers", "1") for _ in range(2)]
    for one in both:
        code, out = one.end()
        assert code == 0 and "16 cases: 16 done" in out, out
    assert Counter(Counter(runs(here)).values()) == {1: 16}
    assert clean(tmp_path) and {row["status"] for row in table(tmp_path)} == {"done"}


def test_one_driver_does_not_wait_for_another_if_told_so(tmp_path, monkeypatch):
    stand_in(tmp_path, monkeypatch, 'case "$*" in *density=2001*) sleep 3;; esac')
    path = many(tmp_path, 3)
    slow = Driver(path, "--workers", "1")
    wait_until(lambda: list((tmp_path / "out/cases").glob("*/lock.*")) if (tmp_path / "out/cases").exists() else False)
    assert main(["sweep", str(path), "--leave"]) == 0
    assert slow.running() and sorted(row["status"] for row in table(tmp_path)) == ["done", "done", "missing"]
    slow.end()
    assert {row["status"] for row in table(tmp_path)} == {"done"}  # those that the first one has left, too


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_ends_the_children_and_leaves_their_cases_to_the_next_call(tmp_path, monkeypatch, how):
    here = stand_in(tmp_path, monkeypatch, 'case "$*" in *density=200[34]*) sleep 30;; esac')
    path = many(tmp_path, 6)
    process = Driver(path, "--workers", "2")
    wait_until(lambda: len(runs(here)) == 4 and len(done(tmp_path)) == 2)
    family = [child for worker in workers_of(process.pid) for child in (worker, *workers_of(worker))]
    assert len(family) == 4
    began = time.monotonic()
    os.kill(process.pid, how)
    code, out = process.end()
    assert code == 130 and time.monotonic() - began < 5
    assert "interrupted: 6 cases: 4 missing, 2 done; the same command goes on" in out
    assert not any(Path(f"/proc/{child}").exists() for child in family)
    assert sorted(row["status"] for row in table(tmp_path)) == ["done"] * 2 + ["missing"] * 4
    (here / "always").write_text("\n")
    assert main(["sweep", str(path)]) == 0 and clean(tmp_path)
    assert max(Counter(runs(here)).values()) == 2


# Disk
@pytest.mark.skipif(os.geteuid() != 0 or shutil.which("unshare") is None, reason="a small disk needs root and unshare")
def test_a_full_disk_leaves_nothing_half_written_and_the_next_call_completes(tmp_path, monkeypatch):
    stand_in(tmp_path, monkeypatch)
    path = many(tmp_path, 8, output="disk/out", keep="results")  # half a megabyte each
    (tmp_path / "disk").mkdir()
    call = f"{sys.executable} -m talus_lab.cli sweep {path} --workers 1"
    look = "find disk/out/cases -name status.json | wc -l; find disk -name '*part*' -o -name 'lock.*' -o -name 'owner.*' | wc -l"
    script = f"mount -t tmpfs -o size=1700k talus disk || exit 77; {call}; echo code $?; {look}; mount -o remount,size=20M disk; {call}; echo code $?; {look}"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(word for word in sys.path if word)}
    found = subprocess.run(["unshare", "--mount", "sh", "-c", script], cwd=tmp_path, env=environment, text=True, capture_output=True)
    if found.returncode == 77 or "unshare" in found.stderr:
        pytest.skip("may not mount a small disk")
    words = found.stdout.split("\n")
    assert "No space left on device" in found.stderr and "make room, and the same command goes on" in found.stderr
    assert words[0] == "code 4" and 0 < int(words[1]) < 8 and words[2] == "0", found
    assert "8 cases: 8 done" in found.stdout and words[-3:-1] == ["8", "0"]


# Progress
def test_progress_is_a_line_that_moves_or_lines_in_a_log(capsys):
    class Stream:
        def __init__(self, terminal):
            self.text, self.terminal = "", terminal

        def isatty(self):
            return self.terminal

        def write(self, text):
            self.text += text

        def flush(self):
            pass

    progress = Progress(100, 40, 2, Stream(True))
    progress.count("done"), progress.count("crashed")
    assert progress.line(2, 4.0) == "41 of 100 done, 3 failed, 2 running; 0.5 cases/s, 112 s to go".replace("112 s", "2 min")
    progress._shown -= 1
    progress.show(lambda: 2)
    assert progress._stream.text.startswith("\r\033[K41 of 100") and "\n" not in progress._stream.text
    log = Progress(100, 40, 2, Stream(False))
    log.show(lambda: 2)
    assert log._stream.text == ""
    log._shown -= 20
    log.show(lambda: 2)
    assert log._stream.text == "40 of 100 done, 2 failed, 2 running\n"
    assert [duration(s) for s in (5, 100, 7000)] == ["5 s", "2 min", "1.9 h"]


# Other engines
def test_a_job_array_for_slurm(tmp_path, monkeypatch, capsys):
    here = stand_in(tmp_path, monkeypatch)
    assert main(["sweep", str(many(tmp_path, 4)), "--emit-slurm", "3", "--workers", "2"]) == 0
    script = Path(capsys.readouterr().out.strip())
    text = script.read_text()
    assert "#SBATCH --array=1-3" in text and "--cpus-per-task=2" in text
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(word for word in sys.path if word)}
    assert subprocess.run(["bash", str(script)], env=environment).returncode == 0
    assert Counter(Counter(runs(here)).values()) == {1: 4}


@pytest.mark.parametrize(("kind", "expected"), [
    ("pbs", ["#PBS -q short", "#PBS -l select=1:ncpus=2:mem=3815MB", "#PBS -l walltime=02:00:00"]),
    ("slurm", ["#SBATCH -p short", "#SBATCH --cpus-per-task=2", "#SBATCH --mem=4G", "#SBATCH -t 02:00:00"])])
def test_a_cluster_submits_jobs_of_one_worker_with_what_the_config_says(kind, expected):
    pytest.importorskip("dask_jobqueue", reason="dask-jobqueue is not installed")
    made = _queue({"kind": kind, "jobs": 4, "cores": 2, "memory": "4 GB", "walltime": "02:00:00", "queue": "short"})
    try:
        lines = made.job_script().splitlines()
    finally:
        made.close()
    assert lines[0] == "#!/usr/bin/env bash" and [line for line in expected if line not in lines] == []
    call = lines[-1].split()
    assert call[0] == sys.executable and "--nthreads" in call and call[call.index("--nthreads") + 1] == "2" and "--nworkers" not in call
    assert made._adaptive.maximum == 4


def test_dask_gives_the_same_table(tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    here = stand_in(tmp_path, monkeypatch)
    path = many(tmp_path, 6)
    sweep.sweep(path, 2)
    local = [{key: value for key, value in row.items() if key not in ("started", "wall_time")} for row in table(tmp_path)]
    shutil.rmtree(tmp_path / "out")
    sweep.sweep(path, 2, "dask")
    assert [{key: value for key, value in row.items() if key not in ("started", "wall_time")} for row in table(tmp_path)] == local
    assert len(runs(here)) == 12


def test_ctrl_c_ends_dask_too():
    pytest.importorskip("distributed")
    with pytest.raises(KeyboardInterrupt), engine_of("dask", 1) as engine:
        call = engine.executor.submit(time.sleep, 60)
        began = time.monotonic()
        raise KeyboardInterrupt
    assert time.monotonic() - began < 20 and not (call.done() and not call.cancelled() and call.exception() is None)


def test_a_dask_worker_that_is_killed_loses_no_case(tmp_path, monkeypatch):
    pytest.importorskip("distributed")
    here = stand_in(tmp_path, monkeypatch, "sleep 0.2")
    path = many(tmp_path, 12)
    found = sweep.prepare(path, 2)
    with engine_of("dask", 2) as engine:
        import threading

        def kill() -> None:
            wait_until(lambda: len(done(tmp_path)) >= 2 if (tmp_path / "out/cases").exists() else False)
            client = engine.executor._client
            os.kill(next(iter(client.run(os.getpid).values())), signal.SIGKILL)

        killer = threading.Thread(target=kill)
        killer.start()
        sweep.driver.compute(found, engine)
        killer.join()
    assert {row["status"] for row in table(tmp_path)} == {"done"}
    assert sum(Counter(runs(here)).values()) <= 13
