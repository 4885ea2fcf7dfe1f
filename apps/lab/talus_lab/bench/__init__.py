"""Studies of contact searches: a config says what `talus bench` measures; the numbers become one CSV, charts and the tables of a page.

>>> rows = measure(read_config(path), talus)
"""

from talus_lab.bench.charts import draw
from talus_lab.bench.config import read_config
from talus_lab.bench.measure import measure, measured, quick
from talus_lab.bench.tables import fill_page

__all__ = ["draw", "fill_page", "measure", "measured", "quick", "read_config"]
