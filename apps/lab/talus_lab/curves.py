"""Histories and energies over time."""

from __future__ import annotations

import textwrap
from typing import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from talus_lab.errors import ResultError, nearest
from talus_lab.plot import finish
from talus_lab.run import Run
from talus_lab.style import CM, DASHES, DPI, NAME_COLORS, STYLE, WIDTH_CM
from talus_lab.units import axis_label, prefix

# name, colour and dashes of each energy, in the order of the ledger; what feeds the others is black.
ENERGIES = {"kinetic": ("kinetic", "#0072b2", "-"), "strain_normal": ("stored, normal", "#009e73", "--"),
            "strain_shear": ("stored, shear", "#009e73", ":"), "friction": ("friction", "#d55e00", "-."),
            "contact_damping": ("contact damping", "#e69f00", "--"), "local_damping": ("local damping", "#e69f00", ":"),
            "released": ("released", "#cc79a7", (0, (5, 1, 1, 1, 1, 1))), "gravity": ("work of gravity", "#000000", ":"),
            "loads": ("work of loads", "#000000", "--"), "driven": ("work of driven blocks", "#000000", "-."),
            "total": ("total", "#000000", "-")}
NOTHING = 1e-6  # of the largest energy: a line on the axis


def history(run: Run, name: str, columns: Sequence[str] = (), width_cm: float = WIDTH_CM) -> Figure:
    """The columns of a history (all if none are named) over time, one panel for each unit. Raises ResultError for unknown names."""
    table = run.history(name)
    known = [column for column in table if column != "time"]
    for column in columns:
        if column not in known:
            raise ResultError(f"{run.path}: history {name}: no column {column}{nearest(column, known)}")
    by_unit: dict[str, dict[str, np.ndarray]] = {}
    for column in columns or known:
        by_unit.setdefault(run.unit(f"histories/{name}/{column}"), {})[column] = table[column]
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width_cm * CM, 0.7 + 1.9 * len(by_unit)), dpi=DPI)
        panels = figure.subplots(len(by_unit), 1, squeeze=False, sharex=True)[:, 0]
        for ax, (unit, lines) in zip(panels, by_unit.items()):
            _panel(ax, table["time"], lines, unit, _common(list(lines)))
        panels[-1].set_xlabel("time in s")
        finish(figure, f"{run.title}: {name}", [])
        return figure


def energies(run: Run, width_cm: float = WIDTH_CM) -> Figure:
    """Every energy of the ledger that is not nothing throughout, over the time of the frames, and their total, which stays as it is."""
    largest = max((float(np.abs(column).max(initial=0.0)) for column in run.energies.values()), default=0.0)
    shown = [name for name in ENERGIES if name in run.energies
             and (name == "total" or np.abs(run.energies[name]).max(initial=0.0) > NOTHING * largest)]
    lines = {ENERGIES[name][0]: run.energies[name] for name in shown}
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(width_cm * CM, 3.4), dpi=DPI)
        ax = figure.subplots()
        _panel(ax, run.times, lines, "J", "energy per m", [ENERGIES[name][1:] for name in shown])
        ax.set_xlabel("time in s")
        finish(figure, f"{run.title}: energy", ax.get_lines())
        return figure


def _panel(ax: Axes, time: np.ndarray, lines: Mapping[str, np.ndarray], unit: str, label: str, styles: Sequence[tuple] = ()) -> None:
    largest = max((float(np.nanmax(np.abs(values), initial=0.0)) for values in lines.values()), default=0.0)
    factor, unit = prefix(largest, unit)
    back = np.flatnonzero(np.diff(time) < 0) + 1  # a stage has set the clock back: the line is broken there
    x = np.insert(time.astype(float), back, np.nan)
    for k, (name, values) in enumerate(lines.items()):
        color, dashes = styles[k] if styles else (NAME_COLORS[k % len(NAME_COLORS)], DASHES[k % len(DASHES)])
        short = name.removeprefix(label).strip(" .,") or name if label else name
        ax.plot(x, np.insert(values.astype(float) * factor, back, np.nan), label=short, color=color, linestyle=dashes, linewidth=1.3)
    ax.set_ylabel("\n".join(textwrap.wrap(axis_label(label, unit), 24)) if label else unit)
    ax.margins(x=0.01)
    ax.grid(True, color="#e0e0e0", linewidth=0.5)
    ax.spines[["top", "right"]].set_visible(False)
    if not styles and len(lines) > 1:
        ax.legend(loc="best", handlelength=2.8)


def _common(names: list[str]) -> str:
    """What the names of columns begin with, up to a dot or blank: `displacement.x at ..` and `displacement.y at ..` are displacements."""
    words = {name.replace(".", " ").split()[0] for name in names}
    return words.pop() if len(words) == 1 else ""
