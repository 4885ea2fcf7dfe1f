"""Runs a scene with a method: talus, or another program through files, see docs/runners.md."""

from __future__ import annotations

import json
import shutil
import sys
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from talus_lab.chart.config import Config, Error, Method, Setting, figure_of, key_text, keys_of
from talus_lab.chart.exchange import call, cut, scene_json, sets, start_velocity
from talus_lab.chart.motion import Motion, motion_of_json, motion_of_run
from talus_lab.chart.values import Look
from talus_lab.run import ResultError, Run, open_run


@dataclass(frozen=True)
class Done:
    motion: Motion
    cpu_time: float  # s, per second of the scene


def command_of(method: Method, talus: str) -> list[str] | None:
    """The words that start another program; None if it is not to be had. A program may lie beside talus; `python` is this one."""
    first, *rest = map(str, method.command)
    if first == "python":
        return [sys.executable, *rest]
    found = shutil.which(Path(talus).with_name(first)) or shutil.which(first)
    return [found, *rest] if found else None


class Prepared:
    """A scene of a config whose blocks have been cut, once for all methods. Lives as long as its folder."""

    def __init__(self, config: Config, name: str, talus: str, folder: str) -> None:
        self.config, self.name, self.talus, self.folder = config, name, talus, Path(folder)
        self.scene = config.scenes[name]

    @cached_property
    def _cut(self) -> tuple[Run, dict]:
        keys = {path: key_text(value, {}) for path, value in self.scene.keys.items()}
        return cut(self.talus, self.config.scenario(self.name), keys, self.folder)

    @property
    def blocks(self) -> Run:
        return self._cut[0]

    @property
    def seconds(self) -> float:
        return self.config.share * self._cut[1]["run"]["until"]["time"]

    def as_json(self, setting: Setting) -> dict:
        return scene_json(*self._cut, self.scene.frames, {**self.scene.given, **setting}, self.config.share)

    def look(self, error: Error) -> Look:
        table = self.blocks.blocks
        direction = None
        if error.direction_deg is not None:
            turned = np.radians(figure_of(error.direction_deg))
            direction = np.array([np.cos(turned), np.sin(turned)])
        return Look(self._chosen(error.blocks), table["mass"], table["inertia"], start_velocity(*self._cut), direction, figure_of(error.tilt))

    def run(self, method: str, setting: Setting, states: bool = True) -> Done:
        """states: with those between start and end; without them the clock is not disturbed. Raises ResultError."""
        described = self.config.methods[method]
        with TemporaryDirectory(dir=self.folder) as folder:
            return self._talus(method, setting, Path(folder), states) if described.ours else self._other(described, setting, Path(folder))

    def _talus(self, method: str, setting: Setting, folder: Path, states: bool) -> Done:
        frames = self.scene.frames if states else 1
        keys = {**keys_of(self.config, self.name, method, setting), "record": f"{{frames: {{count: {frames}}}, contacts: false}}", "expect": "[]"}
        if self.config.share < 1.0 and "run.until" not in keys:  # which says that it does not end by time
            keys["run.until.time"] = format(self.seconds, ".10g")
        out = folder / "run.h5"
        call([self.talus, "run", str(self.config.scenario(self.name)), "-o", str(out), *sets(keys)], self.config.limit_s)
        run = open_run(out)
        if run.status != "complete" or "cpu_time" not in run.attributes:
            raise ResultError(run.status if run.status != "complete" else f"{self.talus} is too old: it does not say its CPU time")
        return Done(motion_of_run(run), float(run.attributes["cpu_time"]) / self.seconds)

    def _other(self, method: Method, setting: Setting, folder: Path) -> Done:
        scene, result = folder / "scene.json", folder / "result.json"
        scene.write_text(json.dumps(self.as_json(setting)), encoding="utf-8")
        call([*command_of(method, self.talus), str(scene), str(result)], self.config.limit_s)
        try:
            given = json.loads(result.read_text(encoding="utf-8"))
            return Done(motion_of_json(given, self.blocks.block_count), float(given["cpu_time"]) / self.seconds)
        except (OSError, json.JSONDecodeError, KeyError, TypeError, ValueError) as error:
            raise ResultError(f"no result: {error}") from None

    def _chosen(self, blocks: str) -> np.ndarray:
        table = self.blocks.blocks
        names = np.array([str(name).partition("[")[0] for name in table["name"]])
        free = ~table["held"].astype(bool)
        if blocks == "free":
            chosen = free
        elif blocks in self.blocks.region_names:
            chosen = free & (table["region"] == self.blocks.region_names.index(blocks))
        else:
            chosen = (table["name"] == blocks) | (names == blocks)
        if not chosen.any():
            raise ResultError(f"{self.scene.scenario}: no block or region is called {blocks}")
        return np.flatnonzero(chosen)
