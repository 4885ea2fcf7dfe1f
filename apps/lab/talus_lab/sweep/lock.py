"""Who computes a case: lock files in its folder, which need nothing but a file system that all drivers see.

The locks of a folder are numbered, and the last one counts. Who finds that its owner is dead makes the next one; of several who try
one only succeeds, for a file is made once. A lock says host, process and when that process began, so that a later process of the same
number is not taken for it. Owners on other hosts cannot be looked at: they touch their lock now and then, and one that is left alone
has none. The time is that of the file system, by a file written at the moment, so that clocks may differ.
"""

from __future__ import annotations

import json
import os
import socket
from functools import cache
from pathlib import Path

BEAT = 20.0  # s between touches
LEFT_ALONE = 6 * BEAT  # s; less, and a file system that hangs for a minute would lose a case to another; more, and a dead host keeps its cases longer
PREFIX, OWNER = "lock.", "owner."


class Lock:
    """Of a folder. Taken or not; whoever holds it releases it."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.held: Path | None = None

    def take(self) -> bool:
        """False if somebody else computes here. Who got it looks again at what there is to do: it may just have been done."""
        numbers = self._numbers()
        last = self.folder / f"{PREFIX}{numbers[-1]}" if numbers else None
        written = self.folder / f"{OWNER}{socket.gethostname()}.{os.getpid()}"
        try:
            written.write_text(owner(), encoding="utf-8")
            before = last and last.read_text(encoding="utf-8")
            if last and alive(before, last.stat().st_mtime, written.stat().st_mtime):
                return False
            mine = self.folder / f"{PREFIX}{numbers[-1] + 1 if numbers else 1}"
            os.link(written, mine)  # made once, and never empty
            # Another may have released the last one meanwhile, or have begun anew: then ours is not the one that counts.
            if self._numbers()[-1] != int(mine.suffix[1:]) or (last and last.read_text(encoding="utf-8") != before):
                mine.unlink(missing_ok=True)
                return False
        except (FileExistsError, FileNotFoundError):
            return False
        finally:
            written.unlink(missing_ok=True)
        self.held = mine
        return True

    def beat(self) -> None:
        """Says that the owner is alive."""
        if self.held:
            os.utime(self.held)

    def release(self) -> None:
        if self.held:
            for number in self._numbers():  # from the first: while the last one stands, nobody begins
                if number <= int(self.held.suffix[1:]):
                    (self.folder / f"{PREFIX}{number}").unlink(missing_ok=True)
        self.held = None

    def _numbers(self) -> list[int]:
        found = (path.name.removeprefix(PREFIX) for path in self.folder.glob(PREFIX + "*"))
        return sorted(int(number) for number in found if number.isdigit())


@cache
def machine() -> str:
    """Its name and that of this boot: of machines made from one image all may have the same name."""
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_text().strip()
    except OSError:
        boot = ""
    return f"{socket.gethostname()} {boot}"


def owner() -> str:
    return json.dumps({"host": machine(), "pid": os.getpid(), "began": began(os.getpid())})


def alive(text: str, touched: float, now: float) -> bool:
    """touched, now: s, both by the clock of the file system."""
    who = json.loads(text)
    if who["host"] != machine():
        return now - touched < LEFT_ALONE
    return began(who["pid"]) == who["began"] != ""


def began(pid: int) -> str:
    """When a process began, in ticks since the machine did; empty if there is none. A zombie is none."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return ""
    return "" if fields[0] in "ZX" else fields[19]
