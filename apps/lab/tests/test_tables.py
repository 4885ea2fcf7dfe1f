"""Results in the shapes of other packages, and for ParaView."""

import sys
import xml.etree.ElementTree as xml

import h5py
import numpy as np
import pytest

import talus_lab
from conftest import ORIGIN, SLIDE, tell
from talus_lab import fields
from talus_lab.cli import main


@pytest.fixture
def run(result):
    return talus_lab.open(tell(result))


def test_fields_are_of_the_blocks_of_a_frame_and_have_units(run):
    assert fields.values(run, "displacement", 1) == pytest.approx([0, SLIDE[1], 0])
    assert fields.values(run, "rotation") == pytest.approx([0, 0, 90]) and fields.field("rotation").unit == "deg"
    assert list(fields.values(run, "mechanism")) == [0, 1, 2]
    with pytest.raises(talus_lab.ResultError, match="did you mean stress_major"):
        fields.values(run, "stress_mayor")


def test_pandas_tables_have_names_for_kinds_and_units_for_columns(run):
    pytest.importorskip("pandas", reason="pandas is not installed")
    blocks = run.to_pandas("blocks")
    assert list(blocks["mechanism"]) == ["still", "slide", "topple"] and list(blocks["region"]) == ["", "face", "back"]
    assert blocks["x"][1] == pytest.approx(ORIGIN[0] + 0.4) and blocks.attrs["units"]["rotation"] == "deg"
    contacts = run.to_pandas("contacts")
    assert list(contacts["state"]) == ["sliding", "open"] and contacts.attrs["units"]["normal_force"] == "N"
    history = run.to_pandas("history", name="slide")
    assert history.index.name == "time" and list(history["x"]) == list(SLIDE) and history.attrs["units"]["x"] == "m"
    assert list(run.to_pandas("energies")["kinetic"]) == [0, 1, 2]
    blocks.loc[0, "x"] = 7  # a table belongs to whoever asked for it
    assert run.position(-1)[0, 0] != 7
    with pytest.raises(talus_lab.ResultError, match="did you mean contacts"):
        run.to_pandas("contact")


def test_xarray_has_frames_blocks_and_axes(run):
    pytest.importorskip("xarray", reason="xarray is not installed")
    data = run.to_xarray(["position", "speed"], frames=[0, 2])
    assert data["position"].shape == (2, 3, 2) and list(data["time"].values) == [0, 1]
    assert float(data["position"].sel(frame=2, block=1, axis="x")) == pytest.approx(ORIGIN[0] + 0.4)
    assert data["speed"].attrs["unit"] == "m/s" and data["time"].attrs["unit"] == "s"
    with pytest.raises(talus_lab.ResultError, match="did you mean position"):
        run.to_xarray(["positon"])


def test_pyvista_has_a_polygon_for_each_part(run):
    pytest.importorskip("pyvista", reason="pyvista is not installed")
    mesh = run.to_pyvista()
    assert mesh.n_cells == 4 and mesh.area == pytest.approx(10 + 1 + 2 + 1)
    assert list(mesh["block_id"]) == [0, 1, 2, 2] and mesh["displacement"][1] == pytest.approx([SLIDE[-1], 0, 0])


def test_a_package_that_is_not_there_is_named(run, monkeypatch):
    for name in ("pandas", "xarray", "pyvista"):
        monkeypatch.setitem(sys.modules, name, None)
    for ask in (lambda: run.to_pandas("blocks"), run.to_xarray, run.to_pyvista):
        with pytest.raises(talus_lab.ResultError, match="pip install"):
            ask()


def arrays(path):
    """name -> array, as the XML of a .vtu says where it lies."""
    head, _, data = path.read_bytes().partition(b'<AppendedData encoding="raw">\n_')
    tree = xml.fromstring(head + b"</VTKFile>")
    types = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "u1"}
    found = {}
    for element in tree.iter("DataArray"):
        begin = int(element.get("offset"))
        size = int(np.frombuffer(data[begin : begin + 8], "<u8")[0])
        values = np.frombuffer(data[begin + 8 : begin + 8 + size], types[element.get("type")])
        found[element.get("Name")] = values.reshape(-1, int(element.get("NumberOfComponents", 1))).squeeze()
    return found


def test_old_paraview_gets_every_frame_with_its_time(result, run):
    with h5py.File(result, "a") as file:
        file["talus/frames/removed"][2, 1] = 1
    assert main(["export", str(result), "--pvd"]) == 0
    sets = list(xml.parse(result.with_suffix(".pvd")).iter("DataSet"))
    assert [float(entry.get("timestep")) for entry in sets] == [0, 0.5, 1]
    middle, last = (arrays(result.parent / entry.get("file")) for entry in sets[1:])
    assert middle["Points"][:, :2] == pytest.approx(run.corners(1)) and list(middle["offsets"]) == [4, 8, 12, 16]
    assert list(middle["block_id"]) == [0, 1, 2, 2] and middle["velocity"][1] == pytest.approx([0.5, 0, 0])
    assert list(last["block_id"]) == [0, 2, 2] and len(last["Points"]) == 12  # the square was deleted
    assert not [path for path in result.parent.rglob("*.part")]


def test_vtk_reads_what_was_exported(result):
    vtk = pytest.importorskip("vtk", reason="the vtk package is not installed")
    assert main(["export", str(result), "--pvd", str(result.with_name("x.pvd")), "--every", "2"]) == 0
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(result.with_name("x") / "x_00002.vtu"))
    reader.Update()
    mesh = reader.GetOutput()
    assert mesh.GetNumberOfCells() == 4 and mesh.GetBounds()[:2] == pytest.approx((ORIGIN[0] - 5, ORIGIN[0] + 5))
    assert mesh.GetCellData().GetArray("rotation_deg").GetValue(3) == pytest.approx(90)


def test_results_that_are_cut_short_are_told(result, capsys):
    with h5py.File(result, "a") as file:
        del file["talus/frames/position"]
    assert main(["plot", str(result)]) == 2
    whole = result.read_bytes()
    result.write_bytes(whole[: len(whole) // 2])
    assert main(["plot", str(result)]) == 2 and main(["animate", str(result), "-o", "x.gif"]) == 2 and main(["export", str(result), "--pvd"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 4 and all("damaged" in line for line in lines)
