"""Scenes as other programs read them, see docs/runners.md. The blocks are those that `talus check` cuts."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from typing import Any, Mapping

import numpy as np

from talus_lab.run import ResultError, Run, open_run

# What a scene for other programs cannot say; it would be computed as something else without a word.
UNSAID = ("stages", "loads")


def cut(talus: str, scenario: Path, keys: Mapping[str, str], folder: Path) -> tuple[Run, dict]:
    """The blocks at the start, and the scenario with every default."""
    given = sets({**keys, "record.contacts": "true"})  # the stretches where blocks touch
    geometry = folder / f"{scenario.stem}.h5"
    call([talus, "check", str(scenario), "--geometry", str(geometry), "--force", *given])
    return open_run(geometry), json.loads(call([talus, "check", str(scenario), "--resolved", *given]))


def scene_json(run: Run, scenario: Mapping[str, Any], frames: int, settings: Mapping[str, Any], share: float = 1.0) -> dict:
    """Raises ResultError if the scenario has what the format does not."""
    for key in UNSAID:
        if scenario.get(key):
            raise ResultError(f"{key}: other programs are not told of it")
    for key in ("driven", "spin"):
        if any(block.get(key) for block in scenario.get("blocks") or []):
            raise ResultError(f"{key} of a block: other programs are not told of it")
    end = share * scenario["run"]["until"]["time"]
    return {"title": scenario["title"], "gravity": gravity(scenario), "end": end, "frames": frames, "blocks": blocks_json(run, scenario),
            "contacts": contacts_json(run, scenario), "friction": default_friction(scenario), "settings": dict(settings)}


def gravity(scenario: Mapping[str, Any]) -> dict:
    """Time table, m/s2: gravity and body acceleration together, linear between the times."""
    tables = [as_table(scenario.get(key) or [0, 0]) for key in ("gravity", "body_acceleration")]
    time = sorted({t for table in tables for t in table["time"]})
    return {"time": time, **{axis: [float(sum(np.interp(t, table["time"], table[axis]) for table in tables)) for t in time] for axis in "xy"}}


def as_table(given: Any) -> dict:
    return given if isinstance(given, dict) else {"time": [0.0], "x": [given[0]], "y": [given[1]]}


def start_velocity(run: Run, scenario: Mapping[str, Any]) -> np.ndarray:
    """[blocks, 2] m/s; blocks cut from rock have none."""
    given = {block["name"]: block["velocity"] for block in scenario.get("blocks") or []}
    names = [str(name).partition("[")[0] for name in run.blocks["name"]]
    return np.array([given.get(name, (0.0, 0.0)) for name in names], dtype=float)


def blocks_json(run: Run, scenario: Mapping[str, Any]) -> list[dict]:
    blocks, position, velocity = run.blocks, run.position(0), start_velocity(run, scenario)
    found = [{"name": str(blocks["name"][b]), "held": bool(blocks["held"][b]), "mass": float(blocks["mass"][b]),
              "inertia": float(blocks["inertia"][b]), "position": position[b].tolist(), "velocity": velocity[b].tolist(),
              "parts": []} for b in range(run.block_count)]
    for part, block in enumerate(run.part_block):
        first, end = run.first_corner[part], run.first_corner[part + 1]
        found[block]["parts"].append(run.arm[first:end].tolist())
    return found


def contacts_json(run: Run, scenario: Mapping[str, Any]) -> list[dict]:
    """Stretches along which two blocks touch at the start."""
    table = run.contacts(0)
    joints = [scenario["joints"][name] for name in run.joint_names]
    found = []
    for row in range(len(table["x"])):
        joint = joints[table["joint"][row]]
        middle = np.array([table["x"][row], table["y"][row]])
        half = 0.5 * table["length"][row] * np.array([-table["ny"][row], table["nx"][row]])
        found.append({"a": int(table["block_a"][row]), "b": int(table["block_b"][row]), "from": (middle - half).tolist(),
                      "to": (middle + half).tolist(), "friction": friction(joint), "bonded": bool(joint["tension"] or joint["cohesion"])})
    return found


def friction(joint: Mapping[str, Any]) -> float:
    return math.tan(math.radians(joint["friction_angle_deg"]))


def default_friction(scenario: Mapping[str, Any]) -> float:
    """Of blocks that do not touch at the start: that of the default joint."""
    name = (scenario.get("contacts") or {}).get("default") or next(iter(scenario["joints"]))
    return friction(scenario["joints"][name])


def sets(keys: Mapping[str, str]) -> list[str]:
    return [word for key, value in keys.items() for word in ("--set", f"{key}={value}")]


def call(command: list[str], limit: float | None = None) -> str:
    """What it says. Raises ResultError with the last line of its complaint if it fails or takes longer than limit (s)."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        raise ResultError(f"takes longer than {limit:g} s") from None
    except OSError as error:
        raise ResultError(f"cannot be started: {error}") from None
    if done.returncode != 0:
        said = [line for line in (done.stderr or done.stdout).splitlines() if line.strip()] or [f"exit code {done.returncode}"]
        raise ResultError(said[-1].strip())
    return done.stdout
