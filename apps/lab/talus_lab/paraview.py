"""Results for ParaView before 5.12 and for other readers of VTK's XML files: one .vtu for each frame, and a .pvd that says at what time.

Format: "VTK XML formats", The VTK User's Guide. The numbers follow the XML as they are in memory ("appended raw")."""

from __future__ import annotations

from pathlib import Path
from typing import Callable, Sequence
from xml.sax.saxutils import quoteattr

import numpy as np

from talus_lab.run import Run
from talus_lab.tables import cell_data

POLYGON = 7  # VTK's number for this kind of cell
TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "i8": "Int64", "u1": "UInt8"}


def write_pvd(run: Run, path: Path, frames: Sequence[int] | None = None,
              progress: Callable[[int, int], None] = lambda done, of: None) -> list[Path]:
    """Writes `path`, and the frames into a folder of the same name beside it. Returns the files, the .pvd first; it comes last, so that it
    names only frames that are whole. Blocks that a stage has deleted are left out of the frames after it."""
    frames = list(range(run.frame_count) if frames is None else frames)
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    files = [folder / f"{path.stem}_{frame:05d}.vtu" for frame in frames]
    for done, (frame, file) in enumerate(zip(frames, files)):
        progress(done, len(frames))
        _replace(file, _vtu(run, frame))
    progress(len(frames), len(frames))
    entries = "".join(f'  <DataSet timestep="{float(run.times[frame])!r}" part="0" file={quoteattr(f"{folder.name}/{file.name}")}/>\n'
                      for frame, file in zip(frames, files))
    _replace(path, f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1" byte_order="LittleEndian">\n<Collection>\n{entries}'
                   "</Collection>\n</VTKFile>\n".encode())
    return [path, *files]


def _vtu(run: Run, frame: int) -> bytes:
    present = ~run.removed(frame)[run.part_block]
    count = np.diff(run.first_corner)[present]
    points = run.corners(frame)[np.repeat(present, np.diff(run.first_corner))]
    appended: list[bytes] = []

    def array(name: str, values: np.ndarray) -> str:
        values = values.astype(values.dtype.newbyteorder("<"), copy=False)
        offset = sum(map(len, appended))
        appended.append(np.uint64(values.nbytes).astype("<u8").tobytes() + np.ascontiguousarray(values).tobytes())
        components = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
        return f'<DataArray type="{TYPES[values.dtype.str[1:]]}" Name={quoteattr(name)}{components} format="appended" offset="{offset}"/>\n'

    cells = "".join(array(name, values[present]) for name, values in cell_data(run, frame).items())
    where = array("Points", np.column_stack([points, np.zeros(len(points))]))
    shape = (array("connectivity", np.arange(len(points), dtype=np.int64)) + array("offsets", np.cumsum(count, dtype=np.int64))
             + array("types", np.full(len(count), POLYGON, np.uint8)))
    head = (f'<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
            f'<UnstructuredGrid>\n<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(count)}">\n<CellData>\n{cells}</CellData>\n'
            f'<Points>\n{where}</Points>\n<Cells>\n{shape}</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding="raw">\n_')
    return head.encode() + b"".join(appended) + b"\n</AppendedData>\n</VTKFile>\n"


def _replace(path: Path, content: bytes) -> None:
    """The whole file, or what was there before."""
    beside = path.with_name(f".{path.name}.part")
    try:
        beside.write_bytes(content)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
