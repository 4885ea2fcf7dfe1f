"""Reads the results of talus and draws them. Computes no mechanics.

>>> import talus_lab
>>> run = talus_lab.open("results/rock_slope.h5")
>>> run.displacement(-1).max()
"""

from talus_lab.run import ResultError, Run, open_run as open

__version__ = "0.1.0"
__all__ = ["ResultError", "Run", "open"]
