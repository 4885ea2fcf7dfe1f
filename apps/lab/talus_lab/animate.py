"""Moving pictures of a run. What does not move, axes, colour bar and legend, is drawn once; each frame only what moves."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Sequence

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable

from talus_lab import fields, forces, layers
from talus_lab.colors import BlockColors, Scale, block_colors, check_color, field_scale
from talus_lab.errors import ResultError
from talus_lab.fields import Field
from talus_lab.layers import Geometry
from talus_lab.movie import movie
from talus_lab.plot import caption, color_bar, finish, moment, page
from talus_lab.run import Run
from talus_lab.style import STYLE, WIDTH_CM

DPI = 200
LOOKED_AT = 40  # frames from which limits, colours and the largest force are taken; reading all of a long run would take as long as drawing

Progress = Callable[[int, int], None]  # frames done, of how many


@dataclass(frozen=True)
class Shown:
    """What is drawn; as the arguments of plot.picture."""

    color: str = "displacement"
    forces: bool = False
    joints: bool = False
    stress: bool = False
    outline: bool = False
    exaggerate: float = 1.0


def animate(run: Run, output: Path, shown: Shown = Shown(), frames: Sequence[int] | None = None, rate: float = 10.0,
            width_cm: float = WIDTH_CM, dpi: int = DPI, progress: Progress = lambda done, of: None) -> None:
    """Writes a .gif or .mp4 of `frames` (default: all), `rate` of them per second. Raises ResultError."""
    frames = list(range(run.frame_count) if frames is None else frames)
    if not frames:
        raise ResultError(f"{run.path}: there are no frames to draw")
    check_color(run, shown.color, shown.forces or shown.joints or shown.stress)
    seen = [frames[k] for k in np.unique(np.linspace(0, len(frames) - 1, min(LOOKED_AT, len(frames))).round().astype(int))]
    with matplotlib.rc_context(STYLE), movie(output, rate) as write:
        stage = _Stage(run, shown, seen, width_cm, dpi)
        for done, frame in enumerate(frames):
            progress(done, len(frames))
            write(stage.draw(frame))
        progress(len(frames), len(frames))


class _Stage:
    """The figure, with its still parts painted."""

    def __init__(self, run: Run, shown: Shown, seen: list[int], width_cm: float, dpi: int) -> None:
        self.run, self.shown = run, shown
        self.start = Geometry(run, 0, shown.exaggerate)
        self.scale = self._scale(seen)
        self.largest_force = max((forces.largest_force(run, k) for k in seen), default=0.0) if shown.forces else 0.0
        self.largest_stress = max((forces.largest_stress(run, k) for k in seen), default=0.0) if shown.stress else 0.0
        ends = [Geometry(run, k, shown.exaggerate) for k in (seen[0], seen[len(seen) // 2], seen[-1])]
        self.figure, (self.ax,) = page(run, ends[-1:], width_cm, self.scale is not None, ends)
        self.figure.set_dpi(dpi)
        self.canvas = FigureCanvasAgg(self.figure)
        self._explain(seen)
        self.still = self.canvas.copy_from_bbox(self.figure.bbox)

    def draw(self, frame: int) -> np.ndarray:
        """[height, width, 3] pixels of a frame."""
        self.canvas.restore_region(self.still)
        before = set(self.ax.collections)
        geometry = Geometry(self.run, frame, self.shown.exaggerate)
        self._layers(geometry)
        moving = sorted((artist for artist in self.ax.collections if artist not in before), key=lambda artist: artist.get_zorder())
        self.caption.set_text(moment(self.run, geometry, []))
        for artist in [*moving, self.caption]:
            self.ax.draw_artist(artist)
        for artist in moving:
            artist.remove()
        return np.asarray(self.canvas.buffer_rgba())[..., :3].copy()

    def _layers(self, geometry: Geometry) -> list:
        """Paints what moves; returns the legend's entries."""
        run, shown, ax = self.run, self.shown, self.ax
        colors = self._colors(geometry.frame)
        layers.draw_blocks(ax, run, geometry, colors.faces, colors.hatches)
        handles = colors.handles
        if shown.joints or shown.color == "joint_state":
            handles = handles + layers.draw_joints(ax, run, geometry, "state")
        if shown.forces:
            handles = handles + forces.draw_forces(ax, run, geometry, self.largest_force)
        if shown.stress:
            handles = handles + forces.draw_stress(ax, run, geometry, self.largest_stress)
        if shown.outline:
            handles = handles + layers.draw_outline(ax, run, self.start, "at the start")
        return handles

    def _colors(self, frame: int) -> BlockColors:
        if self.scale is None:
            return block_colors(self.run, frame, self.shown.color if self.kinds else "none")
        return BlockColors(self.scale.faces(fields.values(self.run, self.shown.color, frame)))

    def _scale(self, seen: list[int]) -> Scale | None:
        """One scale for all frames."""
        self.kinds = self.shown.color not in fields.FIELDS or not isinstance(fields.field(self.shown.color), Field)
        if self.kinds:
            return None
        free = ~self.run.blocks["held"].astype(bool)
        values = [fields.values(self.run, self.shown.color, k)[free & ~self.run.removed(k)] for k in seen]
        return field_scale(self.run, fields.field(self.shown.color), np.concatenate(values))

    def _explain(self, seen: list[int]) -> None:
        """Title, axes, colour bar and a legend of what occurs in any of the frames looked at; numbers that change are left out."""
        handles = {}
        for frame in dict.fromkeys([seen[0], seen[len(seen) // 2], seen[-1]]):
            for handle in self._layers(Geometry(self.run, frame, self.shown.exaggerate)):
                handle.set_label(handle.get_label().partition(" (")[0])
                handles.setdefault(handle.get_label().partition(",")[0], handle)
        for artist in list(self.ax.collections):
            artist.remove()
        if self.scale is not None:
            mappable = ScalarMappable(self.scale.norm, self.scale.cmap)
            color_bar(self.figure, [self.ax], BlockColors(np.empty((0, 4)), mappable, self.scale.label, self.scale.extend))
        self.caption = caption(self.ax, " ", self.figure.get_figwidth())
        finish(self.figure, self.run.title, [layers.held_handle()] * bool(self.run.blocks["held"].any()) + list(handles.values()))
        self.canvas.draw()
