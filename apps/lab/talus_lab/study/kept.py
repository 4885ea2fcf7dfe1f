"""Tables that are written whole after every measurement, and what a measurement was made with."""

from __future__ import annotations

import csv
import hashlib
import os
from pathlib import Path
from typing import Sequence

from talus_lab.errors import ResultError

Row = dict[str, str]


def read_rows(path: Path, columns: Sequence[str] | None = None) -> list[Row]:
    """Nothing if there is no file. Raises ResultError if it has other columns."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    if rows and columns and set(rows[0]) != set(columns):
        raise ResultError(f"{path}: is not a table of this version; move it away, and everything is measured anew")
    return rows


def write_rows(path: Path, columns: Sequence[str], rows: list[Row]) -> None:
    """The whole file, or what was there before: an interrupt leaves no half table."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_suffix(".part")
    with beside.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, restval="", extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    beside.replace(path)


def digest(*parts: object) -> str:
    """Sixteen digits that change with any of the parts: texts as repr gives them, files by what is in them."""
    whole = hashlib.sha256()
    for part in parts:
        whole.update(file_digest(part) if isinstance(part, Path) else repr(part).encode() + b"\n")
    return whole.hexdigest()[:16]


_files: dict[tuple[Path, int], bytes] = {}


def file_digest(file: Path) -> bytes:
    key = file, os.stat(file).st_mtime_ns
    if key not in _files:
        _files[key] = hashlib.sha256(file.read_bytes()).digest()
    return _files[key]
