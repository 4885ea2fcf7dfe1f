"""Results as pandas, xarray and PyVista objects. Each package is loaded when it is asked for, and need not be there."""

from __future__ import annotations

import importlib
from types import ModuleType
from typing import TYPE_CHECKING, Any, Iterable

import numpy as np

from talus_lab import fields
from talus_lab.errors import ResultError, nearest
from talus_lab.fields import Field, Kinds
from talus_lab.run import JOINT_STATES, Run

if TYPE_CHECKING:
    import pandas
    import pyvista
    import xarray

TABLES = ("blocks", "contacts", "energies", "history")
# methods of a Run that give an array for a frame, and their units
ARRAYS = {"position": "m", "angle": "rad", "displacement": "m", "rotation": "rad", "velocity": "m/s", "removed": "1",
          "unbalanced_force": "N"}


def to_pandas(run: Run, table: str, frame: int = -1, name: str = "") -> pandas.DataFrame:
    """See Run.to_pandas."""
    pandas = _package("pandas")
    if table == "blocks":
        columns, units = _blocks(run, frame)
    elif table == "contacts":
        columns = dict(run.contacts(frame))
        units = {column: run.unit(f"contacts/{column}") for column in columns}
        if columns:
            columns |= {"state": _named(columns["state"], JOINT_STATES), "joint": _named(columns["joint"], run.joint_names)}
            units |= {"state": "-", "joint": "-"}
    elif table == "energies":
        columns = {"time": run.times, **run.energies}
        units = {"time": "s"} | {column: run.unit(f"energies/{column}") for column in run.energies}
    elif table == "history":
        columns = dict(run.history(name))
        units = {column: run.unit(f"histories/{name}/{column}") for column in columns}
    else:
        raise ResultError(f"no table is called {table}{nearest(table, TABLES)}")
    made = pandas.DataFrame({column: np.array(values) for column, values in columns.items()})  # copies: a DataFrame may be changed
    made.attrs["units"] = units
    if table in ("energies", "history"):
        return made.set_index("time")
    made.index.name = table.removesuffix("s")
    return made


def to_xarray(run: Run, names: Iterable[str] = ("position", "angle"), frames: Iterable[int] | None = None) -> xarray.Dataset:
    """See Run.to_xarray."""
    xarray = _package("xarray")
    chosen = list(range(run.frame_count) if frames is None else frames)
    data: dict[str, Any] = {}
    for name in names:
        if name not in ARRAYS and name not in fields.FIELDS:
            raise ResultError(f"no array is called {name}{nearest(name, dict.fromkeys((*ARRAYS, *fields.FIELDS)))}")
        each = [getattr(run, name)(k) if name in ARRAYS else fields.values(run, name, k) for k in chosen]
        values = np.stack(each) if each else np.empty((0, run.block_count))
        unit = ARRAYS.get(name) or fields.field(name).unit
        data[name] = (("frame", "block", "axis")[: values.ndim], values, {"unit": unit})
    coordinates = {"frame": chosen, "time": ("frame", np.array([run.times[k] for k in chosen]), {"unit": "s"}),
                   "block": np.arange(run.block_count), "axis": ["x", "y"]}
    return xarray.Dataset(data, coordinates, {"title": run.title, "path": str(run.path)})


def to_pyvista(run: Run, frame: int = -1) -> pyvista.PolyData:
    """See Run.to_pyvista."""
    pyvista = _package("pyvista")
    corners = run.corners(frame)
    count = np.diff(run.first_corner)
    faces = np.insert(np.arange(len(corners)), run.first_corner[:-1], count)
    mesh = pyvista.PolyData(np.column_stack([corners, np.zeros(len(corners))]), faces=faces)
    for name, values in cell_data(run, frame).items():
        mesh.cell_data[name] = values
    mesh.field_data["time"] = [run.times[frame]]
    return mesh


def cell_data(run: Run, frame: int) -> dict[str, np.ndarray]:
    """[parts] or [parts, 3] each: the fields of the block to which a convex part belongs, SI but for rotation_deg."""
    by_block = {"block_id": np.arange(run.block_count)}
    by_block |= {name: run.blocks[name] for name in ("material", "region", "held") if name in run.blocks}
    by_block |= {"displacement": _spatial(run.displacement(frame)), "velocity": _spatial(run.velocity(frame)),
                 "rotation_deg": np.degrees(run.rotation(frame)), "removed": run.removed(frame).astype(np.uint8)}
    if run.contacts(frame):
        by_block |= {name: fields.values(run, name, frame) for name in ("stress_major", "stress_minor")}
    if "block_mechanism" in run.verdict:
        by_block["mechanism"] = run.verdict["block_mechanism"]
    return {name: np.ascontiguousarray(np.asarray(values)[run.part_block]) for name, values in by_block.items()}


def _blocks(run: Run, frame: int) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """What does not change, where the blocks are, and every field that this result has."""
    x, y = run.position(frame).T
    columns: dict[str, np.ndarray] = {"name": run.blocks["name"], "x": x, "y": y, "mass": run.blocks["mass"],
                                      "held": run.blocks["held"].astype(bool), "removed": run.removed(frame)}
    units = {"name": "-", "x": "m", "y": "m", "mass": "kg", "held": "1", "removed": "1"}
    for name, field in fields.FIELDS.items():
        try:
            values = fields.values(run, name, frame)
        except ResultError:
            continue  # this result does not have it
        columns[name] = _named(values, field.names(run)) if isinstance(field, Kinds) else values
        units[name] = field.unit if isinstance(field, Field) else "-"
    return columns, units


def _named(index: np.ndarray, names: Iterable[str]) -> np.ndarray:
    return np.array([*names, ""], dtype=object)[index]  # -1, none, is the last


def _spatial(vectors: np.ndarray) -> np.ndarray:
    return np.column_stack([vectors, np.zeros(len(vectors), vectors.dtype)])


def _package(name: str) -> ModuleType:
    try:
        return importlib.import_module(name)
    except ImportError:
        raise ResultError(f"this needs the package {name}, which is not installed: pip install {name}") from None
