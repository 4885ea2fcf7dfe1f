"""The programs that this package drives."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from talus_lab.errors import ResultError


def find_talus() -> str:
    """The program: $TALUS, the release build of the source tree this tool was installed from, or what is on the path."""
    built = Path(__file__).resolve().parents[3] / "build/release/bin/talus"
    found = os.environ.get("TALUS") or (str(built) if built.exists() else shutil.which("talus"))
    if not found or not shutil.which(found):
        raise ResultError("talus is not built; ./dev build does it, or set TALUS to the program")
    return found


def find_peers(talus: str) -> str | None:
    """talus_bench_peers, if it was built: beside talus."""
    return shutil.which(Path(talus).with_name("talus_bench_peers"))
