"""Reads the results of talus, measures and draws them. Computes no mechanics.

>>> import talus_lab
>>> run = talus_lab.open("results/rock_slope.h5")
>>> talus_lab.measures.max_displacement(run)
>>> talus_lab.charts.picture(run, color="speed").savefig("slope.png")
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

from talus_lab.errors import ResultError

if TYPE_CHECKING:
    from talus_lab import charts, measures, sweep
    from talus_lab.run import Run, open_run as open

__version__ = "0.1.0"
__all__ = ["ResultError", "Run", "charts", "measures", "open", "sweep"]


def __getattr__(name: str) -> object:
    """Parts are loaded when they are asked for: numpy, HDF5 and matplotlib take a second together, and `talus-lab --help` needs none."""
    if name in ("Run", "open"):
        return getattr(importlib.import_module("talus_lab.run"), {"open": "open_run"}.get(name, name))
    if name in __all__:
        return importlib.import_module(f"talus_lab.{name}")
    raise AttributeError(f"module 'talus_lab' has no attribute {name!r}")
