import matplotlib.image
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection

import talus_lab
from conftest import ORIGIN
from talus_lab import layers, plot
from talus_lab.cli import main


def lines(figure):
    return [c for c in figure.axes[0].collections if isinstance(c, LineCollection)]


def legend(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.parametrize("color", plot.COLORS)
def test_every_colouring_makes_a_picture(result, tmp_path, color):
    picture = tmp_path / f"{color}.png"
    assert main(["plot", str(result), "-o", str(picture), "--color", color, "--forces", "--before-after"]) == 0
    pixels = matplotlib.image.imread(picture)[..., :3]
    assert pixels.shape[1] > 600 and pixels.std() > 0.05


def test_colours_follow_displacement_and_the_bar_says_its_unit(result):
    run = talus_lab.open(result)
    figure = plot.picture(run)
    free = next(c for c in figure.axes[0].collections if isinstance(c, PolyCollection))
    square, first_part, second_part = free.get_facecolors()
    assert (first_part == second_part).all() and (square != first_part).any()
    assert figure.axes[-1].get_ylabel() == "displacement in mm"
    assert figure.axes[-1].get_ylim() == pytest.approx((0, 400))


def test_edges_inside_a_block_are_not_drawn(result):
    edges = lines(plot.picture(talus_lab.open(result)))[0]
    assert len(edges.get_segments()) == 16 - 2


def test_joint_states_are_drawn_along_the_joint_and_named(result):
    figure = plot.picture(talus_lab.open(result), color="joint_state")
    assert legend(figure) == ["held", "sliding (1)"]  # the open one has no length
    sliding = lines(figure)[1].get_segments()[0] - ORIGIN
    # The square stands on -0.1 .. 0.9; the centre of pressure, at 0.1, is not the middle of the joint.
    assert np.sort(sliding[:, 0]) == pytest.approx([-0.1, 0.9]) and sliding[:, 1] == pytest.approx([0, 0])


def test_a_contact_that_carries_next_to_nothing_does_not_count_as_sliding(result):
    run = talus_lab.open(result)
    contacts = dict(run.contacts(-1))
    contacts["normal_force"] = contacts["normal_force"] * np.where(contacts["state"] == 1, 1e-6, 1)
    contacts["shear_force"] = contacts["shear_force"] * np.where(contacts["state"] == 1, 1e-6, 1)
    assert list(layers.shown_state(run.contacts(-1))).count(1) == 1
    contacts["normal_force"] = np.append(contacts["normal_force"], 100.0)
    contacts["shear_force"] = np.append(contacts["shear_force"], 0.0)
    contacts["state"] = np.append(contacts["state"], 0)
    assert list(layers.shown_state(contacts)).count(1) == 0


def test_rounding_errors_are_no_movement(result):
    run = talus_lab.open(result)
    figure = plot.picture(run, frame=0)
    assert len(figure.axes) == 1 and "nothing moves" in figure.axes[0].get_title(loc="left")


def test_map_coordinates_stand_in_full_at_the_axes(result):
    figure = plot.picture(talus_lab.open(result))
    figure.canvas.draw()
    assert figure.axes[0].xaxis.get_offset_text().get_text() == ""


def test_the_largest_force_has_the_widest_line(result):
    figure = plot.picture(talus_lab.open(result), forces=True)
    widths = lines(figure)[-1].get_linewidths()
    assert widths[0] / widths[1] == pytest.approx(np.hypot(20, 5) / 30)
    assert legend(figure) == ["held", "contact force, largest 30 N/m"]


def test_movements_can_be_exaggerated(result):
    run = talus_lab.open(result)
    shown = layers.Geometry(run, 2, 10.0)
    assert shown.polygons[1].mean(axis=0) - ORIGIN == pytest.approx([4.0, 0.5])
    corner = run.corners(2)[9:10]
    assert shown.carried(corner, np.array([2])) == pytest.approx(shown.polygons[2][1:2])


def test_thin_blocks_are_found(result):
    run = talus_lab.open(result)
    assert list(plot.thin_blocks(run)) == []
    run.__dict__["arm"] = run.arm * np.repeat([[1, 1], [1, 0.01], [1, 1], [1, 1]], 4, axis=0)
    run.__dict__["blocks"] = {**run.blocks, "area": run.blocks["area"] * [1, 0.01, 1]}
    assert list(plot.thin_blocks(run)) == [1]


def test_a_scene_shows_materials_supports_and_joints(result):
    assert legend(plot.scene(talus_lab.open(result)))[:2] == ["granite (3)", "held"]


def test_units_read_well():
    assert layers.quantity(0.0025, "m") == "2.5 mm"
    assert layers.quantity(1.2345e6, "N") == "1.23 MN"
    assert layers.quantity(1500, "m") == "1500 m"
    assert layers.quantity(0.999996, "s", 4) == "1 s"
    assert layers.quantity(0.25, "s") == "0.25 s" and layers.quantity(0.025, "s") == "25 ms"
    assert layers.quantity(0, "s") == "0 s"


def test_faults_of_the_user_are_one_line_and_code_2(result, tmp_path, capsys):
    assert main(["plot", str(tmp_path / "nothing.h5")]) == 2
    assert main(["plot", str(result), "--frame", "7"]) == 2
    assert main(["plot", str(result), "-o", "x.gif"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 3
