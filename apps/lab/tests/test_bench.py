import csv
import dataclasses
import stat
import sys
from pathlib import Path

import matplotlib.image
import pytest
import yaml

from talus_lab import bench
from talus_lab.bench.measure import COLUMNS
from talus_lab.bench.select import growth
from talus_lab.cli import main
from talus_lab.program import find_talus
from talus_lab.errors import ResultError
from talus_lab.study.formulas import FormulaError, filled
from talus_lab.study.page import number

ROOT = Path(__file__).resolve().parents[3]

# Stands in for talus: dess takes 2 ns per box and block of the scene, isu 20 ns. Says what it was asked, fails when told so.
STAND_IN = """#!{python} -IS
import json, os, pathlib, sys
given, here = sys.argv[1:], pathlib.Path(__file__).parent
with open(here / "asked", "a") as asked:
    asked.write(json.dumps(given) + "\\n")
if (here / "fail").exists() and (here / "fail").read_text() in " ".join(given):
    sys.exit("rock: nothing is left of it")
option = lambda name: given[given.index(name) + 1]
blocks = int(next(word for word in given if word.startswith("size=")).removeprefix("size="))
with open(option("-o"), "w") as out:
    if given[1] == "search":
        out.write("scene,boxes,steps,method,threads,skin,ns_per_box_median,bytes_per_box\\n")
        for method in option("--methods").split(","):
            for threads in option("--threads").split(","):
                ns = 2 * blocks if method == "dess" else 20 / int(threads)
                out.write(f"rock,{{blocks}},{{option('--steps')}},{{method}},{{threads}},0,{{ns}},{{ns * 10}}\\n")
    else:
        out.write(f"scene,blocks,threads,steps,ns_per_block_and_step,search\\nrock,{{blocks}},1,5,{{100 + len(given)}},7\\n")
"""
PAGE = "# Rock\nBefore\n<!-- table ratio -->\nold\n<!-- end -->\nbetween\n<!-- table growth -->\n<!-- end -->\nafter\n"


