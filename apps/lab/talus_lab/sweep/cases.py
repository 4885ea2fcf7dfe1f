"""The cases of a sweep: combinations of parameters as overrides of the scenario, with the name the engine gives to each."""

from __future__ import annotations

import itertools
import json
import math
import re
import subprocess
from dataclasses import dataclass
from typing import Any, Iterator, Mapping

from talus_lab.errors import ResultError
from talus_lab.study.formulas import FormulaError, evaluate, filled, holds
from talus_lab.sweep.config import REPETITION, Config, Parameter
from talus_lab.sweep.ranges import MOST, draw, is_drawn, levels_of, number, quantile

MOST_FAULTS = 20  # in one report: where one key is wrong, a thousand cases say so


@dataclass(frozen=True)
class Case:
    """One combination of parameters. Two of them may be the same scenario, and then have one id and one result."""

    id: str  # hash of the resolved scenario, 16 hexadecimal digits
    values: Mapping[str, Any]
    overrides: tuple[str, ...]  # path=value


def cases_of(config: Config, talus: str) -> list[Case]:
    """All cases in the order of the config, the last parameter varying fastest. Raises ResultError with the engine's report."""
    values = levels(config)
    count = math.prod(len(column) for name, column in values.items() if name == REPETITION or not is_drawn(config.parameters[name]))
    count *= config.sample.count if config.sample else 1
    if count > MOST:
        config.fault(f"parameters: make {count:.3g} combinations, more than {MOST}")
    combinations = list(_combinations(config))
    if not combinations:
        config.fault("where: no combination of the parameters is left" if config.where else "parameters: there are none")
    try:
        overrides = [overrides_of(config, values) for values in combinations]
    except FormulaError as error:
        config.fault(f"{_place_of_formula(config, str(error))}: {error}")
    hashes = resolve(config, talus, overrides)
    return [Case(name, values, tuple(changes)) for name, values, changes in zip(hashes, combinations, overrides)]


def levels(config: Config) -> dict[str, list]:
    """Values of every parameter, in their order; of drawn ones as they were drawn."""
    found = {name: _drawn(config, name) if is_drawn(parameter) else levels_of(parameter, name)[0] for name, parameter in config.parameters.items()}
    if config.repetitions:
        found[REPETITION] = [config.repetitions.seed + k for k in range(config.repetitions.count)]
    return found


def _combinations(config: Config) -> Iterator[dict[str, Any]]:
    values = levels(config)
    drawn = [name for name, parameter in config.parameters.items() if is_drawn(parameter)]
    axes = [name for name in values if name not in drawn]
    for point in itertools.product(*(values[name] for name in axes)):
        for row in zip(*(values[name] for name in drawn)) if drawn else [()]:
            found = dict(zip(axes, point)) | dict(zip(drawn, row))
            found = {name: found[name] for name in values}
            if _wanted(config, found):
                yield found


def _wanted(config: Config, values: Mapping[str, Any]) -> bool:
    for k, condition in enumerate(config.where):
        try:
            if not holds(condition, values):
                return False
        except FormulaError as error:
            config.fault(f"where[{k}]: {error}")
    return True


def _drawn(config: Config, name: str) -> list[float]:
    assert config.sample
    return [quantile(config.parameters[name], share) for share in draw(config.sample, name)]


def keys_of(parameter: Any) -> list[str]:
    """Keys of the scenario that a parameter sets."""
    if isinstance(parameter.set, (dict, list)):
        return [str(key) for key in parameter.set]
    named = [parameter.set] if parameter.set else []
    return named + list(dict.fromkeys(key for keys in getattr(parameter, "levels", {}).values() for key in keys))


def overrides_of(config: Config, values: Mapping[str, Any]) -> list[str]:
    """Keys for all cases first, then those of the parameters in their order."""
    keys: dict[str, Any] = {key: fill(value, values) for key, value in config.set.items()}
    for name, parameter in config.parameters.items():
        keys |= _keys(parameter, values[name], values)
    if config.repetitions:
        keys |= dict.fromkeys(keys_of(config.repetitions), values[REPETITION])
    return [f"{key}={json.dumps(value, ensure_ascii=False)}" for key, value in keys.items()]


