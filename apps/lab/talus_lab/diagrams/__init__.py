"""Pictures of sweeps: which mode of failure where, numbers over two parameters, probabilities, and what matters most.

>>> table = read_table("results/friction_dip")
>>> modes(table, "dip_deg", "friction_deg").savefig("modes.pdf")
"""

from talus_lab.diagrams.boundaries import Curve
from talus_lab.diagrams.maps import probability, value_map
from talus_lab.diagrams.modes import modes
from talus_lab.diagrams.pictures import draw, read_pictures
from talus_lab.diagrams.ranking import scatter, tornado
from talus_lab.diagrams.table import Table, read_table

__all__ = ["Curve", "Table", "draw", "modes", "probability", "read_pictures", "read_table", "scatter", "tornado", "value_map"]
