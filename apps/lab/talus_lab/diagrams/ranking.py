"""What matters most among many parameters."""

from __future__ import annotations

import math
import textwrap

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from talus_lab.diagrams.panels import check, number_axis, scale
from talus_lab.diagrams.table import Table
from talus_lab.errors import ResultError, nearest
from talus_lab.plot import finish
from talus_lab.style import CM, DPI, MODES, STYLE, WIDTH_CM

WAYS = ("rank", "range")
SMALL = (".", "$?$")  # marks that are small for their size
LINE = 28  # letters of a line beside a bar
FEW = 4  # cases: of fewer a rank correlation says nothing


def tornado(table: Table, value: str, by: str = "rank", width_cm: float = WIDTH_CM) -> Figure:
    """A bar for each parameter, the longest on top. by rank: Spearman's correlation of the number with the parameter, from all cases.
    by range: how far the number goes when this parameter alone leaves its usual value (the most frequent one)."""
    if by not in WAYS:
        raise ResultError(f"by: {by}{nearest(by, WAYS)}")
    names = _numeric(table)
    numbers = table.numbers(value)
    bars = {name: (correlation(table.numbers(name), numbers) if by == "rank" else alone(table, name, names, numbers)) for name in names}
    bars = {name: bar for name, bar in bars.items() if bar is not None and not np.isnan(bar).any()}
    if not bars:
        raise ResultError(f"{table.path}: " + (f"fewer than {FEW} cases have {value}" if by == "rank"
                                               else "no parameter varies alone while all others have their most frequent value; use by: rank"))
    order = sorted(bars, key=lambda name: np.ptp([*np.atleast_1d(bars[name]), 0.0 if by == "rank" else bars[name][0]]))
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width_cm * CM, 1.1 + 0.3 * len(order)), dpi=DPI)
        ax = figure.subplots()
        for k, name in enumerate(order):
            low, high = (0.0, bars[name]) if by == "rank" else bars[name]
            positive = high >= 0 or by == "range"
            ax.barh(k, high - low, left=low, height=0.66, color="#0072b2" if positive else "#e69f00", edgecolor="#404040", linewidth=0.5,
                    hatch=None if positive else "////")
        ax.set_yticks(range(len(order)), ["\n".join(textwrap.wrap(table.labels.get(name, name) if by == "rank" else table.label(name), LINE)) for name in order])
        if by == "rank":
            ax.axvline(0, color="#404040", linewidth=0.6)
            ax.set(xlim=(-1.02, 1.02), xlabel=f"rank correlation with {table.labels.get(value, value)}")
        else:
            ax.set_xlabel(number_axis(ax.xaxis, numbers, table.labels.get(value, value), table.units.get(value, "")))
        ax.grid(True, axis="x", color="#e0e0e0", linewidth=0.5)
        ax.set_axisbelow(True)
        ax.spines[["top", "right"]].set_visible(False)
        finish(figure, table.title, [])
        return figure


def scatter(table: Table, value: str, width_cm: float = WIDTH_CM) -> Figure:
    """The number over each parameter in turn; marks say the mode of failure if it was measured."""
    names, numbers = _varied(table), table.numbers(value)
    told = {"verdict", "mechanism"} & set(table.columns)
    mode = table.mode if told else np.full(len(table), "still", dtype=object)
    there = [name for name in MODES if name in set(mode[~np.isnan(numbers)])]
    across = min(len(names), 3)
    high = math.ceil(len(names) / across)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width_cm * CM, 0.9 + 1.6 * high), dpi=DPI)
        axes = figure.subplots(high, across, squeeze=False, sharey=True)
        for ax, name in zip(axes.flat, names):
            for kind in there:
                rows, look = mode == kind, MODES[kind]
                ax.plot(table.numbers(name)[rows], numbers[rows], linestyle="none", marker=look.mark if told else "o", markersize=5 if told and look.mark in SMALL else 3,
                        markerfacecolor=look.color if told else "#0072b2", markeredgecolor="#404040", markeredgewidth=0.3)
            ax.spines[["top", "right"]].set_visible(False)
            if not table.words(name):
                ax.locator_params(axis="x", nbins=4)
            ax.set_xlabel("\n".join(textwrap.wrap(scale(ax, "x", table, name, False), int(15 * (width_cm * CM - 0.8) / across))), fontsize=8)
        known = numbers[~np.isnan(numbers)]
        if len(known) and known.min() > 0 and known.max() > 1000 * known.min():
            axes[0, 0].set_yscale("log")
        label = number_axis(axes[0, 0].yaxis, numbers, table.labels.get(value, value), table.units.get(value, ""))
        for ax in list(axes.flat)[len(names):]:
            ax.remove()
        figure.supylabel(label, fontsize=9)
        finish(figure, table.title, [Line2D([], [], linestyle="none", marker=MODES[kind].mark, markersize=5, markerfacecolor=MODES[kind].color,
                                            markeredgecolor="#404040", markeredgewidth=0.5, label=kind) for kind in there] if told else [])
        return figure


def correlation(x: np.ndarray, y: np.ndarray) -> float:
    """Spearman's: Pearson's of the ranks, equal values sharing the mean of theirs; nan for too few cases, 0 where one does not vary."""
    known = ~np.isnan(x) & ~np.isnan(y)
    if known.sum() < FEW:
        return float("nan")
    a, b = (_ranks(column[known]) for column in (x, y))
    spread = np.std(a) * np.std(b)
    return float(np.mean((a - a.mean()) * (b - b.mean())) / spread) if spread > 0 else 0.0


def _ranks(values: np.ndarray) -> np.ndarray:
    _, of, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - (count - 1) / 2)[of]


def alone(table: Table, name: str, names: list[str], numbers: np.ndarray) -> tuple[float, float] | None:
    """Smallest and largest number among cases in which all other parameters have their most frequent value."""
    rows = ~np.isnan(numbers)
    for other in names:
        if other != name:
            values, count = np.unique(table.columns[other], return_counts=True)
            rows = rows & (table.columns[other] == values[np.argmax(count)])
    return (float(numbers[rows].min()), float(numbers[rows].max())) if rows.sum() > 1 else None


def _varied(table: Table) -> list[str]:
    check(table)
    if not table.varied():
        raise ResultError(f"{table.path}: no parameter varies")
    return table.varied()


def _numeric(table: Table) -> list[str]:
    names = [name for name in _varied(table) if not table.words(name)]
    if not names:
        raise ResultError(f"{table.path}: the values of all parameters are words; scatter can draw them")
    return names
