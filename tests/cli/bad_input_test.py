"""What the user gave wrong: one report that names file, line and key, exit code 2, and earlier results untouched."""

import os
import re
import stat
import unittest

from program import INCLINE, SLOPE, STACK, Program, main


def line_of(text, part):
    return text[:text.index(part)].count("\n") + 1


def replaced(old, new, text=INCLINE):
    assert old in text, old
    return text.replace(old, new)


# name: (scenario, what the report says besides file and line, text on the line it names)
SCENARIOS = {
    "unknown key": (replaced("friction_angle_deg: 20", "friction_angel_deg: 20"),
                    r"joints\.base\.friction_angel_deg: .*friction_angle_deg", "friction_angel"),
    "wrong type": (replaced("density: 2500", "density: heavy"), r"materials\.rock\.density: .*number", "heavy"),
    "negative density": (replaced("density: 2500", "density: -1"), r"materials\.rock\.density: .*> 0", "-1"),
    "unknown joint": (INCLINE + "contacts: {default: bsae}\n", r"contacts\.default: .*base", "bsae"),
    "open outline": (replaced("[[0, 0], [10, 0], [10, 5]]", "[[0, 0], [10, 0]]"), r"blocks\[0\]\.outline: .*3", "plane"),
    "outline that crosses itself": (replaced("[[6, 3], [8, 4], [7.5, 5], [5.5, 4]]", "[[6, 3], [7.5, 5], [8, 4], [5.5, 4]]"),
                                    r"blocks\[1\]\.outline: ", "[7.5, 5]"),
    "rock outline that crosses itself": (replaced("[12, 3], [6, 10]", "[6, 10], [12, 3]", SLOPE), r"rock\.outline: ", "[12, 3]"),
    "overlapping blocks": (replaced("[6, 3], [8, 4]", "[6, 2], [8, 3]"), r"block.*plane.* by 0\.\d+ m at \(", "name: block"),
    "block without area": (replaced("[8, 4], [7.5, 5], [5.5, 4]", "[8, 4], [10, 5]"), r"blocks\[1\]\.outline: .*area", "name: block"),
    "zero spacing": (replaced("spacing: 1.2", "spacing: 0", SLOPE), r"rock\.joint_sets\[1\]\.spacing: .*> 0", "spacing: 0"),
    "duplicate key": (INCLINE + "gravity: [0, -1]\n", r"gravity: ", "gravity: [0, -1]"),
    "water": (INCLINE + "water: {level: 3}\n", r"water: not available yet", "water"),
    "bolts": (INCLINE + "bolts: []\n", r"bolts: not available yet", "bolts"),
    "deformation": (replaced("density: 2500", "density: 2500, young: 5e10"), r"materials\.rock\.young: not available yet", "young"),
    "accuracy of more than all": (replaced("run: {", "run: {accuracy: 0.6, "), r"run\.accuracy: .*0\.5", "accuracy"),
    "accuracy beyond the give of joints": (replaced("run: {", "run: {accuracy: 1e-5, solver: explicit, "),
                                           r"run\.accuracy: 1e-05 cannot be reached: .*1e\+10 Pa/m", "accuracy"),
    "accuracy beyond all": (replaced("run: {", "run: {accuracy: 1e-9, "), r"run\.accuracy: .*1e-06 can be reached", "accuracy"),
    "joint stress with rigid joints": (replaced("run: {", "run: {accuracy: {joint_stress: 1e-2}, solver: rigid, "),
                                       r"run\.accuracy\.joint_stress: .*explicit or static", "accuracy"),
    "negative time": (replaced("time: 0.1", "time: -1"), r"run\.until\.time: ", "-1"),
    "point outside": (replaced("point: [6.75, 4]", "point: [60, 4]"), r"record\.history\[0\]\.point: no block contains the point", "[60, 4]"),
    "expectation outside": (INCLINE + "expect:\n  - quantity: max_normal_stress\n    joint: [1, 1]\n    below: 1\n  - quantity: spin\n"
                            "    point: [60, 4]\n    below: 1\n", r"expect\[1\]\.point: no block contains the point", "point: [60, 4]"),
    "no YAML": (INCLINE + "loads: [{\n", r"", None),
}


