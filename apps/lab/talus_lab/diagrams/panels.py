"""What diagrams have in common: panels side by side, cells of a grid, curves, legends."""

from __future__ import annotations

import math
import textwrap
from typing import Any, Iterator, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, NullFormatter

from talus_lab.diagrams.boundaries import Curve
from talus_lab.diagrams.table import Table
from talus_lab.errors import ResultError, nearest
from talus_lab.style import CM, DPI
from talus_lab.units import SPELT, axis_label, prefix

FEW = 6  # values along an axis: each gets its tick
WORD = 18  # letters of a line of a word at an axis
ACROSS = 3  # panels side by side, at most: a fourth would be 2 cm wide in print


def check(table: Table, **parameters: str | None) -> None:
    """Raises ResultError if a column is no parameter, or given twice."""
    given = {role: name for role, name in parameters.items() if name}
    for role, name in given.items():
        if name not in table.parameters:
            raise ResultError(f"{table.path}: {role}: no parameter {name}{nearest(name, table.parameters)}")
    if len(set(given.values())) < len(given):
        raise ResultError(f"{table.path}: {', '.join(given)} are not all different")
    if not len(table):
        raise ResultError(f"{table.path}: has no cases yet")


def panels(table: Table, panel: str | None, width_cm: float, bar: bool = False) -> Iterator[tuple[Figure, Axes, Table, dict[str, Any]]]:
    """A figure with an axes for each value of a parameter: its rows, and the parameters that have one value in them."""
    values = sorted(set(table.columns[panel].tolist())) if panel else [None]
    across = min(len(values), ACROSS)
    high = math.ceil(len(values) / across)
    inches = width_cm * CM
    side = (inches - 0.75 - (0.75 if bar else 0)) / across
    figure = Figure(figsize=(inches, high * (min(side, 3.0) + 0.25) + 1.15), dpi=DPI)
    axes = figure.subplots(high, across, squeeze=False, sharex=True, sharey=True)
    for ax in list(axes.flat)[len(values):]:
        ax.remove()
    for k, (ax, value) in enumerate(zip(axes.flat, values)):
        rows = table if value is None else table.only(table.columns[panel] == value)
        if value is not None:
            ax.set_title("\n".join(textwrap.wrap(value_label(table, panel, value), int(14 * side))), loc="left", fontsize=9)
        ax.spines[["top", "right"]].set_visible(False)
        ax.tick_params(width=0.5, length=3, labelbottom=k + across >= len(values))
        fixed = {name: rows.columns[name][0] for name in table.parameters if len(rows) and len(set(rows.columns[name].tolist())) == 1}
        yield figure, ax, rows, fixed


def axis_labels(figure: Figure, table: Table, x: str, y: str) -> None:
    """At the outer sides of all panels, and what the values along them look like."""
    axes = [ax for ax in figure.axes if ax.get_subplotspec() is not None]
    across = max(ax.get_subplotspec().colspan.stop for ax in axes)
    label_x, label_y = (scale(axes[0], which, table, name) for which, name in (("x", x), ("y", y)))
    for ax in axes:
        if ax.xaxis.get_tick_params()["labelbottom"]:
            ax.set_xlabel("\n".join(textwrap.wrap(label_x, int(12 * figure.get_figwidth() / across))))
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel("\n".join(textwrap.wrap(label_y, int(10 * figure.get_figheight()))))


def scale(ax: Axes, which: str, table: Table, name: str, cells: bool = True) -> str:
    """Ticks of an axis for the values of a parameter: words, equal ratios, few values, numbers with a prefix to their unit. Returns its
    label. cells: the axis has those of a grid, or anything else with limits above 0 where it should be logarithmic."""
    axis = getattr(ax, f"{which}axis")
    numbers, words = table.numbers(name), table.words(name)
    if words:
        longest = max(map(len, words))
        room = 72 * (ax.get_figure().get_figwidth() - 1) / ax.get_gridspec().ncols / len(words) if which == "x" else 300.0  # points
        upright = which == "x" and min(longest, WORD) * 5 > room
        axis.set_ticks(range(len(words)), ["\n".join(textwrap.wrap(word, WORD)) for word in words], rotation=90 if upright else 0)
        return table.label(name)
    values = np.unique(numbers)
    parameter = table.parameters[name]
    if parameter.log and not cells if parameter.kind == "drawn" else in_ratios(values):
        getattr(ax, f"set_{which}scale")("log")
    elif len(values) <= FEW:
        axis.set_ticks(values)
    return number_axis(axis, values, table.labels.get(name, name), table.units.get(name, ""))


def number_axis(axis: Axis, values: np.ndarray, label: str, unit: str) -> str:
    """Numbers with a prefix to their unit, in full. Returns the label."""
    factor, unit = prefix(float(np.nanmax(np.abs(values), initial=0.0)), unit)
    if axis.get_scale() != "log" or factor != 1:
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value * factor:.6g}".replace("e+", "e")))
        axis.set_minor_formatter(NullFormatter())
    return axis_label(label, unit)


def in_ratios(values: np.ndarray) -> bool:
    """Values above 0 over two decades or more, which on a linear axis would lie on one another."""
    return len(values) > 1 and values.min() > 0 and values.max() >= 100 * values.min()


def value_label(table: Table, name: str, value: Any) -> str:
    """`friction 30 deg`, or the value alone if it is a word."""
    if isinstance(value, str):
        return value
    return f"{table.labels.get(name, name)} {value:.4g} {SPELT.get(table.units.get(name, ''), table.units.get(name, ''))}".strip()


def grid(table: Table, x: str, y: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Values of x and of y in their order, or None if the cases do not lie on a grid."""
    if "drawn" in (table.parameters[x].kind, table.parameters[y].kind):
        return None
    return np.unique(table.numbers(x)), np.unique(table.numbers(y))


def borders(values: np.ndarray) -> np.ndarray:
    """Between the values, and as far beyond the first and the last."""
    if len(values) == 1:
        return values[0] + np.array([-0.5, 0.5]) * (abs(values[0]) or 1.0)
    if in_ratios(values):
        return np.exp(borders(np.log(values)))
    middle = (values[1:] + values[:-1]) / 2
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def cells(at: np.ndarray, x: np.ndarray, y: np.ndarray) -> Path:
    """Rectangles around points at [n, 2] of the grid x, y as one path."""
    bx, by = borders(x), borders(y)
    i, j = np.searchsorted(x, at[:, 0]), np.searchsorted(y, at[:, 1])
    corners = np.stack([np.column_stack([bx[i + a], by[j + b]]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))], axis=1)
    codes = np.tile([Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY], len(at))
    return Path(corners.reshape(-1, 2), codes)


def draw_curves(ax: Axes, curves: Sequence[Curve], x: str, y: str, fixed: dict[str, Any], limits: tuple) -> list[Line2D]:
    """Theory over what was computed, black in a white seam; the axes keep their limits."""
    handles = {}
    for k, curve in enumerate(curves):
        style = dict(color="black", linewidth=1.3, linestyle=("-", (0, (5, 2)), ":")[k % 3])
        for line in curve.lines(x, y, fixed, limits[0]):
            ax.plot(*line.T, **style, zorder=5, path_effects=[withStroke(linewidth=2.6, foreground="white")])
        handles[curve.label] = Line2D([], [], **style, label=curve.label)
    ax.set(xlim=limits[0], ylim=limits[1])
    return list(handles.values())
