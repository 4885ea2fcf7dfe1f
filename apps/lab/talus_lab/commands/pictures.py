"""talus-lab plot."""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from talus_lab.errors import ResultError

if TYPE_CHECKING:
    from talus_lab.run import Run


def add(commands: argparse._SubParsersAction) -> None:
    p = commands.add_parser("plot", help="draw a frame of a result, or a scenario that has not run")
    p.add_argument("file", type=Path, metavar="OUT.h5|SCENARIO.yaml")
    p.add_argument("-o", "--output", type=Path, metavar="FILE", help="picture, .png or .svg (default: beside the file)")
    which = p.add_mutually_exclusive_group()
    which.add_argument("--frame", type=int, default=-1, metavar="K", help="from 0; -1 is the last (default)")
    which.add_argument("--time", type=float, metavar="T", help="the frame nearest to this time in s")
    p.add_argument("--color", choices=("displacement", "velocity", "rotation", "joint_state", "material", "none"), default="displacement", help="what colours the blocks (default: displacement)")
    p.add_argument("--forces", action="store_true", help="contact forces, lines as wide as the force is large")
    p.add_argument("--joints", action="store_true", help="joints coloured by state")
    p.add_argument("--before-after", action="store_true", help="the first frame beside the chosen one")
    p.add_argument("--exaggerate", type=float, default=1.0, metavar="X", help="draw movements X times as large")
    p.set_defaults(command=plot_command)


def plot_command(options: argparse.Namespace) -> int:
    from talus_lab import plot
    from talus_lab.run import open_run

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
    from talus_lab.program import find_talus
    from talus_lab.run import open_run

    done = subprocess.run([find_talus(), "check", scenario, "--geometry", result], capture_output=True, text=True)
    if done.returncode != 0:
        raise ResultError(f"talus check {scenario} failed:\n{(done.stderr or done.stdout).strip()}")
    return open_run(result)
