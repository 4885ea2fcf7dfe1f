"""Pictures: functions that return a matplotlib Figure. `figure.savefig("a.pdf")`, or show it in a notebook.

Of a run:

>>> charts.picture(run, color="speed", outline=True)
>>> charts.history(run, "crest")

Of a sweep, from the table that its folder holds:

>>> table = charts.read_table("results/friction_dip")
>>> charts.modes(table, "dip_deg", "friction_deg", curves=[charts.Curve("plane_slide", slope="dip_deg", friction="friction_deg")])
"""

from talus_lab.curves import energies, history
from talus_lab.diagrams import Curve, Table, modes, probability, read_table, scatter, tornado, value_map
from talus_lab.plot import picture, scene

__all__ = ["Curve", "Table", "energies", "history", "modes", "picture", "probability", "read_table", "scatter", "scene", "tornado", "value_map"]
