"""Pictures of a run: `picture` of a frame, `scene` of a scenario that has not run. Both return a matplotlib Figure."""

from __future__ import annotations

import textwrap

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.patches import Patch

from talus_lab import layers
from talus_lab.layers import Geometry
from talus_lab.run import Run

MOTIONS = ("displacement", "velocity", "rotation")
COLORS = (*MOTIONS, "joint_state", "material", "none")
PLAIN = "#ece7dc"
MOVED = LinearSegmentedColormap.from_list("moved", matplotlib.colormaps["YlGnBu"](np.linspace(0.03, 0.88, 256)))
STYLE = {"font.size": 9, "font.family": "sans-serif", "axes.linewidth": 0.6, "axes.edgecolor": "#808080", "hatch.linewidth": 0.5,
         "xtick.color": "#404040", "ytick.color": "#404040", "legend.frameon": False, "legend.fontsize": 8.5,
         "figure.facecolor": "white", "axes.facecolor": "white", "svg.fonttype": "none"}
STILL = 1e-10  # of the size of a block (per s), of a radian: what moves less has not moved
THIN = 0.05  # of the side of a mean block: blocks thinner than this govern the time step and deserve a look


def picture(run: Run, frame: int = -1, color: str = "displacement", forces: bool = False, joints: bool = False,
            before_after: bool = False, exaggerate: float = 1.0) -> Figure:
    """One frame, or the first one and it side by side.

    color: one of COLORS. forces: contact forces as lines of width by force. joints: joints coloured by state.
    exaggerate: movements since the start are drawn this many times as large.
    """
    joints = joints or color == "joint_state"
    with matplotlib.rc_context(STYLE):
        geometries = [Geometry(run, frame, exaggerate)]
        if before_after:
            geometries.insert(0, Geometry(run, 0, exaggerate))
        figure, axes = _page(run, geometries)
        colors, mappable, label = _block_colors(run, frame, color)
        handles = [layers.held_handle()] if run.blocks["held"].any() else []
        handles += _material_handles(run) if color == "material" else []
        for ax, geometry in zip(axes, geometries):
            blank = len(geometries) > 1 and ax is axes[0] and mappable is not None
            layers.draw_blocks(ax, run, geometry, _same(run, PLAIN) if blank else colors)
            own = layers.draw_joints(ax, run, geometry, "state") if joints else []
            own += layers.draw_forces(ax, run, geometry) if forces else []
            still = color in MOTIONS and mappable is None
            ax.set_title(_moment(run, geometry) + " · nothing moves" * still, loc="left", fontsize=9, color="#404040")
        if mappable is not None:
            figure.colorbar(mappable, ax=axes, shrink=0.8, aspect=28, pad=0.015, use_gridspec=False).set_label(label)
        _finish(figure, run, handles + own)
        return figure


def scene(run: Run) -> Figure:
    """A scenario that has not run: blocks by material, supports, joints by name, thin blocks marked."""
    with matplotlib.rc_context(STYLE):
        geometry = Geometry(run, 0, 1.0)
        figure, (ax,) = _page(run, [geometry])
        layers.draw_blocks(ax, run, geometry, _block_colors(run, 0, "material")[0])
        thin = thin_blocks(run)
        handles = _material_handles(run) + [layers.held_handle()] * bool(run.blocks["held"].any())
        handles += layers.draw_joints(ax, run, geometry, "name")
        handles += layers.mark(ax, run.position(0)[thin], f"thin blocks ({len(thin)})")
        ax.set_title(f"{run.block_count:,} blocks, not run yet", loc="left", fontsize=9, color="#404040")
        _finish(figure, run, handles)
        return figure


def thin_blocks(run: Run) -> np.ndarray:
    """Indices of blocks whose width, 2 area / perimeter, is below THIN x sqrt(mean area)."""
    start, first = run.arm, run.first_corner
    after = np.arange(len(start)) + 1
    after[first[1:] - 1] = first[:-1]
    length = np.hypot(*(start[after] - start).T) * ~run.internal
    perimeter = np.bincount(run.corner_block, length, minlength=run.block_count)
    area = run.blocks["area"]
    return np.flatnonzero(2 * area < THIN * np.sqrt(area.mean()) * perimeter)


