"""Pictures of a run: `picture` of a frame, `scene` of a scenario that has not run. Both return a matplotlib Figure."""

from __future__ import annotations

import math
import textwrap

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Patch
from matplotlib.text import Text

from talus_lab import layers, measures
from talus_lab.colors import BlockColors, block_colors, check_color, plain
from talus_lab.forces import draw_forces, draw_stress
from talus_lab.layers import Geometry
from talus_lab.errors import ResultError
from talus_lab.run import Run
from talus_lab.style import CM, DPI, STYLE, WIDTH_CM
from talus_lab.units import quantity

UPRIGHT = 1.7  # inches, the least height at which the label of a colour bar fits beside it
FARTHEST = 1e15  # m: farther away nothing is told apart in double numbers; and nan is nowhere
THIN = 0.05  # of the side of a mean block: blocks thinner than this govern the time step and deserve a look


def picture(run: Run, frame: int = -1, color: str = "displacement", forces: bool = False, joints: bool = False,
            before_after: bool = False, exaggerate: float = 1.0, stress: bool = False, outline: bool = False,
            width_cm: float = WIDTH_CM) -> Figure:
    """One frame, or the first one and it side by side.

    color: one of COLORS. forces: contact forces as lines of width by force. stress: principal stresses of the blocks as crosses.
    joints: joints coloured by state. outline: where the free blocks stood in the first frame. exaggerate: movements since the start are
    drawn this many times as large. Raises ResultError for what the result does not have.
    """
    joints = joints or color == "joint_state"
    check_color(run, color, forces or joints or stress)
    with matplotlib.rc_context(STYLE):
        start, now = Geometry(run, 0, exaggerate), Geometry(run, frame, exaggerate)
        geometries = [start, now] if before_after else [now]
        colors = block_colors(run, frame, color)
        figure, axes = page(run, geometries, width_cm, colors.mappable is not None, [start] if outline else [])
        handles = [layers.held_handle()] if run.blocks["held"].any() else []
        handles += colors.handles
        for ax, geometry in zip(axes, geometries):
            shown = plain(run) if geometry is start and colors.mappable is not None else colors
            layers.draw_blocks(ax, run, geometry, shown.faces, shown.hatches)
            own = layers.draw_joints(ax, run, geometry, "state") if joints else []
            own += draw_forces(ax, run, geometry) if forces else []
            own += draw_stress(ax, run, geometry) if stress else []
            own += layers.draw_outline(ax, run, start, f"at t = {quantity(run.times[0], 's', 4)}") if outline and geometry is now else []
            found = f"{measures.verdict(run)}, {measures.mechanism(run)}" if color == "mechanism" and geometry is now else ""
            caption(ax, moment(run, geometry, [colors.note, found.removesuffix(", none")]), width_cm * CM / _across(axes))
        color_bar(figure, axes, colors)
        finish(figure, run.title, handles + own)
        return figure


def scene(run: Run, width_cm: float = WIDTH_CM) -> Figure:
    """A scenario that has not run: blocks by material, supports, joints by name, thin blocks marked."""
    with matplotlib.rc_context(STYLE):
        geometry = Geometry(run, 0, 1.0)
        figure, (ax,) = page(run, [geometry], width_cm, False)
        colors = block_colors(run, 0, "material")
        layers.draw_blocks(ax, run, geometry, colors.faces)
        thin = thin_blocks(run)
        handles = colors.handles + [layers.held_handle()] * bool(run.blocks["held"].any())
        handles += layers.draw_joints(ax, run, geometry, "name")
        handles += layers.mark(ax, run.position(0)[thin], f"thin blocks ({len(thin)})")
        caption(ax, f"{run.block_count:,} blocks, not run yet", width_cm * CM)
        finish(figure, run.title, handles)
        return figure


def thin_blocks(run: Run) -> np.ndarray:
    """Indices of blocks whose width, 2 area / perimeter, is below THIN x sqrt(mean area)."""
    length = np.hypot(*(run.arm[run.next_corner] - run.arm).T) * ~run.internal
    perimeter = np.bincount(run.corner_block, length, minlength=run.block_count)
    area = run.blocks["area"]
    return np.flatnonzero(2 * area < THIN * np.sqrt(area.mean()) * perimeter)


