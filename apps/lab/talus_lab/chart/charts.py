"""Error against CPU time: every setting as a mark, the best of each method as a line."""

from __future__ import annotations

import math

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from talus_lab.chart.config import LARGEST, Chart, Config
from talus_lab.chart.fronts import Rows, front, points
from talus_lab.plot import STYLE
from talus_lab.study.picture import bare, finish, line

# colour, mark, line: ours drawn through, other programs dashed
OURS = [("#0072b2", "o"), ("#56b4e9", "^"), ("#000000", "*"), ("#009e73", "s"), ("#5c3d75", "D"), ("#8c8c8c", "v"), ("#0072b2", "P")]
OTHERS = [("#d55e00", "o"), ("#e69f00", "s"), ("#cc79a7", "^"), ("#f0e442", "D"), ("#8c8c8c", "x")]
LOWEST = 1e-9  # errors below are drawn here
HIGHEST = 1.0  # what is wrong altogether


def draw(config: Config, chart: Chart, rows: Rows) -> Figure | None:
    """None if nothing of it was measured."""
    rows = list(rows)
    style = styles(config)
    with matplotlib.rc_context(STYLE):
        wide = min(chart.columns, len(chart.panels))
        high = math.ceil(len(chart.panels) / wide)
        figure = Figure(figsize=(1.4 + 3.6 * wide, 1.4 + 2.9 * high), dpi=100)
        axes = figure.subplots(high, wide, squeeze=False)
        drawn = [_panel(ax, config, panel, rows, style) for ax, panel in zip(axes.flat, chart.panels)]
        if not any(drawn):
            return None
        for ax in list(axes.flat)[len(chart.panels):]:
            ax.remove()
        return finish(figure, 1 + 2 * wide)


def styles(config: Config) -> dict[str, tuple[str, str, str]]:
    """One for each method, the same in all charts."""
    ours = [name for name, method in config.methods.items() if method.ours]
    others = [name for name in config.methods if name not in ours]
    return {name: (*kinds[k % len(kinds)], dashes) for names, kinds, dashes in ((ours, OURS, "-"), (others, OTHERS, "--"))
            for k, name in enumerate(names)}


def _panel(ax: Axes, config: Config, panel: dict, rows: list, style: dict) -> bool:
    scene, error = config.scenes[panel["scene"]], panel.get("error", LARGEST)
    lines = points(rows, panel["scene"], error)
    for method in scene.methods:
        if method not in lines:
            continue
        color, mark, dashes = style[method]
        ax.plot([p.cpu_time for p in lines[method]], [shown(p.error) for p in lines[method]], color=color, marker=mark, linestyle="",
                markersize=3, alpha=0.35, markeredgewidth=0)
        best = front(lines[method])
        line(ax, [p.cpu_time for p in best], [shown(p.error) for p in best], config.methods[method].label, color, mark, dashes, mark == "*")
    ax.set_xscale("log")
    ax.set_yscale("log")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(numticks=12))
        axis.set_minor_formatter(NullFormatter())
    ax.set_xlabel("CPU time, s per simulated second")
    ax.set_ylabel(scene.errors[error].label if error != LARGEST else next(iter(scene.errors.values())).label if len(scene.errors) == 1
                  else "largest error of the scene")
    bare(ax, panel.get("title", scene.title))
    return bool(lines)


def shown(error: float) -> float:
    return min(max(error, LOWEST), HIGHEST)
