"""Numbers over two parameters as colours, and how often something fails."""

from __future__ import annotations

import textwrap
from typing import Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke
from matplotlib.tri import Triangulation

from talus_lab.diagrams.boundaries import Curve
from talus_lab.diagrams.panels import axis_labels, borders, cells, check, draw_curves, grid, number_axis, panels, scale, value_label
from talus_lab.diagrams.table import Table
from talus_lab.errors import ResultError
from talus_lab.plot import finish
from talus_lab.style import CM, DASHES, DPI, MARKS, NAME_COLORS, STYLE, WIDTH_CM
from talus_lab.units import axis_label, quantity

COLORS = "cividis"
DECADES = 1e-5  # of the largest value: smaller ones have the colour of this, for 1e-9 m is rounding and would take the colours of all that is seen
WIDE = 1000.0  # largest over smallest value from which colours go by the logarithm
WRITTEN = 12  # cells along an axis: in so many there is room for a number
NORMAL = 1.96  # of a confidence of 95 %
MISSING = dict(facecolor="white", edgecolor="#b0b0b0", hatch="////")


def value_map(table: Table, x: str, y: str, value: str, panel: str | None = None, limit: float | None = None, curves: Sequence[Curve] = (),
              width_cm: float = WIDTH_CM) -> Figure:
    """A number over two parameters; the mean where several cases lie on one another. limit: the value at which a line is drawn, in the
    unit of the column."""
    check(table, x=x, y=y, panel=panel)
    numbers = table.numbers(value)
    said = f"{table.labels.get(value, value)} = {quantity(limit, table.units.get(value, '1'))}" if limit is not None else ""
    return _map(table, x, y, panel, numbers, table.labels.get(value, value), table.units.get(value, ""), _norm(numbers, table, value), limit, said, curves, width_cm)


def probability(table: Table, x: str, y: str | None = None, panel: str | None = None, value: str | None = None, limit: float | None = None,
                curves: Sequence[Curve] = (), width_cm: float = WIDTH_CM) -> Figure:
    """The share of the decided cases that are unstable, or in which a number exceeds a limit: a map over x and y, with a line where it is
    a half; or, without y, a curve over x with its 95 % confidence band."""
    check(table, x=x, y=y, panel=panel)
    event = failing(table, value, limit)
    if np.isnan(event).all():
        raise ResultError(f"{table.path}: no case is decided" if not value else f"{table.path}: no case has {value} yet")
    words = f"share with {table.labels.get(value, value)} above {quantity(limit, table.units.get(value, '1'))}" if value else "share that fails"
    if y:
        return _map(table, x, y, panel, event, words, "", Normalize(0, 1), 0.5, "a half fails", curves, width_cm, shares=True)
    return _curve(table, x, panel, event, words, width_cm)


def failing(table: Table, value: str | None, limit: float | None) -> np.ndarray:
    """[cases] 1 where it fails, 0 where not, nan where it is not decided."""
    if value:
        if limit is None:
            raise ResultError(f"a probability that {value} exceeds a limit needs the limit")
        numbers = table.numbers(value)
        return np.where(np.isnan(numbers), np.nan, numbers > limit)
    mode = table.mode
    return np.where(np.isin(mode, ["", "undecided", "failed"]), np.nan, mode != "stable").astype(float)


