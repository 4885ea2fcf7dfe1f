"""What the tests of the command line share: the program, a folder of its own for every test, small scenarios."""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TALUS = pathlib.Path(os.environ.get("TALUS", SOURCE / "build/release/bin/talus"))

INCLINE = """\
title: Block on an incline
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints:
  base: {normal_stiffness: 1e10, shear_stiffness: 5e9, friction_angle_deg: 20}
blocks:
  - {name: plane, held: true, outline: [[0, 0], [10, 0], [10, 5]]}
  - {name: block, outline: [[6, 3], [8, 4], [7.5, 5], [5.5, 4]]}
run: {until: {time: 0.1}}
record: {history: [{name: block, point: [6.75, 4]}]}
"""

# Columns of 1 x 5 m side by side, on a plane that dips at 20 degrees: as they begin to turn they press their feet apart and jam.
COLUMNS = """\
title: Columns
gravity: [3.3552, -9.2184]
materials: {rock: {density: 2500}}
joints: {face: {friction_angle_deg: 35}}
blocks:
  - {name: plane, rectangle: {corner: [-10, -1], size: [40, 1]}, held: true}
  - {name: column, rectangle: {corner: [0, 0], size: [1, 5]}, repeat: {count: 5, step: [1, 0]}}
run: {until: {time: 1.5}, accuracy: 1e-2}
"""

# Runs for a second or two, with stages, frames, contacts that slide, and histories at two intervals.
SLOPE = """\
title: Small jointed slope
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints:
  rough: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 20}
  firm: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 35, cohesion: 1e4, tension: 2e3}
contacts: {default: rough}
rock:
  outline: [[0, 0], [12, 0], [12, 3], [6, 10], [0, 10]]
  joint_sets: [{angle_deg: -35, spacing: 1}, {angle_deg: 60, spacing: 1.2, joint: firm}]
  held: {left: true, bottom: true}
stages: [{name: settle, damping: {local: 0.8}, until: {time: 0.05}, reset: true}]
run: {until: {time: 1}}
record: {history: [{name: top, point: [1, 9]}, {name: energy, quantity: energy, every: 0.01}]}
"""

# Six blocks that ring under their weight, opening and closing their joints: with long steps they gain energy.
STACK = """\
title: Stack
gravity: [0, -9.81]
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 30}}
blocks:
  - {name: base, rectangle: {corner: [-1, -1], size: [3, 1]}, held: true}
  - {name: block, rectangle: {corner: [0, 0], size: [1, 1]}, repeat: {count: 6, step: [0, 1]}}
run: {until: {time: 1}, unchecked: true}
"""


class Program(unittest.TestCase):
    """Every test runs in a folder of its own, which is gone afterwards."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="talus-cli-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return name

    def start(self, *arguments, **options):
        return subprocess.Popen([TALUS, *arguments], cwd=self.folder, text=True, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, **options)

    def talus(self, *arguments, code=0, **options):
        """Runs the program to its end; stdout and stderr as text. Fails unless it exits with `code`."""
        process = self.start(*arguments, **options)
        out, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, code, f"talus {' '.join(map(str, arguments))}\n{out}\n{err}")
        return out, err

    def files(self):
        return {path.name: path.read_bytes() for path in self.folder.iterdir()}

    def attribute(self, results, name):
        """As `talus info` prints it."""
        return re.search(rf"^  {name} +(.*)$", self.talus("info", results)[0], re.M).group(1)

    def when_running(self, process, results, after):
        """Waits until the run can be resumed, and `after` seconds more. False if it has ended by then."""
        restart = self.folder / results.replace(".h5", ".restart.h5")
        while not restart.exists() and process.poll() is None:
            time.sleep(0.005)
        time.sleep(after)
        return process.poll() is None

    def assert_same_results(self, a, b, apart_from=()):
        """Every dataset of two result files, bit for bit."""
        if shutil.which("h5diff") is None:
            self.skipTest("h5diff is not there: apt install hdf5-tools")
        listing = subprocess.run(["h5ls", "-r", a], cwd=self.folder, text=True, capture_output=True, check=True).stdout
        datasets = [line.split(" Dataset ")[0].rstrip().replace("\\ ", " ") for line in listing.splitlines() if " Dataset " in line]
        self.assertGreater(len(datasets), 30)
        for dataset in set(datasets) - set(apart_from):
            found = subprocess.run(["h5diff", a, b, dataset, dataset], cwd=self.folder, text=True, capture_output=True)
            self.assertEqual(found.returncode, 0, f"{dataset}: {found.stdout}{found.stderr}")


def interrupt(process):
    process.send_signal(signal.SIGINT)
    return process.communicate(timeout=60)


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
