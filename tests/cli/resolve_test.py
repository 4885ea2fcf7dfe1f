"""`talus resolve`: the name of each of many variants of a scenario, and what is wrong with those that are none."""

import json
import subprocess

from program import INCLINE, TALUS, Program, main


class Resolve(Program):
    def resolve(self, lines, code=0, scenario="slope.yaml"):
        done = subprocess.run([TALUS, "resolve", scenario], cwd=self.folder, text=True, capture_output=True,
                              input="".join(line + "\n" for line in lines))
        self.assertEqual(done.returncode, code, done.stderr)
        return [json.loads(line) for line in done.stdout.splitlines()], done.stderr

    def test_a_variant_has_the_hash_of_the_results_that_come_of_it(self):
        self.write("slope.yaml", INCLINE)
        variants = [[], ["joints.base.friction_angle_deg=25", "run.until.time=0.01"], ["gravity=[1, -9.5]"], ["title=\"a: \\\"b\\\" é\""]]
        answers, _ = self.resolve([json.dumps(changes, ensure_ascii=False) for changes in variants])
        for changes, answer in zip(variants, answers, strict=True):
            self.talus("run", "slope.yaml", "-o", "out.h5", "--force", *(word for change in changes for word in ("--set", change)))
            self.assertEqual(answer, {"hash": self.attribute("out.h5", "scenario_hash")})
        self.assertEqual(len({answer["hash"] for answer in answers}), len(variants))

    def test_what_changes_nothing_has_the_same_name(self):
        self.write("slope.yaml", INCLINE)
        answers, _ = self.resolve(["[]", '["joints.base.friction_angle_deg=20"]', '["joints.base.friction_angle_deg=2.0e1"]', "[]"])
        self.assertEqual(len({answer["hash"] for answer in answers}), 1)

    def test_faults_of_one_variant_leave_the_others_alone(self):
        self.write("slope.yaml", INCLINE)
        lines = ['["joints.base.friction_angel_deg=25", "run.untl=3"]', '["joints.base.friction_angle_deg=99"]', "nonsense", "[", "[]"]
        answers, _ = self.resolve(lines, code=2)
        self.assertEqual(len(answers[0]["faults"]), 2)
        self.assertRegex(answers[0]["faults"][0], r"^--set joints\.base\.friction_angel_deg: .*friction_angle_deg\?$")
        self.assertRegex(answers[0]["faults"][1], r"^--set run\.untl: .*until\?$")
        self.assertRegex(answers[1]["faults"][0], r"^--set joints\.base\.friction_angle_deg: .*0 to 90.*99")
        self.assertRegex(answers[2]["faults"][0], r"list of path=value in each line")
        self.assertRegex(answers[3]["faults"][0], r"not valid YAML")
        self.assertRegex(answers[4]["hash"], r"^[0-9a-f]{16}$")

    def test_faults_of_the_file_itself_have_their_line(self):
        self.write("slope.yaml", INCLINE.replace("density: 2500", "density: -1"))
        answers, _ = self.resolve(["[]", '["materials.rock.density=2600"]'], code=2)
        self.assertRegex(answers[0]["faults"][0], r"^slope\.yaml:3 materials\.rock\.density: ")
        self.assertIn("hash", answers[1])
        for name, text in (("none.yaml", None), ("broken.yaml", "a: [")):
            if text:
                self.write(name, text)
            answers, err = self.resolve(["[]"], code=2, scenario=name)
            self.assertEqual(answers, [])
            self.assertIn(name, err)


if __name__ == "__main__":
    main()
