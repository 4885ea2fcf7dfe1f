"""How pictures look. Colours are Okabe and Ito's, which colour-blind people can tell apart; what matters differs in a second way too, by
hatch, mark or dashes, for prints in black and white."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from talus_lab.errors import ResultError

WIDTH_CM = 12.0  # letters of 9 points are 6 points high when a picture is printed 8 cm wide; at half they would drown the picture
DPI = 250
CM = 1 / 2.54
FORMATS = (".png", ".svg", ".pdf")
STYLE = {"font.size": 9, "font.family": "sans-serif", "axes.linewidth": 0.6, "axes.edgecolor": "#808080", "hatch.linewidth": 0.5,
         "xtick.color": "#404040", "ytick.color": "#404040", "legend.frameon": False, "legend.fontsize": 8.5,
         "figure.facecolor": "white", "axes.facecolor": "white", "svg.fonttype": "none", "pdf.fonttype": 42}
PLAIN = "#ece7dc"
EDGE = "#262626"
HELD = dict(facecolor="#d9d9d9", edgecolor="#8c8c8c", hatch="////")
STATE_COLORS = dict(elastic="#9a9a9a", sliding="#d55e00", slipped="#e69f00", bonded="#0072b2", broken="#cc79a7")
NAME_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
PALE_COLORS = ("#e8dcc4", "#c9d8e6", "#d6e4c8", "#ead1dc", "#d9d2e9", "#f4e3b2", "#cfe5e2")
DASHES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (8, 2)), (0, (1, 1)))
MARKS = ("o", "s", "^", "D", "v", "P", "X")
MOVED = LinearSegmentedColormap.from_list("moved", matplotlib.colormaps["YlGnBu"]([k / 255 * 0.85 + 0.03 for k in range(256)]))
SIGNED = "PuOr"


@dataclass(frozen=True)
class Mode:
    """How one mode of failure is shown: the colour of its face, the hatch of its blocks, the mark of its cases."""

    color: str
    hatch: str
    mark: str


# A column of names: stable and still are the same, seen from a slope and from one of its blocks.
MODES = {
    "stable": Mode("#ece7dc", "", "."), "still": Mode("#ece7dc", "", "."), "none": Mode("#ece7dc", "", "."),
    "slide": Mode("#56b4e9", "----", "s"), "topple": Mode("#e69f00", "\\\\\\\\", "^"), "slide and topple": Mode("#009e73", "xxxx", "D"),
    "fall": Mode("#cc79a7", "....", "v"), "rotation": Mode("#f0e442", "oo", "P"), "unstable": Mode("#d55e00", "++", "X"),
    "undecided": Mode("#ffffff", "", "$?$"), "failed": Mode("#b0b0b0", "", "x"),
}


def check_format(path: Path) -> None:
    """Before anything is computed. Raises ResultError."""
    if path.suffix.lower() not in FORMATS:
        raise ResultError(f"{path}: pictures are written as {', '.join(FORMATS)}")
    if not path.absolute().parent.is_dir():
        raise ResultError(f"{path}: there is no folder {path.parent}")


def save(figure: Figure, path: Path, dpi: int = DPI) -> None:
    """The whole picture, or what was there before. Raises ResultError if it cannot be written."""
    beside = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        figure.savefig(beside, dpi=dpi)
        beside.replace(path)
    except OSError as error:
        raise ResultError(f"{path}: {error.strerror}") from None
    finally:
        beside.unlink(missing_ok=True)
