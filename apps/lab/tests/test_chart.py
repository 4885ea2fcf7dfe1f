import csv
import dataclasses
import json
import math
import stat
import sys
from pathlib import Path

import h5py
import matplotlib.image
import numpy as np
import pytest
import yaml
from conftest import write_result

from talus_lab import chart
from talus_lab.chart import fronts, theory
from talus_lab.chart.exchange import gravity
from talus_lab.chart.motion import Motion, motion_of_json
from talus_lab.chart.tables import seconds
from talus_lab.chart.values import VALUES, Look
from talus_lab.cli import main
from talus_lab.program import find_talus
from talus_lab.errors import ResultError
from talus_lab.runners import scene as runner

ROOT = Path(__file__).resolve().parents[3]

# Stands in for talus: the square of conftest slides by 0.4 m in 1 s, and takes 1/stiffness s of CPU for it.
STAND_IN = """#!{python} -IS
import json, pathlib, shutil, sys
given, here = sys.argv[1:], pathlib.Path(__file__).parent
with open(here / "asked", "a") as asked:
    asked.write(json.dumps(given) + "\\n")
sets = dict(word.partition("=")[::2] for option, word in zip(given, given[1:]) if option == "--set")
if given[0] == "check" and "--resolved" in given:
    rough, bedding = [dict(friction_angle_deg=angle, tension=0, cohesion=0) for angle in (45, 0)]
    print(json.dumps(dict(title="A square that slides", gravity=[0, -9.81], joints=dict(rough=rough, bedding=bedding), run=dict(until=dict(time=1.0)))))
elif given[0] == "check":
    shutil.copy(here / "1.h5", given[given.index("--geometry") + 1])
elif float(sets["k"]) > 1e6:
    sys.exit("talus: time step above the limit")
else:
    shutil.copy(here / f"{{float(sets['k']):g}}.h5", given[given.index("-o") + 1])
"""
# A runner: the square slides by 0.4 m less 0.4 / rate, and takes rate / 1e4 s for it.
RUNNER = """
import json, sys
scene = json.load(open(sys.argv[1]))
rate = scene["settings"]["rate"]
if rate > 1000:
    sys.exit("runner: no such rate")
start = [block["position"] for block in scene["blocks"]]
end = [list(place) for place in start]
end[1][0] += 0.4 - 0.4 / rate
json.dump({"cpu_time": rate / 1e4, "time": [0, scene["end"]], "position": [start, end], "angle": [[0] * len(start)] * 2}, open(sys.argv[2], "w"))
"""
PAGE = "# Square\n" + "".join(f"<!-- table {name} -->\n<!-- end -->\n" for name in ("lead", "front-slide", "front-other", "reference", "failed"))


