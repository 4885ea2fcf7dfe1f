"""The command `talus-lab`."""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import talus_lab
from talus_lab import bench, plot
from talus_lab.program import find_talus
from talus_lab.run import ResultError, Run, open_run

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


def bench_command(options: argparse.Namespace) -> int:
    config = bench.read_config(options.config)
    if options.quick:
        config = bench.quick(config)
    bench.fill_page(config.page.read_text(encoding="utf-8"), config, [])  # faults of the page before hours of measuring
    if options.draw:
        rows = bench.measured(config)
    else:
        rows = bench.measure(config, find_talus(), options.long, options.again, lambda line: print(line, flush=True))
        print(config.output / "results.csv")
    config.output.mkdir(parents=True, exist_ok=True)
    config.images.mkdir(parents=True, exist_ok=True)
    for name, chart in config.charts.items():
        figure = bench.draw(config, chart, rows)
        if figure is None:
            print(f"{name}: no chart, nothing of it was measured")
            continue
        figure.savefig(config.output / f"{name}.svg")
        bench.save_small(figure, config.images / f"{name}.png")
        print(config.images / f"{name}.png")
    written = config.output / config.page.name if options.quick else config.page
    page = config.page.read_text(encoding="utf-8")  # as it is now: it may have been written on meanwhile
    written.write_text(bench.fill_page(page, config, rows), encoding="utf-8")
    print(written)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="talus-lab", description="Reads the results of talus and draws them; measures contact searches.")
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

    b = commands.add_parser("bench", help="measure contact searches as a config says; table, charts and the numbers of its page")
    b.add_argument("config", type=Path, metavar="CONFIG.yaml")
    b.add_argument("--quick", action="store_true", help="each study in its shortest form, to see that it works; the page is left alone")
    b.add_argument("--long", action="store_true", help="with the studies marked `long`")
    b.add_argument("--draw", action="store_true", help="charts and page from what was measured so far, and nothing else")
    b.add_argument("--again", action="store_true", help="measure also what an earlier run has measured")
    b.set_defaults(command=bench_command)
    return parser


if __name__ == "__main__":
    sys.exit(main())