def study_config() -> dict:
    return {
        "output": "out", "page": "page.md", "images": "images", "largest": {"direct": 100},
        "quantities": {"blocks": {"label": "number of blocks", "short": "blocks"}, "ns_per_box_median": {"label": "time, ns per block"},
                       "ns_per_block_and_step": {"label": "time of a step, ns per block"}},
        "scenes": {"rock": {"scenario": "rock.yaml", "name": "a rock mass", "set": {"blocks": {"size": "{blocks}"}}}},
        "studies": {
            "alone": {"command": "search", "scenes": ["rock"], "vary": {"blocks": [100, 1000, 10000]}, "methods": ["dess", "isu", "direct"],
                      "steps": "{min(60, 2000 / blocks)}", "threads": [1, 2]},
            "whole": {"command": "step", "scenes": ["rock"], "vary": {"blocks": [100]}, "methods": ["dess", "isu"], "skins": [0, "auto"]},
            "huge": {"command": "search", "scenes": ["rock"], "vary": {"blocks": [1000000]}, "methods": ["isu"], "long": True}},
        "charts": {},
        "tables": {"ratio": {"kind": "ratios", "studies": ["alone"], "pairs": [["dess", "isu"], ["isu", "isu@2"]]},
                   "growth": {"kind": "growth", "studies": ["alone"], "between": [100, 10000], "series": ["dess", "isu"]}}}


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A folder with a config, its page, and a program that stands in for talus."""
    program = tmp_path / "bin" / "talus"
    program.parent.mkdir()
    program.write_text(STAND_IN.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("TALUS", str(program))
    (tmp_path / "rock.yaml").write_text("title: rock\n")
    (tmp_path / "page.md").write_text(PAGE)
    write(tmp_path, study_config())
    return tmp_path


def write(folder: Path, config: dict) -> None:
    (folder / "study.yaml").write_text(yaml.safe_dump(config))


def command(folder: Path, *options: str) -> int:
    return main(["bench", str(folder / "study.yaml"), *options])


def asked(folder: Path) -> list[str]:
    log = folder / "bin" / "asked"
    lines = log.read_text().splitlines() if log.exists() else []
    log.unlink(missing_ok=True)
    return lines


def results(folder: Path) -> list[dict]:
    with open(folder / "out" / "results.csv", newline="") as file:
        return list(csv.DictReader(file))


def test_a_study_becomes_a_table_charts_and_the_numbers_of_its_page(study, capsys):
    config = study_config()
    config["charts"] = {"time": {"kind": "methods", "panels": [{"studies": ["alone"], "scene": "rock", "title": "Rock"}]},
                        "shares": {"kind": "shares", "panels": [{"studies": ["whole"], "scene": "rock", "title": "Rock"}]}}
    write(study, config)
    assert command(study) == 0
    rows = results(study)
    assert tuple(rows[0]) == COLUMNS
    assert [(row["value"], row["method"], row["threads"]) for row in rows if row["study"] == "alone"][:3] == [
        ("100", "dess", "1"), ("100", "dess", "2"), ("100", "isu", "1")]
    assert {row["steps"] for row in rows if row["value"] == "10000"} == {"0"}  # the formula, as a whole number
    assert {row["value"] for row in rows if row["method"] == "direct"} == {"100"}  # left out above
    assert [(row["method"], row["skin"]) for row in rows if row["study"] == "whole"] == [
        ("dess", "0"), ("isu", "0"), ("dess", "auto"), ("isu", "auto")]
    for picture in ("time", "shares"):
        assert matplotlib.image.imread(study / "images" / f"{picture}.png")[..., :3].std() > 0.05
        assert (study / "out" / f"{picture}.svg").exists()
    page = (study / "page.md").read_text()
    assert page.startswith("# Rock\nBefore\n<!-- table ratio -->\n| scene | blocks | dess / isu | isu / isu, 2 threads |")
    assert "| a rock mass | 1,000 | 100 | 2.0 |" in page and "old" not in page
    assert "| a rock mass | 100 to 10,000 | 2.00 | 1.00 |" in page
    assert page.endswith("<!-- end -->\nafter\n")
    assert "[4/4] whole, rock, blocks 100: " in capsys.readouterr().out


def test_an_interrupted_study_goes_on_where_it_stopped(study, capsys):
    (study / "bin" / "fail").write_text("size=10000")
    assert command(study) == 2
    said = capsys.readouterr().err
    assert "rock: nothing is left of it" in said and "goes on from here" in said
    assert {row["value"] for row in results(study)} == {"100", "1000"} and len(asked(study)) == 3
    assert command(study, "--draw") == 0 and asked(study) == []
    assert "| 1,000 | 100 |" in (study / "page.md").read_text() and "10,000 |" not in (study / "page.md").read_text()
    (study / "bin" / "fail").unlink()
    assert command(study) == 0
    assert len(asked(study)) == 1 + 4
    assert command(study) == 0 and asked(study) == []


def test_what_changed_is_measured_anew_and_only_that(study):
    assert command(study) == 0 and len(asked(study)) == 3 + 4
    changed = study_config()
    changed["studies"]["alone"]["vary"]["blocks"] = [100, 2000]
    changed["studies"]["whole"]["repeat"] = 7
    write(study, changed)
    assert command(study) == 0
    again = asked(study)
    assert len(again) == 1 + 4 and "size=2000" in again[0] and '"7"' in again[1]
    assert {row["value"] for row in results(study) if row["study"] == "alone"} == {"100", "2000"}
    with open(study / "bin" / "talus", "a") as program:
        program.write("# another build\n")
    assert command(study) == 0 and len(asked(study)) == 2 + 4
    (study / "rock.yaml").write_text("title: other rock\n")
    assert command(study) == 0 and len(asked(study)) == 2 + 4
    assert command(study, "--again") == 0 and len(asked(study)) == 2 + 4


def test_words_written_while_it_measures_stay_in_the_page(study, monkeypatch):
    def measure_and_write(*arguments):
        (study / "page.md").write_text(PAGE.replace("Before", "Meanwhile"))
        return measure(*arguments)

    measure = bench.measure
    monkeypatch.setattr(bench, "measure", measure_and_write)
    assert command(study) == 0
    page = (study / "page.md").read_text()
    assert "Meanwhile" in page and "dess / isu" in page


def test_long_studies_are_measured_when_asked_for_and_kept(study):
    assert command(study) == 0 and not any(row["study"] == "huge" for row in results(study))
    assert command(study, "--long") == 0
    assert command(study, "--again") == 0 and any(row["study"] == "huge" for row in results(study))


def test_quick_leaves_the_page_alone_and_is_small(study):
    assert command(study, "--quick") == 0
    assert (study / "page.md").read_text() == PAGE
    assert "dess / isu" in (study / "out" / "quick" / "page.md").read_text()
    assert all(any(f"size={n}" in line for n in (100, 300)) and '"--steps", "3"' in line for line in asked(study))


def test_every_fault_of_a_config_is_in_one_report(study, capsys):
    config = study_config()
    config["pages"] = config.pop("page")
    config["studies"]["alone"]["method"] = config["studies"]["alone"].pop("methods")
    config["studies"]["whole"]["repeat"] = "often"
    config["scenes"]["rock"]["set"] = None
    write(study, config)
    assert command(study) == 2
    said = capsys.readouterr().err
    for fault in ("pages: unknown key; did you mean page?", "page: is missing", "studies.alone.method: unknown key; did you mean methods?",
                  "studies.alone.methods: is missing", "studies.whole.repeat: is not a whole number", "scenes.rock.set: is not a mapping"):
        assert fault in said
    assert asked(study) == [] and not (study / "out").exists()


def test_names_that_fit_nothing_are_faults(study, capsys):
    config = study_config()
    config["scenes"]["rock"]["scenario"] = "stone.yaml"
    config["studies"]["alone"].update(methods=["isu", "des"], scenes=["rocks"])
    config["studies"]["whole"]["vary"] = {"angle": [0]}
    config["studies"]["huge"]["steps"] = "{blocks + friction}"
    config["charts"]["time"] = {"kind": "methods", "panels": [{"studies": ["along"], "scene": "rock"}]}
    config["tables"]["growth"]["kind"] = "grow"
    write(study, config)
    assert command(study) == 2
    said = capsys.readouterr().err
    for fault in ("there is no file stone.yaml", "unknown des; did you mean dess?", "unknown rocks; did you mean rock?",
                  "studies.whole, scene rock: unknown angle", "no value is called friction", "unknown along; did you mean alone?",
                  "unknown grow; did you mean growth?"):
        assert fault in said
    assert asked(study) == []


@pytest.mark.parametrize("text, words", [("", "is no config"), ("a: [", "no YAML"), ("- 1\n", "is no config")])
def test_a_file_that_is_no_config_is_refused(study, text, words, capsys):
    (study / "study.yaml").write_text(text)
    assert command(study) == 2
    assert words in capsys.readouterr().err


def test_a_program_that_is_not_there_is_one_line(study, monkeypatch, capsys):
    monkeypatch.setenv("TALUS", str(study / "nothing"))
    assert command(study) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_libraries_are_left_out_where_their_program_is_not_built(study, capsys):
    config = study_config()
    config["studies"]["peers"] = {"command": "peers", "scenes": ["rock"], "vary": {"blocks": [100]}, "methods": ["isu", "box2d"]}
    config["tables"]["ratio"]["studies"] = ["peers"]
    write(study, config)
    assert command(study) == 0
    assert "left out, talus_bench_peers is not built: peers" in capsys.readouterr().out
    assert "<!-- table ratio -->\nnot measured\n<!-- end -->" in (study / "page.md").read_text()


@pytest.mark.parametrize("text, words", [(PAGE.replace("table growth", "table grows"), "no table is called grows"),
                                         (PAGE.replace("<!-- table growth -->\n<!-- end -->\n", ""), "<!-- table growth -->"),
                                         (PAGE.replace("<!-- end -->\nafter", "after"), "growth")])
def test_markers_and_tables_have_to_match_before_anything_is_measured(study, text, words, capsys):
    (study / "page.md").write_text(text)
    assert command(study) == 2
    assert words in capsys.readouterr().err and asked(study) == []
    assert (study / "page.md").read_text() == text


def test_a_table_of_another_kind_is_not_overwritten(study, capsys):
    (study / "out").mkdir()
    (study / "out" / "results.csv").write_text("mine\n1\n")
    assert command(study) == 2
    assert "move it away" in capsys.readouterr().err and (study / "out" / "results.csv").read_text() == "mine\n1\n"


def test_formulas_are_arithmetic_and_nothing_else():
    assert filled("[0, {sqrt(n) / 2}, {-n ** 2}]", {"n": 16}) == "[0, 2, -256]"
    assert filled(7, {}) == "7"
    for bad in ("{m}", "{n.real}", "{__import__('os')}", "{1 / 0}", "{sqrt(-1)}", "{n +}", "{open('x')}", "{}"):
        with pytest.raises(FormulaError):
            filled(bad, {"n": 16})


def test_growth_is_the_exponent_of_a_power_law():
    assert growth({10: 5 * 10**1.5, 1000: 5 * 1000**1.5}, 10, 1000) == pytest.approx(1.5)


def test_totals_run_over_threads_and_skins(study):
    config = study_config()
    config["tables"]["ratio"] = {"kind": "totals", "studies": ["alone"], "column": "ns_per_box_median", "series": ["dess", "isu"]}
    write(study, config)
    assert command(study) == 0
    assert "| a rock mass | 1,000 | 4,000 | 30.0 |" in (study / "page.md").read_text()  # 2000 + 2000, 20 + 10


def test_numbers_read_well():
    assert [number(x) for x in (12345.6, 123.4, 12.34, 1.234, 0.01234, 0, None)] == ["12,300", "123", "12.3", "1.23", "0.0123", "0", "-"]


def test_the_config_of_the_page_works_with_the_program(tmp_path, monkeypatch):
    monkeypatch.delenv("TALUS", raising=False)
    try:
        talus = find_talus()
    except ResultError as not_built:
        pytest.skip(str(not_built))
    config = bench.quick(bench.read_config(ROOT / "configs/contact_detection.yaml"))
    config = dataclasses.replace(config, output=tmp_path)
    rows = bench.measure(config, talus, say=lambda line: None)
    assert {row["study"] for row in rows} >= {name for name, study in config.studies.items() if study.command != "peers" and not study.long}
    assert {row["wrong_steps"] for row in rows if row["study"] == "exact"} == {"0"}
    bench.fill_page(config.page.read_text(encoding="utf-8"), config, rows)
    assert all(bench.draw(config, chart, rows) for name, chart in config.charts.items() if name != "contact_search_beyond")
