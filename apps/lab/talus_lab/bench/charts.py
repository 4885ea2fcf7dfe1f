"""The charts of a study."""

from __future__ import annotations

import math

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

from talus_lab.bench.config import Chart, Config
from talus_lab.bench.select import Rows, series, words
from talus_lab.style import STYLE
from talus_lab.study.picture import bare, finish, line

# colour, mark, line
METHOD_STYLE = {
    "dess": ("#d55e00", "o", "-"), "dess-fused": ("#d55e00", "s", "--"), "isu": ("#0072b2", "^", "-"), "isu-separated": ("#0072b2", "v", "--"),
    "isu-parallel": ("#56b4e9", "D", "-."), "grid": ("#009e73", "P", "-"), "direct": ("#8c8c8c", "x", "-"), "direct-simd": ("#8c8c8c", "+", "--"),
    "auto": ("#000000", "*", "-"), "read": ("#b0b0b0", "", ":"),
    "box2d": ("#e69f00", "o", "-"), "box2d-wide": ("#e69f00", "s", "--"), "bullet-tree": ("#cc79a7", "^", "-"),
    "bullet-tree-wide": ("#cc79a7", "v", "--"),
}
OTHERS = [("#5c3d75", mark, line) for line in ("-", "--") for mark in "dXosP"]
PARTS = {"move": ("#56b4e9", "v"), "place": ("#009e73", "s"), "search": ("#d55e00", "o"), "contacts_part": ("#0072b2", "^"),
         "sum": ("#cc79a7", "D"), "account": ("#e69f00", "P"), "ns_per_block_and_step": ("#000000", "*")}
PART_WORDS = {"contacts_part": "contacts", "ns_per_block_and_step": "whole step"}


def draw(config: Config, chart: Chart, rows: Rows) -> Figure | None:
    """None if nothing of it was measured."""
    rows = list(rows)
    draw_panel = {"methods": _methods, "parts": _parts, "shares": _shares}[chart.kind]
    with matplotlib.rc_context(STYLE):
        wide = min(chart.columns, len(chart.panels))
        high = math.ceil(len(chart.panels) / wide)
        figure = Figure(figsize=(1.0 + 3.2 * wide, 0.8 + 2.5 * high), dpi=100)
        axes = figure.subplots(high, wide, squeeze=False, **({"sharex": True} if chart.kind == "shares" else {"sharey": "row"}))
        drawn = [draw_panel(ax, config, chart, panel, rows) for ax, panel in zip(axes.flat, chart.panels)]
        if not any(drawn):
            return None
        for ax in list(axes.flat)[len(chart.panels):]:
            ax.remove()
        return finish(figure, 2 + 2 * wide)


def _methods(ax: Axes, config: Config, chart: Chart, panel: dict, rows: list) -> bool:
    """A line for each method."""
    column = panel.get("column", "ns_per_box_median")
    lines = series(rows, column, panel["studies"], panel["scene"], panel.get("where"))
    lines = {name: line for name, line in lines.items() if not chart.series or name in chart.series}
    others = [name for name in lines if name.partition("@")[0] not in METHOD_STYLE]
    for name, values in lines.items():
        style = METHOD_STYLE.get(name.partition("@")[0]) or OTHERS[others.index(name) % len(OTHERS)]
        line(ax, list(values), list(values.values()), words(name), *style, strong=name.startswith("auto"))
    _axes(ax, config, config.studies[panel["studies"][0]].varied, column, panel, lines)
    return bool(lines)


def _parts(ax: Axes, config: Config, chart: Chart, panel: dict, rows: list) -> bool:
    """A line for each part of a step on one thread, and for the whole step on each number of threads."""
    drawn = {}
    for part, (color, mark) in PARTS.items():
        for name, values in series(rows, part, panel["studies"], panel["scene"], panel.get("where")).items():
            threads = name.partition("@")[2]
            if threads and part != "ns_per_block_and_step":
                continue
            text = PART_WORDS.get(part, part) + (f", {threads} threads" if threads else "")
            line(ax, list(values), list(values.values()), text, color, mark, "--" if threads else "-", strong=part == "ns_per_block_and_step")
            drawn[text] = values
    _axes(ax, config, config.studies[panel["studies"][0]].varied, "ns_per_block_and_step", panel, drawn)
    ax.set_ylim(bottom=1)  # ns: less is nothing
    return bool(drawn)


def _shares(ax: Axes, config: Config, chart: Chart, panel: dict, rows: list) -> bool:
    """A bar for each method: the search, and the rest of the step."""
    column = "ns_per_block_and_step"
    both = [series(rows, name, panel["studies"], panel["scene"], panel.get("where")) for name in ("search", column)]
    names = [name for name in both[1] if not chart.series or name in chart.series]
    at = np.arange(len(names))[::-1]
    value = [max(both[1][name]) for name in names]  # the largest scene
    search = np.array([both[0][name][v] for name, v in zip(names, value)])
    rest = np.array([both[1][name][v] for name, v in zip(names, value)]) - search
    if names:
        ax.barh(at, rest, color="#d9d9d9", edgecolor="#404040", linewidth=0.5, label="rest of the step")
        ax.barh(at, search, left=rest, color="#d55e00", edgecolor="#404040", linewidth=0.5, hatch="////", label="search")
    ax.set_yticks(at, [words(name) for name in names])
    ax.set_xlabel(config.quantities[column].label)
    ax.set_title(panel.get("title", ""), loc="left", fontsize=9)
    ax.spines[["top", "right"]].set_visible(False)
    return bool(names)


def _axes(ax: Axes, config: Config, varied: str, column: str, panel: dict, lines: dict) -> None:
    x, y = config.quantities[varied], config.quantities[column]
    if x.log:
        ax.set_xscale("log")
    else:
        ax.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 1.5, 3, 5, 10]))
    numbers = [value for values in lines.values() for value in values.values()]
    if y.log and numbers and min(numbers) > 0:
        ax.set_yscale("log")
        ax.yaxis.set_major_locator(LogLocator(subs=(1,) if max(numbers) > 100 * min(numbers) else (1, 2, 5)))
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.10g}"))
        axis.set_minor_formatter(NullFormatter())
    ax.set_xlabel(x.label)
    if ax.get_subplotspec().is_first_col():
        ax.set_ylabel(y.label)
    bare(ax, panel.get("title", ""))
