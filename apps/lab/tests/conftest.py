"""A small result in the layout of docs/results-format.md: a held floor, a square that slides on it, and an L of two parts."""

from pathlib import Path

import h5py
import numpy as np
import pytest

ORIGIN = np.array([1000.0, 2000.0])
TIMES = np.array([0.0, 0.5, 1.0])
SLIDE = np.array([0.0, 0.1, 0.4])  # m, of the square along x, by frame
UNITS = {"frames/time": "s", "frames/position": "m", "blocks/area": "m2", "blocks/mass": "kg", "blocks/start": "m", "energies/kinetic": "J",
         "contacts/x": "m", "contacts/normal_force": "N", "histories/slide/time": "s", "histories/slide/x": "m", "histories/slide/a": "s"}
TURN = np.array([0.0, 0.0, np.pi / 2])  # rad, of the L, by frame


def write_result(path: Path, frames: int = 3) -> Path:
    arms = [  # by part; the L is centred on its inner corner here, which nobody minds
        [(-5, -0.5), (5, -0.5), (5, 0.5), (-5, 0.5)],
        [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)],
        [(-1, -1), (1, -1), (1, 0), (-1, 0)],
        [(-1, 0), (0, 0), (0, 1), (-1, 1)],
    ]
    start = np.array([[0.0, -0.5], [0.0, 0.5], [3.0, 1.0]])
    part_block = np.array([0, 1, 2, 2], np.int32)
    first_corner = np.arange(0, 17, 4, dtype=np.int32)
    internal = np.zeros(16, np.uint8)
    internal[[10, 12]] = 1
    position = np.repeat(start[None], len(TIMES), axis=0)
    position[:, 1, 0] += SLIDE
    angle = np.zeros((len(TIMES), 3))
    angle[:, 2] = TURN
    with h5py.File(path, "w") as f:
        talus = f.create_group("talus")
        talus.attrs.update(schema_version=1, title=np.bytes_("A square that slides"), origin=ORIGIN, status=np.bytes_("complete"))
        talus["scenario"] = np.bytes_("title: A square that slides\n")
        talus["blocks/name"] = np.array(["floor", "square", ""], "S6")
        talus["blocks/start"] = start
        talus["blocks/area"] = np.array([10.0, 1.0, 3.0])
        talus["blocks/mass"] = np.array([10.0, 1.0, 3.0])
        talus["blocks/material"] = np.zeros(3, np.int32)
        talus["blocks/region"], talus["regions/name"] = np.array([-1, 0, 1], np.int32), np.array(["face", "back"], "S4")
        talus["blocks/held"] = np.array([1, 0, 0], np.uint8)
        talus["blocks/first_part"] = np.array([0, 1, 2, 4], np.int32)
        talus["materials/name"] = np.array(["granite"], "S7")
        talus["joints/name"] = np.array(["rough", "bedding"], "S7")
        talus["parts/block"], talus["parts/first_corner"] = part_block, first_corner
        talus["corners/arm"], talus["corners/internal"] = np.concatenate(arms).astype(float), internal
        talus["frames/time"], talus["frames/position"], talus["frames/angle"] = TIMES, position, angle
        talus["frames/removed"] = np.zeros((3, 3), np.uint8)
        talus["energies/kinetic"] = np.array([0.0, 1.0, 2.0])
        talus["histories/slide/time"], talus["histories/slide/x"], talus["histories/slide/a"] = TIMES, SLIDE, TIMES
        talus["histories/slide"].attrs["columns"] = np.array(["x", "a"], "S1")
        columns = dict(block_a=[0, 0, 0], block_b=[1, 1, 2], part_a=[0, 0, 0], part_b=[1, 1, 2], joint=[0, 0, 1],
                       x=[0.0, 0.1, 3.0], y=[0.0, 0.0, 0.0], nx=[0, 0, 0], ny=[1, 1, 1], normal_force=[10.0, 20.0, 30.0],
                       shear_force=[0.0, 5.0, 0.0], normal_stress=[1.0, 2.0, 3.0], shear_stress=[0.0, 0.5, 0.0],
                       opening=[0.0, 0.0, 0.1], slip=[0.0, 0.4, 0.0], utilisation=[0.0, 1.0, 0.0], length=[1.0, 1.0, 2.0], state=[0, 1, 5])
        for name, column in columns.items():
            talus[f"contacts/{name}"] = np.array(column, np.uint8 if name == "state" else None)
        talus["contacts/first_row"], talus["contacts/row_count"] = np.array([0, 0, 1]), np.array([0, 1, 2])
        f.create_group("VTKHDF/Steps").attrs["NSteps"] = frames
        moved, speed = np.zeros((2, 3, 3, 3), np.float32)
        moved[:, 1, 0], speed[:, 1, 0] = SLIDE, [0.0, 0.5, 0.8]
        turned = np.zeros((3, 3), np.float32)
        turned[:, 2] = TURN
        f["VTKHDF/CellData/displacement"] = moved[:, part_block].reshape(-1, 3)
        f["VTKHDF/CellData/velocity"] = speed[:, part_block].reshape(-1, 3)
        f["VTKHDF/CellData/unbalanced_force"] = np.tile(np.array([0, 7, 0, 0], np.float32), 3)
        f["VTKHDF/CellData/rotation"] = turned[:, part_block].ravel()
        for name, unit in UNITS.items():
            talus[name].attrs["unit"] = np.bytes_(unit)
    return path


def tell(path: Path, verdict: str = "unstable", mechanism: str = "slide and topple", **more) -> Path:
    """The verdict of the engine, added to a result: the square slides, the L topples."""
    with h5py.File(path, "a") as f:
        group = f.create_group("talus/verdict")
        group.attrs.update(verdict=np.bytes_(verdict), mechanism=np.bytes_(mechanism), **more)
        group["block_mechanism"] = np.array([0, 1, 2], np.uint8)
    return path


@pytest.fixture
def result(tmp_path: Path) -> Path:
    return write_result(tmp_path / "slide.h5")
