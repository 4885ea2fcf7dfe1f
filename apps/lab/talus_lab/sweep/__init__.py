"""Scenarios computed many times with other keys, on one machine or many, and the table of what came of them. See docs/sweeps.md.

>>> found = sweep.sweep("configs/sweep_friction_dip.yaml")   # computes what is missing
>>> found.config.output / "table.h5"
"""

from __future__ import annotations

from pathlib import Path

from talus_lab.program import find_talus
from talus_lab.sweep.case import DiskError
from talus_lab.sweep.config import COLUMNS, REPETITION, Config, read_config
from talus_lab.sweep.driver import Sweep, compute, listing, summary
from talus_lab.sweep.driver import prepare as _prepare
from talus_lab.sweep.engines import cores, engine_of

__all__ = ["COLUMNS", "REPETITION", "Config", "DiskError", "Sweep", "listing", "prepare", "read_config", "summary", "sweep"]


def prepare(config: str | Path, workers: int | None = None, retry: str = "") -> Sweep:
    """The cases of a config and what is there of them; computes nothing. Raises ResultError with every fault of the config."""
    return _prepare(read_config(Path(config)), find_talus(), workers or cores(), retry)


def sweep(config: str | Path, workers: int | None = None, engine: str = "local", scheduler: str = "", retry: str = "", wait: bool = True) -> Sweep:
    """Computes what is missing and writes the table. workers: cases at a time, all cores if none are given. engine: local or dask.
    retry: failed or all. wait: also for cases that another driver computes. Raises ResultError with every fault of the config,
    DiskError if nothing more can be written."""
    found = prepare(config, workers, retry)
    if not found.due():
        found.write()
        return found
    with engine_of(engine, workers or cores(), scheduler, found.config.cluster) as made:
        compute(found, made, wait)
    return found
