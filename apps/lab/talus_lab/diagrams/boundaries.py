"""Where theory puts the boundaries between modes of failure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Mapping

import numpy as np

from talus_lab.errors import ResultError, nearest
from talus_lab.study.formulas import FormulaError, evaluate

Line = np.ndarray  # [n, 2] deg: angle of the slope, angle of friction
STEEPEST = 90.0


def toppling_friction_deg(slope_deg: np.ndarray, ratio: float) -> np.ndarray:
    """deg, friction above which a block on a slope topples without sliding as it is let go. ratio: its width along the slope over its
    height, t. Newton's laws at that moment, turning about the lower corner:
        tan phi = [(1 + 4 t^2) sin a + 3 t cos a] / [(4 + t^2) cos a + 3 t sin a]
    the limit of static toppling, a = atan t, lies on phi = a   [E. Sagaseta, Int. J. Rock Mech. Min. Sci. 23 (1986) 243-246]."""
    a, t = np.radians(slope_deg), ratio
    return np.degrees(np.arctan2((1 + 4 * t**2) * np.sin(a) + 3 * t * np.cos(a), (4 + t**2) * np.cos(a) + 3 * t * np.sin(a)))


def dynamic_block_modes(ratio: float) -> list[Line]:
    """Boundaries of stable, slide, topple, and slide and topple, of a block let go on a slope."""
    upright = float(np.degrees(np.arctan(ratio)))
    steep = np.linspace(upright, STEEPEST, 200)
    return [np.array([[0.0, 0.0], [upright, upright]]), np.array([[upright, upright], [upright, STEEPEST]]),
            np.array([[upright, upright], [STEEPEST, upright]]), np.column_stack([steep, toppling_friction_deg(steep, ratio)])]


def static_block_modes(ratio: float) -> list[Line]:
    """Slide where the slope is steeper than friction, topple where it is steeper than the block is slender: statics alone   [E. Hoek,
    J.W. Bray, Rock Slope Engineering, 1981]."""
    upright = float(np.degrees(np.arctan(ratio)))
    return [np.array([[0.0, 0.0], [STEEPEST, STEEPEST]]), np.array([[upright, 0.0], [upright, STEEPEST]])]


def plane_slide() -> list[Line]:
    """A block without cohesion slides where the plane is steeper than its friction."""
    return [np.array([[0.0, 0.0], [STEEPEST, STEEPEST]])]


NAMED: Mapping[str, Callable[..., list[Line]]] = {"dynamic_block_modes": dynamic_block_modes, "static_block_modes": static_block_modes,
                                                  "plane_slide": plane_slide}
NEEDS = {"dynamic_block_modes": ("ratio",), "static_block_modes": ("ratio",), "plane_slide": ()}


@dataclass(frozen=True)
class Curve:
    """A line on a diagram. Either the name of a theory, whose slope and friction angles in deg are the columns `slope` and `friction`
    and whose ratio is a column or a number; or a formula that gives y from {x} and from all other parameters, such as
    `atan_deg(0.5 * tan_deg(x))`."""

    theory: str = ""
    slope: str = ""
    friction: str = ""
    ratio: Any = None
    y: str = ""
    label: str = "theory"

    def faults(self, columns: Mapping[str, object]) -> list[str]:
        """What is wrong with it, in words."""
        if bool(self.theory) == bool(self.y):
            return ["a curve has either theory or y"]
        if self.y:
            return []
        if self.theory not in NAMED:
            return [f"no theory is called {self.theory}{nearest(self.theory, NAMED)}"]
        wanted = {"slope": self.slope, "friction": self.friction}
        wanted |= {"ratio": self.ratio} if "ratio" in NEEDS[self.theory] else {}
        return [f"{name}: no column {given}{nearest(given, columns)}" for name, given in wanted.items()
                if given not in columns and not (name == "ratio" and isinstance(given, (int, float)))]

    def lines(self, x: str, y: str, values: Mapping[str, float], x_range: tuple[float, float]) -> list[np.ndarray]:
        """[n, 2] each, in the units of the columns x and y. values: of the other parameters of this panel. Raises ResultError."""
        if self.y:
            at = np.linspace(*x_range, 200)
            try:
                return [np.array([[u, evaluate(self.y, {**values, "x": u, x: u})] for u in at])]
            except FormulaError as error:
                raise ResultError(f"curve {error}") from None
        if {x, y} != {self.slope, self.friction}:
            raise ResultError(f"curve {self.theory}: x and y are {x} and {y}, not {self.slope} and {self.friction}")
        ratio = values.get(str(self.ratio), self.ratio)
        if "ratio" in NEEDS[self.theory] and not isinstance(ratio, (int, float)):
            raise ResultError(f"curve {self.theory}: {self.ratio} varies within a panel; give it as `panel`")
        lines = NAMED[self.theory](*([float(ratio)] if "ratio" in NEEDS[self.theory] else []))
        return lines if x == self.slope else [line[:, ::-1] for line in lines]
