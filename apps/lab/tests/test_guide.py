"""The code of docs/python.md runs as it stands, and prints what the page says."""

import contextlib
import importlib.util
import io
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from talus_lab.diagrams import read_pictures
from talus_lab.program import find_talus
from talus_lab.run import ResultError

ROOT = Path(__file__).resolve().parents[3]
FENCED = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    try:
        talus = find_talus()
    except ResultError:
        pytest.skip("talus is not built")
    shutil.copy(ROOT / "scenarios/examples/first_slope.yaml", tmp_path)
    monkeypatch.chdir(tmp_path)
    subprocess.run([talus, "run", "first_slope.yaml"], check=True, capture_output=True)
    return tmp_path


def test_the_guide_runs_and_prints_what_it_says(folder):
    names, printed = {}, None
    for language, more, text in FENCED.findall((ROOT / "docs/python.md").read_text(encoding="utf-8")):
        if language == "yaml":
            (folder / more).write_text(text)
        elif language == "python":
            printed = None
            if more and not importlib.util.find_spec(more):
                continue
            with contextlib.redirect_stdout(io.StringIO()) as said:
                exec(compile(text, f"docs/python.md: {text.splitlines()[0]}", "exec"), names)
            printed = said.getvalue()
        elif language == "text" and printed is not None:
            assert printed == text
    assert {"python_outline.png", "energies.pdf", "map.png"} <= {path.name for path in folder.iterdir()}
    assert list(read_pictures(folder / "pictures.yaml")) == ["block_modes"]
