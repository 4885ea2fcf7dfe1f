"""The showcase of the single block: verdicts against the boundaries that follow from Newton's laws."""

from pathlib import Path

import pytest
import yaml
from sweeping import stand_in, table

from talus_lab import sweep

CONFIGS = Path(__file__).resolve().parents[3] / "configs"
# Below and above each boundary   [docs/verification.md, V17]
MODES = {"stable or slide": ("slide", "none"), "stable or topple": ("none", "topple"), "slide or both": ("slide", "slide and topple"),
         "both or topple": ("slide and topple", "topple")}


def changed(name: str, folder: Path, parameters: dict) -> Path:
    """The config with other values of some parameters, and its output here."""
    given = yaml.safe_load((CONFIGS / name).read_text())
    given |= {"scenario": str((CONFIGS / given["scenario"]).resolve()), "output": str(folder / "out")}
    for parameter, values in parameters.items():
        given["parameters"][parameter] = {key: value for key, value in given["parameters"][parameter].items() if key in ("set", "label")} | values
    path = folder / name
    path.write_text(yaml.safe_dump(given, sort_keys=False))
    return path


def test_a_block_fails_on_either_side_of_a_boundary_as_theory_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in(tmp_path, monkeypatch, workers=False)
    sweep.sweep(changed("single_block_boundaries.yaml", tmp_path, {"along_deg": {"values": [8.5, 36.5]}}))
    rows = table(tmp_path)
    assert len(rows) == 3 * 2 + 3 * 3 * 2
    for row in rows:
        expected = MODES[row["boundary"]][float(row["off_deg"]) > 0]
        assert (row["mechanism"], row["verdict"]) == (expected, "stable" if expected == "none" else "unstable"), row


def test_the_points_of_the_verification_have_their_modes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in(tmp_path, monkeypatch, workers=False)
    points = {(20, 30, 0.5): "none", (20, 15, 0.5): "slide", (30, 40, 0.3): "topple", (30, 25, 0.5): "slide", (30, 28, 0.5): "topple", (40, 20, 2): "slide",
              (20, 40, 0.4): "none", (40, 23, 0.36397): "slide and topple"}
    names = ("slope_deg", "friction_deg", "ratio")
    path = changed("single_block_chart.yaml", tmp_path, {name: {"values": sorted({point[k] for point in points})} for k, name in enumerate(names)})
    conditions = (" and ".join(f"{name} == {value}" for name, value in zip(names, point)) for point in points)
    path.write_text(path.read_text() + yaml.safe_dump({"where": [" or ".join(conditions)]}))
    sweep.sweep(path)
    assert {tuple(float(row[name]) for name in names): row["mechanism"] for row in table(tmp_path)} == points
