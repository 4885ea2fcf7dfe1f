import numpy as np
import pytest

import talus_lab
from conftest import ORIGIN, SLIDE, write_result


def test_blocks_and_corners_are_given_in_the_coordinates_of_the_scenario(result):
    run = talus_lab.open(result)
    assert run.title == "A square that slides"
    assert list(run.blocks["name"]) == ["floor", "square", ""]
    square = run.corners(2)[4:8] - ORIGIN
    assert square == pytest.approx(np.array([[-0.1, 0], [0.9, 0], [0.9, 1], [-0.1, 1]]))


def test_corners_turn_with_their_block(result):
    corner = talus_lab.open(result).corners(-1)[9] - ORIGIN  # arm (1, -1) turned by 90 degrees is (1, 1)
    assert corner == pytest.approx([4.0, 2.0])


def test_fields_of_parts_are_given_by_block(result):
    run = talus_lab.open(result)
    assert run.displacement(2) == pytest.approx(np.array([[0, 0], [SLIDE[2], 0], [0, 0]]))
    assert run.velocity(1)[1] == pytest.approx([0.5, 0])
    assert run.rotation(2) == pytest.approx([0, 0, np.pi / 2])


def test_contacts_are_those_of_the_frame(result):
    run = talus_lab.open(result)
    assert [len(run.contacts(k)["x"]) for k in range(3)] == [0, 1, 2]
    assert list(run.contacts(2)["normal_force"]) == [20, 30]
    assert run.contacts(2)["x"] == pytest.approx(ORIGIN[0] + np.array([0.1, 3.0]))


def test_histories_keep_the_order_of_their_columns(result):
    history = talus_lab.open(result).histories["slide"]
    assert list(history) == ["time", "x", "a"]
    assert history["x"] == pytest.approx(SLIDE)


def test_frames_that_were_never_finished_are_not_there(tmp_path):
    run = talus_lab.open(write_result(tmp_path / "killed.h5", frames=2))
    assert list(run.times) == [0, 0.5]
    assert len(run.energies["kinetic"]) == 2
    assert run.angle(-1)[2] == 0
    with pytest.raises(talus_lab.ResultError, match="no frame 2, there are 2"):
        run.position(2)


def test_arrays_cannot_be_changed(result):
    run = talus_lab.open(result)
    for array in (run.times, run.position(0), run.blocks["area"], run.histories["slide"]["x"], run.contacts(1)["x"]):
        with pytest.raises(ValueError):
            array[0] = 1
    with pytest.raises(AttributeError):
        run.frame_count = 7


def test_the_frame_nearest_to_a_time_is_found(result):
    run = talus_lab.open(result)
    assert [run.frame_at(t) for t in (-1, 0.2, 0.3, 9)] == [0, 0, 1, 2]


@pytest.mark.parametrize("content, complaint", [(None, "no such file"), (b"hello", "not an HDF5 file")])
def test_what_is_no_result_is_refused_in_words(tmp_path, content, complaint):
    path = tmp_path / "x.h5"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(talus_lab.ResultError, match=complaint):
        talus_lab.open(path)
