"""Error against CPU time: every setting as a mark, the best of each method as a line."""

from __future__ import annotations

import math

import matplotlib
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from talus_lab.chart.config import LARGEST, Chart, Config
from talus_lab.chart.fronts import Rows, confirmed, front, points
from talus_lab.style import STYLE
from talus_lab.study.picture import bare, finish, line

# colour, mark, line: ours drawn through, other programs dashed
METHOD_STYLE = {
    "explicit": ("#0072b2", "o", "-"), "explicit-general": ("#56b4e9", "^", "-"), "explicit-loaded": ("#0072b2", "s", "-"),
    "explicit-frozen": ("#0072b2", "D", ":"), "explicit-local": ("#8c8c8c", "v", "-"), "rigid": ("#000000", "*", "-"),
    "static": ("#009e73", "D", "-"), "box2d": ("#d55e00", "o", "--"), "chipmunk": ("#e69f00", "s", "--"),
}
OTHERS = [("#cc79a7", mark, dashes) for dashes in ("-", "--") for mark in "^DPXv"]
LOWEST = 1e-9  # errors below are drawn here
HIGHEST = 1.0  # what is wrong altogether


def draw(config: Config, chart: Chart, rows: Rows) -> Figure | None:
    """None if nothing of it was measured."""
    rows = list(rows)
    others = [name for name in config.methods if name not in METHOD_STYLE]
    style = METHOD_STYLE | {name: OTHERS[k % len(OTHERS)] for k, name in enumerate(others)}
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
        return finish(figure, 1 + wide)


def _panel(ax: Axes, config: Config, panel: dict, rows: list, style: dict) -> bool:
    scene, error = config.scenes[panel["scene"]], panel.get("error", LARGEST)
    lines = points(rows, panel["scene"], error)
    for method in scene.methods:
        if method not in lines:
            continue
        color, mark, dashes = style[method]
        ax.plot([p.cpu_time for p in lines[method]], [shown(p.error) for p in lines[method]], color=color, marker=mark, linestyle="",
                markersize=3, alpha=0.35, markeredgewidth=0)
        best = front(confirmed(lines[method]))
        line(ax, [p.cpu_time for p in best], [shown(p.error) for p in best], config.methods[method].label, color, mark, dashes, mark == "*")
    ax.set_xscale("log")
    ax.set_yscale("log")
    for axis, numbers in ((ax.xaxis, [p.cpu_time for line in lines.values() for p in line]),
                          (ax.yaxis, [shown(p.error) for line in lines.values() for p in line])):
        narrow = not numbers or max(numbers) < 30 * min(numbers)
        axis.set_major_locator(LogLocator(subs=(1, 2, 5) if narrow else (1,), numticks=12))
        axis.set_minor_formatter(NullFormatter())
        if narrow:
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.set_xlabel("CPU time, s per simulated second")
    one = next(iter(scene.errors)) if len(scene.errors) == 1 else error
    ax.set_ylabel(scene.errors[one].label if one != LARGEST else f"relative error, largest of {', '.join(scene.errors)}")
    bare(ax, panel.get("title", scene.title))
    return bool(lines)


def shown(error: float) -> float:
    return min(max(error, LOWEST), HIGHEST)
