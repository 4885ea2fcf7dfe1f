"""The values that a parameter takes: listed, in even steps, or drawn."""

from __future__ import annotations

import math
import random
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from talus_lab.sweep.config import Parameter, Sample

MOST = 1_000_000  # values of a range: more is a slip of the pen


def number(given: Any) -> Any:
    """Numbers as scenarios have them: YAML of Python's kind takes 1e9 for a text. Anything else as it is."""
    if isinstance(given, str):
        try:
            return float(given) if math.isfinite(float(given)) else given
        except ValueError:
            return given
    return [number(part) for part in given] if isinstance(given, list) else given


def is_drawn(parameter: Parameter) -> bool:
    return not parameter.values and not parameter.levels and not parameter.count and parameter.step is None


def levels_of(parameter: Parameter, where: str) -> tuple[list, list[str]]:
    """Values of a parameter that is not drawn, and faults of any."""
    ways = {"values": bool(parameter.values), "levels": bool(parameter.levels), "from": parameter.from_ is not None or parameter.to is not None,
            "mean": parameter.mean is not None or parameter.deviation is not None}
    given = [name for name, there in ways.items() if there]
    if len(given) != 1:
        return [], [f"{where}: needs one of values, levels, from and to, or mean and deviation" + (f"; has {' and '.join(given)}" if given else
                    "; the list of its values is empty")]
    if given == ["values"]:
        return [number(value) for value in parameter.values], []
    if given == ["levels"]:
        wrong = [f"{where}.levels.{name}: is not a mapping of keys to values" for name, keys in parameter.levels.items() if not isinstance(keys, dict)]
        return [str(name) for name in parameter.levels], wrong
    pair = ("mean", "deviation") if given == ["mean"] else ("from", "to")
    low, high = (number(parameter.mean), number(parameter.deviation)) if given == ["mean"] else (number(parameter.from_), number(parameter.to))
    wrong = [f"{where}.{name}: is not a finite number" for name, end in zip(pair, (low, high)) if not is_finite(end)]
    if wrong:
        return [], wrong
    if given == ["mean"]:
        return [], [] if high > 0 else [f"{where}.deviation: is not above 0"]
    return _range(parameter, low, high, where)


def is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_finite(value: Any) -> bool:
    return is_number(value) and math.isfinite(value)


def _range(parameter: Parameter, low: float, high: float, where: str) -> tuple[list, list[str]]:
    step = number(parameter.step)
    if parameter.scale not in ("linear", "log"):
        return [], [f"{where}.scale: is neither linear nor log"]
    if parameter.scale == "log" and not (low > 0 and high > 0 and step is None):
        return [], [f"{where}.scale: log needs ends above 0, and count in place of step"]
    if step is not None and parameter.count:
        return [], [f"{where}: has both count and step"]
    if step is not None and not is_finite(step):
        return [], [f"{where}.step: is not a finite number"]
    if is_drawn(parameter):
        return [], [] if low < high else [f"{where}: the range from {low:g} to {high:g} is empty"]
    if step is not None:
        if step == 0 or (high - low) / step < 0:
            return [], [f"{where}: the range from {low:g} to {high:g} by {step:g} is empty"]
        count = int(min((high - low) / step * (1 + 1e-12) + 1e-9, 2 * MOST)) + 1  # an end that is met but for rounding belongs to it
        if count > MOST:
            return [], [f"{where}: has more than {MOST} values"]
        whole = isinstance(low, int) and isinstance(step, int)
        return [low + k * step if whole else tidy(low + k * step) for k in range(count)], []
    if not 1 <= parameter.count <= MOST or (parameter.count == 1 and low != high):
        return [], [f"{where}.count: is not from 2 to {MOST}"]
    shares = [k / max(1, parameter.count - 1) for k in range(parameter.count)]
    return [quantile(parameter, share) for share in shares], []


def quantile(parameter: Parameter, share: float) -> float:
    """The value below which this share of the range, or of the normal distribution, lies."""
    if parameter.mean is not None:
        return tidy(NormalDist(number(parameter.mean), number(parameter.deviation)).inv_cdf(share))
    low, high = number(parameter.from_), number(parameter.to)
    if parameter.scale == "log":
        return tidy(low * (high / low) ** share)
    return tidy(low + share * (high - low))


def tidy(value: float) -> float:
    """Without the last digits, which are rounding: 0.3 in place of 0.30000000000000004. Half as many digits would move points of fine
    ranges, all of them would give one case two names."""
    return float(f"{value:.12g}")


def draw(sample: Sample, name: str) -> list[float]:
    """Shares between 0 and 1, one for each row of the sample. Latin hypercube: one in each of as many equal parts. What is drawn depends
    on the seed and the name alone, so that other parameters may come and go. [McKay, Beckman & Conover 1979]"""
    chance = random.Random(f"{sample.seed} {name}")
    if sample.method == "random":
        return [chance.random() or 0.5 for _ in range(sample.count)]
    shares = [(k + (chance.random() or 0.5)) / sample.count for k in range(sample.count)]
    keys = [chance.random() for _ in shares]
    return [share for _, share in sorted(zip(keys, shares))]
