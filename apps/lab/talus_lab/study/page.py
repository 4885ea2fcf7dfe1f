"""The tables of a page: Markdown between a line `<!-- table NAME -->` and a line `<!-- end -->`, replaced by each run of a study."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, Callable, Iterable, Sequence

from talus_lab.errors import ResultError

BLOCK = re.compile(r"(<!-- table ([^ >]+) -->\n).*?(<!-- end -->)", re.DOTALL)
NOTHING = "not measured\n"


def fill(page: Path, text: str, names: Iterable[str], table: Callable[[str], str]) -> str:
    """The text with the table of every name. Raises ResultError for markers without a table, and tables without a marker."""
    names = list(names)
    marked = [match[2] for match in BLOCK.finditer(text)]
    faults = [f"no table is called {name}, there are {', '.join(names)}" for name in marked if name not in names]
    faults += [f"a line <!-- table {name} -->, and <!-- end --> below it, is missing" for name in names if name not in marked]
    if faults or text.count("<!-- table ") != len(marked):
        raise ResultError("\n".join(f"{page}: {fault}" for fault in faults or ["a table has no <!-- end -->"]))
    return BLOCK.sub(lambda match: match[1] + table(match[2]) + match[3], text)


def table_text(head: Sequence[str], body: Iterable[Sequence[str]], words: int) -> str:
    """Markdown: `words` columns of words, to the left, and then numbers, to the right."""
    lines = [head, ["---"] * words + ["---:"] * (len(head) - words), *body]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def number(x: Any, digits: int = 3) -> str:
    """`digits` significant digits, thousands apart."""
    if x is None:
        return "-"
    if x == 0:
        return "0"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(x))))
    return f"{round(x, digits - 1 - math.floor(math.log10(abs(x)))):,.{decimals}f}"