def page(run: Run, geometries: list[Geometry], width_cm: float, bar: bool, also: list[Geometry] = []) -> tuple[Figure, list[Axes]]:
    """A figure with one axes for each geometry, all with the same limits, side by side or, if they are wide, one above the other.
    bar: there will be a colour bar. also: what must fit in beside them."""
    corners = np.concatenate([_seen(run, geometry) for geometry in [*geometries, *also]])
    low, high = corners.min(axis=0), corners.max(axis=0)
    if not np.abs(corners).max() < FARTHEST:
        raise ResultError(f"{run.path}: cannot be drawn, blocks are at {corners.min():.3g} to {corners.max():.3g} m")
    margin = 0.03 * (high - low).max()
    width, height = high - low + 2 * margin
    below = len(geometries) > 1 and width > 1.2 * height
    columns, rows = (1, len(geometries)) if below else (len(geometries), 1)
    inches = min((width_cm * CM - 0.6) / (width * columns), 1.3 * width_cm * CM / (height * rows))
    if bar and inches * height * rows > UPRIGHT:
        inches = min(inches, (width_cm * CM - 1.4) / (width * columns))
    beside = 1.1 if inches * height * rows > UPRIGHT or not bar else 1.7
    figure = Figure(figsize=(width_cm * CM, max(inches * height * rows + 0.35 * rows + beside, 2.0)), dpi=DPI)
    axes = list(figure.subplots(rows, columns, squeeze=False, sharey=True, sharex=True).flat)
    for ax in axes:
        ax.set(aspect="equal", xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
        ax.tick_params(width=0.5, length=3)
        ax.ticklabel_format(useOffset=False, style="plain")  # map coordinates in full: whoever reads them looks there
        ax.locator_params(axis="x", nbins=max(1, int(1.6 * inches * width)))
        ax.locator_params(axis="y", nbins=max(2, int(2.5 * inches * height)))
        ax.spines[["top", "right"]].set_visible(False)
        if ax.get_subplotspec().is_last_row():
            ax.set_xlabel("x in m")
        if ax.get_subplotspec().is_first_col():
            ax.set_ylabel("y in m")
    return figure, axes


def _across(axes: list[Axes]) -> int:
    return max(ax.get_subplotspec().colspan.stop for ax in axes)


def _seen(run: Run, geometry: Geometry) -> np.ndarray:
    corners = geometry.corners
    present = ~run.removed(geometry.frame)[run.corner_block]
    return corners[present] if present.any() else corners


def moment(run: Run, geometry: Geometry, notes: list[str]) -> str:
    shown = run.block_count - int(run.removed(geometry.frame).sum())
    words = [f"t = {quantity(run.times[geometry.frame], 's', 4)}", f"{shown:,} blocks"]
    if geometry.exaggerate != 1:
        words.append(f"movements drawn {geometry.exaggerate:g} times as large")
    if run.status not in ("", "complete"):
        words.append(run.status)
    return " · ".join([*words, *filter(None, notes)])


def caption(ax: Axes, text: str, inches: float) -> Text:
    """Above an axes that has so many inches of the page for itself; in the middle of one that is too narrow for it."""
    narrow = ax.viewLim.height > 2 * ax.viewLim.width
    text = textwrap.fill(text, max(20, int(13 * (inches - 0.8))))
    return ax.set_title(text, loc="center" if narrow else "left", fontsize=9, color="#404040")


def color_bar(figure: Figure, axes: list[Axes], colors: BlockColors) -> None:
    """Upright beside the axes, or below them if they are too low for its label."""
    if colors.mappable is None:
        return
    width, height = axes[0].get_window_extent().size / figure.dpi
    limits = axes[0].viewLim
    high = min(height, width * limits.height / limits.width) * len({ax.get_subplotspec().rowspan.start for ax in axes})
    where = "right" if high > UPRIGHT else "bottom"
    bar = figure.colorbar(colors.mappable, ax=axes, location=where, shrink=0.9, aspect=26, pad=0.015 if where == "right" else 0.03,
                          use_gridspec=False, extend=colors.extend)
    bar.set_label("\n".join(textwrap.wrap(colors.label, int(12 * high if where == "right" else 12 * width))))
    bar.ax.tick_params(width=0.5, length=3)
    bar.ax.locator_params(nbins=6)


def finish(figure: Figure, title: str, handles: list[Patch]) -> None:
    """Title, legend and layout. The page grows by the lines that they take beyond one each."""
    inches = figure.get_figwidth()
    lines = textwrap.wrap(title, int(12 * inches))
    figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=10, fontweight="bold")
    rows = 1
    if handles:
        longest = max(len(handle.get_label()) for handle in handles)
        columns = min(len(handles), max(1, int(inches / (0.35 + 0.058 * longest))))
        rows = math.ceil(len(handles) / columns)
        figure.legend(handles=handles, loc="outside lower center", ncols=columns, columnspacing=1.2, handlelength=1.8)
    figure.set_figheight(figure.get_figheight() + 0.18 * (rows - 1) + 0.16 * max(len(lines) - 1, 0))
    ConstrainedLayoutEngine().execute(figure)  # once; as the figure's own engine it would draw everything twice