def _keys(parameter: Parameter, value: Any, values: Mapping[str, Any]) -> dict[str, Any]:
    if parameter.levels:
        return {key: fill(given, values) for key, given in parameter.levels[value].items()}
    if isinstance(parameter.set, dict):
        return {key: fill(given, values) for key, given in parameter.set.items()}
    return dict.fromkeys(keys_of(parameter), value)


def fill(given: Any, values: Mapping[str, Any]) -> Any:
    """The value with its formulas computed: a text that is one formula in braces becomes a number, others keep their words."""
    if isinstance(given, dict):
        return {key: fill(part, values) for key, part in given.items()}
    if isinstance(given, list):
        return [fill(part, values) for part in given]
    if not isinstance(given, str):
        return given
    formula = re.fullmatch(r"\{([^{}]*)\}", given.strip())
    if not formula:
        return filled(given, values) if "{" in given else number(given)
    name = formula[1].strip()
    return values[name] if name in values else evaluate(formula[1], values)


def _place_of_formula(config: Config, said: str) -> str:
    """Where in the config the formula of a report stands."""
    formula = said.partition("}")[0] + "}"
    for where in ("set", *(f"parameters.{name}.{part}" for name in config.parameters for part in ("set", "levels"))):
        given: Any = config.set if where == "set" else getattr(config.parameters[where.split(".")[1]], where.split(".")[2])
        if isinstance(given, dict):
            for key, value in given.items():
                if formula in json.dumps(value, ensure_ascii=False):
                    return f"{where}.{key}"
    return "set"


def resolve(config: Config, talus: str, overrides: list[list[str]]) -> list[str]:
    """The hash of each resolved scenario. Raises ResultError with what is wrong, each fault once, where the config says it."""
    lines = "".join(json.dumps(changes, ensure_ascii=False) + "\n" for changes in overrides)
    done = subprocess.run([talus, "resolve", str(config.scenario)], input=lines, capture_output=True, text=True, encoding="utf-8")
    answers = [json.loads(line) for line in done.stdout.splitlines()]
    if len(answers) != len(overrides):
        raise ResultError(done.stderr.strip() or f"talus resolve ended with exit code {done.returncode}")
    faults = list(dict.fromkeys(fault for answer in answers for fault in answer.get("faults", [])))
    if faults:
        ours = [_placed(config, fault) for fault in faults if fault.startswith("--set ")]
        theirs = [fault for fault in faults if not fault.startswith("--set ")]
        _refuse(config, ours, theirs)
    return [answer["hash"] for answer in answers]


def _refuse(config: Config, ours: list[str], theirs: list[str]) -> None:
    more = len(ours) + len(theirs) - MOST_FAULTS
    try:
        config.fault(*ours[:MOST_FAULTS])
    except ResultError as error:
        theirs = [str(error), *theirs]
    raise ResultError("\n".join(theirs[:MOST_FAULTS] + ([f"and {more} more"] if more > 0 else [])))


def _placed(config: Config, fault: str) -> str:
    """`--set run.untl: ...` as `parameters.length.set: run.untl: ...`."""
    fault = fault.removeprefix("--set ")
    key = fault.partition(": ")[0]
    for name, parameter in config.parameters.items():
        for known in keys_of(parameter):
            if _within(key, known):
                part = "levels" if parameter.levels else "set"
                return f"parameters.{name}.{part}{'.' + known if isinstance(parameter.set, dict) else ''}: {fault}"
    if config.repetitions and any(_within(key, known) for known in keys_of(config.repetitions)):
        return f"repetitions.set: {fault}"
    return f"set.{next((known for known in config.set if _within(key, known)), '')}: {fault}"


def _within(key: str, known: str) -> bool:
    """Whether the key is the known one or a part of it; a fault may stand deeper than what was set."""
    return key == known or (key.startswith(known) and key[len(known)] in ".[")