def _block_colors(run: Run, frame: int, color: str) -> tuple[np.ndarray, ScalarMappable | None, str]:
    """Colours [blocks, 4] with the mappable and the label of their colour bar, if there is one."""
    if color == "material":
        palette = np.array([to_rgba(c) for c in layers.PALE_COLORS])
        return palette[run.blocks["material"] % len(palette)], None, ""
    if color in ("none", "joint_state"):
        return _same(run, PLAIN), None, ""
    if color == "rotation":
        values, unit, cmap, scale = np.degrees(run.rotation(frame)), "deg", "PuOr", 60.0
    elif color == "velocity":
        values, unit, cmap, scale = np.hypot(*run.velocity(frame).T), "m/s", MOVED, layers.block_size(run)
    else:
        values, unit, cmap, scale = np.hypot(*run.displacement(frame).T), "m", MOVED, layers.block_size(run)
    shown = ~run.blocks["held"].astype(bool) & ~run.removed(frame)
    largest = float(np.abs(values[shown]).max(initial=0.0))
    if largest <= STILL * scale:  # rounding only: its pattern means nothing
        return _same(run, PLAIN), None, ""
    factor, unit = layers.prefix(largest, unit)
    top = largest * factor
    mappable = ScalarMappable(Normalize(-top if color == "rotation" else 0.0, top), cmap)
    return mappable.to_rgba(values * factor), mappable, f"{color} in {unit}"


def _same(run: Run, color: str) -> np.ndarray:
    return np.tile(to_rgba(color), (run.block_count, 1))


def _material_handles(run: Run) -> list[Patch]:
    return [Patch(facecolor=layers.PALE_COLORS[k % len(layers.PALE_COLORS)], edgecolor=layers.EDGE, linewidth=0.4,
                  label=f"{run.material_names[k]} ({np.sum(run.blocks['material'] == k)})")
            for k in np.unique(run.blocks["material"])]


def _page(run: Run, geometries: list[Geometry]) -> tuple[Figure, list[Axes]]:
    """A figure as large as what it shows needs, with one axes for each geometry, all with the same limits."""
    corners = np.concatenate([_seen(run, geometry) for geometry in geometries])
    low, high = corners.min(axis=0), corners.max(axis=0)
    margin = 0.03 * (high - low).max()
    width, height = high - low + 2 * margin
    inches = min(9.5 / (width * len(geometries)), 7.0 / height)
    size = (max(inches * width * len(geometries) + 1.4, 4.5), max(inches * height + 1.3, 2.6))
    figure = Figure(figsize=size, dpi=150)
    axes = figure.subplots(1, len(geometries), squeeze=False, sharey=True)[0]
    for ax in axes:
        ax.set(aspect="equal", xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin), xlabel="x in m")
        ax.tick_params(width=0.5, length=3)
        ax.ticklabel_format(useOffset=False, style="plain")  # map coordinates in full: whoever reads them looks there
        ax.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("y in m")
    return figure, list(axes)


def _seen(run: Run, geometry: Geometry) -> np.ndarray:
    present = ~run.removed(geometry.frame)[run.corner_block]
    return np.concatenate(geometry.polygons)[present] if present.any() else np.concatenate(geometry.polygons)


def _moment(run: Run, geometry: Geometry) -> str:
    shown = run.block_count - int(run.removed(geometry.frame).sum())
    words = [f"t = {layers.quantity(run.times[geometry.frame], 's', 4)}", f"{shown:,} blocks"]
    if geometry.exaggerate != 1:
        words.append(f"movements drawn {geometry.exaggerate:g} times as large")
    if run.status not in ("", "complete"):
        words.append(run.status)
    return " · ".join(words)


def _finish(figure: Figure, run: Run, handles: list) -> None:
    figure.suptitle("\n".join(textwrap.wrap(run.title, int(11 * figure.get_figwidth()))), x=0.01, ha="left", fontsize=11,
                    fontweight="bold")
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=min(len(handles), max(2, int(figure.get_figwidth() / 1.7))))
    ConstrainedLayoutEngine().execute(figure)  # once; as the figure's own engine it would draw everything twice
