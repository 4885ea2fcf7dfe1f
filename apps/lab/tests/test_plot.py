import subprocess
import sys
from types import SimpleNamespace

import h5py
import matplotlib.image
import numpy as np
import pytest
from matplotlib.collections import LineCollection, PathCollection

import talus_lab
from conftest import ORIGIN, tell
from talus_lab import colors, curves, forces, layers, plot, stress, units
from talus_lab.cli import main
from talus_lab.silhouette import silhouette


def drawn(figure):
    """Blocks, held blocks, edges, in this order."""
    return [c for c in figure.axes[0].collections if isinstance(c, PathCollection)]


def lines(figure):
    return [c for c in figure.axes[0].collections if isinstance(c, LineCollection)]


def legend(figure):
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


@pytest.mark.parametrize("color", colors.COLORS)
def test_every_colouring_makes_a_picture(result, tmp_path, color):
    picture = tmp_path / f"{color}.png"
    assert main(["plot", str(tell(result)), "-o", str(picture), "--color", color, "--forces", "--before-after", "--dpi", "60"]) == 0
    pixels = matplotlib.image.imread(picture)[..., :3]
    assert pixels.shape[1] == pytest.approx(60 * 12 / 2.54, abs=1) and pixels.std() > 0.05


def test_colours_follow_displacement_and_the_bar_says_its_unit(result):
    run = talus_lab.open(result)
    figure = plot.picture(run)
    faces = dict(zip([len(path.vertices) for path in drawn(figure)[0].get_paths()], drawn(figure)[0].get_facecolors()))
    assert sorted(faces) == [5, 10]  # rings of four corners: the square, and in one path the two parts of the L
    assert sum(faces[5][:3]) < sum(faces[10][:3])  # what has moved is darker
    assert figure.axes[-1].get_xlabel() == "displacement in mm"  # below, for the scene is low
    assert figure.axes[-1].get_xlim() == pytest.approx((0, 400))


def test_edges_inside_a_block_are_not_drawn(result):
    edges = drawn(plot.picture(talus_lab.open(result)))[2]
    assert sum(len(path.vertices) for path in edges.get_paths()) == 2 * (16 - 2)


def test_joint_states_are_drawn_along_the_joint_and_named(result):
    figure = plot.picture(talus_lab.open(result), color="joint_state")
    assert legend(figure) == ["held", "sliding (1)"]  # the open one has no length
    sliding = lines(figure)[0].get_segments()[0] - ORIGIN
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


def test_mechanisms_are_named_counted_and_hatched(result):
    figure = plot.picture(talus_lab.open(tell(result)), color="mechanism")
    assert legend(figure) == ["held", "slide (1)", "topple (1)"] and figure.axes[0].get_title(loc="left").endswith("unstable, slide and topple")
    assert len({c.get_hatch() for c in drawn(figure)}) == 4  # none, held, slide, topple


def test_a_scene_shows_materials_supports_and_joints(result):
    assert legend(plot.scene(talus_lab.open(result)))[:2] == ["granite (3)", "held"]


def test_units_read_well():
    assert units.quantity(0.0025, "m") == "2.5 mm"
    assert units.quantity(1.2345e6, "N") == "1.23 MN"
    assert units.quantity(1500, "m") == "1500 m"
    assert units.quantity(0.999996, "s", 4) == "1 s"
    assert units.quantity(0.25, "s") == "0.25 s" and units.quantity(0.025, "s") == "25 ms"
    assert units.quantity(0, "s") == "0 s"


def test_a_block_pressed_from_both_sides_has_that_stress():
    run = SimpleNamespace(
        block_count=2, blocks={"held": np.array([0, 1]), "area": np.array([6.0, 1.0])}, removed=lambda frame: np.zeros(2, bool),
        position=lambda frame: np.array([[10.0, 5.0], [0.0, 0.0]]),
        contacts=lambda frame: {"block_a": np.array([1, 0, 1, 1]), "block_b": np.array([0, 1, 0, 0]), "x": np.array([8.5, 11.5, 10, 10]),
                                "y": np.array([5.0, 5, 4, 6]), "nx": np.array([1.0, 1, 0, 0]), "ny": np.array([0.0, 0, 1, -1]),
                                "normal_force": np.array([40.0, 40, 0, 0]), "shear_force": np.array([0.0, 0, -30, -30])})
    found = stress.block_stress(run)
    # 3 m wide, 2 m high: 40 N on the 2 m high sides press with 20 Pa. 30 N to the right on the 3 m wide base, whose outward normal n is
    # (0, -1): t = -sigma n = 10 Pa, sigma_xy = 10 Pa. Nothing balances the moment, so the symmetric part has half of it.
    assert found[0] == pytest.approx(np.array([[20, 5], [5, 0]])) and np.isnan(found[1]).all()


def test_one_nipped_block_among_many_does_not_shrink_the_crosses_of_the_others(result, monkeypatch):
    pressed = np.zeros((3, 2, 2))
    pressed[:, 0, 0], pressed[:, 1, 1] = 1e3, 2e3
    many = np.repeat(pressed, 40, axis=0)
    many[7] *= 1e6
    monkeypatch.setattr("talus_lab.forces.block_stress", lambda run, frame: many)
    assert forces.largest_stress(None, -1) == pytest.approx(2e3)
    pressed[1] *= 1e6
    monkeypatch.setattr("talus_lab.forces.block_stress", lambda run, frame: pressed)
    assert forces.largest_stress(None, -1) == pytest.approx(2e9)  # of a few blocks the largest counts


