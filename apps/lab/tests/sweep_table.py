"""Tables of sweeps that never ran: blocks on a slope as theory has them, and numbers made up for the purpose."""

import csv
import json
from pathlib import Path

import h5py
import numpy as np


def write_sweep(folder: Path, parameters: dict, measures: dict, kinds: dict = {}, units: dict = {}, status=None, only_csv: bool = False) -> Path:
    """parameters and measures: name -> column."""
    folder.mkdir(exist_ok=True)
    count = len(next(iter(parameters.values())))
    columns = {"case": [f"{k:04x}" for k in range(count)], **parameters, **measures, "status": status or ["done"] * count,
               "wall_time": [0.1] * count}
    about = {"title": "Blocks", "parameters": [{"name": n, "unit": units.get(n, "1"), "label": "", "kind": kinds.get(n, "grid"),
                                                "values": sorted(set(v))} for n, v in parameters.items()],
             "measures": [{"name": n, "unit": units.get(n, "-"), "label": n} for n in measures]}
    (folder / "sweep.json").write_text(json.dumps(about, default=float))
    with (folder / "table.csv").open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*columns.values()))
    if not only_csv:
        with h5py.File(folder / "table.h5", "w") as file:
            for name, column in columns.items():
                file[name] = np.array([str(v).encode() for v in column]) if isinstance(column[0], str) else np.array(column, float)
    return folder


def block_mode(slope_deg: float, friction_deg: float, ratio: float) -> str:
    """V17: what a block does that is let go on a slope."""
    a, phi, delta = np.radians(slope_deg), np.radians(friction_deg), np.arctan(ratio)
    needed = ((1 + 4 * ratio**2) * np.sin(a) + 3 * ratio * np.cos(a)) / ((4 + ratio**2) * np.cos(a) + 3 * ratio * np.sin(a))
    if a <= phi and a <= delta:
        return "none"
    if a > phi and phi < delta:
        return "slide"
    return "topple" if a > delta and np.tan(phi) >= needed else "slide and topple"


def block_sweep(folder: Path, slopes, frictions, ratios, **more) -> Path:
    cases = [(float(a), float(f), float(t)) for t in ratios for f in frictions for a in slopes]
    mechanism = [block_mode(*case) for case in cases]
    slope, friction, ratio = (list(column) for column in zip(*cases))
    return write_sweep(folder, {"slope_deg": slope, "friction_deg": friction, "ratio": ratio},
                       {"verdict": ["stable" if m == "none" else "unstable" for m in mechanism], "mechanism": mechanism,
                        "max_displacement": [1e-4 if m == "none" else 0.05 * a for m, a in zip(mechanism, slope)]},
                       units={"slope_deg": "deg", "friction_deg": "deg", "max_displacement": "m"}, **more)
