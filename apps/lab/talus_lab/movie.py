"""Files that moving pictures are written to, frame by frame: GIF, and MP4 through ffmpeg. A file is there when it is whole, or not at all."""

from __future__ import annotations

import shutil
import signal
import subprocess
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import Callable, Iterator

import numpy as np
from PIL import GifImagePlugin, Image

from talus_lab.errors import ResultError

Write = Callable[[np.ndarray], None]  # takes the pixels of a frame, [height, width, 3]
COLORS = 128  # of a GIF, at most 256; at 64 the steps of the colour bar show, at 256 the file is a third larger


def check(path: Path) -> None:
    """Raises ResultError if a movie of this name cannot be written."""
    if path.suffix.lower() not in (".gif", ".mp4"):
        raise ResultError(f"{path}: animations are written as .gif or .mp4")
    if path.suffix.lower() == ".mp4" and not shutil.which("ffmpeg"):
        raise ResultError(f"{path}: .mp4 needs the program ffmpeg (Debian: apt install ffmpeg); .gif does not")
    if not path.absolute().parent.is_dir():
        raise ResultError(f"{path}: there is no folder {path.parent}")


def default_suffix() -> str:
    return ".mp4" if shutil.which("ffmpeg") else ".gif"


@contextmanager
def movie(path: Path, rate: float) -> Iterator[Write]:
    """rate: frames per second. What was there before stays until all is written, also if the writing is interrupted."""
    beside = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        with _interrupts() as check_interrupt, (_gif if path.suffix.lower() == ".gif" else _mp4)(beside, rate) as write:

            def write_on(pixels: np.ndarray) -> None:
                check_interrupt()
                write(pixels)

            yield write_on
            check_interrupt()
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def _interrupts() -> Iterator[Callable[[], None]]:
    """Ctrl-C and a polite kill end the work between two frames. Raised at any moment, the interrupt may come while matplotlib cleans up
    after itself, where Python drops it."""
    asked: list[int] = []

    def check_interrupt() -> None:
        if asked:
            raise KeyboardInterrupt

    handled = (signal.SIGINT, signal.SIGTERM) if threading.current_thread() is threading.main_thread() else ()  # others cannot
    before = [signal.signal(number, lambda number, frame: asked.append(number)) for number in handled]
    try:
        yield check_interrupt
    finally:
        for number, handler in zip(handled, before):
            signal.signal(number, handler)


@contextmanager
def _gif(path: Path, rate: float) -> Iterator[Write]:
    """Frame by frame: Pillow's own way to save keeps all of them in memory."""
    with path.open("wb") as file:

        def write(pixels: np.ndarray) -> None:
            image = Image.fromarray(pixels).quantize(COLORS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
            if not file.tell():
                file.write(b"".join(GifImagePlugin.getheader(image, info={"loop": 0, "duration": 1000 / rate})[0]))
            file.write(b"".join(GifImagePlugin.getdata(image, duration=max(round(1000 / rate), 20), include_color_table=True)))

        yield write
        file.write(b";")


@contextmanager
def _mp4(path: Path, rate: float) -> Iterator[Write]:
    process: subprocess.Popen | None = None

    def write(pixels: np.ndarray) -> None:
        nonlocal process
        if process is None:
            height, width = pixels.shape[:2]
            command = ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}",
                       "-r", f"{rate:g}", "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",  # H.264 wants even sizes
                       "-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart", str(path)]
            process = subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)  # Ctrl-C is ours
        try:
            process.stdin.write(pixels.tobytes())
        except BrokenPipeError:
            raise _failed(path, process) from None

    try:
        yield write
    except BaseException:
        if process:
            process.kill()
            process.wait()
        raise
    if process:
        process.stdin.close()
        if process.wait() != 0:
            raise _failed(path, process)


def _failed(path: Path, process: subprocess.Popen) -> ResultError:
    lines = process.stderr.read().decode(errors="replace").strip().splitlines() or ["no reason given"]
    return ResultError(f"{path}: ffmpeg failed: {lines[-1]}")