def wilson(failed: np.ndarray, of: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bound of a probability at 95 %, from counts   [E.B. Wilson, J. Am. Stat. Assoc. 22 (1927) 209-212]."""
    share, z2 = failed / of, NORMAL**2
    middle = (share + z2 / (2 * of)) / (1 + z2 / of)
    half = NORMAL * np.sqrt(share * (1 - share) / of + z2 / (4 * of**2)) / (1 + z2 / of)
    return middle - half, middle + half


def _norm(numbers: np.ndarray, table: Table, value: str) -> Normalize:
    known = numbers[np.isfinite(numbers)]
    if not len(known):
        raise ResultError(f"{table.path}: no case has {value} yet")
    above = known[known > 0]
    if len(above) and known.min() >= 0 and above.max() > WIDE * above.min():
        return LogNorm(max(above.min(), DECADES * above.max()), above.max(), clip=True)
    return Normalize(known.min(), known.max() if known.max() > known.min() else known.min() + 1)


def _map(table: Table, x: str, y: str, panel: str | None, numbers: np.ndarray, label: str, unit: str, norm: Normalize, limit: float | None, said: str,
         curves: Sequence[Curve], width_cm: float, shares: bool = False) -> Figure:
    lattice = grid(table, x, y)
    table = Table(table.path, table.title, {**table.columns, "": numbers}, table.parameters, table.measures, table.units, table.labels)
    theory, empty = [], False
    with matplotlib.rc_context(STYLE):
        axes = []
        for figure, ax, rows, fixed in panels(table, panel, width_cm, True):
            axes.append(ax)
            written = shares and lattice is not None and not panel and max(map(len, lattice)) <= WRITTEN
            at = np.column_stack([rows.numbers(x), rows.numbers(y)])
            if lattice:
                empty |= _cells(ax, at, rows.columns[""], lattice, norm, limit, written)
                limits = tuple((edge[0], edge[-1]) for edge in map(borders, lattice))
            else:
                _scattered(ax, at, rows.columns[""], norm, limit)
                limits = (ax.get_xlim(), ax.get_ylim())
            theory = draw_curves(ax, curves, x, y, fixed, limits)
        bar = figure.colorbar(ScalarMappable(norm, COLORS), ax=axes, shrink=0.9, aspect=26, pad=0.015, use_gridspec=False,
                              extend="min" if isinstance(norm, LogNorm) and np.nanmin(numbers) < norm.vmin else "neither")
        label = number_axis(bar.ax.yaxis, numbers, label, unit) if bar.ax.yaxis.get_scale() != "log" else axis_label(label, unit)
        bar.set_label("\n".join(textwrap.wrap(label, int(10 * figure.get_figheight()))))
        axis_labels(figure, table, x, y)
        line = [Line2D([], [], color="#d55e00", linewidth=1.6, label=said)] if limit is not None else []
        finish(figure, table.title, line + theory + [Patch(**MISSING, linewidth=0.4, label="no value")] * empty)
        return figure


def _cells(ax: Axes, at: np.ndarray, numbers: np.ndarray, lattice: tuple, norm: Normalize, limit: float | None, written: bool) -> bool:
    """Whether some cell has no value. written: the numbers stand in their cells."""
    x, y = lattice
    mean = means(at, numbers, x, y)
    ax.pcolormesh(borders(x), borders(y), mean, norm=norm, cmap=COLORS, edgecolors="face", linewidth=0.2, zorder=1)
    j, i = np.nonzero(np.isnan(mean))
    if len(i):
        ax.add_collection(PathCollection([cells(np.column_stack([x[i], y[j]]), x, y)], **MISSING, linewidth=0, zorder=1), autolim=False)
    if limit is not None and min(mean.shape) > 1 and np.nanmin(mean) < limit <= np.nanmax(mean):
        level, over = (np.log(limit), np.log(mean)) if isinstance(norm, LogNorm) and limit > 0 and np.nanmin(mean) > 0 else (limit, mean)
        ax.contour(x, y, np.ma.masked_invalid(over), [level], colors="white", linewidths=3.0, linestyles="solid", zorder=4)
        ax.contour(x, y, np.ma.masked_invalid(over), [level], colors="#d55e00", linewidths=1.6, linestyles="solid", zorder=4)
    for row, column in np.argwhere(~np.isnan(mean)) if written else []:
        share = mean[row, column]
        seam = withStroke(linewidth=2.5, foreground=matplotlib.colormaps[COLORS](norm(share)))  # lines pass behind the number
        ax.text(x[column], y[row], f"{share:.2f}".removeprefix("0") if 0 < share < 1 else f"{share:.0f}", ha="center", va="center",
                fontsize=7, color="white" if share < 0.55 else "black", zorder=6, path_effects=[seam])
    return bool(len(i))


def means(at: np.ndarray, numbers: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """[len(y), len(x)] mean of what is known at each point of a grid; nan where nothing is."""
    known = ~np.isnan(numbers)
    index = np.searchsorted(y, at[known, 1]) * len(x) + np.searchsorted(x, at[known, 0])
    count = np.bincount(index, minlength=len(x) * len(y))
    total = np.bincount(index, numbers[known], minlength=len(x) * len(y))
    with np.errstate(invalid="ignore"):
        return (total / count).reshape(len(y), len(x))


def _scattered(ax: Axes, at: np.ndarray, numbers: np.ndarray, norm: Normalize, limit: float | None) -> None:
    """Cases that lie anywhere: filled contours between them, and each as a point in its own colour."""
    known = np.isfinite(numbers)
    if known.sum() > 3 and min(len(set(column)) for column in at[known].T) > 2:
        mesh = Triangulation(*at[known].T)
        ax.tripcolor(mesh, numbers[known], norm=norm, cmap=COLORS, shading="gouraud", zorder=1)
        if limit is not None and numbers[known].min() < limit <= numbers[known].max():
            ax.tricontour(mesh, numbers[known], [limit], colors="#d55e00", linewidths=1.6, linestyles="solid", zorder=4)
    ax.scatter(*at[known].T, c=numbers[known], norm=norm, cmap=COLORS, s=14, edgecolors="white", linewidths=0.5, zorder=3)
    ax.plot(*at[~known].T, linestyle="none", marker="x", color="#707070", markersize=4)


def _curve(table: Table, x: str, panel: str | None, event: np.ndarray, label: str, width_cm: float) -> Figure:
    """A line for each value of `panel`."""
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width_cm * CM, 3.2), dpi=DPI)
        ax = figure.subplots()
        for k, value in enumerate(sorted(set(table.columns[panel].tolist())) if panel else [None]):
            rows = ~np.isnan(event) & (True if value is None else table.columns[panel] == value)
            at, of = np.unique(table.numbers(x)[rows], return_inverse=True)
            if not len(at):
                continue
            count, failed = np.bincount(of), np.bincount(of, event[rows])
            color = NAME_COLORS[k % len(NAME_COLORS)]
            ax.fill_between(at, *wilson(failed, count), color=color, alpha=0.15, linewidth=0)
            ax.plot(at, failed / count, color=color, markersize=4, label="" if value is None else value_label(table, panel, value),
                    linestyle=DASHES[(k + k // 7) % len(DASHES)], marker=MARKS[(k + k // 7) % len(MARKS)])
        ax.set(xlabel=scale(ax, "x", table, x, False), ylabel=label, ylim=(-0.02, 1.02), yticks=np.linspace(0, 1, 6))
        ax.grid(True, color="#e0e0e0", linewidth=0.5)
        ax.spines[["top", "right"]].set_visible(False)
        finish(figure, table.title, ax.get_lines() if panel else [])
        return figure
