import json
import math
from pathlib import Path

import h5py
import numpy as np
import pytest
from sweeping import config, runs, stand_in, status, table

from talus_lab import sweep
from talus_lab.cli import main
from talus_lab.errors import ResultError
from talus_lab.study.formulas import FormulaError, holds
from talus_lab.sweep.cases import fill, levels
from talus_lab.sweep.config import Parameter, Sample, read_config
from talus_lab.sweep.ranges import draw, levels_of, number, quantile


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return stand_in(tmp_path, monkeypatch, workers=False)


def refused(path: Path, capsys: pytest.CaptureFixture, *options: str) -> str:
    assert main(["sweep", str(path), *options]) == 2
    return capsys.readouterr().err


# Values of parameters
@pytest.mark.parametrize(("given", "expected"), [
    (dict(values=[1, "2e9", "rough"]), [1, 2e9, "rough"]),
    (dict(from_=10, to=30, step=10), [10, 20, 30]),
    (dict(from_=30, to=10, step=-10), [30, 20, 10]),
    (dict(from_=0, to=1, step=0.3), [0.0, 0.3, 0.6, 0.9]),
    (dict(from_=0.1, to=0.3, step=0.1), [0.1, 0.2, 0.3]),  # 0.1 + 2 * 0.1 is not 0.3 in double numbers
    (dict(from_=10, to=50, count=5), [10.0, 20.0, 30.0, 40.0, 50.0]),
    (dict(from_="1e6", to="1e9", count=4, scale="log"), [1e6, 1e7, 1e8, 1e9]),
])
def test_values_of_a_parameter(given, expected):
    found, faults = levels_of(Parameter(**given), "p")
    assert faults == []
    assert found == expected


@pytest.mark.parametrize(("given", "fault"), [
    (dict(), "needs one of values, levels"), (dict(values=[]), "is empty"), (dict(from_=30, to=10, step=5), "from 30 to 10 by 5 is empty"),
    (dict(from_=30, to=10), "from 30 to 10 is empty"), (dict(from_=1, to=2, step=0), "is empty"), (dict(from_=1, to="x", count=3), "p.to: is not a finite number"),
    (dict(from_=1, to=2, count=3, step=1), "both count and step"), (dict(from_=0, to=2, count=3, scale="log"), "ends above 0"),
    (dict(values=[1], mean=3), "has values and mean"), (dict(mean=3, deviation=0), "deviation: is not above 0"), (dict(from_=1, to=2, count=1), "count"),
])
def test_a_range_that_is_none_is_a_fault(given, fault):
    found, faults = levels_of(Parameter(**given), "p")
    assert found == [] and len(faults) == 1 and fault in faults[0]


def test_a_latin_hypercube_has_one_value_in_each_of_as_many_equal_parts():
    for name in ("a", "b"):
        shares = draw(Sample(count=50, seed=3), name)
        assert sorted(int(50 * share) for share in shares) == list(range(50))
        assert shares != sorted(shares)
    assert draw(Sample(50, 3), "a") == draw(Sample(50, 3), "a") != draw(Sample(50, 4), "a")
    assert abs(np.corrcoef(draw(Sample(500, 3), "a"), draw(Sample(500, 3), "b"))[0, 1]) < 0.15  # 3 deviations of what chance does


def test_what_is_drawn_follows_its_distribution():
    normal = [quantile(Parameter(mean=30, deviation=2), share) for share in draw(Sample(400), "phi")]
    assert np.mean(normal) == pytest.approx(30, abs=0.05) and np.std(normal) == pytest.approx(2, rel=0.03)
    flat = [quantile(Parameter(from_=10, to=20), share) for share in draw(Sample(400, method="random"), "phi")]
    assert 10 <= min(flat) and max(flat) <= 20 and np.mean(flat) == pytest.approx(15, abs=0.6)
    wide = [quantile(Parameter(from_=1, to=100, scale="log"), share) for share in draw(Sample(400), "k")]
    assert np.median(wide) == pytest.approx(10, rel=0.02)