def study_config() -> dict:
    slide = {"label": "error of the slide", "value": "travel", "blocks": "square", "direction_deg": 0, "exact": "{0.4 * sqrt(1)}"}
    return {
        "output": "out", "page": "page.md", "images": "images", "repeat": 2, "limit_s": 20, "levels": [0.1, 0.001],
        "settings": {"stiffness": {"label": "stiffness"}, "rate": {"label": "steps per s"}},
        "methods": {"explicit": {"label": "ours"}, "peer": {"label": "theirs", "command": ["python", "runner.py"]},
                    "absent": {"label": "not there", "command": ["no_such_program"], "missing": "Ask for it."}},
        "scenes": {
            "slide": {"title": "Slide", "scenario": "slide.yaml", "set": {"stiffness": {"k": "{2 * stiffness}"}}, "errors": {"slide": slide},
                      "methods": {"explicit": {"stiffness": [10, 1000, 1e9]}, "peer": {"rate": [5, 100, 5000]}, "absent": {"rate": [1]}}},
            "other": {"title": "Against a reference", "scenario": "slide.yaml", "set": {"stiffness": {"k": "{stiffness}"}},
                      "errors": {"slide": {**slide, "exact": "reference"}},
                      "reference": {"method": "explicit", "settings": [{"stiffness": 10}, {"stiffness": 100}]},
                      "methods": {"peer": {"rate": [100]}}}},
        "charts": {}}


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A folder with a config, its page, a program that stands in for talus, and a runner."""
    program = tmp_path / "bin" / "talus"
    program.parent.mkdir()
    program.write_text(STAND_IN.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    for stiffness in (1, 10, 20, 100, 1000, 2000):
        finish(write_result(tmp_path / "bin" / f"{stiffness}.h5"), 1 / stiffness)
    monkeypatch.setenv("TALUS", str(program))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slide.yaml").write_text("title: slide\n")
    (tmp_path / "runner.py").write_text(RUNNER)
    (tmp_path / "page.md").write_text(PAGE)
    write(tmp_path, study_config())
    return tmp_path


def finish(path: Path, cpu_time: float) -> None:
    """What the result of conftest lacks."""
    with h5py.File(path, "a") as file:
        file["talus"].attrs["cpu_time"] = cpu_time
        file["talus/blocks/inertia"] = np.array([10.0, 1 / 6, 3.0])


def write(folder: Path, config: dict) -> None:
    (folder / "study.yaml").write_text(yaml.safe_dump(config))


def command(folder: Path, *options: str) -> int:
    return main(["chart", str(folder / "study.yaml"), *options])


def asked(folder: Path) -> list[str]:
    log = folder / "bin" / "asked"
    lines = [line for line in (log.read_text().splitlines() if log.exists() else []) if '"run"' in line]
    log.unlink(missing_ok=True)
    return lines


def rows(folder: Path) -> dict[tuple, dict]:
    with open(folder / "out" / "results.csv", newline="") as file:
        return {(row["scene"], row["method"], row["setting"]): row for row in csv.DictReader(file)}


def test_a_study_becomes_a_table_charts_and_the_numbers_of_its_page(study, capsys):
    write(study, {**study_config(), "charts": {"slide": {"panels": [{"scene": "slide"}, {"scene": "other", "error": "slide"}]}}})
    assert command(study) == 0
    found = rows(study)
    ours, theirs = found["slide", "explicit", "stiffness 1000"], found["slide", "peer", "rate 100"]
    assert float(ours["error"]) < 1e-6 and float(ours["cpu_time"]) == pytest.approx(1 / 2000) and ours["repeat"] == "2"
    assert float(theirs["error"]) == pytest.approx(0.01) and float(theirs["cpu_time"]) == pytest.approx(0.01)
    assert matplotlib.image.imread(study / "images" / "slide.png")[..., :3].std() > 0.05 and (study / "out" / "slide.svg").exists()
    page = (study / "page.md").read_text()
    assert "| Slide | 20 (ours / theirs) | only ours |" in page
    assert "| ours | **5.0e-04** | **5.0e-04** |" in page and "| theirs | 0.01 | - | 1.0e-02 at 0.01 | rate 100 |" in page
    assert "| not there | is not there | is not there |" in page
    assert "no_such_program is not there. Ask for it." in capsys.readouterr().out


def test_what_fails_says_why_and_the_rest_goes_on(study):
    assert command(study) == 0
    found = rows(study)
    assert found["slide", "explicit", "stiffness 1e+09"]["said"] == "talus: time step above the limit"
    assert found["slide", "peer", "rate 5000"]["said"] == "runner: no such rate"
    assert "| Slide | theirs | rate 5000 | runner: no such rate |" in (study / "page.md").read_text()


def test_a_reference_says_how_far_it_has_converged(study):
    assert command(study) == 0
    assert "| Against a reference | error of the slide | explicit, stiffness 100 | 0.4 | 0.0e+00 |" in (study / "page.md").read_text()
    assert float(rows(study)["other", "peer", "rate 100"]["error"]) == pytest.approx(0.01, rel=1e-3)


def test_an_error_below_that_of_the_reference_counts_as_that():
    row = {"scene": "a", "method": "m", "setting": "", "cpu_time": "1", "error": "1e-7", "errors": "x=1e-7", "unsure": "1e-3"}
    assert fronts.points([row], "a")["m"][0].error == 1e-3


def test_a_study_goes_on_where_it_stopped_and_measures_what_changed(study):
    assert command(study) == 0 and len(asked(study)) == 2 * 2 + 1 + 2
    assert command(study) == 0 and asked(study) == []
    config = study_config()
    config["scenes"]["slide"]["methods"]["explicit"]["stiffness"] = [10, 500]
    write(study, config)
    assert command(study) == 0
    assert [line.count("k=1000") for line in asked(study)] == [1, 1]
    (study / "runner.py").write_text(RUNNER.replace("0.4 / rate", "0.8 / rate"))
    assert command(study) == 0 and asked(study) == []  # the reference is kept
    assert float(rows(study)["slide", "peer", "rate 100"]["error"]) == pytest.approx(0.02)
    assert command(study, "--draw") == 0 and command(study, "--again") == 0 and len(asked(study)) == 4


def test_quick_leaves_the_page_alone(study):
    assert command(study, "--quick") == 0
    assert (study / "page.md").read_text() == PAGE and "| theirs |" in (study / "out" / "quick" / "page.md").read_text()
    assert all("run.until.time=0.02" in line for line in asked(study))


def test_every_fault_of_a_config_is_in_one_report(study, capsys):
    config = study_config()
    config["scenes"]["slide"]["methods"] = {"explicitt": {"stiffness": [1]}, "peer": {"rates": [1]}}
    config["scenes"]["slide"]["errors"]["slide"]["value"] = "travels"
    config["scenes"]["other"]["scenario"] = "slid.yaml"
    config["charts"]["slide"] = {"panels": [{"scene": "slides"}, {"scene": "slide", "error": "slip"}]}
    write(study, config)
    assert command(study) == 2
    said = capsys.readouterr().err
    for fault in ("unknown explicitt; did you mean explicit?", "unknown rates; did you mean rate?", "unknown travels; did you mean travel?",
                  "there is no file slid.yaml", "unknown slides; did you mean slide?", "unknown slip; did you mean slide?"):
        assert fault in said
    assert asked(study) == [] and not (study / "out").exists()


@pytest.mark.parametrize("change, words", [
    ({"repeats": 3}, "repeats: unknown key; did you mean repeat?"), ({"repeat": 0}, "repeat: is not a whole number above 0"),
    ({"levels": [0]}, "levels: is not a list"), ({"limit_s": "long"}, "limit_s: is not a number above 0")])
def test_plain_keys_are_checked(study, change, words, capsys):
    write(study, {**study_config(), **change})
    assert command(study) == 2
    assert words in capsys.readouterr().err


def test_formulas_and_references_are_checked(study, capsys):
    for where, value, words in ((("exact",), "{sqrt(-1)}", "math domain"), (("exact",), 0, "needs a scale"), (("exact",), "reference", "no reference")):
        config = study_config()
        config["scenes"]["slide"]["errors"]["slide"][where[0]] = value
        write(study, config)
        assert command(study) == 2
        assert words in capsys.readouterr().err


def test_rocking_follows_its_equation_of_motion():
    a, p2 = math.atan(0.25), 0.75 * 9.81 / (0.5 * math.hypot(1, 4))
    tilt, spin, t, dt = a / 2, 0.0, 0.0, 1e-4
    while True:  # leapfrog, error about dt^2
        spin -= 0.5 * dt * p2 * math.sin(a - tilt)
        before, tilt = tilt, tilt + dt * spin
        spin -= 0.5 * dt * p2 * math.sin(a - tilt)
        if tilt < 0:
            break
        t += dt
    assert theory.rocking_impact_time(1, 4, 0.5) == pytest.approx(t + dt * before / (before - tilt), rel=1e-6)
    energy = 0.5 * (spin * (1 - 1.5 * math.sin(a) ** 2)) ** 2 / p2  # what is left after the impact, over m g R
    other = theory.rocking_amplitude(1, 4, 0.5)
    assert math.cos(a - other) - math.cos(a) == pytest.approx(energy, rel=1e-3)


def test_a_chain_moves_as_small_steps_of_its_masses_do():
    mass, k, g, steps = np.array([2.0, 50.0, 50.0, 2.0, 50.0, 50.0]), 1e6, 9.81, 20000
    x, v, dt = np.zeros(6), np.zeros(6), 0.1 / steps
    for _ in range(steps):  # leapfrog, error about (w dt)^2
        stretch = np.diff(x, prepend=0.0)
        force = k * (np.append(stretch[1:], 0.0) - stretch)
        v += dt * (force / mass + g) * (0.5 if _ == 0 else 1.0)
        x += dt * v
    assert theory.chain_motion(0.1, k, g, 2, 2.0, 2, 50.0) == pytest.approx(x[-1], rel=1e-5)


def test_values_of_a_motion():
    time = np.linspace(0, 2, 201)
    tilt = np.where(time < 1, 0.1 * (1 - time**2), -0.05 * np.sin(2 * (time - 1)))
    position = np.zeros((201, 2, 2))
    position[:, 0, 0], position[:, 1] = 3 * time, np.column_stack([3 * time, 0.2 * time])
    motion = Motion(time, position, np.column_stack([tilt - 0.1, 0 * time]))
    look = Look(np.array([0, 1]), np.array([2.0, 2.0]), np.array([1.0, 1.0]), np.array([[3.0, 0], [3, 0.2]]), np.array([1.0, 0.0]), 0.1)
    assert VALUES["impact_time"](motion, look) == pytest.approx(1, abs=1e-9)
    assert VALUES["amplitude"](motion, look) == pytest.approx(0.05, rel=1e-6)
    assert VALUES["travel"](motion, look) == pytest.approx(6) and VALUES["largest_motion"](motion, look) == pytest.approx(6)
    assert VALUES["scatter"](motion, look) == pytest.approx(0.2)  # 0.4 m apart, each 0.2 m from their mean
    spin = (tilt[-1] - tilt[-2]) / 0.01
    assert VALUES["energy_change"](motion, look) == pytest.approx(spin**2 / (2 * 9), rel=1e-6)
    with pytest.raises(ResultError):
        VALUES["impact_time"](Motion(time, position, np.zeros((201, 2))), look)


def test_results_of_other_programs_are_checked():
    good = {"time": [0, 1], "position": [[[0, 0]], [[1, 0]]], "angle": [[0], [0]]}
    assert motion_of_json(good, 1).displacement().tolist() == [[1, 0]]
    for change in ({"time": [0]}, {"angle": [[0, 0], [0, 0]]}, {"position": [[[0, 0]], [[math.nan, 0]]]}, {"time": None}):
        with pytest.raises(ResultError):
            motion_of_json({**good, **change}, 1)


def test_scenes_say_what_pulls_the_blocks():
    table = gravity({"gravity": [0, -9.81], "body_acceleration": {"time": [0, 1], "x": [2, 4], "y": [0, 0]}})
    assert table == {"time": [0, 1], "x": [2, 4], "y": [-9.81, -9.81]}
    assert runner.gravity({"gravity": table}, 0.5) == (3, -9.81) and runner.gravity({"gravity": table}, 7) == (4, -9.81)


def test_a_front_has_what_no_other_setting_beats():
    line = [fronts.Point(t, e, "") for t, e in ((1, 0.5), (2, 0.7), (3, 0.1), (4, 0.1))]
    assert [p.cpu_time for p in fronts.front(line)] == [1, 3]
    assert fronts.least(line, 0.2).cpu_time == 3 and fronts.least(line, 0.01) is None


def test_an_error_that_dearer_settings_do_not_reach_is_an_accident():
    line = [fronts.Point(t, e, "") for t, e in ((1, 1e-4), (2, 2e-2), (3, 1e-2), (4, 3e-3), (5, 8e-3))]
    assert [p.cpu_time for p in fronts.confirmed(line)] == [2, 3, 4, 5]
    line = [fronts.Point(t, e, "") for t, e in ((1.0, 1e-6), (1.1, 1e-4), (1.2, 1e-2))]
    assert fronts.confirmed(line) == line, "finer at no cost"


def test_times_read_well():
    assert [seconds(t) for t in (1.234, 123.4, 1.234e-5)] == ["1.2", "123", "1.2e-05"]


def test_scenes_can_be_written_for_other_programs(tmp_path, monkeypatch):
    monkeypatch.delenv("TALUS", raising=False)
    try:
        find_talus()
    except ResultError as not_built:
        pytest.skip(str(not_built))
    out = tmp_path / "scene.json"
    assert main(["scene", str(ROOT / "scenarios/accuracy/incline.yaml"), "-o", str(out)]) == 0
    scene = json.loads(out.read_text())
    assert [block["held"] for block in scene["blocks"]] == [True, False] and scene["end"] == 1
    (contact,) = scene["contacts"]
    assert contact["friction"] == pytest.approx(math.tan(math.radians(20))) and not contact["bonded"]
    ends = np.array([contact["from"], contact["to"]])
    assert np.linalg.norm(ends[1] - ends[0]) == pytest.approx(2) and np.ptp(ends[:, 1]) == pytest.approx(1)
    assert main(["scene", str(ROOT / "scenarios/verification/v08_incline.yaml"), "-o", str(out)]) == 2  # stages cannot be said


def test_the_config_of_the_page_works_with_the_program(tmp_path, monkeypatch):
    monkeypatch.delenv("TALUS", raising=False)
    try:
        talus = find_talus()
    except ResultError as not_built:
        pytest.skip(str(not_built))
    config = dataclasses.replace(chart.quick(chart.read_config(ROOT / "configs/speed_accuracy.yaml")), output=tmp_path, limit_s=60)
    few = {name: config.scenes[name] for name in ("incline", "stack", "wedge-merged")}
    config = dataclasses.replace(config, scenes=few, charts={"one": chart.charts.Chart(panels=[{"scene": "stack"}])})
    found = chart.measure(config, talus, say=lambda line: None)
    assert [row["said"] for row in found if row["method"] == "explicit"] == [""] * 3
    assert all(chart.draw(config, described, found) for described in config.charts.values())
