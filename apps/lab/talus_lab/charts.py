"""Pictures: functions that return a matplotlib Figure. `figure.savefig("a.pdf")`, or show it in a notebook.

>>> charts.picture(run, color="speed", outline=True)
>>> charts.history(run, "crest")
"""

from talus_lab.curves import energies, history
from talus_lab.plot import picture, scene

__all__ = ["energies", "history", "picture", "scene"]