def test_conditions_compare_formulas_and_words():
    values = {"phi": 20, "dip": 30, "rock": "granite"}
    for condition, expected in [("phi < dip", True), ("phi + 10 <= dip < 31", True), ("not phi < dip", False), ("rock == 'granite' and dip > 40", False),
                                ("rock != 'granite' or tan_deg(45) >= 0.99", True)]:
        assert holds(condition, values) is expected
    for condition in ("phi", "phi < dap", "__import__('os') == 1", "phi <", "phi in [1]"):
        with pytest.raises(FormulaError):
            holds(condition, values)


def test_formulas_stand_anywhere_in_a_value():
    values = {"a": 30.0, "n": 3}
    assert fill(["{9.81*sin_deg(a)}", {"k": "{a}"}, "1e3", "x{n}"], values) == [pytest.approx(4.905), {"k": 30.0}, 1000.0, "x3"]
    assert number("rough") == "rough"


# Cases
def test_every_combination_is_a_case_named_by_its_scenario(tmp_path, here):
    found = sweep.prepare(config(tmp_path))
    assert [tuple(case.values.values()) for case in found.cases] == [(phi, rho) for phi in (10, 20, 30) for rho in (2400, 2500, 2600)]
    again = sweep.prepare(config(tmp_path, parameters={"rho": {"set": ["materials.rock.density"], "values": [2600]}},
                                 set={"joints.base.friction_angle_deg": 10.0}))
    assert again.cases[0].id == found.cases[2].id  # whatever the config calls it


def test_conditions_levels_formulas_and_repetitions(tmp_path, here):
    parameters = {"slope_deg": {"values": [0, 30], "set": {"gravity": ["{9.81*sin_deg(slope_deg)}", "{-9.81*cos_deg(slope_deg)}"]}},
                  "rock": {"levels": {"soft": {"materials.rock.density": 2000, "joints.base.friction_angle_deg": "{15 + slope_deg/10 + more}"},
                                      "hard": {"materials.rock.density": 2700}}},
                  "more": {"values": [0]}}
    found = sweep.prepare(config(tmp_path, parameters=parameters, where=["slope_deg == 0 or rock == 'soft'"], set={"title": "slope {slope_deg}"},
                                 repetitions={"count": 2, "seed": 5, "set": "blocks[1].spin"}))
    assert [(v["slope_deg"], v["rock"], v["repetition"]) for v in (case.values for case in found.cases)] == [(0, "soft", 5), (0, "soft", 6), (0, "hard", 5), (0, "hard", 6), (30, "soft", 5), (30, "soft", 6)]
    changes = dict(change.split("=", 1) for change in found.cases[5].overrides)
    assert json.loads(changes["gravity"]) == pytest.approx([4.905, -9.81 * math.sqrt(3) / 2])
    assert changes["joints.base.friction_angle_deg"] == "18.0" and changes["title"] == '"slope 30"' and changes["blocks[1].spin"] == "6"
    assert len({case.id for case in found.cases}) == 6


def test_drawn_parameters_go_together_and_with_every_point_of_the_grid(tmp_path, here):
    parameters = {"k": {"set": "joints.base.friction_angle_deg", "from": 10, "to": 40}, "n": {"set": "run.until.time", "values": [0.05, 0.1]},
                  "rho": {"set": "materials.rock.density", "mean": 2600, "deviation": 50}}
    path = config(tmp_path, parameters=parameters, sample={"count": 4, "seed": 2})
    rows = [case.values for case in sweep.prepare(path).cases]
    assert len(rows) == 8
    assert [(row["k"], row["rho"]) for row in rows[:4]] == [(row["k"], row["rho"]) for row in rows[4:]]
    assert levels(read_config(path))["k"] == [row["k"] for row in rows[:4]]


