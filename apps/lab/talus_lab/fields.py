"""Fields: one number for each block in a frame, by name. What colours the blocks of a picture, and the columns of tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Callable, Mapping, Sequence

import numpy as np

from talus_lab.errors import ResultError, nearest
from talus_lab.run import MECHANISMS, Run
from talus_lab.stress import block_stress, principal


@dataclass(frozen=True)
class Field:
    """values(run, frame) -> [blocks] in `unit`."""

    values: Callable[[Run, int], np.ndarray]
    unit: str
    label: str
    signed: bool = False  # zero lies in the middle of its colours
    robust: bool = False  # a few blocks stand out so far that they would take the colours of all others
    still: float = 0.0  # what is less is rounding; of the size of a block where the unit is m or m/s
    needs_contacts: bool = False


@dataclass(frozen=True)
class Kinds:
    """A field that says to which of a few kinds a block belongs: values(run, frame) -> [blocks] index into names(run)."""

    values: Callable[[Run, int], np.ndarray]
    names: Callable[[Run], Sequence[str]]
    unit: str = "1"


def _magnitude(name: str) -> Callable[[Run, int], np.ndarray]:
    return lambda run, frame: np.hypot(*getattr(run, name)(frame).T)


def _component(name: str, axis: int) -> Callable[[Run, int], np.ndarray]:
    return lambda run, frame: getattr(run, name)(frame)[:, axis]


def _stress(row: int) -> Callable[[Run, int], np.ndarray]:
    return lambda run, frame: principal(block_stress(run, frame))[row]


def _mechanism(run: Run, frame: int) -> np.ndarray:
    if "block_mechanism" not in run.verdict:
        raise ResultError(f"{run.path}: has no verdict, so no mechanism of its blocks")
    return np.asarray(run.verdict["block_mechanism"])


STILL = 1e-10  # of the size of a block (per s), of a radian: what moves less has not moved
FIELDS: Mapping[str, Field | Kinds] = {
    "displacement": Field(_magnitude("displacement"), "m", "displacement", still=STILL),
    "displacement_x": Field(_component("displacement", 0), "m", "displacement to the right", signed=True, still=STILL),
    "displacement_y": Field(_component("displacement", 1), "m", "displacement upwards", signed=True, still=STILL),
    "speed": Field(_magnitude("velocity"), "m/s", "speed", still=STILL),
    "rotation": Field(lambda run, frame: np.degrees(run.rotation(frame)), "deg", "rotation", signed=True, still=60 * STILL),
    "stress_major": Field(_stress(0), "Pa", "major principal stress, compression > 0", robust=True, needs_contacts=True),
    "stress_minor": Field(_stress(1), "Pa", "minor principal stress, compression > 0", robust=True, needs_contacts=True),
    "unbalanced_force": Field(lambda run, frame: run.unbalanced_force(frame), "N", "unbalanced force per m", robust=True),
    "area": Field(lambda run, frame: run.blocks["area"], "m2", "area of the block", robust=True),
    "mechanism": Kinds(_mechanism, lambda run: MECHANISMS),
    "material": Kinds(lambda run, frame: run.blocks["material"], lambda run: run.material_names),
    "region": Kinds(lambda run, frame: run.blocks["region"], lambda run: run.region_names),
}


def field(name: str) -> Field | Kinds:
    """Raises ResultError with the nearest right name."""
    if name not in FIELDS:
        raise ResultError(f"no field is called {name}{nearest(name, FIELDS)}")
    return FIELDS[name]


def values(run: Run, name: str, frame: int = -1) -> np.ndarray:
    """[blocks] in the unit of the field. Raises ResultError if the result lacks what it needs."""
    found = field(name)
    if isinstance(found, Field) and found.needs_contacts and not run.contacts(frame):
        raise ResultError(f"{run.path}: {name} needs contacts; the scenario says record: {{contacts: false}}")
    try:
        return found.values(run, frame)
    except KeyError as error:
        raise ResultError(f"{run.path}: has no field {name} ({error.args[0]})") from None
