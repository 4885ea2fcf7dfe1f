"""`talus bench`: tables that say what they say they do, and what does not fit refused before anything is written."""

import csv
import math
import resource
import struct
import unittest

from program import INCLINE, SLOPE, Program, main

COLUMNS = ("scene,boxes,steps,method,threads,skin,ns_per_box_median,ns_per_box_q1,ns_per_box_q3,ns_per_box_mean,"
           "ns_per_box_max,first_ns_per_box,list_ns_per_box,exchanges_per_box,pairs_per_box,bytes_per_box,wrong_steps").split(",")
STEP_COLUMNS = ("scene,blocks,parts,contacts,threads,steps,ns_per_block_and_step,move,place,search,contacts_part,sum,account,"
                "refreshes,bytes_per_block,build_s").split(",")
METHODS = {"direct", "dess", "isu", "read"}


def trajectory(boxes, dt=0.1, header=None):
    """Bytes of a trajectory file; `boxes` is steps x boxes x 4 numbers."""
    n, f = header or (len(boxes[0]), len(boxes))
    return b"BPTRAJ01" + struct.pack("<QQd", n, f, dt) + b"".join(struct.pack("<4d", *b) for step in boxes for b in step)


class Bench(Program):
    def table(self, name):
        with open(self.folder / name, newline="") as file:
            return list(csv.DictReader(file))

    def refused(self, *arguments, report):
        before = self.files()
        _, err = self.talus("bench", *arguments, code=2)
        self.assertRegex(err, report)
        self.assertEqual(len(err.strip().splitlines()), 1, err)
        self.assertEqual(self.files(), before)

    def test_a_scenario_is_recorded_replayed_and_checked(self):
        self.write("slope.yaml", SLOPE)
        out, _ = self.talus("bench", "search", "slope.yaml", "--steps", "12", "--every", "3", "--record", "slope.bpt", "--threads",
                            "1,2", "--skin", "0,0.01", "--repeat", "2", "-o", "table.csv")
        self.assertEqual(set(self.files()), {"slope.yaml", "slope.bpt", "table.csv"})
        rows = self.table("table.csv")
        self.assertEqual(list(rows[0]), COLUMNS)
        self.assertLessEqual(METHODS, {row["method"] for row in rows})
        methods = {row["method"] for row in rows}
        self.assertEqual({(row["method"], row["threads"], row["skin"]) for row in rows},
                         {(m, t, s) for m in methods for t in "12" for s in ("0", "0.01")})
        data = (self.folder / "slope.bpt").read_bytes()
        n, f, dt = struct.unpack_from("<QQd", data, 8)
        self.assertEqual((data[:8], f, len(data)), (b"BPTRAJ01", 12, 32 + 32 * n * f))
        self.assertGreater(dt, 0.0)
        boxes = list(struct.iter_unpack("<4d", data[32:]))
        pairs = 0
        for step in range(f):
            now = boxes[step * n:(step + 1) * n]
            pairs += sum(a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]
                         for i, a in enumerate(now) for b in now[:i])
        for row in rows:
            self.assertEqual((row["scene"], int(row["boxes"]), int(row["steps"])), ("slope", n, f))
            self.assertEqual(row["wrong_steps"], "" if row["method"] == "read" else "0", row)
            numbers = [float(row[c]) for c in COLUMNS[6:16]]
            self.assertTrue(all(map(math.isfinite, numbers)), row)
            self.assertLessEqual(float(row["ns_per_box_q1"]), float(row["ns_per_box_median"]))
            self.assertLessEqual(float(row["ns_per_box_median"]), float(row["ns_per_box_max"]))
            if row["method"] != "read" and row["skin"] == "0":
                self.assertAlmostEqual(float(row["pairs_per_box"]), pairs / (n * f), places=4)
        self.assertIn(f"slope: {n} boxes, 12 steps", out)

    def test_a_trajectory_made_elsewhere_is_replayed(self):
        gone = (1, 1, -1, -1)
        steps = [[(0, 0, 1, 1), (1, 0, 2, 1), (5, 5, 6, 6)], [(0, 0, 1, 1), (1.5, 0, 2.5, 1), (2, 1, 3, 2)],
                 [(0, 0, 1, 1), gone, (1, 1, 2, 2)]]
        (self.folder / "other.bpt").write_bytes(trajectory(steps))
        self.talus("bench", "search", "--trajectory", "other.bpt", "--repeat", "1", "-o", "a.csv")
        for row in self.table("a.csv"):
            self.assertEqual(row["wrong_steps"], "" if row["method"] == "read" else "0")
            self.assertAlmostEqual(float(row["pairs_per_box"]), 0 if row["method"] == "read" else 3 / 9, places=5)
        self.talus("bench", "search", "--trajectory", "other.bpt", "--methods", "isu", "--no-check", "-o", "a.csv")
        self.assertEqual([row["wrong_steps"] for row in self.table("a-2.csv")], [""])  # and the earlier table is kept
        self.assertEqual(len(self.table("a.csv")), len(METHODS | {row["method"] for row in self.table("a.csv")}))

    def test_the_parts_of_a_step_add_up_for_every_number_of_threads(self):
        self.write("slope.yaml", SLOPE)
        self.write("incline.yaml", INCLINE)
        out, _ = self.talus("bench", "step", "slope.yaml", "incline.yaml", "--threads", "1,2", "--steps", "20", "--repeat", "2",
                            "--from", "0.01", "--set", "run.until.time=1", "-o", "table.csv")
        rows = self.table("table.csv")
        self.assertEqual(list(rows[0]), STEP_COLUMNS)
        self.assertEqual([(row["scene"], row["threads"], row["steps"]) for row in rows],
                         [(scene, threads, "40") for scene in ("slope", "incline") for threads in "12"])
        for row in rows:
            parts = [float(row[name]) for name in STEP_COLUMNS[7:13]]
            self.assertGreater(min(parts), 0.0)
            self.assertAlmostEqual(sum(parts), float(row["ns_per_block_and_step"]), delta=1e-4 * sum(parts))
        self.assertEqual((rows[2]["blocks"], rows[2]["parts"], rows[2]["contacts"]), ("2", "2", "1"))
        self.assertIn("slope: ", out)

    def test_a_trajectory_that_is_none(self):
        good = trajectory([[(0, 0, 1, 1), (1, 0, 2, 1)]] * 3)
        nan = trajectory([[(0, 0, 1, 1), (1, 0, 2, 1)], [(0, 0, 1, 1), (1, 0, math.nan, 1)]])
        inverted = trajectory([[(0, 0, 1, 1), (1, 0, 2, 1)], [(0, 3, 1, 1), (1, 0, 2, 1)]])
        cases = {
            "other magic": (b"BPTRAJ02" + good[8:], "is not a trajectory"),
            "empty": (b"", "is not a trajectory"),
            "cut off": (good[:-1], "cut off: 223 bytes are there, 224 are expected"),
            "cut off in the header": (good[:20], "cut off"),
            "no boxes": (trajectory([[]], header=(0, 3)), "holds nothing"),
            "no steps": (trajectory([], header=(3, 0)), "holds nothing"),
            "one step": (trajectory([[(0, 0, 1, 1)]]), "one step"),
            "not a number": (nan, r"step 1, box 1 .*not finite"),
            "inverted": (inverted, r"step 1, box 0 .*inverted"),
            "too many boxes": (trajectory([], header=(10**9, 10**9)), r"too much for memory, .* needed, .* available"),
        }
        (self.folder / "good.bpt").write_bytes(good)
        for name, (data, report) in cases.items():
            with self.subTest(name):
                (self.folder / "bad.bpt").write_bytes(data)
                self.refused("search", "--trajectory", "good.bpt", "--trajectory", "bad.bpt", "-o", "a.csv",
                             report=r"^(bad\.bpt: )?.*" + report)
        self.refused("search", "--trajectory", "none.bpt", "-o", "a.csv", report=r"^none\.bpt: cannot be read")

    def test_a_disk_that_is_full(self):
        self.write("slope.yaml", SLOPE)
        command = ("bench", "search", "slope.yaml", "--steps", "20", "--methods", "isu", "--repeat", "1")
        self.talus(*command, "--record", "whole.bpt", "-o", "whole.csv")
        before = self.files()
        for size, options in ((10_000, ("--record", "a.bpt")), (100, ("-o", "a.csv"))):
            _, err = self.talus(*command, *options, code=4,
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
            self.assertRegex(err, rf"^output failed: {options[1]}: cannot be written: ")
            self.assertEqual(self.files(), before)

    def test_faults_of_the_command_line(self):
        self.write("slope.yaml", INCLINE)
        (self.folder / "good.bpt").write_bytes(trajectory([[(0, 0, 1, 1), (1, 0, 2, 1)]] * 3))
        for command in (["search", "--trajectory", "good.bpt"], ["search", "slope.yaml", "--record", "a.bpt"]):
            for options, report in (
                    (("--methods", "isu,fastest"), r'unknown search "fastest"; allowed:.* isu'),
                    (("--threads", "0"), "threads: 0"), (("--threads", "1,5000"), "threads: 5000"),
                    (("--skin=-1",), "skin: -1"), (("--skin", "nan"), "skin: nan"), (("--repeat", "0"), "repeat: 0"),
                    (("-o", "no/such/folder/a.csv"), r"no/such/folder/a\.csv: cannot be written")):
                with self.subTest(command[1], options=options):
                    self.refused(*command, *options, report=report)
        self.refused("search", "none.yaml", report="none.yaml")
        self.refused("search", "slope.yaml", "--set", "gravty=1", report="gravty: .*gravity")
        self.refused("search", "slope.yaml", "--steps", "0", report="steps: 0")
        self.refused("search", "slope.yaml", "--from", "later", report=r"'later' is neither .*; there are: run")
        self.refused("search", "slope.yaml", "--from", "7", report=r"the run ends at t = 0\.1 s, before 7")
        self.refused("search", "slope.yaml", "slope.yaml", "--record", "a.bpt", report="--record")
        self.refused("search", "slope.yaml", "--record", "no/a.bpt", report=r"no/a\.bpt: cannot be written")
        self.refused("step", "slope.yaml", "--steps", "100000", report=r"the run ends after \d+ steps")
        for options, report in ((("--threads", "0"), "threads: 0"), (("--steps", "0"), "steps: 0"), (("--repeat", "-1"), "repeat: -1"),
                                (("--from", "later"), "'later'"), (("-o", "no/a.csv"), r"no/a\.csv: cannot be written")):
            self.refused("step", "slope.yaml", *options, report=report)
        self.talus("bench", code=2)
        self.talus("bench", "step", code=2)


if __name__ == "__main__":
    main()