class BadInput(Program):
    def refused(self, *arguments, report):
        """The program ends with 2 and this report, and no file has changed, come or gone."""
        before = self.files()
        out, err = self.talus(*arguments, code=2)
        self.assertRegex(err, report)
        self.assertEqual(self.files(), before)
        return out, err

    def test_every_fault_of_a_scenario_is_one_report_with_file_line_and_key(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")  # an earlier result of the same name
        for name, (text, report, at) in SCENARIOS.items():
            with self.subTest(name):
                self.write("slope.yaml", text)
                line = line_of(text, at) if at else r"\d+"
                for command in ("run", "check"):
                    _, err = self.refused(command, "slope.yaml", report=rf"^slope\.yaml:{line}.*{report}")
                    self.assertEqual(len(err.strip().splitlines()), 1, err)

    def test_all_faults_come_at_once(self):
        self.write("bad.yaml", replaced("density: 2500", "density: -1") + "water: 3\ncontacts: {default: nothing}\n")
        _, err = self.refused("run", "bad.yaml", report="density")
        self.assertEqual([line.split()[0] for line in err.strip().splitlines()], ["bad.yaml:3", "bad.yaml:11", "bad.yaml:12"])

    def test_a_step_above_the_stable_one(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")
        self.refused("run", "slope.yaml", "--set", "run.time_step=0.1", report=r"run\.time_step: .*stable step.*unchecked")

    def test_what_takes_time_in_a_stage_without_time(self):
        for change, report in [("until: {time: 1}", r"run\.until: needs `equilibrium`: no time passes"),
                               ("until: {equilibrium: 1e-6}", r"blocks\.block\.driven: a prescribed velocity takes time")]:
            self.write("slope.yaml", INCLINE.replace("until: {time: 0.1}", "solver: static, " + change).replace(
                "{name: block, outline", "{name: block, driven: {velocity_x: 0.1}, outline"))
            self.refused("run", "slope.yaml", report=report)
        self.write("slope.yaml", INCLINE.replace("{time: 0.1}", "{time: 0.1, iterations: 5}"))
        self.refused("run", "slope.yaml", report=r"run\.until\.iterations: is for a static stage")

    def test_a_step_that_is_too_long_for_a_later_stage_is_refused_before_anything_is_written(self):
        # The block, 1.25 m2, alone on its longest face of 5^(1/2) m: limit about 7e-4 s; with joints 100 times as stiff 7e-5 s,
        # with joints a hundredth as stiff 7e-3 s.
        def stages(change, step):
            return f"""stages:
  - {{name: first, until: {{time: 0.01}}}}
  - name: second
    change: {{joints: {{base: {{{change}}}}}}}
    until: {{time: 0.01}}
    time_step: {step}
"""
        stiff, soft = "normal_stiffness: 1e12, shear_stiffness: 5e11", "normal_stiffness: 1e8, shear_stiffness: 5e7"
        for change, step, good in ((stiff, "2e-4", False), (stiff, "2e-5", True), (soft, "2e-3", True), (soft, "2e-2", False)):
            with self.subTest(change, step=step):
                text = INCLINE + stages(change, step)
                self.write("slope.yaml", text)
                for command in ("run", "check"):
                    if good:
                        self.talus(command, "slope.yaml")
                    else:
                        self.refused(command, "slope.yaml", report=rf"^slope\.yaml:{line_of(text, 'time_step')} "
                                                                   r"stages\[1\]\.time_step: .*stable step")
        text = INCLINE.replace("run: {", "run: {time_step: 2e-4, ") + stages(stiff, "auto")  # a change holds in `run` too
        self.write("slope.yaml", text)
        self.refused("run", "slope.yaml", report=rf"^slope\.yaml:{line_of(text, 'run:')} run\.time_step: .*stable step")
        self.write("slope.yaml", INCLINE + """stages:
  - {until: {time: 0.01}}
  - {until: {time: 0.01}, delete: [[60, 4]]}
""")
        self.refused("run", "slope.yaml", report=r"^slope\.yaml:13 stages\[1\]\.delete\[0\]: no block contains the point")

    def test_a_step_that_is_found_too_long_when_its_stage_begins(self):
        # In a chain of six, 2 / (2 (k/m)^(1/2) sin(11 pi / 26)) = 1.6285e-3 s; before they touch, each block alone says 2.5e-3 s.
        self.write("stack.yaml", STACK + "stages: [{name: settle, damping: {local: 0.8}, until: {time: 0.1}}]\n")
        out, err = self.talus("run", "stack.yaml", "--set", "run.unchecked=false", "--set", "run.time_step=2e-3", code=2)
        self.assertRegex(err, r"^--set run\.time_step: .*stable step, estimated at 0\.001628")
        self.assertIn("stage run cannot begin; results up to its start: stack.h5", out)
        self.assertEqual(self.attribute("stack.h5", "status"), "refused")
        self.assertAlmostEqual(float(self.attribute("stack.h5", "end_time")), 0.1)
        frames = self.attribute("stack.h5", "frames")
        for _ in range(2):  # with the restart file of the end of the stage before, which stays good
            _, err = self.talus("resume", "stack.h5", code=2)
            self.assertRegex(err, r"run\.time_step: .*stable step")
            self.assertEqual(self.attribute("stack.h5", "frames"), frames)

    def test_faults_of_the_command_line(self):
        self.write("slope.yaml", INCLINE)
        self.refused("run", "nothing.yaml", report="nothing.yaml")
        self.refused("run", ".", report=r"\.")
        self.refused("run", "slope.yaml", "--set", "joints.base.cohesoin=1", report="joints.base.cohesoin: .*cohesion")
        self.refused("run", "slope.yaml", "--set", "nonsense", report="nonsense")
        self.refused("run", "slope.yaml", "--case", "none", report="none")
        self.refused("run", "slope.yaml", "--search", "fastest", report="run.search")
        self.refused("run", "slope.yaml", "--wrong", report="wrong")
        self.refused("verify", "nothing", report="nothing")
        self.refused("verify", "slope.yaml", report="expect")
        self.refused("export", "nothing.h5", report="nothing.h5")
        self.refused("frobnicate", report="frobnicate|required")

    def test_a_result_that_cannot_be_written(self):
        self.write("slope.yaml", INCLINE)
        self.refused("run", "slope.yaml", "-o", "no/such/folder/out.h5", report=r"no/such/folder/out\.h5: cannot be written")
        (self.folder / "folder.h5").mkdir()
        self.assertEqual(self.talus("run", "slope.yaml", "-o", "folder.h5/", code=2)[0].count("frames in"), 0)
        if os.geteuid() != 0:  # nothing is forbidden to root
            (self.folder / "locked").mkdir()
            (self.folder / "locked").chmod(stat.S_IRUSR | stat.S_IXUSR)
            self.talus("run", "slope.yaml", "-o", "locked/out.h5", code=2)

    def test_a_result_of_another_version(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")
        for name, version, commands in (("slope.h5", 1, ("info", "export")), ("slope.restart.h5", 7, ("resume",))):
            with self.subTest(name):
                path = self.folder / name
                good = path.read_bytes()
                at = good.index(b"schema_version\0")
                value = good.rindex(version.to_bytes(8, "little"), at, at + 72)  # the last such number of the attribute
                path.write_bytes(good[:value] + (99).to_bytes(8, "little") + good[value + 8:])
                for command in commands:
                    self.refused(command, "slope.h5", report=rf"{re.escape(name)}: .*version 99")
                path.write_bytes(good)
        self.talus("info", "slope.h5")

    def test_a_place_that_is_none(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")
        self.refused("query", "slope.h5", report="--at, --in or --along")
        for place in ("7", "7,x", "7,4,", "7 4", "7,4,5", "nan,4", "1e999,4", ""):
            self.refused("query", "slope.h5", "--at", place, report=rf"--at: needs 2 numbers .*not `{re.escape(place)}`")
        self.refused("query", "slope.h5", "--in", "1,2,3", report="--in: needs 4 numbers")
        self.refused("query", "slope.h5", "--along", "1,2", report="--along: needs 4 numbers")
        self.refused("query", "slope.h5", "--at", "7,4", "--frame", "99", report=r"slope\.h5: there is no frame 99, the last one is \d+")
        self.refused("query", "slope.h5", "--at", "7,4", "--frame", "-1", report=r"slope\.h5: there is no frame -1")

    def test_a_file_that_is_cut_off_or_none_of_ours(self):
        self.write("slope.yaml", INCLINE)
        self.talus("run", "slope.yaml")
        good = self.files()
        for name, commands in (("slope.h5", ("info", "export", "resume")), ("slope.restart.h5", ("resume",))):
            for size in (0, 100, len(good[name]) // 2, len(good[name]) - 1):
                with self.subTest(name, size=size):
                    (self.folder / name).write_bytes(good[name][:size])
                    for command in commands:
                        self.refused(command, "slope.h5", report=re.escape(name))
            (self.folder / name).write_bytes(good[name])
        self.refused("info", "slope.yaml", report="slope.yaml")
        self.refused("query", "slope.yaml", "--at", "1,1", report="slope.yaml")
        self.refused("resume", "other.h5", report=r"other\.")
        (self.folder / "slope.restart.h5").unlink()
        self.refused("resume", "slope.h5", report=r"^slope\.restart\.h5: is not there; .*run the scenario again")


if __name__ == "__main__":
    main()
