"""Arrays as results hold them, and points that move with their blocks."""

from __future__ import annotations

from typing import Callable, Iterator, Mapping, Sequence

import numpy as np


def placed(arm: np.ndarray, position: np.ndarray, angle: np.ndarray, block: np.ndarray) -> np.ndarray:
    """[n, 2] m: points given from the centroids of their blocks [n, 2], turned with them and moved to where they are."""
    cos, sin = np.cos(angle)[block], np.sin(angle)[block]
    turned = np.column_stack([cos * arm[:, 0] - sin * arm[:, 1], sin * arm[:, 0] + cos * arm[:, 1]])
    return turned + position[block]


def frozen(array: np.ndarray) -> np.ndarray:
    """The same, not to be written to."""
    array = np.asarray(array)
    array.flags.writeable = False
    return array


def texts(values: np.ndarray) -> np.ndarray:
    """Texts as Python has them; other values as they are."""
    return np.char.decode(values, "utf-8") if values.dtype.kind == "S" else values


def plain(value: object) -> object:
    """Attributes as Python values: texts, numbers, or arrays."""
    if isinstance(value, bytes):
        return value.decode()
    if isinstance(value, np.ndarray) and value.shape == ():
        return plain(value[()])
    return value.item() if isinstance(value, np.generic) else value


class Columns(Mapping[str, np.ndarray]):
    """A table whose columns are read when they are asked for, once."""

    def __init__(self, names: Sequence[str], read: Callable[[str], np.ndarray]):
        self._names, self._read = dict.fromkeys(names), read
        self._known: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._known:
            self._known[name] = self._read(name)
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)
