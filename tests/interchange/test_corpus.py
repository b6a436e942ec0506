"""Robots that nobody here wrote: imported, and equal to what another engine makes of the same file."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
sys.path.insert(0, str(Path(__file__).parent))
from corpus import compared_urdf, urdf_files

TOLERANCE = 1e-10
#: what is refused, and why
REFUSED = {"ur_description/urdf/ur3.urdf": "the robot has no <link>"}
SAMPLE = (
    "ur_description/urdf/ur5_robot.urdf",
    "panda_description/urdf/panda.urdf",
    "kinova_description/robots/kinova.urdf",
    "talos_data/robots/talos_left_arm.urdf",
    "quadruped_description/urdf/quadruped.urdf",
    "iris_description/robots/iris.urdf",
)
without_package = pytest.mark.skipif(not urdf_files(), reason="pip install --no-deps example-robot-data")


def judge(name: str, refused: dict[str, str]) -> None:
    row = compared_urdf(name)
    if name in refused:
        assert refused[name] in row.refused
    else:
        assert not row.refused
        assert row.error < TOLERANCE


@without_package
@pytest.mark.parametrize("name", SAMPLE)
def test_urdf_files_are_what_pinocchio_makes_of_them(name: str) -> None:
    judge(name, {})


@pytest.mark.deep
@without_package
@pytest.mark.parametrize("name", urdf_files())
def test_all_urdf_files_are_what_pinocchio_makes_of_them(name: str) -> None:
    judge(name, REFUSED)
