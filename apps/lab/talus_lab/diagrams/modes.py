"""Which mode of failure where: a diagram over two parameters."""

from __future__ import annotations

from collections import Counter
from typing import Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from talus_lab.diagrams.boundaries import Curve
from talus_lab.diagrams.panels import axis_labels, borders, cells, check, draw_curves, grid, panels
from talus_lab.diagrams.table import Table
from talus_lab.plot import finish
from talus_lab.style import EDGE, MODES, STYLE, WIDTH_CM

MARKED = 30  # cells along an axis of a panel: of more the marks would touch, and cells are hatched instead


def modes(table: Table, x: str, y: str, panel: str | None = None, curves: Sequence[Curve] = (), width_cm: float = WIDTH_CM) -> Figure:
    """stable, slide, topple, slide and topple, fall, rotation, undecided, failed: by colour and by mark or hatch. panel: a parameter, one
    panel for each of its values. curves: boundaries of theory. Where cases lie on one another, such as repetitions, the most frequent
    mode is shown. Raises ResultError for unknown columns."""
    check(table, x=x, y=y, panel=panel)
    table = table.only(table.mode != "")
    check(table)
    table, most = most_frequent(table, [name for name in (x, y, panel) if name])
    there = [mode for mode in MODES if mode in set(table.mode)]
    lattice = grid(table, x, y)
    marked = lattice is None or max(map(len, lattice)) <= MARKED
    limits = _limits(table, x, y, lattice)
    with matplotlib.rc_context(STYLE):
        for figure, ax, rows, fixed in panels(table, panel, width_cm):
            size = _mark_size(figure, lattice, len(set(table.columns[panel].tolist())) if panel else 1)
            for mode in there:
                at = np.column_stack([rows.numbers(x), rows.numbers(y)])[rows.mode == mode]
                _draw(ax, at, mode, lattice, marked, size)
            theory = draw_curves(ax, curves, x, y, fixed, limits)
        axis_labels(figure, table, x, y)
        handles = [_handle(mode, int(np.sum(table.mode == mode)), lattice is not None, marked) for mode in there]
        finish(figure, table.title + (f" (most frequent of up to {most})" if most > 1 else ""), handles + theory)
        return figure


def most_frequent(table: Table, names: list[str]) -> tuple[Table, int]:
    """One row of those that agree in these columns, with their most frequent mode, the worse of two that are as frequent; and how many
    agree at most."""
    worse = list(MODES)
    rows: dict[tuple, list[int]] = {}
    for k, key in enumerate(zip(*(table.columns[name].tolist() for name in names))):
        rows.setdefault(key, []).append(k)

    def chosen(cases: list[int]) -> int:
        count = Counter(table.mode[cases])
        mode = max(count, key=lambda mode: (count[mode], worse.index(mode)))
        return next(k for k in cases if table.mode[k] == mode)

    return table.only(np.array(sorted(map(chosen, rows.values())), int)), max(map(len, rows.values()))


def _limits(table: Table, x: str, y: str, lattice: tuple | None) -> tuple:
    if lattice:
        return tuple((edge[0], edge[-1]) for edge in map(borders, lattice))
    ends = [(table.numbers(name).min(), table.numbers(name).max()) for name in (x, y)]
    return tuple((low - 0.04 * (high - low or 1), high + 0.04 * (high - low or 1)) for low, high in ends)


def _mark_size(figure: Figure, lattice: tuple | None, count: int) -> float:
    """Points: a third of a cell."""
    if lattice is None:
        return 3.5
    return float(np.clip(72 * (figure.get_figwidth() - 0.8) / min(count, 3) / max(map(len, lattice)) * 0.38, 1.2, 5.0))


def _draw(ax: Axes, at: np.ndarray, mode: str, lattice: tuple | None, marked: bool, size: float) -> None:
    if not len(at):
        return
    look = MODES[mode]
    if lattice:
        ax.add_collection(PathCollection([cells(at, *lattice)], facecolor=look.color, edgecolor="#707070", linewidth=0, zorder=1,
                                         hatch=None if marked else look.hatch), autolim=False)
    if marked:
        ax.plot(*at.T, linestyle="none", marker=look.mark, markersize=size, markeredgewidth=0.4, zorder=3,
                markerfacecolor="#404040" if lattice else look.color, markeredgecolor="#404040")


def _handle(mode: str, count: int, celled: bool, marked: bool) -> Patch | Line2D:
    look = MODES[mode]
    label = f"{mode} ({count:,})"
    if celled and not marked:
        return Patch(facecolor=look.color, edgecolor=EDGE, linewidth=0.4, hatch=look.hatch, label=label)
    return Line2D([], [], linestyle="none", marker=look.mark, markersize=5, markerfacecolor=look.color, markeredgecolor="#404040",
                  markeredgewidth=0.6, label=label)
