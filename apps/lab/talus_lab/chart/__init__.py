"""Error against CPU time: a config says which scenes run with which methods and settings; the numbers become one CSV, charts and the
tables of a page.

>>> rows = measure(read_config(path), talus)
"""

from talus_lab.chart.charts import draw
from talus_lab.chart.config import quick, read_config
from talus_lab.chart.measure import measure, measured
from talus_lab.chart.tables import fill_page

__all__ = ["draw", "fill_page", "measure", "measured", "quick", "read_config"]
