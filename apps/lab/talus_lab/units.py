"""Numbers and units as pictures show them."""

from __future__ import annotations

from typing import Sequence

PREFIXES: Sequence[tuple[float, str]] = [(1e9, "G"), (1e6, "M"), (1e3, "k"), (1, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n")]
SMALL_ONLY = ("m", "m/s", "s", "rad/s", "rad")  # 1500 m, not 1.5 km
WITHOUT = ("deg", "1", "-", "m2", "")
SPELT = {"m2": "m²", "m/s2": "m/s²", "1": "", "-": ""}


def prefix(value: float, unit: str) -> tuple[float, str]:
    """Factor and unit with which a value reads well: 2.5e-3 m -> (1e3, 'mm'). Times are in s down to a tenth of it."""
    if unit in WITHOUT:
        return 1.0, SPELT.get(unit, unit)
    rounded = abs(float(f"{value:.4g}"))  # 0.99999 s is 1 s, not 1000 ms
    for size, letter in PREFIXES[3:] if unit in SMALL_ONLY else PREFIXES:
        if rounded >= (0.1 if unit == "s" and size == 1 else size):
            return 1 / size, letter + unit
    return 1.0, unit


def quantity(value: float, unit: str, digits: int = 3) -> str:
    factor, unit = prefix(value, unit)
    return f"{float(f'{value * factor:.{digits}g}'):.12g} {unit}".rstrip()  # 1200, not 1.2e+03


def axis_label(label: str, unit: str) -> str:
    """`displacement in mm`; plain numbers have no unit."""
    unit = SPELT.get(unit, unit)
    return f"{label} in {unit}" if unit else label