# Running
def test_a_sweep_makes_one_table_of_parameters_measures_and_provenance(tmp_path, here, capsys):
    path = config(tmp_path)
    assert main(["sweep", str(path), "--workers", "2"]) == 0
    assert "9 cases: 9 done" in capsys.readouterr().out
    rows = table(tmp_path)
    assert list(rows[0]) == ["case", "friction_deg", "density", "max_displacement", "way", "status", "wall_time", "talus_version", "scenario_hash",
                             "host", "started"]
    # The plane dips at atan(1/2) = 26.6 deg: at 30 it holds; below it slides, by s = a t^2 / 2 = g (sin - cos tan phi) t^2 / 2
    for row in rows:
        phi, way = float(row["friction_deg"]), float(row["max_displacement"])
        a = 9.81 * (math.sin(math.atan(0.5)) - math.cos(math.atan(0.5)) * math.tan(math.radians(phi)))
        assert way == pytest.approx(0.5 * max(a, 0) * 0.05**2, rel=0.02, abs=1e-4) and way * (1 - 1e-6) <= float(row["way"]) < way + 1e-4
        assert row["scenario_hash"] == row["case"] and row["status"] == "done" and 0 < float(row["wall_time"]) < 60
    with h5py.File(tmp_path / "out/table.h5") as file:
        assert {name: file[name].attrs["unit"] for name in ("density", "friction_deg", "max_displacement", "way", "wall_time", "status")} == {
            "density": "kg/m3", "friction_deg": "deg", "max_displacement": "m", "way": "m", "wall_time": "s", "status": "-"}
        assert file["max_displacement"][:].tolist() == [float(row["max_displacement"]) for row in rows]
        assert file["case"][:].tolist() == [row["case"].encode() for row in rows]
    about = json.loads((tmp_path / "out/sweep.json").read_text())
    assert about["parameters"][1] == {"name": "density", "keys": ["materials.rock.density"], "unit": "kg/m3", "label": "density", "kind": "grid",
                                      "values": [2400, 2500, 2600]}
    assert [(m["name"], m["unit"]) for m in about["measures"]] == [("max_displacement", "m"), ("way", "m")]
    for row in rows:
        assert sorted(file.name for file in (tmp_path / "out/cases" / row["case"]).iterdir()) == ["log.txt", "status.json"]


def test_the_table_is_written_as_parquet_too_if_asked_for(tmp_path, here, capsys, monkeypatch):
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    sweep.sweep(config(tmp_path, parquet=True, measures=["verdict", "max_displacement"], where=["density == 2500"]))
    found = parquet.read_table(tmp_path / "out/table.parquet")
    assert [{name: str(value) for name, value in row.items()} for row in found.select(["case", "verdict", "status"]).to_pylist()] == [
        {name: row[name] for name in ("case", "verdict", "status")} for row in table(tmp_path)]
    assert found["max_displacement"].to_pylist() == [float(row["max_displacement"]) for row in table(tmp_path)]
    assert found.schema.field("max_displacement").metadata[b"unit"] == b"m" and found.schema.field("density").type == "double"
    assert json.loads(found.schema.metadata[b"sweep"])["cases"] == 3


