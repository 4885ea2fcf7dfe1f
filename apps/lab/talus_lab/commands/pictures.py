"""talus-lab plot, animate, export."""

from __future__ import annotations

import argparse
import math
import subprocess
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from talus_lab.errors import ResultError

if TYPE_CHECKING:
    from talus_lab.run import Run

MOST = 1e9  # times as large: a thousandth of what is still computed well would cross the picture


def add(commands: argparse._SubParsersAction) -> None:
    p = commands.add_parser("plot", help="draw a frame, a history or the energies of a result, or a scenario that has not run")
    p.add_argument("file", type=Path, metavar="OUT.h5|SCENARIO.yaml")
    picture_options(p, "picture, .png, .svg or .pdf (default: beside the file, .png)")
    frame_options(p)
    p.add_argument("--before-after", action="store_true", help="the first frame beside the chosen one")
    curve = p.add_mutually_exclusive_group()
    curve.add_argument("--history", metavar="NAME", help="a history over time in place of a frame")
    curve.add_argument("--energies", action="store_true", help="the energy ledger over time in place of a frame")
    p.add_argument("--columns", default="", metavar="A,B", help="of the history (default: all)")
    which = p.add_mutually_exclusive_group()
    which.add_argument("--frame", type=int, default=-1, metavar="K", help="from 0; -1 is the last (default)")
    which.add_argument("--time", type=finite, metavar="T", help="the frame nearest to this time in s")
    p.set_defaults(command=plot_command)

    a = commands.add_parser("animate", help="make a moving picture of a result, .mp4 if ffmpeg is there, else .gif")
    a.add_argument("file", type=Path, metavar="OUT.h5")
    picture_options(a, "animation, .mp4 or .gif (default: beside the file)")
    frame_options(a)
    a.add_argument("--from", type=finite, dest="begin", metavar="T", help="first frame: the nearest to this time in s")
    a.add_argument("--to", type=finite, dest="end", metavar="T", help="last frame: the nearest to this time in s")
    a.add_argument("--every", type=int, default=1, metavar="N", help="only every N-th frame")
    a.add_argument("--rate", type=float, default=10.0, metavar="N", help="frames per second (default: 10)")
    a.set_defaults(command=animate_command)

    e = commands.add_parser("export", help="write the frames of a result for ParaView before 5.12: .vtu files and a .pvd that names them")
    e.add_argument("file", type=Path, metavar="OUT.h5")
    e.add_argument("--pvd", type=Path, nargs="?", metavar="FILE.pvd", help="default: beside the file; frames go into a folder of the same name")
    e.add_argument("--every", type=int, default=1, metavar="N", help="only every N-th frame")
    e.set_defaults(command=export_command)


def picture_options(p: argparse.ArgumentParser, output: str) -> None:
    p.add_argument("-o", "--output", type=Path, metavar="FILE", help=output)
    p.add_argument("--width", type=float, default=12.0, metavar="CM", help="width in print; letters keep their size (default: 12)")
    p.add_argument("--dpi", type=int, help="dots per inch (default: 250; 200 for animations)")


def frame_options(p: argparse.ArgumentParser) -> None:
    p.add_argument("--color", default="displacement", metavar="FIELD",
                   help="what colours the blocks: displacement (default), displacement_x, displacement_y, speed, rotation, stress_major, "
                   "stress_minor, unbalanced_force, area, mechanism, material, region, joint_state or none")
    p.add_argument("--forces", action="store_true", help="contact forces, lines as wide as the force is large")
    p.add_argument("--stress", action="store_true", help="principal stresses of the blocks as crosses")
    p.add_argument("--joints", action="store_true", help="joints coloured by state")
    p.add_argument("--outline", action="store_true", help="where the blocks stood in the first frame, dashed")
    p.add_argument("--exaggerate", type=finite, default=1.0, metavar="X", help="draw movements X times as large")


