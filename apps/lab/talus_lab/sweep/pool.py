"""Workers on this machine, as an Executor: processes that each take one call after the other.

The pool of the standard library gives up when one of its processes is killed. Here that costs one call, which fails with
WorkerLostError, and another process takes its place.
"""

from __future__ import annotations

import os
import pickle
import queue
import subprocess
import sys
import threading
from concurrent.futures import BrokenExecutor, Executor, Future
from typing import Any, Callable


PATIENCE = 5.0  # s that a worker has to put down what it does


class WorkerLostError(BrokenExecutor):
    """The process that made the call has ended."""


class LocalPool(Executor):
    def __init__(self, workers: int):
        self._calls: queue.SimpleQueue[tuple[Future, bytes] | None] = queue.SimpleQueue()
        self._processes: list[subprocess.Popen | None] = [None] * workers
        self._stopped = False
        self._threads = [threading.Thread(target=self._serve, args=(k,), daemon=True) for k in range(workers)]
        for thread in self._threads:
            thread.start()

    def submit(self, function: Callable, /, *arguments: Any) -> Future:
        future: Future = Future()
        self._calls.put((future, pickle.dumps((function, arguments))))
        return future

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """cancel_futures: ends what runs, too."""
        self._stopped = self._stopped or cancel_futures
        for _ in self._threads:
            self._calls.put(None)
        if cancel_futures:
            for process in self._processes:
                if process:
                    process.terminate()
        for thread in self._threads if wait else []:
            thread.join()

    def _serve(self, k: int) -> None:
        while (item := self._calls.get()) is not None:
            future, call = item
            if self._stopped:
                future.cancel()
            if not future.set_running_or_notify_cancel():
                continue
            try:
                good, answer = self._ask(k, call)
            except (EOFError, OSError, pickle.UnpicklingError):
                self._end(k)
                good, answer = False, WorkerLostError("a worker was killed")
            future.set_result(answer) if good else future.set_exception(answer)
        self._end(k)

    def _ask(self, k: int, call: bytes) -> tuple[bool, Any]:
        process = self._processes[k]
        if not process or process.poll() is not None:  # one that was killed while it had nothing to do costs nothing
            process = self._processes[k] = _start()
        if self._stopped:  # between the call and the process
            process.terminate()
        assert process.stdin and process.stdout
        process.stdin.write(call)
        process.stdin.flush()
        return pickle.load(process.stdout)

    def _end(self, k: int) -> None:
        process, self._processes[k] = self._processes[k], None
        if not process:
            return
        try:
            process.communicate(timeout=PATIENCE)  # without another call it ends
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        except OSError:
            process.wait()


def _start() -> subprocess.Popen:
    """In a session of its own: Ctrl-C is for the driver, which ends its workers."""
    found = os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    return subprocess.Popen([sys.executable, "-m", "talus_lab.sweep.worker"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=found,
                            start_new_session=True)
