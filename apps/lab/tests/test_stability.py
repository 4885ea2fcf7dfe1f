"""The table of the stability suite, from rows written by hand and from a suite of two cases."""

import os

import pytest

from talus_lab import cli, stability
from talus_lab.program import find_talus
from talus_lab.errors import ResultError

CONFIG = """
scenarios: suite
output: out
page: page.md
methods: {explicit: 'explicit, faces', explicit general: general form, rigid: rigid}
tests: []
"""
PAGE = "before\n<!-- table modes -->\nold\n<!-- end -->\nafter\n"


def check(mode="F01", case="a", method="explicit", quantity="spin of b, max", measured=1e-4, asked="below", bar=1e-3, allowed=0.0, passed=True, trouble=""):
    return stability.Check(mode, "corners", case, method, quantity, measured, asked, bar, allowed, passed, trouble)


@pytest.fixture
def config(tmp_path):
    (tmp_path / "suite").mkdir()
    (tmp_path / "page.md").write_text(PAGE)
    (tmp_path / "stability.yaml").write_text(CONFIG)
    return tmp_path / "stability.yaml"


def test_a_cell_shows_the_number_nearest_to_its_bar():
    far, near = check(), check(case="b", quantity="rotation", measured=0.95, asked="expected", bar=1.0, allowed=0.1)
    assert stability.cell([far, near]) == "ok, 2 cases: rotation off by 0.05 of 0.1"
    assert stability.cell([far]) == "ok, 1 case: spin, max 0.0001 < 0.001"
    below_zero = check(quantity="position", measured=-2.0, asked="above", bar=-4.0)
    assert stability.cell([below_zero, far]) == "ok, 1 case: position -2 > -4"


def test_a_failure_hides_all_that_passed():
    text = stability.cell([check(), check(case="steep", measured=0.5, passed=False)])
    assert text == "**failed**: steep: spin, max 0.5 < 0.001"
    text = stability.cell([check(measured=float("nan"), passed=False, trouble="diverged: blocks lie in each other")])
    assert text.startswith("**failed**") and text.endswith("(diverged)")


def test_what_is_only_told_counts_as_guarded():
    told = check(quantity="fault `overlaps`", measured=1, asked="expected", bar=1, allowed=0)
    assert stability.cell([told]) == "guarded, 1 case"
    assert stability.cell([told, check(case="b")]) == "ok, 2 cases (1 guarded): spin, max 0.0001 < 0.001"


def test_equal_bits_have_no_share_of_a_bar():
    same = check(quantity="energy.kinetic", measured=7.5, asked="expected", bar=7.5, allowed=0)
    assert same.used == -1
    assert stability.cell([same]) == "ok, 1 case: equal in every bit"


def test_methods_without_a_row_have_no_column_and_modes_without_a_method_have_a_dash(config):
    rows = [check(), check(mode="F02", method="explicit general")]
    lines = stability.markdown(stability.read_config(config), rows).splitlines()
    assert lines[0] == "|  | failure mode | explicit, faces | general form |"
    assert lines[2].startswith("| F01 | corners | ok") and lines[2].endswith("| - |")
    assert lines[3].startswith("| F02 | corners | - | ok")
    refused = check(mode="F03", method="auto", quantity="fault `overlaps`")
    assert stability.markdown(stability.read_config(config), [*rows, refused]).splitlines()[4].count("guarded, 1 case") == 2
    with pytest.raises(ResultError, match="no column for static"):
        stability.markdown(stability.read_config(config), [check(method="static")])


def test_only_the_table_of_the_page_changes(config):
    read = stability.read_config(config)
    page = stability.fill_page(PAGE, read, [check()])
    assert page.startswith("before\n<!-- table modes -->\n|  |") and page.endswith("<!-- end -->\nafter\n") and "old" not in page
    with pytest.raises(ResultError, match="is missing"):
        stability.fill_page("no table", read, [check()])


def test_faults_of_a_config_are_told(config):
    config.write_text(CONFIG.replace("tests: []", "tests: [{mode: F26}]"))
    with pytest.raises(ResultError, match="each of tests needs"):
        stability.read_config(config)
    config.write_text(CONFIG.replace("tests", "test"))
    with pytest.raises(ResultError, match="needs the keys"):
        stability.read_config(config)
    config.write_text(CONFIG.replace("tests: []", "tests: [{mode: F26, title: a, method: magic, program: b, names: []}]"))
    with pytest.raises(ResultError, match="no method is called magic"):
        stability.read_config(config)


def test_a_suite_runs_and_fills_its_page(config):
    try:
        find_talus()
    except ResultError:
        pytest.skip("talus is not built")
    (config.parent / "suite" / "f99_fall.yaml").write_text("""
title: free fall
gravity: [0, -10]
materials: {rock: {density: 2500}}
blocks: [{name: b, rectangle: {corner: [0, 0], size: [1, 1]}}]
run: {until: {time: 1}}
expect: [{quantity: velocity, component: y, block: b, value: -10, tolerance: 0.01}]
cases: [{name: falls}, {name: rises, expect: [{quantity: velocity, component: y, block: b, value: 10, tolerance: 0.01}]}]
""")
    assert cli.main(["stability", str(config)]) == 1
    page = (config.parent / "page.md").read_text()
    assert "| F99 | free fall | **failed**: rises: velocity.y off by 20 of 0.1 |" in page
    assert (config.parent / "out" / "stability.csv").exists()


def test_tests_of_the_engine_count_when_they_are_built(config, tmp_path):
    folder = tmp_path / "bin"
    folder.mkdir()
    (folder / "test_x").write_text("#!/bin/sh\necho '<Catch><OverallResults successes=\"7\" failures=\"0\"/></Catch>'\n")
    os.chmod(folder / "test_x", 0o755)
    text = CONFIG.replace("tests: []", "tests: [{mode: F26, title: restart, method: explicit, program: test_x, names: [some words]},"
                                       " {mode: F27, title: b, method: explicit, program: test_y, names: [c]}]")
    config.write_text(text)
    checks = stability.tests(stability.read_config(config), str(folder / "talus"))
    assert [check.mode for check in checks] == ["F26"]
    assert stability.cell(checks) == "ok, 1 test: 7 checks"
