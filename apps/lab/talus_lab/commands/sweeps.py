"""talus-lab sweep."""

from __future__ import annotations

import argparse
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, Mapping

from talus_lab.errors import ResultError

if TYPE_CHECKING:
    from talus_lab.diagrams.pictures import Picture

NOT_DONE, OUTPUT_FAILED = 1, 4  # exit codes, as in talus


def add(commands: argparse._SubParsersAction) -> None:
    p = commands.add_parser("sweep", help="run a scenario with other keys, as a config says: only what is missing, into one table")
    p.add_argument("config", type=Path, metavar="CONFIG.yaml")
    p.add_argument("--dry-run", action="store_true", help="list the cases and what is there of them, and compute nothing")
    p.add_argument("--retry", choices=("failed", "all"), default="", help="compute again what has failed, or all")
    p.add_argument("--workers", type=_count, metavar="N", help="cases at a time; each has the cores divided by them as threads (default: all cores)")
    p.add_argument("--engine", choices=("local", "dask"), default="local", help="local: workers on this machine; dask: those of Dask distributed")
    p.add_argument("--scheduler", default="", metavar="ADDRESS", help="of a Dask scheduler that is there, e.g. tcp://node1:8786")
    p.add_argument("--leave", action="store_true", help="do not wait for cases that another driver computes")
    p.add_argument("--emit-slurm", type=_count, metavar="TASKS", help="write a job array of so many tasks for sbatch, and compute nothing")
    p.set_defaults(command=sweep_command)


def sweep_command(options: argparse.Namespace) -> int:
    from talus_lab import sweep
    from talus_lab.sweep.slurm import write_script

    if options.dry_run or options.emit_slurm:
        found = sweep.prepare(options.config, options.workers, options.retry)
        print(sweep.listing(found) if options.dry_run else write_script(found.config, options.emit_slurm, options.workers or 1))
        return 0
    pictures = _pictures(options.config)
    before = signal.signal(signal.SIGTERM, _interrupt)  # a polite kill, such as that of a queueing system
    try:
        found = sweep.sweep(options.config, options.workers, options.engine, options.scheduler, options.retry, not options.leave)
    except sweep.DiskError as error:
        print(f"talus-lab: {error}\ncases that are done are complete; make room, and the same command goes on", file=sys.stderr)
        return OUTPUT_FAILED
    finally:
        signal.signal(signal.SIGTERM, before)
    print(f"{sweep.summary(found)}\n{found.config.output / 'table.csv'}")
    if pictures and not options.leave:
        _draw(found.config.output, pictures)
    return 0 if options.leave or set(found.counts()) == {"done"} else NOT_DONE


def _pictures(config: Path) -> Mapping[str, Picture]:
    """Those that the config lists, looked at before hours of computing."""
    from talus_lab import sweep

    read = sweep.read_config(config)
    if not read.pictures:
        return {}
    from talus_lab.diagrams.pictures import read_pictures, unknown_names

    pictures = read_pictures(config)
    parameters = [*read.parameters, *([sweep.REPETITION] if read.repetitions else [])]
    read.fault(*unknown_names(pictures, parameters, [*parameters, *(measure.name for measure in read.measures), *sweep.COLUMNS]))
    return pictures


def _draw(folder: Path, pictures: Mapping[str, Picture]) -> None:
    from talus_lab import style
    from talus_lab.diagrams.pictures import draw
    from talus_lab.diagrams.table import read_table

    table = read_table(folder)
    for name, picture in pictures.items():
        try:
            style.save(draw(table, picture), folder / f"{name}.png", style.DPI)
            print(folder / f"{name}.png")
        except ResultError as error:  # such as no case that is decided: no reason to leave out the others
            print(f"talus-lab: no picture {name}: {error}", file=sys.stderr)


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _count(text: str) -> int:
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} is not a whole number above 0")
    return int(text)