def plot_command(options: argparse.Namespace) -> int:
    from talus_lab import curves, plot, style
    from talus_lab.run import open_run

    given: Path = options.file
    if given.is_dir():
        raise ResultError(f"{given}: is a folder; `talus-lab sweep-plot` draws that of a sweep")
    word = options.history or ("energies" if options.energies else "")
    output: Path = options.output or given.with_name(f"{given.stem}{'_' if word else ''}{word}.png")
    style.check_format(output)
    check_size(options)
    if given.suffix.lower() in (".yaml", ".yml"):
        with tempfile.TemporaryDirectory() as folder:
            figure = plot.scene(check_geometry(given, Path(folder) / "geometry.h5"), options.width)
    elif options.history:
        figure = curves.history(open_run(given), options.history, list(filter(None, options.columns.split(","))), options.width)
    elif options.energies:
        figure = curves.energies(open_run(given), options.width)
    else:
        run = open_run(given)
        frame = options.frame if options.time is None else run.frame_at(options.time)
        figure = plot.picture(run, frame, options.color, options.forces, options.joints, options.before_after, options.exaggerate,
                              options.stress, options.outline, options.width)
    style.save(figure, output, options.dpi or style.DPI)
    print(output)
    return 0


def animate_command(options: argparse.Namespace) -> int:
    from talus_lab import movie
    from talus_lab.animate import DPI, Shown, animate
    from talus_lab.commands.progress import progress
    from talus_lab.run import open_run

    output: Path = options.output or options.file.with_suffix(movie.default_suffix())
    movie.check(output)
    check_size(options)
    if options.every < 1 or not 0.1 <= options.rate <= 50:
        raise ResultError("--every: is 1 or more; --rate: is from 0.1 to 50 frames per second")
    run = open_run(options.file)
    first = 0 if options.begin is None else run.frame_at(options.begin)
    last = run.frame_count - 1 if options.end is None else run.frame_at(options.end)
    shown = Shown(options.color, options.forces, options.joints, options.stress, options.outline, options.exaggerate)
    animate(run, output, shown, range(first, last + 1, options.every), options.rate, options.width, options.dpi or DPI, progress("frame"))
    print(output)
    return 0


def export_command(options: argparse.Namespace) -> int:
    from talus_lab.commands.progress import progress
    from talus_lab.paraview import write_pvd
    from talus_lab.run import open_run

    output: Path = options.pvd or options.file.with_suffix(".pvd")
    if output.suffix.lower() != ".pvd":
        raise ResultError(f"{output}: the file for ParaView is written as .pvd")
    if options.every < 1:
        raise ResultError("--every: is 1 or more")
    run = open_run(options.file)
    print(write_pvd(run, output, range(0, run.frame_count, options.every), progress("frame"))[0])
    return 0


def finite(text: str) -> float:
    """The type of an option that takes a number."""
    number = float(text)
    if not math.isfinite(number):
        raise ValueError
    return number


def check_size(options: argparse.Namespace) -> None:
    if not 4 <= options.width <= 100:
        raise ResultError(f"--width {options.width:g}: is in cm, from 4 to 100")
    if options.dpi is not None and not 30 <= options.dpi <= 1200:
        raise ResultError(f"--dpi {options.dpi}: is from 30 to 1200")

    if abs(getattr(options, "exaggerate", 1)) > MOST:
        raise ResultError(f"--exaggerate {options.exaggerate:g}: is at most {MOST:g}")


def check_geometry(scenario: Path, result: Path) -> Run:
    """The blocks of a scenario that has not run, as `talus check` cuts them."""
    from talus_lab.program import find_talus
    from talus_lab.run import open_run

    done = subprocess.run([find_talus(), "check", scenario, "--geometry", result], capture_output=True, text=True)
    if done.returncode != 0:
        raise ResultError(f"talus check {scenario} failed:\n{(done.stderr or done.stdout).strip()}")
    return open_run(result)
