"""Runs as users have them: results and exit codes, interrupts, kills, full disks, what goes in by options and out as files."""

import csv
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import unittest

from program import INCLINE, SLOPE, TALUS, Program, interrupt, main, SOURCE


class Results(Program):
    def test_earlier_results_are_never_lost(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")
        first = (self.folder / "slope.h5").read_bytes()
        out, _ = self.talus("run", "slope.yaml")
        self.assertIn("slope-2.h5", out)
        self.assertEqual((self.folder / "slope.h5").read_bytes(), first)
        self.assert_same_results("slope.h5", "slope-2.h5")
        self.talus("run", "slope.yaml", "--force", "--set", "run.until.time=0.05")
        self.assertNotEqual((self.folder / "slope.h5").read_bytes(), first)
        self.assertFalse((self.folder / "slope-3.h5").exists())

    def test_set_and_case_change_the_scenario_and_are_noted(self):
        self.write("slope.yaml", INCLINE + """\
cases:
  - {name: steep, set: {gravity: [-3, -9.81]}, expect: [{quantity: unstable, block: block}]}
  - {name: flat, set: {gravity: [4.905, -9.81]}, expect: [{quantity: stable, block: block, limit: 0.01}]}
""")
        self.talus("run", "slope.yaml", "-o", "plain.h5")
        out, _ = self.talus("run", "slope.yaml", "--case", "flat", "-o", "flat.h5")
        self.assertIn("ok ", out)
        self.talus("run", "slope.yaml", "--set", "gravity=[4.905, -9.81]", "-o", "set.h5")
        self.assertNotEqual(self.attribute("plain.h5", "scenario_hash"), self.attribute("set.h5", "scenario_hash"))
        self.assertIn("gravity=[4.905, -9.81]", self.talus("info", "set.h5")[0])
        self.talus("export", "flat.h5", "-o", "flat")
        self.talus("export", "set.h5", "-o", "set")
        self.assertEqual((self.folder / "flat/block.csv").read_text(), (self.folder / "set/block.csv").read_text())

    def test_the_resolved_scenario_is_json_and_reads_back_as_the_same(self):
        for text in (INCLINE, SLOPE):
            self.write("scene.yaml", text)
            resolved, _ = self.talus("check", "scene.yaml", "--resolved")
            self.assertEqual(json.loads(resolved)["run"]["step_fraction"], 0.8)  # a default, filled in
            self.write("again.yaml", resolved)
            self.assertEqual(self.talus("check", "again.yaml", "--resolved")[0], resolved)
            for name in ("scene", "again"):
                self.talus("run", f"{name}.yaml", "--until", "0.01")
            self.assertEqual(self.attribute("scene.h5", "scenario_hash"), self.attribute("again.h5", "scenario_hash"))
            for path in self.folder.glob("*.h5"):
                path.unlink()

    def test_export_writes_tables_that_read_back(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")
        self.talus("export", "slope.h5", "-o", "tables")
        with open(self.folder / "tables/block.csv") as file:
            rows = list(csv.reader(file))
        self.assertIn("time", rows[0][0])
        self.assertGreater(len(rows), 50)
        times = [float(row[0]) for row in rows[1:]]
        self.assertEqual(times, sorted(times))
        self.assertAlmostEqual(times[-1], 0.1, places=12)
        with open(self.folder / "tables/energies.csv") as file:
            self.assertEqual(len(list(csv.reader(file))), 52)  # a header, the start and 50 frames

    def test_search_and_threads_leave_no_trace_in_the_results(self):
        self.write("slope.yaml", SLOPE)
        self.talus("run", "slope.yaml", "--until", "0.1", "-o", "a.h5")
        self.talus("run", "slope.yaml", "--until", "0.1", "--search", "direct", "--threads", "2", "-o", "b.h5")
        self.assert_same_results("a.h5", "b.h5", apart_from=["/talus/canonical_json", "/talus/overrides", "/talus/scenario"])


class ExitCodes(Program):
    def test_1_if_an_expectation_fails(self):
        expect = "expect: [{quantity: displacement, component: y, block: block, value: %s, tolerance_absolute: 1}]\n"
        self.write("good.yaml", INCLINE + expect % 0)
        self.write("bad.yaml", INCLINE + expect % 5)
        self.talus("run", "good.yaml")
        out, _ = self.talus("run", "bad.yaml", code=1)
        self.assertIn("FAILED", out)
        self.talus("verify", "good.yaml")
        self.assertIn("1 cases failed", self.talus("verify", "bad.yaml", code=1)[0])

    def test_verify_takes_one_file_of_the_collection(self):
        out, _ = self.talus("verify", SOURCE / "scenarios/verification/v01_free_fall.yaml")
        self.assertIn("0 cases failed", out)

    def test_1_if_equilibrium_is_not_reached(self):
        self.write("slope.yaml", INCLINE.replace("{time: 0.1}", "{time: 0.02, equilibrium: 1e-9}"))
        self.assertIn("equilibrium", self.talus("run", "slope.yaml", code=1)[0])
        self.assertIn("stopped", self.talus("info", "slope.h5")[0])

    def test_3_if_the_run_diverges_and_the_good_frames_stay(self):
        # A load that grows without bound: no step is short enough.
        self.write("slope.yaml", INCLINE + "loads: [{block: block, force: {time: [0.05, 0.051], x: [0, 0], y: [0, 1e300]}}]\n")
        _, err = self.talus("run", "slope.yaml", code=3)
        self.assertIn("diverged", err)
        out, _ = self.talus("info", "slope.h5")
        self.assertIn("diverged", out)
        self.assertGreaterEqual(int(self.attribute("slope.h5", "frames").split(",")[0]), 25)

    def test_4_if_the_file_may_not_grow_and_what_is_complete_stays(self):
        self.write("slope.yaml", SLOPE)
        limit = 1_200_000

        def small_files():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        _, err = self.talus("run", "slope.yaml", code=4, preexec_fn=small_files)
        self.assertIn("output failed", err)
        self.assertGreater(int(self.attribute("slope.h5", "frames").split(",")[0]), 3)
        self.talus("export", "slope.h5", "-o", "tables")

    def test_4_if_the_disk_is_full(self):
        self.write("slope.yaml", SLOPE)
        disk = self.folder / "disk"
        disk.mkdir()
        # In a name space of its own, so that the small disk is gone with the shell.
        script = f"mount -t tmpfs -o size=1200k talus {disk} || exit 77; '{TALUS}' run slope.yaml -o disk/out.h5; echo code $?; " \
                 f"'{TALUS}' info disk/out.h5; echo info $?"
        if os.geteuid() != 0 or shutil.which("unshare") is None:
            self.skipTest("a small disk needs root and unshare")
        done = subprocess.run(["unshare", "--mount", "sh", "-c", script], cwd=self.folder, text=True, capture_output=True)
        if done.returncode == 77 or "unshare" in done.stderr:
            self.skipTest("may not mount a small disk")
        self.assertIn("output failed", done.stderr)
        self.assertIn("code 4", done.stdout)
        self.assertIn("info 0", done.stdout)
        self.assertRegex(done.stdout, r"frames +[1-9]")


class Interrupts(Program):
    def setUp(self):
        super().setUp()
        self.write("slope.yaml", SLOPE)
        self.talus("run", "slope.yaml", "-o", "whole.h5")

    def test_ctrl_c_leaves_a_restart_and_resume_goes_on_bit_for_bit(self):
        process = self.start("run", "slope.yaml", "-o", "parts.h5")
        self.assertTrue(self.when_running(process, "parts.h5", 0.2), "the run is over before it can be interrupted")
        out, _ = interrupt(process)
        self.assertEqual(process.returncode, 130)
        self.assertIn("talus resume parts.h5", out)
        self.assertTrue((self.folder / "parts.restart.h5").exists())
        self.assertIn("interrupted", self.talus("info", "parts.h5")[0])
        self.assertLess(int(self.attribute("parts.h5", "frames").split(",")[0]), 51)
        self.talus("resume", "parts.h5", "--threads", "2")
        self.assertIn("complete", self.talus("info", "parts.h5")[0])
        self.assert_same_results("whole.h5", "parts.h5")

    def test_resume_wants_the_files_that_the_run_began_with(self):
        self.write("map.csv", "id,x,y\na,-1,2\na,13,2\n")
        self.write("mapped.yaml", SLOPE.replace("  held:", "  traces: {file: map.csv}\n  held:"))
        process = self.start("run", "mapped.yaml")
        self.assertTrue(self.when_running(process, "mapped.h5", 0.1), "the run is over before it can be interrupted")
        interrupt(process)
        self.assertIn("map.csv", self.talus("info", "mapped.h5")[0])
        self.write("map.csv", "id,x,y\na,-1,2.5\na,13,2\n")
        self.assertIn("map.csv: has changed", self.talus("resume", "mapped.h5", code=2)[1])
        self.write("map.csv", "id,x,y\na,-1,2\na,13,2\n")
        self.talus("resume", "mapped.h5")

    def test_ctrl_c_while_it_settles(self):
        process = self.start("run", "slope.yaml", "-o", "parts.h5", "--set", "stages[0].until.time=1")
        while not (self.folder / "parts.h5").exists():
            self.assertIsNone(process.poll())
        interrupt(process)
        self.assertEqual(process.returncode, 130)
        self.talus("resume", "parts.h5")
        self.talus("run", "slope.yaml", "-o", "settled.h5", "--set", "stages[0].until.time=1")
        self.assert_same_results("settled.h5", "parts.h5")

    def test_kill_at_any_time_loses_no_more_than_the_time_since_the_restart(self):
        chance = random.Random(1)
        killed = interrupted = 0
        process = self.start("run", "slope.yaml", "-o", "parts.h5")
        for turn in range(40):
            if not self.when_running(process, "parts.h5", chance.uniform(0.0, 0.25)):
                break
            if turn % 3 == 2:
                interrupt(process)
                self.assertIn(process.returncode, (130, -signal.SIGINT))  # the second: before the run has gone on
                interrupted += process.returncode == 130  # leaves a restart file of this moment
            else:
                process.kill()
                process.communicate()
                killed += 1
            self.talus("info", "parts.h5")
            process = self.start("resume", "parts.h5")
            if killed >= 8:
                break
        out, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0, out + err)
        self.assertGreaterEqual(killed, 5)
        self.assertGreaterEqual(interrupted, 2)
        self.assert_same_results("whole.h5", "parts.h5")


if __name__ == "__main__":
    main()
