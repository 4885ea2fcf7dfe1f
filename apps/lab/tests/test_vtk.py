"""A result written by talus opens in the reader that ParaView uses."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

import talus_lab

TALUS = Path(__file__).resolve().parents[3] / "build/release/bin/talus"
SCENARIO = """\
title: A box that falls
gravity: [0, -9.81]
materials: {granite: {density: 2600}}
joints: {rough: {normal_stiffness: 1e8, shear_stiffness: 1e8, friction_angle_deg: 30}}
contacts: {default: rough}
blocks:
  - {name: floor, outline: [[-5, -1], [5, -1], [5, 0], [-5, 0]], material: granite, held: true}
  - {name: box, outline: [[0, 0.01], [2, 0.01], [2, 1], [1, 1], [1, 2], [0, 2]], material: granite}
run: {until: {time: 0.2}, solver: explicit}
record: {frames: {every: 0.05}}
"""


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    if not TALUS.exists():
        pytest.skip("talus is not built")
    folder = tmp_path_factory.mktemp("box")
    (folder / "box.yaml").write_text(SCENARIO)
    done = subprocess.run([TALUS, "run", "box.yaml", "-o", "box.h5"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder / "box.h5"


@pytest.fixture
def reader(written):
    vtk = pytest.importorskip("vtk", reason="the vtk package is not installed")
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(written))
    reader.UpdateInformation()
    return reader


def test_vtk_sees_every_frame_and_the_same_corners(written, reader):
    from vtk.util.numpy_support import vtk_to_numpy

    run = talus_lab.open(written)
    assert run.frame_count == 5 and reader.GetNumberOfSteps() == 5
    assert run.displacement(1)[1][1] < -0.005  # free fall through the gap of 0.01 m takes 0.045 s, the frame is at 0.05 s
    for frame in range(run.frame_count):
        reader.SetStep(frame)
        reader.Update()
        mesh = reader.GetOutput()
        assert mesh.GetNumberOfPolys() == len(run.part_block) == 3
        points = vtk_to_numpy(mesh.GetPoints().GetData())[:, :2] + run.origin
        assert np.abs(points - run.corners(frame)).max() < 1e-5
        data = mesh.GetCellData()
        assert list(vtk_to_numpy(data.GetArray("block_id"))) == list(run.part_block)
        displacement = vtk_to_numpy(data.GetArray("displacement"))
        assert np.abs(displacement[:, :2] - run.displacement(frame)[run.part_block]).max() < 1e-6


def test_a_scenario_that_has_not_run_can_be_drawn(written):
    from talus_lab.cli import main

    scenario = written.with_name("box.yaml")
    assert main(["plot", str(scenario)]) == 0
    assert scenario.with_suffix(".png").stat().st_size > 5000
