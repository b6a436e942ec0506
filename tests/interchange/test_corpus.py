"""Robots that nobody here wrote: imported, and equal to what another engine makes of the same file."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
sys.path.insert(0, str(Path(__file__).parent))
from corpus import compared_file, mjcf_files, urdf_files

TOLERANCE = 1e-10
MESH = "the mass of a mesh needs its file"
#: what is refused, and why
REFUSED = {
    "ur_description/urdf/ur3.urdf": "the robot has no <link>",
    "mjcf/test_assets/test_model.xml": "'diaginertia' or 'fullinertia' is needed",
    "brax/test_data/world_body_transform.xml": "only a body of the world may have a free joint",
    "build_fruitfly/assets/drosophila.xml": MESH,
    "build_fruitfly/assets/drosophila_fused.xml": MESH,
    "assets/build_fruitfly/fruitfly.xml": MESH,
    "assets/fruitfly_v2/fruitfly.xml": MESH,
    "assets/dog_v2/dog.xml": MESH,
    "assets/dog_v2/scene.xml": MESH,
    "dm_control/suite/dog.xml": MESH,
    "third_party/kinova/jaco_arm.xml": MESH,
    "third_party/kinova/jaco_hand.xml": MESH,
    "brax/test_data/colour_objects.xml": MESH,
    "brax/test_data/convex_convex.xml": MESH,
}
SAMPLE = (
    "ur_description/urdf/ur5_robot.urdf",
    "panda_description/urdf/panda.urdf",
    "kinova_description/robots/kinova.urdf",
    "talos_data/robots/talos_left_arm.urdf",
    "quadruped_description/urdf/quadruped.urdf",
    "iris_description/robots/iris.urdf",
    "dm_control/suite/cheetah.xml",
    "dm_control/suite/quadruped.xml",
    "dm_control/suite/fish.xml",
    "third_party/ant/ant.xml",
    "envs/assets/humanoid.xml",
    "brax/test_data/nonzero_joint_ref.xml",
    "testing/assets/model_with_ball_joints.xml",
)
FILES = [*urdf_files(), *mjcf_files()]
PACKAGES = "pip install --no-deps example-robot-data dm_control brax"


@pytest.mark.filterwarnings("ignore:.*settotalmass")
@pytest.mark.parametrize("name", SAMPLE)
def test_files_are_what_another_engine_makes_of_them(name: str) -> None:
    if name not in FILES:
        pytest.skip(PACKAGES)
    row = compared_file(name)
    assert not row.refused
    assert row.error < TOLERANCE


@pytest.mark.deep
@pytest.mark.skipif(not FILES, reason=PACKAGES)
@pytest.mark.filterwarnings("ignore:.*settotalmass")
@pytest.mark.parametrize("name", FILES)
def test_all_files_are_what_another_engine_makes_of_them(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Prints a row of the table."""
    row = compared_file(name)
    with capsys.disabled():
        print(f"\r{row}")
    if name in REFUSED:
        assert REFUSED[name] in row.refused
    else:
        assert not row.refused
        assert row.error < TOLERANCE
