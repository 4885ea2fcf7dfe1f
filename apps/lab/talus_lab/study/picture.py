"""What charts of studies have in common. Colours are Okabe and Ito's, which colour-blind people can tell apart; marks tell them apart
in print."""

from __future__ import annotations

from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from PIL import Image


def finish(figure: Figure, columns: int) -> Figure:
    """One legend for all panels, below them."""
    handles = {}
    for ax in figure.axes:
        handles |= {text: handle for handle, text in zip(*ax.get_legend_handles_labels())}
    figure.legend(handles.values(), handles, loc="outside lower center", ncols=min(len(handles), columns))
    ConstrainedLayoutEngine().execute(figure)
    return figure


def line(ax: Axes, x: list, y: list, text: str, color: str, mark: str, dashes: str, strong: bool) -> None:
    ax.plot(x, y, color=color, marker=mark, linestyle=dashes, label=text, linewidth=2.0 if strong else 1.2,
            markersize=7 if mark == "*" else 4.5, zorder=3 if strong else 2)


def bare(ax: Axes, title: str) -> None:
    """Title, faint grid, two sides of the frame."""
    ax.set_title(title, loc="left", fontsize=9)
    ax.grid(True, which="major", color="#e0e0e0", linewidth=0.5)
    ax.spines[["top", "right"]].set_visible(False)


def save_small(figure: Figure, path: Path, colors: int = 64) -> None:
    """As PNG of few colours: a third of the size, and nothing to be seen of it. Pictures with a colour bar need 200."""
    figure.savefig(path)
    with Image.open(path) as picture:
        small = picture.convert("RGB").quantize(colors)
    small.save(path, optimize=True)
