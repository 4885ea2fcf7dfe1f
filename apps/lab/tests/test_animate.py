import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

import talus_lab
from conftest import tell
from talus_lab import movie
from talus_lab.animate import Shown, _Stage, animate
from talus_lab.cli import main

SMALL = ["--dpi", "60"]


def test_every_frame_is_in_the_animation_and_things_move(result, capsys):
    assert main(["animate", str(result), "-o", str(result.with_suffix(".gif")), "--rate", "5", *SMALL]) == 0
    shown = capsys.readouterr()
    assert "frame 3 of 3" in shown.err and shown.out.strip().endswith("slide.gif")
    with Image.open(result.with_suffix(".gif")) as picture:
        assert picture.n_frames == 3 and picture.info["duration"] == 200 and picture.info["loop"] == 0
        first = np.asarray(picture.convert("RGB"), int)
        picture.seek(2)
        assert (np.abs(np.asarray(picture.convert("RGB"), int) - first).max(axis=2) > 60).sum() > 50
    assert sorted(path.name for path in result.parent.iterdir()) == ["slide.gif", "slide.h5"]


def test_a_frame_of_an_animation_is_the_picture_of_that_frame_alone(result):
    """Nothing of one frame stays in the next."""
    run = talus_lab.open(tell(result))
    for shown in (Shown(forces=True, joints=True, outline=True), Shown("mechanism", stress=True), Shown("joint_state", exaggerate=0.5)):
        used, new = (_Stage(run, shown, [0, 1, 2], 12, 60) for _ in range(2))
        used.draw(0), used.draw(1)
        assert (used.draw(2) == new.draw(2)).all()


def test_what_was_there_stays_when_the_writing_is_interrupted(result):
    gif = result.with_suffix(".gif")
    gif.write_bytes(b"earlier")

    def stop(done, of):
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        animate(talus_lab.open(result), gif, dpi=50, progress=stop)
    assert gif.read_bytes() == b"earlier" and len(list(result.parent.iterdir())) == 2


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_animation_that_is_ended_leaves_nothing(result, number):
    gif = result.with_suffix(".gif")
    code = "from pathlib import Path; from talus_lab.animate import animate; from talus_lab.run import open_run; " \
           f"animate(open_run({str(result)!r}), Path({str(gif)!r}), frames=[0, 1, 2] * 1000)"  # takes minutes
    process = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.DEVNULL)
    part, given_up = result.with_name(".slide.part.gif"), time.monotonic() + 30
    while not part.exists() and time.monotonic() < given_up:
        time.sleep(0.02)
    assert part.exists()
    process.send_signal(number)
    assert process.wait(20) != 0 and [path.name for path in result.parent.iterdir()] == ["slide.h5"]


@pytest.fixture
def ffmpeg(tmp_path, monkeypatch):
    """Stands in for ffmpeg: writes what it is given, or fails in the middle."""
    folder = tmp_path / "bin"
    folder.mkdir()

    def install(script):
        (folder / "ffmpeg").write_text(f"#!/bin/bash\n{script}\n")
        os.chmod(folder / "ffmpeg", 0o755)

    monkeypatch.setenv("PATH", str(folder), prepend=os.pathsep)
    return install


def test_an_mp4_is_what_ffmpeg_made_of_the_pixels(result, tmp_path, ffmpeg):
    ffmpeg('echo "$@" > "$(dirname "$0")/asked"; cat > "${@: -1}"')
    assert main(["animate", str(result), "--every", "2", *SMALL]) == 0
    asked = (tmp_path / "bin/asked").read_text().split()
    width, height = (int(side) for side in asked[asked.index("-s") + 1].split("x"))
    assert result.with_suffix(".mp4").stat().st_size == 2 * 3 * width * height


def test_a_failure_of_ffmpeg_is_reported_and_leaves_nothing(result, ffmpeg, capsys):
    ffmpeg('head -c 10 > /dev/null; echo "no such codec" >&2; exit 1')
    assert main(["animate", str(result), "-o", str(result.with_suffix(".mp4")), *SMALL]) == 2
    assert "ffmpeg failed: no such codec" in capsys.readouterr().err
    assert not list(result.parent.glob("*slide.*mp4"))


@pytest.mark.parametrize("options, complaint", [
    (["-o", "x.avi"], ".gif or .mp4"), (["-o", "nowhere/x.gif"], "there is no folder"), (["-o", "x.mp4"], "needs the program ffmpeg"),
    (["--color", "sped", "-o", "x.gif"], "did you mean speed"), (["--every", "0", "-o", "x.gif"], "1 or more"),
    (["--from", "1", "--to", "0", "-o", "x.gif"], "no frames to draw")])
def test_what_cannot_be_animated_is_told_before_anything_is_drawn(result, tmp_path, monkeypatch, capsys, options, complaint):
    monkeypatch.setattr(movie.shutil, "which", lambda name: None)
    monkeypatch.chdir(tmp_path)
    assert main(["animate", str(result), *options]) == 2
    assert complaint in capsys.readouterr().err and not list(tmp_path.glob("*x*"))
