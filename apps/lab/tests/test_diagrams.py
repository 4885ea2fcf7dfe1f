import json
from pathlib import Path

import numpy as np
import pytest
import yaml

import talus_lab
from sweep_table import block_mode, block_sweep, write_sweep
from talus_lab.cli import main
from talus_lab.diagrams import boundaries, maps, pictures, ranking
from talus_lab.diagrams import modes as draw_modes
from talus_lab.diagrams import read_table

SLOPES, FRICTIONS, RATIOS = (10, 20, 30, 40), (10, 25, 28, 50), (0.3, 0.5)
THEORY = "dynamic_block_modes slope=slope_deg friction=friction_deg ratio=ratio"


@pytest.fixture
def blocks(tmp_path):
    return block_sweep(tmp_path / "blocks", SLOPES, FRICTIONS, RATIOS)


def legend(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


@pytest.mark.parametrize("slope, delta, friction", [(15, 10, 11.25), (40, 20, 25.20), (50, 30, 35.20), (30, 20, 22.52), (35, 35, 35.0)])
def test_toppling_begins_at_the_friction_that_theory_gives(slope, delta, friction):
    """Table of the verification case V17."""
    assert boundaries.toppling_friction_deg(np.array([slope]), np.tan(np.radians(delta)))[0] == pytest.approx(friction, abs=0.006)


def test_boundaries_of_theory_part_the_modes_of_theory():
    """A step across any boundary, away from its ends, changes the mode."""
    for line in boundaries.dynamic_block_modes(0.5):
        for k in range(len(line) - 1):
            (slope, friction), step = (line[k] + line[k + 1]) / 2, (line[k + 1] - line[k]) / np.hypot(*(line[k + 1] - line[k]))
            across = 0.02 * np.array([-step[1], step[0]])
            if friction < 85 and np.hypot(slope - 26.6, friction - 26.6) > 2 and slope < 85:
                assert block_mode(slope + across[0], friction + across[1], 0.5) != block_mode(slope - across[0], friction - across[1], 0.5)


def test_a_diagram_has_a_panel_for_each_value_and_counts_the_modes(blocks):
    table = read_table(blocks)
    curve = boundaries.Curve("dynamic_block_modes", "slope_deg", "friction_deg", "ratio")
    figure = draw_modes(table, "slope_deg", "friction_deg", "ratio", [curve])
    assert [ax.get_title(loc="left") for ax in figure.axes] == ["ratio 0.3", "ratio 0.5"]
    assert figure.axes[0].get_xlabel() == "slope in deg" and figure.axes[0].get_ylabel() == "friction in deg"
    expected = [block_mode(a, f, t) for a in SLOPES for f in FRICTIONS for t in RATIOS]
    assert f"slide ({expected.count('slide')})" in legend(figure) and f"stable ({expected.count('none')})" in legend(figure)
    upright = [line for line in figure.axes[0].get_lines() if len(set(line.get_xdata())) == 1 and line.get_linestyle() == "-"]
    assert upright[0].get_xdata()[0] == pytest.approx(np.degrees(np.arctan(0.3)))
    assert [mark.get_marker() for mark in figure.axes[0].get_lines()[:3]] == [".", "s", "^"]  # each mode its own


def test_axes_can_be_swapped_and_curves_follow(blocks):
    curve = boundaries.Curve("plane_slide", "slope_deg", "friction_deg")
    tall = boundaries.Curve("static_block_modes", "slope_deg", "friction_deg", 0.3)
    figure = draw_modes(read_table(blocks), "friction_deg", "slope_deg", "ratio", [curve, tall])
    level = figure.axes[0].get_lines()[-1]
    assert set(level.get_ydata()) == {np.degrees(np.arctan(0.3))} and set(level.get_xdata()) == {0, 90}


def test_cases_that_failed_or_are_undecided_are_shown_as_such_and_missing_ones_are_not(tmp_path):
    folder = write_sweep(tmp_path / "s", {"a": [1, 2, 3, 4], "b": [1, 1, 2, 2]}, {"verdict": ["stable", "undecided", "unstable", ""],
                         "mechanism": ["none", "none", "none", ""]}, status=["done", "done", "timed out", "missing"])
    table = read_table(folder)
    assert list(table.mode) == ["stable", "undecided", "failed", ""]
    assert legend(draw_modes(table, "a", "b")) == ["stable (1)", "undecided (1)", "failed (1)"]


def test_a_probability_is_the_share_of_decided_cases(tmp_path):
    verdict = ["unstable", "stable", "unstable", "undecided", "stable", "stable"]
    folder = write_sweep(tmp_path / "s", {"dip_deg": [30, 30, 30, 30, 40, 40], "repetition": [1, 2, 3, 4, 1, 2]},
                         {"verdict": verdict, "run_out": [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]}, kinds={"repetition": "repetition"})
    table = read_table(folder)
    figure = maps.probability(table, "dip_deg")
    assert figure.axes[0].get_lines()[0].get_ydata() == pytest.approx([2 / 3, 0])
    above = maps.probability(table, "dip_deg", value="run_out", limit=2.5)
    assert above.axes[0].get_lines()[0].get_ydata() == pytest.approx([0.5, 1])
    low, high = maps.wilson(np.array([5.0]), np.array([10.0]))  # Wilson 1927: 0.237, 0.763
    assert (low[0], high[0]) == pytest.approx((0.2366, 0.7634), abs=1e-4)


def test_of_repetitions_the_most_frequent_mode_is_shown_and_the_worse_of_equals(tmp_path):
    mechanism = ["none", "slide", "slide", "none", "topple", "none"]
    folder = write_sweep(tmp_path / "s", {"a": [1, 1, 1, 2, 2, 2], "b": [1] * 6, "repetition": [1, 2, 3] * 2}, {"mechanism": mechanism},
                         kinds={"repetition": "repetition"})
    assert legend(draw_modes(read_table(folder), "a", "b")) == ["stable (1)", "slide (1)"]
    folder = write_sweep(tmp_path / "s", {"a": [1, 1], "b": [1, 1]}, {"mechanism": ["none", "slide"]})
    assert legend(draw_modes(read_table(folder), "a", "b")) == ["slide (1)"]


def test_shares_stand_in_their_cells(tmp_path):
    folder = write_sweep(tmp_path / "s", {"a": [1, 1, 2, 2], "b": [1] * 4, "repetition": [1, 2, 1, 2]},
                         {"verdict": ["stable", "unstable", "unstable", "unstable"]}, kinds={"repetition": "repetition"})
    figure = maps.probability(read_table(folder), "a", "b")
    assert [text.get_text() for text in figure.axes[0].texts] == [".50", "1"]


def test_cases_on_one_another_are_averaged_and_empty_cells_are_hatched(tmp_path):
    mean = maps.means(np.array([[1.0, 5], [1, 5], [2, 6]]), np.array([3.0, 5, 7]), np.array([1.0, 2]), np.array([5.0, 6]))
    assert mean[0, 0] == 4 and mean[1, 1] == 7 and np.isnan(mean[0, 1])
    folder = write_sweep(tmp_path / "s", {"a": [1, 2, 1, 2], "b": [1, 1, 2, 2]}, {"d": [0.1, 0.2, 0.4, 0.5]}, status=["done", "done", "done", "diverged"],
                         units={"d": "m"})
    figure = maps.value_map(read_table(folder), "a", "b", "d", limit=0.3)
    assert legend(figure) == ["d = 300 mm", "no value"] and figure.axes[-1].get_ylabel() == "d in mm"


def ticks(axis):
    axis.figure.canvas.draw()
    return [tick.get_text() for tick in axis.get_ticklabels()]


def test_words_stand_along_an_axis_in_the_order_of_the_config(tmp_path):
    folder = write_sweep(tmp_path / "s", {"rock": ["tuff", "marl", "tuff", "marl"], "friction_deg": [10.0, 10, 20, 20]},
                         {"verdict": ["stable", "unstable"] * 2, "mechanism": ["none", "slide"] * 2, "d": [1.0, 2, 3, 4]})
    about = json.loads((folder / "sweep.json").read_text())
    about["parameters"][0]["values"] = ["tuff", "marl"]
    (folder / "sweep.json").write_text(json.dumps(about))
    table = read_table(folder)
    assert list(table.numbers("rock")) == [0, 1, 0, 1]
    for kind in ("modes", "map"):
        ax = pictures.draw(table, pictures.Picture(kind)).axes[0]
        assert ax.get_xlabel() == "friction" and ticks(ax.yaxis) == ["tuff", "marl"] and ticks(ax.xaxis) == ["10", "20"]
    assert list(pictures.fitting(table)) == ["modes", "map"]


def test_values_in_equal_ratios_have_cells_of_equal_width_and_units_get_a_prefix(tmp_path):
    stiffness = [1e8, 1e9, 1e10]
    folder = write_sweep(tmp_path / "s", {"k": stiffness * 2, "c": [1e6] * 3 + [2e6] * 3}, {"force": [1e6, 2e6, 3e6, 4e6, 5e6, 6e6]},
                         units={"k": "Pa/m", "c": "Pa", "force": "N"})
    figure = maps.value_map(read_table(folder), "k", "c", "force")
    ax, bar = figure.axes
    assert ax.get_xscale() == "log" and ax.get_xlim() == pytest.approx((1e8 / 10**0.5, 1e10 * 10**0.5))
    assert (ax.get_xlabel(), ax.get_ylabel(), bar.get_ylabel()) == ("k in GPa/m", "c in MPa", "force in MN")
    assert "1" in ticks(ax.xaxis) and ticks(ax.yaxis) == ["1", "2"] and all(float(text) < 10 for text in ticks(bar.yaxis))


def test_rounding_takes_no_colours_from_what_moves_and_what_is_no_number_has_no_value(tmp_path):
    folder = write_sweep(tmp_path / "s", {"a": [1.0, 2, 1, 2], "b": [1.0, 1, 2, 2]}, {"d": [1e-12, 1.0, 0.01, float("inf")]}, units={"d": "m"})
    figure = maps.value_map(read_table(folder), "a", "b", "d")
    assert legend(figure) == ["no value"] and figure.axes[-1].get_ylim() == pytest.approx((1e-5, 1.0))


def test_without_a_decided_case_there_is_no_probability_but_a_diagram(tmp_path):
    folder = write_sweep(tmp_path / "s", {"a": [1.0, 2, 1, 2], "b": [1.0, 1, 2, 2], "repetition": [1, 1, 2, 2]}, {"verdict": ["undecided"] * 4},
                         kinds={"repetition": "repetition"})
    table = read_table(folder)
    with pytest.raises(talus_lab.ResultError, match="no case is decided"):
        maps.probability(table, "a", "b")
    assert list(pictures.fitting(table)) == ["modes"]


def test_rank_correlation_is_spearmans():
    x = np.array([1.0, 2, 3, 4, 5, 6])
    assert ranking.correlation(x, np.exp(x)) == pytest.approx(1) and ranking.correlation(x, -x**3) == pytest.approx(-1)
    # d = (0, 1, -1, 0, 1, -1): rho = 1 - 6 sum d^2 / (n (n^2 - 1)) = 1 - 24 / 210
    assert ranking.correlation(x, np.array([1.0, 3, 2, 4, 6, 5])) == pytest.approx(1 - 24 / 210)
    assert ranking.correlation(x[:4], np.array([1.0, 1, 2, 2])) == pytest.approx(2 / np.sqrt(5))  # ties share their mean rank
    assert np.isnan(ranking.correlation(x[:3], x[:3])) and ranking.correlation(x, np.ones(6)) == 0


def test_a_tornado_has_the_longest_bar_on_top_by_rank_and_by_range(tmp_path):
    folder = write_sweep(tmp_path / "s", {"weak": [5.0, 5, 5, 4, 6], "strong": [1.0, 2, 3, 2, 2]}, {"d": [0.0, 10, 20, 9, 11]})
    table = read_table(folder)
    for by, spans in (("rank", None), ("range", [2, 20])):
        ax = ranking.tornado(table, "d", by).axes[0]
        assert [text.get_text() for text in ax.get_yticklabels()] == ["weak", "strong"]
        assert spans is None or [bar.get_width() for bar in ax.patches] == spans


def test_a_table_can_be_csv_alone(blocks):
    whole = read_table(blocks)
    (blocks / "table.h5").unlink()
    alone = read_table(blocks)
    assert (alone.mode == whole.mode).all() and (alone.numbers("max_displacement") == whole.numbers("max_displacement")).all()


def test_the_command_draws_what_fits_or_what_is_asked_for(blocks, tmp_path, capsys):
    assert main(["sweep-plot", str(blocks), "--curve", THEORY, "--dpi", "60"]) == 0
    assert main(["sweep-plot", str(blocks), "--kind", "map", "--panel", "ratio", "--limit", "1", "-o", str(tmp_path / "x.svg")]) == 0
    assert capsys.readouterr().out.split() == [str(blocks / "modes.png"), str(blocks / "map.png"), str(tmp_path / "x.svg")]
    assert (blocks / "modes.png").stat().st_size > 5000


def test_a_config_lists_pictures(blocks, tmp_path):
    curve = {"theory": "dynamic_block_modes", "slope": "slope_deg", "friction": "friction_deg", "ratio": "ratio", "label": "exact"}
    listed = {"chart": {"kind": "modes", "only": {"ratio": 0.5}, "curves": [curve, {"y": "0.5 * x", "label": "half"}], "title": "Slender"},
              "what_matters": {"kind": "tornado", "value": "max_displacement"}}
    (tmp_path / "p.yaml").write_text(yaml.safe_dump({"title": "a sweep", "pictures": listed}))
    assert main(["sweep-plot", str(blocks), "--config", str(tmp_path / "p.yaml"), "-o", str(tmp_path), "--dpi", "60"]) == 0
    assert (tmp_path / "chart.png").exists() and (tmp_path / "what_matters.png").exists()
    figure = pictures.draw(read_table(blocks), pictures.read_pictures(tmp_path / "p.yaml")["chart"])
    assert len(figure.axes) == 1 and legend(figure)[-2:] == ["exact", "half"]
    assert figure.axes[0].get_lines()[-1].get_ydata() == pytest.approx(0.5 * figure.axes[0].get_lines()[-1].get_xdata())


def test_the_config_of_the_sweep_is_used_if_it_lists_pictures_and_nothing_else_is_asked_for(blocks, tmp_path, capsys):
    config, about = tmp_path / "c.yaml", json.loads((blocks / "sweep.json").read_text())
    (blocks / "sweep.json").write_text(json.dumps({**about, "config": str(config)}))
    config.write_text("title: a\npictures: {most: {kind: tornado, value: max_displacement}}")
    for options, names in (([], ["most.png"]), (["--kind", "scatter"], ["scatter.png"])):
        assert main(["sweep-plot", str(blocks), "--dpi", "60", *options]) == 0
        assert [Path(line).name for line in capsys.readouterr().out.split()] == names
    listed = f"scenario: {__file__}\noutput: blocks\nparameters: {{}}\npictures: {{whole: {{kind: modes, panel: ratio}}}}"
    config.write_text(listed)
    assert main(["sweep-plot", str(config), "--dpi", "60"]) == 0
    assert Path(capsys.readouterr().out.strip()) == blocks / "whole.png"
    config.write_text("title: a")
    assert main(["sweep-plot", str(blocks), "--dpi", "60"]) == 0
    assert [Path(line).name for line in capsys.readouterr().out.split()] == ["modes.png", "map.png"]


@pytest.mark.parametrize("options, complaint", [
    (["--kind", "mode"], "did you mean modes"), (["--x", "slope"], "did you mean slope_deg"),
    (["--kind", "map", "--value", "max_displacment"], "did you mean max_displacement"), (["--kind", "map", "--value", "mechanism"], "words"),
    (["--kind", "probability", "--value", "max_displacement"], "needs the limit"), (["--curve", "dynamic_block_mods"], "did you mean dynamic"),
    (["--curve", THEORY.replace("=ratio", "=rato")], "did you mean ratio"), (["-o", "x.png"], "there are 2 pictures"),
    (["--x", "ratio", "--panel", "ratio"], "not all different"), (["--kind", "tornado", "--by", "rnk"], "did you mean rank"),
    (["--kind", "modes", "--curve", "y=0.5 * z"], "no value is called z")])
def test_what_cannot_be_drawn_is_told_in_one_line(blocks, capsys, options, complaint):
    assert main(["sweep-plot", str(blocks), *options]) == 2
    error = capsys.readouterr().err
    assert complaint in error and len(error.splitlines()) == 1


def test_folders_that_are_no_sweep_and_damaged_ones_are_told(blocks, tmp_path):
    for folder, complaint in ((tmp_path / "nowhere", "no such folder"), (tmp_path, "has no sweep.json")):
        with pytest.raises(talus_lab.ResultError, match=complaint):
            read_table(folder)
    (blocks / "table.h5").write_bytes(b"cut short")
    with pytest.raises(talus_lab.ResultError, match="damaged"):
        read_table(blocks)
    (tmp_path / "bad.yaml").write_text("pictures: {a: {kind: mode}, b: {kind: map, width_cm: 1, curvs: []}}")
    with pytest.raises(talus_lab.ResultError, match="did you mean curves(.|\n)*did you mean modes"):
        pictures.read_pictures(tmp_path / "bad.yaml")
