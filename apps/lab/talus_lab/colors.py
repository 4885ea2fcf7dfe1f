"""What colours the blocks of a picture."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize, to_rgba
from matplotlib.patches import Patch

from talus_lab import fields
from talus_lab.errors import ResultError, nearest
from talus_lab.fields import Field, Kinds
from talus_lab.layers import block_size
from talus_lab.run import Run
from talus_lab.style import EDGE, MODES, MOVED, PALE_COLORS, PLAIN, SIGNED
from talus_lab.units import axis_label, prefix

COLORS = (*fields.FIELDS, "joint_state", "none")
MOST = 98  # per cent of the blocks within the colours of a field with outliers; 100 would leave one dark block among pale ones


@dataclass(frozen=True)
class BlockColors:
    """How blocks are filled, and what explains it."""

    faces: np.ndarray  # [blocks, 4]
    mappable: ScalarMappable | None = None  # of the colour bar
    label: str = ""
    extend: str = "neither"  # ends of the bar beyond which there are values
    handles: list[Patch] = field(default_factory=list)
    hatches: dict[str, np.ndarray] = field(default_factory=dict)  # hatch -> blocks
    note: str = ""


@dataclass(frozen=True)
class Scale:
    """From the values of a field to colours, the same for all frames of an animation."""

    norm: Normalize
    cmap: object
    factor: float
    label: str
    extend: str = "neither"

    def faces(self, values: np.ndarray) -> np.ndarray:
        """[blocks, 4]; blocks without a value are plain."""
        faces = ScalarMappable(self.norm, self.cmap).to_rgba(values * self.factor)
        faces[np.isnan(values)] = to_rgba(PLAIN)
        return faces


def check_color(run: Run, color: str, contacts: bool) -> None:
    """Raises ResultError if blocks cannot be coloured by `color`, or if contacts are wanted and not there."""
    if color not in COLORS:
        raise ResultError(f"nothing is coloured by {color}{nearest(color, COLORS)}")
    if contacts and not run.contacts(-1):
        raise ResultError(f"{run.path}: has no contacts; the scenario says record: {{contacts: false}}")


def block_colors(run: Run, frame: int, color: str) -> BlockColors:
    """color: one of COLORS. Raises ResultError if the result lacks what it needs."""
    if color in ("none", "joint_state"):
        return plain(run)
    found = fields.field(color)
    values = fields.values(run, color, frame)
    if isinstance(found, Kinds):
        return _kinds(run, frame, color, found, values)
    scale = field_scale(run, found, values[_shown(run, frame)])
    if scale is None:  # rounding only: its pattern means nothing
        return BlockColors(plain(run).faces, note="nothing moves" if found.still else "")
    return BlockColors(scale.faces(values), ScalarMappable(scale.norm, scale.cmap), scale.label, scale.extend)


def plain(run: Run) -> BlockColors:
    return BlockColors(np.tile(to_rgba(PLAIN), (run.block_count, 1)))


def field_scale(run: Run, found: Field, values: np.ndarray) -> Scale | None:
    """Colours for values [n] of a field; None if there is nothing but rounding errors."""
    values = values[~np.isnan(values)]
    size = np.abs(values)
    limit = found.still * (block_size(run) if found.unit in ("m", "m/s") else 1.0)
    if not len(values) or size.max() <= limit or not np.isfinite(size.max()):
        return None
    largest = float(np.percentile(size, MOST) if found.robust else size.max()) or float(size.max())
    factor, unit = prefix(largest, found.unit)
    top, both = largest * factor, found.signed or values.min() < -0.02 * largest
    beyond = found.robust and size.max() > largest
    extend = "neither" if not beyond else "both" if both and values.min() < -largest else "max" if values.max() > largest else "min"
    return Scale(Normalize(-top if both else 0.0, top), SIGNED if both else MOVED, factor, axis_label(found.label, unit), extend)


def _shown(run: Run, frame: int) -> np.ndarray:
    return ~run.blocks["held"].astype(bool) & ~run.removed(frame)


def _kinds(run: Run, frame: int, color: str, found: Kinds, kind: np.ndarray) -> BlockColors:
    names = list(found.names(run))
    shown = ~run.removed(frame) & ((~run.blocks["held"].astype(bool)) if color == "mechanism" else True)
    modes = [MODES[name] for name in names] if color == "mechanism" else None
    palette = [mode.color for mode in modes] if modes else [PALE_COLORS[k % len(PALE_COLORS)] for k in range(len(names))]
    faces = np.array([to_rgba(c) for c in [*palette, PLAIN]])[kind]  # -1, no kind, is the last one
    there = [k for k in np.unique(kind[shown]) if k >= 0]
    handles = [Patch(facecolor=palette[k], edgecolor=EDGE, linewidth=0.4, hatch=modes[k].hatch if modes else None,
                     label=f"{names[k]} ({np.sum(shown & (kind == k)):,})") for k in there]
    hatches = {modes[k].hatch: np.flatnonzero(shown & (kind == k)) for k in there if modes[k].hatch} if modes else {}
    return BlockColors(faces, handles=handles, hatches=hatches)
