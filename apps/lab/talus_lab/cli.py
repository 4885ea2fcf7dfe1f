"""The command `talus-lab`."""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path
from types import ModuleType

import talus_lab
from talus_lab import bench, chart, plot, stability
from talus_lab.chart.exchange import cut, scene_json
from talus_lab.program import find_talus
from talus_lab.run import ResultError, Run, open_run
from talus_lab.study.picture import save_small

NOT_MET = 1  # as in talus
BAD_INPUT = 2  # exit code for anything the user gave, as in talus
INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        return options.command(options)
    except (ResultError, OSError) as error:
        print(f"talus-lab: {error}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("talus-lab: interrupted", file=sys.stderr)
        return INTERRUPTED


def plot_command(options: argparse.Namespace) -> int:
    given: Path = options.file
    output: Path = options.output or given.with_suffix(".png")
    if output.suffix.lower() not in (".png", ".svg"):
        raise ResultError(f"{output}: pictures are written as .png or .svg")
    if given.suffix.lower() in (".yaml", ".yml"):
        with tempfile.TemporaryDirectory() as folder:
            figure = plot.scene(check_geometry(given, Path(folder) / "geometry.h5"))
    else:
        run = open_run(given)
        frame = options.frame if options.time is None else run.frame_at(options.time)
        figure = plot.picture(run, frame, options.color, options.forces, options.joints, options.before_after, options.exaggerate)
    figure.savefig(output)
    print(output)
    return 0


def check_geometry(scenario: Path, result: Path) -> Run:
    """The blocks of a scenario that has not run, as `talus check` cuts them."""
    done = subprocess.run([find_talus(), "check", scenario, "--geometry", result], capture_output=True, text=True)
    if done.returncode != 0:
        raise ResultError(f"talus check {scenario} failed:\n{(done.stderr or done.stdout).strip()}")
    return open_run(result)


def scene_command(options: argparse.Namespace) -> int:
    keys = dict(word.partition("=")[::2] for word in options.set)
    with tempfile.TemporaryDirectory() as folder:
        blocks, scenario = cut(find_talus(), options.scenario, keys, Path(folder))
        scene = scene_json(blocks, scenario, options.frames, {})
    output: Path = options.output or options.scenario.with_suffix(".json")
    output.write_text(json.dumps(scene), encoding="utf-8")
    print(output)
    return 0


def study_command(options: argparse.Namespace) -> int:
    """Measures what a config lists; one table, charts, and the numbers of a page. `options.study` is the package that knows how."""
    study = options.study
    config = study.read_config(options.config)
    if options.quick:
        config = study.quick(config)
    study.fill_page(config.page.read_text(encoding="utf-8"), config, [])  # faults of the page before hours of measuring
    if options.draw:
        rows = study.measured(config)
    else:
        rows = study.measure(config, find_talus(), options.long, options.again, lambda line: print(line, flush=True))
        print(config.output / "results.csv")
    config.output.mkdir(parents=True, exist_ok=True)
    config.images.mkdir(parents=True, exist_ok=True)
    for name, described in config.charts.items():
        figure = study.draw(config, described, rows)
        if figure is None:
            print(f"{name}: no chart, nothing of it was measured")
            continue
        figure.savefig(config.output / f"{name}.svg")
        save_small(figure, config.images / f"{name}.png")
        print(config.images / f"{name}.png")
    written = config.output / config.page.name if options.quick else config.page
    page = config.page.read_text(encoding="utf-8")  # as it is now: it may have been written on meanwhile
    written.write_text(study.fill_page(page, config, rows), encoding="utf-8")
    print(written)
    return 0


def stability_command(options: argparse.Namespace) -> int:
    config = stability.read_config(options.config)
    stability.fill_page(config.page.read_text(encoding="utf-8"), config, [])  # a fault of the page before minutes of running
    if options.draw:
        checks = stability.read_table(config.output / "stability.csv")
    else:
        checks = stability.verify(config, find_talus(), lambda line: print(line, flush=True))
    checks += stability.tests(config, find_talus())
    config.page.write_text(stability.fill_page(config.page.read_text(encoding="utf-8"), config, checks), encoding="utf-8")
    print(config.page)
    return 0 if all(check.passed for check in checks) else NOT_MET


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="talus-lab", description="Reads the results of talus and draws them; measures speed and accuracy.")
    parser.add_argument("--version", action="version", version=f"talus-lab {talus_lab.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    p = commands.add_parser("plot", help="draw a frame of a result, or a scenario that has not run")
    p.add_argument("file", type=Path, metavar="OUT.h5|SCENARIO.yaml")
    p.add_argument("-o", "--output", type=Path, metavar="FILE", help="picture, .png or .svg (default: beside the file)")
    which = p.add_mutually_exclusive_group()
    which.add_argument("--frame", type=int, default=-1, metavar="K", help="from 0; -1 is the last (default)")
    which.add_argument("--time", type=float, metavar="T", help="the frame nearest to this time in s")
    p.add_argument("--color", choices=plot.COLORS, default="displacement", help="what colours the blocks (default: displacement)")
    p.add_argument("--forces", action="store_true", help="contact forces, lines as wide as the force is large")
    p.add_argument("--joints", action="store_true", help="joints coloured by state")
    p.add_argument("--before-after", action="store_true", help="the first frame beside the chosen one")
    p.add_argument("--exaggerate", type=float, default=1.0, metavar="X", help="draw movements X times as large")
    p.set_defaults(command=plot_command)

    c = commands.add_parser("scene", help="write a scenario as other programs read it, see docs/runners.md")
    c.add_argument("scenario", type=Path, metavar="SCENARIO.yaml")
    c.add_argument("-o", "--output", type=Path, metavar="FILE", help="default: beside the scenario, .json")
    c.add_argument("--frames", type=int, default=1, metavar="K", help="states to look at beside the start (default: 1)")
    c.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change a key of the scenario")
    c.set_defaults(command=scene_command)

    _study(commands, "bench", bench, "measure contact searches as a config says; table, charts and the numbers of its page", "studies")
    _study(commands, "chart", chart, "draw error against CPU time for the scenes and methods of a config; table, charts and page", "scenes")

    s = commands.add_parser("stability", help="run the stability suite and make the table of its page")
    s.add_argument("config", type=Path, metavar="CONFIG.yaml")
    s.add_argument("--draw", action="store_true", help="the table from what was measured last, and nothing else")
    s.set_defaults(command=stability_command)
    return parser


def _study(commands: argparse._SubParsersAction, name: str, study: ModuleType, help: str, parts: str) -> None:
    p = commands.add_parser(name, help=help)
    p.add_argument("config", type=Path, metavar="CONFIG.yaml")
    p.add_argument("--quick", action="store_true", help=f"the {parts} in their shortest form, to see that they work; the page is left alone")
    p.add_argument("--long", action="store_true", help=f"with the {parts} marked `long`")
    p.add_argument("--draw", action="store_true", help="charts and page from what was measured so far, and nothing else")
    p.add_argument("--again", action="store_true", help="measure also what an earlier run has measured")
    p.set_defaults(command=study_command, study=study)


if __name__ == "__main__":
    sys.exit(main())
