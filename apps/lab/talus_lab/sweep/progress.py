"""How far a sweep is: one line that moves on a terminal, a line now and then in a log."""

from __future__ import annotations

import sys
import time
from typing import Callable, TextIO

ON_TERMINAL, IN_LOG = 0.2, 10.0  # s between lines


class Progress:
    def __init__(self, total: int, done: int, failed: int, stream: TextIO | None = None):
        """done, failed: by earlier calls."""
        self.total, self.done, self.failed = total, done, failed
        self._stream = stream or sys.stderr
        self._terminal = self._stream.isatty()
        self._began = self._shown = time.monotonic()
        self._before = done + failed

    def count(self, status: str) -> None:
        if status == "done":
            self.done += 1
        else:
            self.failed += 1

    def show(self, running: Callable[[], int]) -> None:
        """If it is time for a line. running: asked then only, for a scheduler may be far away."""
        now = time.monotonic()
        if now - self._shown >= (ON_TERMINAL if self._terminal else IN_LOG):
            self._shown = now
            self._write(self.line(running(), now - self._began))

    def line(self, running: int, elapsed: float) -> str:
        new = self.done + self.failed - self._before
        rate = new / elapsed if elapsed > 0 else 0.0
        left = self.total - self.done - self.failed
        speed = f"; {rate:.3g} cases/s, {duration(left / rate)} to go" if rate > 0 else ""
        return f"{self.done} of {self.total} done, {self.failed} failed, {running} running{speed}"

    def say(self, text: str) -> None:
        """A line that stays."""
        self._clear()
        print(text, file=self._stream, flush=True)

    def close(self) -> None:
        self._clear()

    def _write(self, text: str) -> None:
        self._clear()
        self._stream.write(text if self._terminal else text + "\n")
        self._stream.flush()

    def _clear(self) -> None:
        if self._terminal:
            self._stream.write("\r\033[K")


def duration(seconds: float) -> str:
    """45 s, 12 min, 3.5 h"""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
