"""The stability suite: scenarios that say what they expect where methods of this kind fail, and the table of them on its page.

>>> config = read_config(path); rows = verify(config, talus) + tests(config, talus)
>>> text = fill_page(page, config, rows)
"""

from __future__ import annotations

import csv
import math
import re
import subprocess
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import Callable, Iterable, Mapping

import yaml

from talus_lab.errors import ResultError

KEYS = ("scenarios", "output", "page", "methods", "tests")
ANY = "auto"  # refused before a method was chosen: holds for each of them
TABLE = re.compile(r"(<!-- table modes -->\n).*?(<!-- end -->)", re.DOTALL)


@dataclass(frozen=True)
class Config:
    scenarios: Path
    output: Path
    page: Path
    methods: Mapping[str, str]  # as `talus verify` calls them: head of their column
    tests: tuple[Mapping, ...]  # mode, title, method, program, names


@dataclass(frozen=True)
class Check:
    """One expectation of one case, or one test."""

    mode: str  # F01, N02, ...
    title: str
    case: str
    method: str
    quantity: str
    measured: float
    asked: str  # expected, above, below; test
    bar: float
    allowed: float
    passed: bool
    trouble: str = ""

    @property
    def told(self) -> bool:
        return self.quantity.startswith(("fault `", "warning `"))

    @property
    def used(self) -> float:
        """Share of its bar that the number has used: 1 is the bar itself. -1: no share can be given (a bound of zero, equal bits)."""
        if self.asked == "expected" and self.allowed > 0 and not self.told:
            return abs(self.measured - self.bar) / self.allowed
        if (self.asked, self.bar > 0) in (("below", True), ("above", False)) and self.bar != 0:
            return max(0.0, self.measured / self.bar)
        return -1.0


def read_config(path: Path) -> Config:
    try:
        read = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, yaml.YAMLError) as error:
        raise ResultError(f"{path}: cannot be read: {error}") from error
    if not isinstance(read, dict) or sorted(read) != sorted(KEYS):
        raise ResultError(f"{path}: needs the keys {', '.join(KEYS)}, and no others")
    wanted = {"mode", "title", "method", "program", "names"}
    for test in read["tests"]:
        if not isinstance(test, dict) or set(test) != wanted:
            raise ResultError(f"{path}: each of tests needs {', '.join(sorted(wanted))}")
        if test["method"] not in read["methods"]:
            raise ResultError(f"{path}: tests of {test['mode']}: no method is called {test['method']}, there are {', '.join(read['methods'])}")
    folder = path.parent
    return Config(folder / read["scenarios"], folder / read["output"], folder / read["page"], read["methods"], tuple(read["tests"]))


def verify(config: Config, talus: str, say: Callable[[str], None] = print) -> list[Check]:
    """Runs the suite; what `talus verify` says of it goes to `say` as it comes, the numbers to stability.csv."""
    config.output.mkdir(parents=True, exist_ok=True)
    table = config.output / "stability.csv"
    with subprocess.Popen([talus, "verify", config.scenarios, "--csv", table, "--force"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as run:
        assert run.stdout
        last = ""
        for line in run.stdout:
            last = line.rstrip()
            if not line.startswith("    "):
                say(last)
    if run.returncode not in (0, 1):  # 1: some expectation is not met, which is for the table to say
        raise ResultError(f"talus verify {config.scenarios} failed: {last}")
    return read_table(table)


def read_table(path: Path) -> list[Check]:
    with path.open(encoding="utf-8", newline="") as file:
        return [Check(row["file"].split("_")[0].upper(), row["title"], row["case"], row["method"], row["quantity"], float(row["measured"]), row["asked"],
                      float(row["bar"]), float(row["allowed"]), row["passed"] == "1" and not row["trouble"], row["trouble"]) for row in csv.DictReader(file)]


def tests(config: Config, talus: str) -> list[Check]:
    """What no scenario can say of itself, from the tests of the engine; left out if they are not built."""
    checks = []
    for test in config.tests:
        program = Path(talus).with_name(test["program"])
        if not program.exists():
            continue
        for name in test["names"]:
            done = subprocess.run([program, name.replace(",", "\\,"), "-r", "xml"], capture_output=True, text=True)
            found = [result for result in ElementTree.fromstring(done.stdout).iter("OverallResults")]
            passes, failures = (sum(int(result.get(key, 0)) for result in found[:1]) for key in ("successes", "failures"))
            checks.append(Check(test["mode"], test["title"], name, test["method"], "checks", passes, "test", failures, 0.0, passes > 0 and failures == 0))
    return checks


def fill_page(text: str, config: Config, checks: Iterable[Check]) -> str:
    """The text with its table of failure modes as the checks have it. Raises ResultError if the markers are missing."""
    if len(TABLE.findall(text)) != 1:
        raise ResultError(f"{config.page}: a line <!-- table modes -->, and <!-- end --> below it, is missing")
    return TABLE.sub(lambda match: match[1] + markdown(config, checks) + match[2], text)


def markdown(config: Config, checks: Iterable[Check]) -> str:
    checks = list(checks)
    methods = [name for name in config.methods if any(check.method == name for check in checks)]
    unknown = {check.method for check in checks} - set(methods) - {ANY, ANY + " general"}
    if unknown:
        raise ResultError(f"there is no column for {', '.join(sorted(unknown))}; give it one under methods")
    lines = [["", "failure mode", *(config.methods[name] for name in methods)], ["---"] * (len(methods) + 2)]
    for mode in sorted({check.mode for check in checks}):
        rows = [check for check in checks if check.mode == mode]
        lines.append([mode, rows[0].title, *(cell([check for check in rows if check.method in (name, ANY)]) for name in methods)])
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def cell(checks: list[Check]) -> str:
    """Passed or failed, how many cases, and the number that came nearest to its bar."""
    if not checks:
        return "-"
    failed = [check for check in checks if not check.passed]
    if failed:
        worst = max(failed, key=lambda check: check.used if math.isfinite(check.used) else math.inf)
        return f"**failed**: {worst.case}: {comparison(worst)}" + (f" ({worst.trouble.split(':')[0]})" if worst.trouble else "")
    cases = {check.case for check in checks}
    guarded = {check.case for check in checks if check.told}
    count = f"{len(cases)} {'test' if checks[0].asked == 'test' else 'case'}{'' if len(cases) == 1 else 's'}"
    if guarded == cases:
        return f"guarded, {count}"
    count = f"ok, {count}" + (f" ({len(guarded)} guarded)" if guarded else "")
    if checks[0].asked == "test":
        return f"{count}: {sum(int(check.measured) for check in checks):,} checks"
    nearest = max(checks, key=lambda check: check.used)
    return f"{count}: {comparison(nearest) if nearest.used >= 0 else 'equal in every bit'}"


def comparison(check: Check) -> str:
    what = re.sub(r" at (joint )?\(.*?\)| of [^,]+", "", check.quantity)
    if check.told:
        return check.quantity
    if check.asked == "expected":
        return f"{what} off by {abs(check.measured - check.bar):.2g} of {check.allowed:.2g}"
    return f"{what} {check.measured:.4g} {'<' if check.asked == 'below' else '>'} {check.bar:.4g}"
