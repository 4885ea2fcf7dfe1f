"""How far something is, on a terminal as one line that changes, elsewhere as a line now and then."""

from __future__ import annotations

import sys
import time
from typing import Callable

SELDOM = 10  # lines in all where there is no terminal


def progress(what: str) -> Callable[[int, int], None]:
    """A function of how many are done, and of how many."""
    start, last = time.monotonic(), -1

    def show(done: int, of: int) -> None:
        nonlocal last
        each = (time.monotonic() - start) / max(done, 1)
        if sys.stderr.isatty():
            text = f"{what} {done} of {of}" + (f", {each:.2f} s each, {each * (of - done):.0f} s to go" if done else "")
            sys.stderr.write(f"\r{text:<60}" + ("\r" + " " * 60 + "\r" if done == of else ""))
            sys.stderr.flush()
        elif done * SELDOM // of > last:
            last = done * SELDOM // of
            print(f"{what} {done} of {of}, {each:.2f} s each" if done else f"{what} 0 of {of}", file=sys.stderr, flush=True)

    return show