def test_principal_stresses_of_pure_shear_lie_at_45_degrees():
    major, minor, angle = stress.principal(np.array([[[3.0, 2.0], [2.0, 3.0]], [[1.0, 0.0], [0.0, -4.0]]]))
    assert major == pytest.approx([5, 1]) and minor == pytest.approx([1, -4]) and angle == pytest.approx([np.pi / 4, 0])


def test_crosses_are_as_long_as_the_stress_and_say_how_large_it_is(result):
    figure = plot.picture(talus_lab.open(result), color="none", stress=True)
    assert legend(figure)[1].startswith("compression, largest 1")  # 20 N below the square: 20 Pa x 0.5 of its height, and some shear


def test_where_blocks_stood_is_dashed_around_each_of_a_few(result):
    figure = plot.picture(talus_lab.open(result), outline=True)
    before = lines(figure)[-1].get_segments()
    assert len(before) == 4 + 6 and legend(figure)[-1] == "at t = 0 s"
    assert np.concatenate(before).min(axis=0) - ORIGIN == pytest.approx([-0.5, 0.0])


def test_the_outline_of_touching_blocks_is_one_line_and_holes_show():
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    around = [square + [x, y] for x in range(3) for y in range(3) if (x, y) != (1, 1)]
    outer, hole = sorted(silhouette(around, 0.1), key=len, reverse=True)
    assert outer.min() == pytest.approx(0, abs=0.005) and outer.max() == pytest.approx(3, abs=0.005)
    assert hole.min() == pytest.approx(1, abs=0.005) and hole.max() == pytest.approx(2, abs=0.005)
    assert len(silhouette(around, 2.0)) == 1


def test_histories_have_a_panel_for_each_unit_and_break_where_the_clock_goes_back(result):
    figure = curves.history(talus_lab.open(result), "slide")
    assert [ax.get_ylabel() for ax in figure.axes] == ["x in mm", "a in s"] and figure.axes[-1].get_xlabel() == "time in s"
    assert figure.axes[0].get_lines()[0].get_ydata() == pytest.approx([0, 100, 400])
    with h5py.File(result, "a") as file:
        file["talus/histories/slide/time"][2] = 0.1
    assert np.isnan(curves.history(talus_lab.open(result), "slide").axes[0].get_lines()[0].get_xdata()).tolist() == [False] * 2 + [True, False]


def test_energies_that_are_nothing_are_left_out(result):
    with h5py.File(result, "a") as file:
        file["talus/energies/friction"], file["talus/energies/total"] = np.array([0.0, 1e-9, 1e-9]), np.zeros(3)
    assert legend(curves.energies(talus_lab.open(result))) == ["kinetic", "total"]


@pytest.mark.parametrize("options, complaint", [
    (["--color", "sped"], "did you mean speed"), (["--history", "slid"], "did you mean slide"), (["--frame", "7"], "no frame 7"),
    (["--history", "slide", "--columns", "b"], "no column b"), (["--width", "1"], "from 4 to 100"), (["--dpi", "9"], "from 30"),
    (["--exaggerate", "1e300"], "is at most 1e+09"), (["--color", "mechanism"], "has no verdict"), (["-o", "nowhere/x.png"], "there is no folder nowhere")])
def test_what_is_not_there_is_told_in_one_line(result, capsys, options, complaint):
    assert main(["plot", str(result), *options]) == 2
    error = capsys.readouterr().err
    assert complaint in error and len(error.splitlines()) == 1


@pytest.mark.parametrize("suffix, begins", [(".pdf", b"%PDF"), (".svg", b"<?xml"), (".PNG", b"\x89PNG")])
def test_pictures_are_written_in_the_format_of_their_name(result, tmp_path, suffix, begins):
    assert main(["plot", str(result), "--energies", "-o", str(tmp_path / f"x{suffix}")]) == 0
    assert (tmp_path / f"x{suffix}").read_bytes().startswith(begins) and len(list(tmp_path.glob("x*"))) == 1


def test_help_names_every_field_and_loads_no_library(capsys):
    code = "import sys; from talus_lab.cli import main\ntry: main(['plot', '--help'])\nexcept SystemExit: pass\n" \
           "assert not {'numpy', 'matplotlib', 'h5py'} & set(sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert all(name in done.stdout.replace("\n", " ") for name in colors.COLORS)


@pytest.mark.parametrize("option", ["--time", "--exaggerate"])
def test_numbers_that_are_none_are_refused(result, capsys, option):
    with pytest.raises(SystemExit) as ended:
        main(["plot", str(result), option, "nan"])
    assert ended.value.code == 2 and f"argument {option}" in capsys.readouterr().err


def test_blocks_that_are_nowhere_and_folders_are_told(result, tmp_path, capsys):
    with h5py.File(result, "a") as file:
        file["talus/frames/position"][2, 1] = np.nan
    for given, complaint in ((result, "cannot be drawn"), (tmp_path, "is a folder")):
        assert main(["plot", str(given)]) == 2
        error = capsys.readouterr().err
        assert complaint in error and len(error.splitlines()) == 1


def test_a_picture_that_cannot_be_written_is_told_by_its_name_and_leaves_nothing(result, tmp_path, monkeypatch, capsys):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", full)
    assert main(["plot", str(result), "-o", str(tmp_path / "x.png")]) == 2
    assert capsys.readouterr().err == f"talus-lab: {tmp_path / 'x.png'}: No space left on device\n" and not list(tmp_path.glob("*x*"))


def test_faults_of_the_user_are_one_line_and_code_2(result, tmp_path, capsys):
    assert main(["plot", str(tmp_path / "nothing.h5")]) == 2
    assert main(["plot", str(result), "--frame", "7"]) == 2
    assert main(["plot", str(result), "-o", "x.gif"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 3
