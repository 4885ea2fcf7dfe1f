"""Runs as users have them: results and exit codes, interrupts, kills, full disks, what goes in by options and out as files."""

import csv
import json
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import unittest

from program import COLUMNS, INCLINE, SLOPE, STACK, TALUS, Program, interrupt, main, SOURCE


class Results(Program):
    def test_one_block_needs_no_joint(self):
        self.write("fall.yaml", """\
gravity: [0, -10]
materials: {rock: {density: 2500}}
blocks: [{name: cube, rectangle: {corner: [0, 0], size: [1, 1]}}]
run: {until: {time: 1}}
expect: [{quantity: displacement, block: cube, component: y, value: -5, tolerance: 1e-9}]
""")
        self.talus("run", "fall.yaml")

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

    def test_blocks_of_a_result_are_found_by_place(self):
        self.write("map.yaml", """\
gravity: [0, 0]
materials: {rock: {density: 2500}}
joints: {joint: {normal_stiffness: 1e9, shear_stiffness: 5e8, friction_angle_deg: 30}}
contacts: {default: joint}
blocks:
  - {name: west, rectangle: {corner: [500000, 6000000], size: [2, 1]}}
  - {name: east, rectangle: {corner: [500002, 6000000], size: [2, 1]}}
run: {until: {time: 0.01}}
""")
        self.talus("run", "map.yaml")
        west, east = "block 0 `west` at (500001.00, 6000000.50)\n", "block 1 `east` at (500003.00, 6000000.50)\n"
        self.assertEqual(self.talus("query", "map.h5", "--at", "500001,6000000.2")[0], west)
        self.assertEqual(self.talus("query", "map.h5", "--at", "500002,6000000.2", "--frame", "0")[0], west + east)
        self.assertEqual(self.talus("query", "map.h5", "--at", "500001,6000007")[0], "")
        self.assertEqual(self.talus("query", "map.h5", "--in", "500009,6000009,500003,6000000")[0], east)
        out, _ = self.talus("query", "map.h5", "--along", "500005,6000000.5,500001.5,6000000.5")
        self.assertRegex(out, r"^block 1 .*, inside from 1 m to 3 m\nblock 0 .*, inside from 3 m to 3\.5 m\n$")

    def test_check_replaces_no_file_either(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")
        before = self.files()
        out, _ = self.talus("check", "slope.yaml", "--geometry", "slope.h5")
        self.assertRegex(out, r"geometry +slope-2\.h5")
        after = self.files()
        self.assertEqual(after.keys() - before.keys(), {"slope-2.h5"})
        self.assertEqual({name: after[name] for name in before}, before)  # results and restart file
        self.assertIn("checked", self.talus("info", "slope-2.h5")[0])
        self.talus("check", "slope.yaml", "--geometry", "slope.h5", "--force")
        self.assertIn("checked", self.talus("info", "slope.h5")[0])

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

    def test_a_run_may_end_with_its_last_stage(self):
        scene = INCLINE.replace("run: {until: {time: 0.1}}", "run: {}")
        self.write("a.yaml", scene + "stages: [{name: slide, until: {time: 0.1}}]\n")
        self.write("b.yaml", INCLINE)
        self.write("c.yaml", scene + "stages: [{name: slide, until: {time: 0.1}, reset: true}]\n")  # nothing to prepare
        for name in "abc":
            self.talus("run", f"{name}.yaml")
        for name in "ac":
            self.assert_same_results("b.h5", f"{name}.h5", apart_from=["/talus/canonical_json", "/talus/scenario"])
        self.assertRegex(self.talus("check", "a.yaml")[0], r"1 stage, ")

    def test_check_says_what_an_accuracy_decides_and_without_one_what_it_would(self):
        self.write("slope.yaml", INCLINE)
        out, _ = self.talus("check", "slope.yaml")
        self.assertRegex(out, r"solver +explicit")
        self.assertRegex(out, r"advice +solver: rigid would do: .*to 1e-3 of the motion")
        self.assertNotIn("accuracy  ", out)
        out, _ = self.talus("check", "slope.yaml", "--set", "run.accuracy=1e-3")
        self.assertRegex(out, r"accuracy +0\.001 of the motion.*\n +run\.solver +rigid: ")
        self.assertRegex(out, r"cost .*about .* in all")
        self.assertNotIn("advice", out)
        self.assertIn("run.solver rigid", self.talus("run", "slope.yaml", "--set", "run.accuracy=1e-3")[0])

    def test_a_run_estimates_its_error(self):
        self.write("slope.yaml", INCLINE)
        out, _ = self.talus("run", "slope.yaml", "--estimate-error")
        self.assertRegex(out, r"error, estimated from a run with steps of 0\.45 of the length:\n +max_displacement .*error about")
        self.assertEqual(len(re.findall("error about", out)), 5)  # two histories of two components, displacement and velocity
        self.assertNotIn("error about", self.talus("run", "slope.yaml")[0])
        out, _ = self.talus("run", "slope.yaml", "--set", "run.accuracy=1e-2", "--estimate-error", "--force")
        self.assertRegex(out, r"\n  held: the largest displacement is wrong by about [0-9.e-]+ of the motion\n")

    def test_an_accuracy_that_was_not_held_is_told(self):  # rigid columns jam while they begin to turn
        self.write("columns.yaml", COLUMNS)
        out, _ = self.talus("run", "columns.yaml", "--estimate-error")
        self.assertRegex(out, r"WARNING: not held: the largest displacement is wrong by about 0\.[0-9]+ of the motion; where")

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

    def test_1_with_the_ratio_of_the_stage_that_ran_out_of_time(self):
        # Its own weight is all that acts on a block that falls: ratio 1. Without gravity, afterwards, nothing acts.
        self.write("fall.yaml", """\
materials: {rock: {density: 2500}}
blocks: [{name: cube, rectangle: {corner: [0, 0], size: [1, 1]}}]
stages: [{name: fall, gravity: [0, -10], until: {time: 0.01, equilibrium: 1e-3}}]
run: {until: {time: 0.01}}
""")
        out, _ = self.talus("run", "fall.yaml", code=1)
        self.assertRegex(out, r"unbalanced +0 of")
        self.assertIn("stage fall did not come to equilibrium in its 0.01 s: unbalanced ratio 1, not below 0.001\n", out)

    def test_1_with_the_block_that_keeps_moving_where_there_is_no_equilibrium(self):
        # The plane dips at 26.6 degrees: the block slides below a friction angle of that, and stays above.
        self.write("slope.yaml", INCLINE.replace("{until: {time: 0.1}}", "{solver: static, until: {equilibrium: 1e-6}}"))
        out, _ = self.talus("run", "slope.yaml", code=1)
        self.assertRegex(out, r"no equilibrium: block 1 `block` at .* keeps moving; unbalanced ratio")
        out, _ = self.talus("run", "slope.yaml", "--set", "joints.base.friction_angle_deg=30")
        self.assertRegex(out, r"static +stage 1: equilibrium; unbalanced ratio \d(\.\d)?e-\d+")

    def test_1_if_the_iterations_do_not_suffice(self):
        run = "{solver: static, until: {equilibrium: 1e-9, iterations: 7}}"
        self.write("slope.yaml", INCLINE.replace("{until: {time: 0.1}}", run))
        out, _ = self.talus("run", "slope.yaml", code=1)
        self.assertIn("stage run did not come to equilibrium in 7 iterations: unbalanced ratio", out)

    def test_3_if_the_run_diverges_and_the_good_frames_stay(self):
        # A load that grows without bound: no step is short enough.
        self.write("slope.yaml", INCLINE + "loads: [{block: block, force: {time: [0.05, 0.051], x: [0, 0], y: [0, 1e300]}}]\n")
        _, err = self.talus("run", "slope.yaml", code=3)
        self.assertIn("diverged", err)
        out, _ = self.talus("info", "slope.h5")
        self.assertIn("diverged", out)
        self.assertGreaterEqual(int(self.attribute("slope.h5", "frames").split(",")[0]), 25)

    def test_3_if_the_step_makes_energy_and_the_frames_before_stay(self):
        self.write("stack.yaml", STACK)
        _, err = self.talus("run", "stack.yaml", "--set", "run.time_step=3e-3", "--set", "record.frames.every=0.005", code=3)
        self.assertIn("from nowhere", err)
        self.assertIn("diverged", self.talus("info", "stack.h5")[0])
        self.assertGreaterEqual(int(self.attribute("stack.h5", "frames").split(",")[0]), 4)
        self.assertGreater(float(self.attribute("stack.h5", "energy_gain")), 0.05)

    def test_a_warning_if_energy_is_gained_also_before_the_last_reset(self):
        stages = "stages: [{name: ring, time_step: %s, until: {time: 1}, reset: true}]\n"
        for step, gained in (("1.1e-3", True), ("1e-4", False)):
            self.write("stack.yaml", STACK + stages % step)
            out, _ = self.talus("run", "stack.yaml", "-o", "stack.h5", "--force", "--set", "run.time_step=1e-4", "--until", "0.01")
            self.assertEqual("WARNING" in out, gained, out)
            self.assertEqual(float(self.attribute("stack.h5", "energy_gain")) > 0.05, gained)

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
            if not self.when_running(process, "parts.h5", chance.uniform(0.0, 0.1)):
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
            if killed >= 8 and interrupted >= 2:
                break
        out, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0, out + err)
        self.assertGreaterEqual(killed, 5)
        self.assertGreaterEqual(interrupted, 2)
        self.assert_same_results("whole.h5", "parts.h5")


if __name__ == "__main__":
    main()