def test_parquet_without_its_package_says_what_to_install(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("talus_lab.sweep.config.find_spec", lambda name: None)
    assert "parquet: needs the package pyarrow: pip install 'talus-lab[parquet]'" in refused(config(tmp_path, parquet=True), capsys)


def test_a_second_call_computes_only_what_is_missing_or_changed(tmp_path, here):
    sweep.sweep(config(tmp_path, keep="results"))
    assert len(runs(here)) == 9
    sweep.sweep(config(tmp_path, keep="results"))
    assert len(runs(here)) == 9
    wider = {"friction_deg": {"set": "joints.base.friction_angle_deg", "values": [10, 20, 30, 40]}, "density": {"set": "materials.rock.density", "values": [2500]}}
    sweep.sweep(config(tmp_path, keep="results", parameters=wider))
    assert len(runs(here)) == 10 and len(table(tmp_path)) == 4
    # Another measure is taken of results that were kept; of those that were not, after another run
    found = sweep.sweep(config(tmp_path, keep="results", parameters=wider, measures=["run_out"]))
    assert len(runs(here)) == 10 and "run_out" in table(tmp_path)[0]
    (tmp_path / "out/cases" / found.cases[0].id / "out.h5").unlink()
    sweep.sweep(config(tmp_path, parameters=wider, measures=["moved_area"]))
    assert len(runs(here)) == 11


def test_dry_run_computes_nothing_and_says_what_is_there(tmp_path, here, capsys):
    path = config(tmp_path)
    assert main(["sweep", str(path), "--dry-run"]) == 0
    assert "9 cases: 9 missing" in capsys.readouterr().out
    assert not (tmp_path / "out").exists() and runs(here) == []


def test_cases_that_are_the_same_scenario_are_computed_once(tmp_path, here):
    twins = {"a": {"set": "joints.base.friction_angle_deg", "values": [20, 20.0, "2e1"]}}
    found = sweep.sweep(config(tmp_path, parameters=twins))
    assert len(runs(here)) == 1 and len(table(tmp_path)) == 3
    assert "2 have the same scenario" in sweep.summary(found)


# Bad input
def test_faults_come_in_one_report_with_file_and_line_and_nothing_is_touched(tmp_path, here, capsys):
    sweep.sweep(config(tmp_path))
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")}
    path = config(tmp_path, parameters={"a": {"set": "joints.base.friction_angel_deg", "values": [10, 20]}, "b": {"set": "run.untl.time", "from": 1, "to": 2, "step": 1}})
    lines = path.read_text().splitlines()
    a, b = (next(k for k, line in enumerate(lines, 1) if word in line) for word in ("friction_angel", "untl"))
    err = refused(path, capsys)
    assert f"sweep.yaml:{a} parameters.a.set: joints.base.friction_angel_deg: " in err and "did you mean friction_angle_deg?" in err
    assert f"sweep.yaml:{b} parameters.b.set: run.untl: untl is an unknown key; did you mean until?" in err or \
           f"sweep.yaml:{b} parameters.b.set: run.untl.time: untl is an unknown key; did you mean until?" in err
    assert len(err.strip().splitlines()) == 2
    path = config(tmp_path, measures=["max_displacment", {"name": "x", "history": "block", "at": "middle"}], keep="everything",
                  parameters={"a": {"set": "gravity", "from": 3, "to": 1, "step": 1}})
    err = refused(path, capsys)
    assert "measures[0]: unknown measure max_displacment; did you mean max_displacement?" in err and "at: middle; there are" in err
    path = config(tmp_path, parameters={"a": {"set": "gravity", "from": 3, "to": 1, "step": 1}})
    assert "sweep.yaml:4 parameters.a: the range from 3 to 1 by 1 is empty" in refused(path, capsys)
    assert "where: no combination" in refused(config(tmp_path, where=["friction_deg > 90"]), capsys)
    assert "where[0]: " in refused(config(tmp_path, where=["friction > 90"]), capsys)
    assert "parameters.a: sets no key" in refused(config(tmp_path, parameters={"a": {"values": [1]}}), capsys)
    assert "no file" in refused(config(tmp_path, scenario="none.yaml"), capsys)
    assert "friction_angle_deg: expected number" in refused(config(tmp_path, set={"joints.base.friction_angle_deg": 99}, parameters={
        "d": {"set": "materials.rock.density", "values": [2500]}}), capsys)
    assert "is a column of every table" in refused(config(tmp_path, parameters={"status": {"set": "title", "values": ["a"]}}), capsys)
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")} == before


@pytest.mark.parametrize(("text", "fault"), [
    ("", "is no config"), ("- a", "is no config"), ("a: [1, 2\nb: 3", ":2 no YAML: expected ',' or ']'"), ("a: &x [*x]", ":1 no YAML: an alias that stands within"),
    ("scenario: a\noutput: b\nscenario: c", ":3 scenario: stands here for a second time"), (b"title: B\xf6schung", "is no text in UTF-8"),
    ("materials: {}\nrun: {}", "is a scenario, which `talus run` computes")])
def test_a_file_that_is_no_config_is_told_in_one_line(tmp_path, text, fault):
    path = tmp_path / "sweep.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ResultError) as told:
        read_config(path)
    assert fault in str(told.value) and len(str(told.value).splitlines()) == 1


@pytest.mark.parametrize(("changes", "fault"), [
    (dict(parameters={"a": {"set": 5, "values": [1]}}), "parameters.a.set: is neither a key"), (dict(set={"title=x": 1}), "set: title=x is no key of a scenario"),
    (dict(parameters={"a": {"set": "title", "levels": {"x": {"title": "b"}}}}), "parameters.a.set: levels say"),
    (dict(parameters={"a": {"set": "title", "from": 1, "to": float("inf"), "count": 3}}), "parameters.a.to: is not a finite number"),
    (dict(parameters={"a": {"set": "title", "from": 1, "to": 2, "step": 1e-300}}), "parameters.a: has more than 1000000 values"),
    (dict(repetitions={"count": 2, "set": {"title": 1}}), "repetitions.set: is neither"), (dict(cluster={"kind": "slrum"}), "did you mean slurm?"),
    (dict(output="incline.yaml/out"), "incline.yaml is no folder"), (dict(output="."), "output: is the folder of the config"),
    (dict(measures=[{"name": "x", "measure": "displacement"}]), "needs point"), (dict(measures=[{"name": "x", "measure": "run_out", "limt": 1}]), "did you mean limit?"),
    (dict(measures=[{"name": "x", "measure": "displacement", "point": "here"}]), "point is not a point [x, y]")])
def test_what_a_config_must_not_say_is_told_before_talus_is_asked(tmp_path, changes, fault):
    with pytest.raises(ResultError) as told:
        read_config(config(tmp_path, **changes))
    assert fault in str(told.value) and len(str(told.value).splitlines()) == 1


def test_more_combinations_than_can_be_meant_are_refused_at_once(tmp_path, here, capsys):
    wide = {"set": "title", "from": 1, "to": 2000, "step": 1}
    assert "make 4e+06 combinations" in refused(config(tmp_path, parameters={"a": wide, "b": wide | {"set": "source"}}), capsys)
    assert "is too large" in refused(config(tmp_path, where=["9**9**9 > friction_deg"]), capsys)


def test_a_program_that_is_not_talus_is_told(tmp_path, monkeypatch, capsys):
    for program in ("/bin/false", "/bin/true"):
        monkeypatch.setenv("TALUS", program)
        assert f"{program}: is not talus" in refused(config(tmp_path), capsys)


def test_names_in_pictures_are_looked_at_before_anything_is_computed(tmp_path, here, capsys):
    curve = {"theory": "plane_slide", "slope": "dip", "friction": "friction_deg"}
    listed = {"a": {"kind": "map", "x": "friction", "value": "max_displacment", "only": {"verdict": "stable"}, "curves": [curve]}}
    err = refused(config(tmp_path, pictures=listed), capsys).splitlines()
    assert len(err) == 4 and "pictures.a.x: unknown friction; did you mean friction_deg?" in err[0] and "slope: no column dip" in err[3]
    assert all("sweep.yaml:" in line for line in err) and runs(here) == []


def test_who_asks_for_another_measure_later_hears_what_it_costs(tmp_path, here, capsys):
    few = dict(where=["density == 2500"])
    sweep.sweep(config(tmp_path, **few))
    path = config(tmp_path, measures=["max_displacement", "run_out"], **few)
    assert main(["sweep", str(path), "--dry-run"]) == 0
    said = capsys.readouterr().out
    assert "3 cases that are done run again for run_out: their results were not kept (keep: results)" in said and "3 cases: 3 done; 3 to compute" in said
    assert main(["sweep", str(path)]) == 0
    assert "3 cases that are done run again for run_out" in capsys.readouterr().err
    assert main(["sweep", str(path), "--dry-run"]) == 0
    assert "0 to compute" in capsys.readouterr().out


def test_a_measure_of_what_is_not_recorded_stops_the_sweep(tmp_path, here, capsys):
    path = config(tmp_path, measures=["run_out", {"name": "x", "history": "blok"}])
    assert "measures[1]: no history blok; did you mean block?" in refused(path, capsys) and runs(here) == []
    path = config(tmp_path, measures=[{"name": "x", "history": "block", "column": "speed"}])
    assert "no column speed" in refused(path, capsys)
    assert all("measures" not in status(tmp_path, folder.name) for folder in (tmp_path / "out/cases").iterdir() if (folder / "status.json").exists())


def test_an_engine_that_is_not_installed_says_what_to_install(tmp_path, here, capsys, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "distributed", None)
    assert "pip install 'talus-lab[dask]'" in refused(config(tmp_path), capsys, "--engine", "dask")
    with pytest.raises(ResultError, match="cluster.kind"):
        from talus_lab.sweep.engines import _queue
        _queue({"kind": "slrum"})
