"""talus-lab sweep-plot."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from talus_lab.commands.pictures import check_size, finite
from talus_lab.errors import ResultError

if TYPE_CHECKING:
    from talus_lab.diagrams.boundaries import Curve
    from talus_lab.diagrams.pictures import Picture


def add(commands: argparse._SubParsersAction) -> None:
    p = commands.add_parser("sweep-plot", help="draw what came of a sweep: modes of failure, maps, probabilities, what matters most")
    p.add_argument("folder", type=Path, metavar="FOLDER|CONFIG.yaml", help="the output of `talus-lab sweep`, or its config")
    p.add_argument("-o", "--output", type=Path, metavar="PATH", help="picture, .png, .svg or .pdf, or a folder for several (default: FOLDER)")
    p.add_argument("--config", type=Path, metavar="CONFIG.yaml",
                   help="draw what it lists under `pictures`, see docs/python.md (default: the config of the sweep, if it lists any and no other option "
                   "says what to draw)")
    p.add_argument("--kind", metavar="KIND", help="modes, map, probability, tornado or scatter (default: what fits)")
    p.add_argument("--x", default="", metavar="PARAMETER")
    p.add_argument("--y", default="", metavar="PARAMETER")
    p.add_argument("--panel", default="", metavar="PARAMETER", help="one panel for each of its values")
    p.add_argument("--value", default="", metavar="MEASURE", help="the number that is drawn")
    p.add_argument("--limit", type=finite, metavar="NUMBER", help="where it fails: a line on maps, an event for probabilities")
    p.add_argument("--by", default="rank", metavar="WAY", help="tornado by rank correlation (rank) or one at a time (range)")
    p.add_argument("--curve", action="append", default=[], metavar="CURVE",
                   help='a line of theory: "dynamic_block_modes slope=P friction=P ratio=P", or "y=FORMULA of x"')
    p.add_argument("--width", type=float, default=12.0, metavar="CM", help="width in print; letters keep their size (default: 12)")
    p.add_argument("--dpi", type=int, help="dots per inch (default: 250)")
    p.set_defaults(command=sweep_plot_command)


def sweep_plot_command(options: argparse.Namespace) -> int:
    from talus_lab import style
    from talus_lab.diagrams.pictures import draw, lists_pictures, read_pictures
    from talus_lab.diagrams.table import read_table

    check_size(options)
    given = options.folder if options.folder.suffix.lower() in (".yaml", ".yml") else None
    table = read_table(_output(given) if given else options.folder)
    config = options.config or (given or table.config if not _says_what(options) else None)
    pictures = read_pictures(config) if config and (options.config or lists_pictures(config)) else _asked(options, table)
    files = _files(options, table.path, list(pictures))
    for path in files:
        style.check_format(path)
    for picture, path in zip(pictures.values(), files):
        style.save(draw(table, picture), path, options.dpi or style.DPI)
        print(path)
    return 0


def _output(config: Path) -> Path:
    from talus_lab.sweep import read_config

    return read_config(config).output


def _says_what(options: argparse.Namespace) -> bool:
    return options.limit is not None or any((options.kind, options.x, options.y, options.panel, options.value, options.curve))


def _asked(options: argparse.Namespace, table) -> dict[str, Picture]:
    from dataclasses import replace

    from talus_lab.diagrams.pictures import Picture, fitting, picture_faults

    said = dict(x=options.x, y=options.y, panel=options.panel, value=options.value, limit=options.limit, by=options.by,
                curves=[_curve(text) for text in options.curve], width_cm=options.width)
    if not options.kind:
        return {name: replace(picture, **said) for name, picture in fitting(table).items()}
    picture = Picture(options.kind, **said)
    for fault in picture_faults(picture, "--kind"):
        raise ResultError(fault.replace("--kind.", "--"))
    return {options.kind: picture}


def _curve(text: str) -> Curve:
    """`THEORY key=value ...` or `y=FORMULA`."""
    from dataclasses import fields

    from talus_lab.diagrams.boundaries import Curve
    from talus_lab.errors import nearest

    if text.startswith("y="):
        return Curve(y=text.removeprefix("y="), label=text)
    theory, *words = text.split()
    given = dict(word.partition("=")[::2] for word in words)
    known = [f.name for f in fields(Curve)]
    for key in given:
        if key not in known:
            raise ResultError(f"--curve: unknown {key}{nearest(key, known)}")
    try:
        given["ratio"] = float(given["ratio"])
    except (KeyError, ValueError):
        pass  # none, or the name of a parameter
    return Curve(theory, **given)


def _files(options: argparse.Namespace, folder: Path, names: list[str]) -> list[Path]:
    output: Path = options.output or folder
    if output.suffix and len(names) > 1:
        raise ResultError(f"{output}: there are {len(names)} pictures, {', '.join(names)}; give a folder, or one of them as --kind")
    return [output] if output.suffix else [output / f"{name}.png" for name in names]
