import h5py
import numpy as np
import pytest

import talus_lab
from conftest import ORIGIN, SLIDE, tell
from talus_lab import measures


def test_what_the_engine_said_is_given_as_it_is(result):
    run = talus_lab.open(tell(result, mechanism="slide", moving_blocks=2, moving_area=4.0))
    assert measures.verdict(run) == "unstable" and measures.mechanism(run) == "slide"
    assert measures.moving_blocks(run) == 2 and measures.moving_area(run) == 4.0
    assert list(run.verdict["block_mechanism"]) == [0, 1, 2]


def test_a_run_that_ended_before_its_verdict_is_undecided(result):
    run = talus_lab.open(result)
    assert measures.verdict(run) == "undecided" and np.isnan(measures.moving_blocks(run))


def test_held_blocks_do_not_count(result):
    run = talus_lab.open(result)
    assert measures.max_displacement(run) == pytest.approx(SLIDE[-1])
    assert measures.max_displacement(run, frame=1) == pytest.approx(SLIDE[1])
    assert measures.max_rotation_deg(run) == pytest.approx(90)
    assert measures.moved_blocks(run, limit=0.1) == 1 and measures.moved_area(run, limit=0.1) == 1.0
    assert measures.moved_blocks(run, limit=0.5) == 0


def test_the_block_at_a_point_is_found_and_else_the_nearest(result):
    run = talus_lab.open(result)
    assert measures.block_at(run, ORIGIN + [0.3, 0.9]) == 1
    assert measures.block_at(run, ORIGIN + [2.5, 1.5]) == 2  # the second part of the L
    assert measures.block_at(run, ORIGIN + [0.2, 1.8]) == 1  # in the air
    assert measures.displacement(run, ORIGIN + [0.3, 0.9]) == pytest.approx(0.4)
    assert measures.displacement(run, ORIGIN + [0.3, 0.9], "y") == 0


def test_run_out_is_how_far_what_moved_reaches_beyond_where_it_reached(result):
    assert measures.run_out(talus_lab.open(result)) == pytest.approx(0.4)
    assert measures.run_out(talus_lab.open(result), limit=0.5) == 0
    with h5py.File(result, "a") as file:
        file["talus/frames/position"][2, 1:, 0] = [6.0, -4.0]  # both have moved; the L, once the right one, is the left one now
        file["VTKHDF/CellData/displacement"][2 * 4 + 1 : 3 * 4, 0] = [6.0, -7.0, -7.0]
    # The right end goes from 4 to 6.5, the left end from -0.5 to -5: arms of the L turned by 90 degrees lie between -1 and 1
    assert measures.run_out(talus_lab.open(result)) == pytest.approx(4.5)


def test_histories_and_energies_are_read_at_the_end_or_where_they_are_largest(result):
    run = talus_lab.open(result)
    assert measures.history(run, "slide", "x") == pytest.approx(0.4)
    assert measures.history(run, "slide", "x", at="mean") == pytest.approx(SLIDE.mean())
    assert measures.energy(run, "kinetic", at="max") == 2
    assert measures.end_time(run) == 1.0


def test_stress_along_a_line_comes_in_order_and_leaves_other_joints_out(result):
    run = talus_lab.open(result)
    along = measures.stress_along(run, ORIGIN + [5, 0], ORIGIN + [-1, 0])
    assert along["distance"] == pytest.approx([2.0, 4.9]) and list(along["normal_stress"]) == [3, 2]
    assert len(measures.stress_along(run, ORIGIN + [0.1, -1], ORIGIN + [0.1, 1])["distance"]) == 0  # across the joint


@pytest.mark.parametrize("name, options, complaint", [
    ("max_displacemnt", {}, "did you mean max_displacement"), ("history", {"name": "slid"}, "did you mean slide"),
    ("history", {"name": "slide"}, "say which column of x, a"), ("energy", {"name": "kinetc"}, "did you mean kinetic"),
    ("energy", {"name": "kinetic", "at": "ende"}, "did you mean end"), ("run_out", {"limt": 1}, "limt")])
def test_unknown_names_are_told_with_the_right_ones(result, name, options, complaint):
    with pytest.raises(talus_lab.ResultError, match=complaint):
        measures.evaluate(talus_lab.open(result), name, **options)


def test_every_measure_has_a_unit_and_works_on_a_result_without_verdict(result):
    run = talus_lab.open(result)
    options = {"displacement": {"point": ORIGIN}, "history": {"name": "slide", "column": "x"}}
    for name, measure in measures.MEASURES.items():
        assert isinstance(measures.evaluate(run, name, **options.get(name, {})), (float, int, str)) and measure.unit
