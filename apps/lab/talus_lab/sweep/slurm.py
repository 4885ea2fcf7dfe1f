"""A sweep as a job array of SLURM, without any daemon: every task of the array is a driver of its own on the same folder, and takes the
next case that nobody has."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path

from talus_lab.program import find_talus
from talus_lab.sweep.config import Config

SCRIPT = """\
#!/bin/bash
#SBATCH --job-name={name}
#SBATCH --array=1-{tasks}
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={workers}
#SBATCH --output={output}/slurm-%A_%a.txt
# Memory, time, partition and account are for you to say, here or as options of sbatch. Tasks that are killed leave nothing but a case
# that another one computes: send the script again until nothing is missing.
export TALUS={talus}
exec {python} -m talus_lab.cli sweep {config} --workers {workers} --leave
"""


def write_script(config: Config, tasks: int, workers: int) -> Path:
    """The script, for sbatch. workers: cases that each task computes at a time, one core each."""
    config.output.mkdir(parents=True, exist_ok=True)
    path = config.output / "sweep.sbatch"
    quoted = {name: shlex.quote(str(value)) for name, value in
              {"talus": Path(find_talus()).resolve(), "python": sys.executable, "config": config.path.resolve()}.items()}
    path.write_text(SCRIPT.format(name=config.path.stem, tasks=tasks, workers=workers, output=config.output, **quoted), encoding="utf-8")
    return path
