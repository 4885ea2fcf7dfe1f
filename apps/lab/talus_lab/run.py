"""A result file as numpy arrays.

Everything is SI (angles in rad), in the coordinates of the scenario, and read-only. Layout: docs/results-format.md.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Iterable, Iterator, Mapping

import h5py
import numpy as np

from talus_lab.arrays import Columns, frozen, placed, plain, texts
from talus_lab.errors import ResultError, nearest

if TYPE_CHECKING:
    import pandas
    import pyvista
    import xarray

SCHEMA_VERSION = 1
JOINT_STATES = ("elastic", "sliding", "slipped", "bonded", "broken", "open")  # values of the contact column `state`
MECHANISMS = ("still", "slide", "topple", "slide and topple", "fall", "rotation")  # values of block_mechanism of the verdict


def open_run(path: str | Path) -> Run:
    """Opens a result file, also while talus is still writing it. Raises ResultError."""
    path = Path(path)
    try:
        with h5py.File(path, "r", locking=False) as file:
            version = file["talus"].attrs["schema_version"]
            if version != SCHEMA_VERSION:
                raise ResultError(f"{path}: version {version} of the results format; this program reads {SCHEMA_VERSION}")
            return Run(path, int(file["VTKHDF/Steps"].attrs["NSteps"]))
    except FileNotFoundError:
        raise ResultError(f"{path}: no such file") from None
    except OSError as error:
        raise ResultError(f"{path}: is not an HDF5 file or is damaged ({error})") from None
    except KeyError:
        raise ResultError(f"{path}: is not a result of talus") from None


@dataclass(frozen=True)
class Run:
    """One result, as it was when it was opened; nothing is read before it is asked for.

    `frame` is 0 .. frame_count - 1, or negative to count from the end.
    """

    path: Path
    frame_count: int  # complete frames; what lies behind them in the file is unfinished

    # What was run
    @cached_property
    def attributes(self) -> Mapping[str, object]:
        """Provenance: title, source, scenario_file, talus_version, status, time_step, ..."""
        with self._file() as file:
            return MappingProxyType({name: plain(value) for name, value in file["talus"].attrs.items()})

    @property
    def title(self) -> str:
        return str(self.attributes.get("title") or self.path.stem)

    @property
    def status(self) -> str:
        """in progress (also after a kill) | complete | interrupted | diverged | stopped | refused"""
        return str(self.attributes.get("status", ""))

    @cached_property
    def scenario(self) -> str:
        """Text of the scenario file."""
        return str(plain(self._read("talus/scenario")[()]))

    @cached_property
    def origin(self) -> np.ndarray:
        """[2] m, what the file's coordinates are relative to; added to all coordinates given here."""
        return frozen(np.asarray(self.attributes["origin"], dtype=float))

    # Blocks and their shape
    @cached_property
    def blocks(self) -> Mapping[str, np.ndarray]:
        """[blocks] each: name, area [m2], mass [kg], inertia [kg m2], material, region, held, start [blocks, 2] m."""
        with self._file() as file:
            names = tuple(file["talus/blocks"])
        return Columns(names, self._block_column)

    @property
    def block_count(self) -> int:
        return len(self.blocks["mass"])

    @cached_property
    def material_names(self) -> tuple[str, ...]:
        return tuple(self._read("talus/materials/name").tolist())

    @cached_property
    def region_names(self) -> tuple[str, ...]:
        return tuple(self._read("talus/regions/name").tolist())

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        return tuple(self._read("talus/joints/name").tolist())

    @cached_property
    def part_block(self) -> np.ndarray:
        """[parts] block to which each convex part belongs."""
        return self._read("talus/parts/block")

    @cached_property
    def first_corner(self) -> np.ndarray:
        """[parts + 1] corners of part p are first_corner[p] .. first_corner[p + 1] - 1, counter-clockwise."""
        return self._read("talus/parts/first_corner")

    @cached_property
    def next_corner(self) -> np.ndarray:
        """[corners] where the edge ends that starts at each corner."""
        after = np.arange(self.first_corner[-1]) + 1
        after[self.first_corner[1:] - 1] = self.first_corner[:-1]
        return frozen(after)

    @cached_property
    def corner_block(self) -> np.ndarray:
        """[corners] block to which each corner belongs."""
        return frozen(np.repeat(self.part_block, np.diff(self.first_corner)))

    @cached_property
    def arm(self) -> np.ndarray:
        """[corners, 2] m, from the centroid of the block, unrotated."""
        return self._read("talus/corners/arm")

    @cached_property
    def internal(self) -> np.ndarray:
        """[corners] true if the edge that starts here lies between two parts of one block."""
        return frozen(self._read("talus/corners/internal").astype(bool))

    # Motion
    @cached_property
    def times(self) -> np.ndarray:
        """[frames] s"""
        return frozen(self._read("talus/frames/time")[: self.frame_count])

    def frame_at(self, time: float) -> int:
        """The frame nearest to a time in s; the last one of several, for a stage may set the clock back."""
        distance = np.abs(self.times - time)
        return int(np.flatnonzero(distance == distance.min())[-1])

    def position(self, frame: int) -> np.ndarray:
        """[blocks, 2] m, centroids."""
        return frozen(self._frame("talus/frames/position", frame) + self.origin)

    def angle(self, frame: int) -> np.ndarray:
        """[blocks] rad, turned since the scene was built."""
        return self._frame("talus/frames/angle", frame)

    def removed(self, frame: int) -> np.ndarray:
        """[blocks] true for blocks that a stage has deleted."""
        return frozen(self._frame("talus/frames/removed", frame).astype(bool))

    def displacement(self, frame: int) -> np.ndarray:
        """[blocks, 2] m, of the centroids since the start or the last reset (single precision)."""
        return self._block_field("displacement", frame)

    def rotation(self, frame: int) -> np.ndarray:
        """[blocks] rad, since the start or the last reset (single precision)."""
        return self._block_field("rotation", frame)

    def velocity(self, frame: int) -> np.ndarray:
        """[blocks, 2] m/s, of the centroids (single precision)."""
        return self._block_field("velocity", frame)

    def unbalanced_force(self, frame: int) -> np.ndarray:
        """[blocks] N per m, magnitude, along the axes that are free to move, without local damping (single precision)."""
        return self._block_field("unbalanced_force", frame)

    def corners(self, frame: int) -> np.ndarray:
        """[corners, 2] m, where the corners of all parts are."""
        return placed(self.arm, self.position(frame), self.angle(frame), self.corner_block)

    # Forces, energies, histories
    def contacts(self, frame: int) -> Mapping[str, np.ndarray]:
        """[contacts of this frame] each: block_a, block_b, joint, x, y [m], nx, ny, normal_force and shear_force [N per m],
        normal_stress, shear_stress [Pa], opening, slip, length [m], utilisation, state (index into JOINT_STATES).
        Empty if the scenario says so."""
        with self._file() as file:
            if "talus/contacts/first_row" not in file:
                return MappingProxyType({})
            group, k = file["talus/contacts"], self._index(frame)
            rows = slice(group["first_row"][k], group["first_row"][k] + group["row_count"][k])
            columns = {name: group[name][rows] for name in group if name not in ("first_row", "row_count")}
        for name, origin in zip("xy", self.origin):
            columns[name] = columns[name] + origin
        return MappingProxyType({name: frozen(column) for name, column in columns.items()})

    @cached_property
    def energies(self) -> Mapping[str, np.ndarray]:
        """[frames] J per m each: kinetic, strain_normal, strain_shear, friction, ..., total."""
        table = self._table("talus/energies")
        return MappingProxyType({name: frozen(column[: self.frame_count]) for name, column in table.items()})

    @cached_property
    def history_names(self) -> tuple[str, ...]:
        with self._file() as file:
            return tuple(file["talus/histories"]) if "talus/histories" in file else ()

    @property
    def histories(self) -> Mapping[str, Mapping[str, np.ndarray]]:
        """By name, all of them: see `history`."""
        return MappingProxyType({name: self.history(name) for name in self.history_names})

    def history(self, name: str) -> Mapping[str, np.ndarray]:
        """A table of columns of equal length: `time` [s] and then those of the scenario, in its order."""
        if name not in self.history_names:
            raise ResultError(f"{self.path}: no history {name}{nearest(name, self.history_names)}")
        with self._file() as file:
            group = file[f"talus/histories/{name}"]
            columns = ["time", *texts(group.attrs["columns"]).tolist()]
            return MappingProxyType({column: frozen(group[column][()]) for column in columns})

    @cached_property
    def verdict(self) -> Mapping[str, object]:
        """What the engine has found: verdict, mechanism, reason, time [s], max_displacement [m], moving_blocks, moving_area [m2], ...,
        and block_mechanism [blocks], index into MECHANISMS. Empty if the run ended before anything could be said."""
        with self._file() as file:
            if "talus/verdict" not in file:
                return MappingProxyType({})
            group = file["talus/verdict"]
            return MappingProxyType({name: plain(value) for name, value in group.attrs.items()}
                                    | {name: frozen(column[()]) for name, column in group.items()})

    def unit(self, path: str) -> str:
        """Unit of a dataset below /talus, such as blocks/mass; "1" for plain numbers, "-" for text."""
        with self._file() as file:
            if path not in file["talus"]:
                raise ResultError(f"{self.path}: no dataset {path}")
            return str(plain(file["talus"][path].attrs.get("unit", "1")))

    # In the shapes of other packages, which need not be there
    def to_pandas(self, table: str, frame: int = -1, name: str = "") -> pandas.DataFrame:
        """A table as a pandas DataFrame, a copy; its units are in `attrs["units"]`, column -> unit.

        table: blocks (of a frame: x, y, mass, held, ... and every field of talus_lab.fields), contacts (of a frame), energies (indexed by
        time), or history (`name`, indexed by time). Raises ResultError for unknown tables, and if pandas is not there."""
        from talus_lab import tables

        return tables.to_pandas(self, table, frame, name)

    def to_xarray(self, names: Iterable[str] = ("position", "angle"), frames: Iterable[int] | None = None) -> xarray.Dataset:
        """Arrays of frames and blocks as an xarray Dataset [frame, block] or [frame, block, axis], with the coordinate `time` [s]; each has
        its unit in `attrs["unit"]`. names: position, angle, displacement, rotation, velocity, removed, unbalanced_force, or fields of
        talus_lab.fields. frames: all if none are given. Raises ResultError for unknown names, and if xarray is not there."""
        from talus_lab import tables

        return tables.to_xarray(self, names, frames)

    def to_pyvista(self, frame: int = -1) -> pyvista.PolyData:
        """A frame as PyVista's mesh: a polygon for each convex part, fields of its block as cell data. Raises ResultError if pyvista is not
        there."""
        from talus_lab import tables

        return tables.to_pyvista(self, frame)

    # Reading
    def _block_column(self, name: str) -> np.ndarray:
        column = self._read(f"talus/blocks/{name}")
        return frozen(column + self.origin) if name == "start" else column

    @contextmanager
    def _file(self) -> Iterator[h5py.File]:
        try:
            with h5py.File(self.path, "r", locking=False) as file:
                yield file
        except (OSError, KeyError) as error:
            raise ResultError(f"{self.path}: is damaged, cut short or no longer there ({error})") from None

    def _read(self, path: str) -> np.ndarray:
        with self._file() as file:
            return frozen(texts(file[path][()]))

    def _table(self, group: str) -> dict[str, np.ndarray]:
        with self._file() as file:
            return {name: frozen(texts(column[()])) for name, column in file[group].items()}

    def _frame(self, path: str, frame: int) -> np.ndarray:
        with self._file() as file:
            return frozen(file[path][self._index(frame)])

    def _block_field(self, name: str, frame: int) -> np.ndarray:
        first, count = self._index(frame) * len(self.part_block), len(self.part_block)
        with self._file() as file:
            by_part = file[f"VTKHDF/CellData/{name}"][first : first + count]
        by_block = by_part[self.blocks["first_part"][:-1]]
        return frozen(by_block[:, :2] if by_block.ndim == 2 else by_block)

    def _index(self, frame: int) -> int:
        if not -self.frame_count <= frame < self.frame_count:
            raise ResultError(f"{self.path}: no frame {frame}, there are {self.frame_count}")
        return frame % self.frame_count
