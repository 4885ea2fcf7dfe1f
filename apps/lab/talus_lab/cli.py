"""The command `talus-lab`."""

from __future__ import annotations

import argparse
import sys

import talus_lab
from talus_lab.commands import diagrams, pictures, studies, sweeps
from talus_lab.errors import ResultError

BAD_INPUT = 2  # exit code for anything the user gave, as in talus
INTERRUPTED = 130


def main(arguments: list[str] | None = None) -> int:
    options = _parser().parse_args(arguments)
    try:
        return options.command(options)
    except ResultError as error:
        print(f"talus-lab: {error}", file=sys.stderr)
        return BAD_INPUT
    except OSError as error:
        print(f"talus-lab: {f'{error.filename}: {error.strerror}' if error.filename else error.strerror or error}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        print("talus-lab: interrupted", file=sys.stderr)
        return INTERRUPTED


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="talus-lab", description="Reads the results of talus and draws them; measures speed and accuracy.")
    parser.add_argument("--version", action="version", version=f"talus-lab {talus_lab.__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for group in (pictures, sweeps, diagrams, studies):
        group.add(commands)
    return parser


if __name__ == "__main__":
    sys.exit(main())
