"""Robots that nobody here wrote: imported, and equal to what another engine makes of the same file."""

from __future__ import annotations

import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest

from substructures import Definition
from substructures.interchange.importing import import_file
from substructures.part.topology import topology

pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
sys.path.insert(0, str(Path(__file__).parent))
from corpus import all_files, compared_file
from package_files import included

TOLERANCE = 1e-10
#: of masses of meshes, whose corners the other engine keeps in single precision
SINGLE = 1e-6
MESHES = (
    "brax/test_data/convex_convex.xml",
    "assets/bases/omron_mobile_base.xml",
    "build_fruitfly/assets/drosophila_fused.xml",
    "assets/dog_v2/dog.xml",
    "dm_control/suite/dog.xml",
    *(f"assets/grippers/{kind}_{side}_hand.xml" for kind in ("fourier", "inspire") for side in ("left", "right")),
)
#: what is refused, and why
REFUSED = {
    "ur_description/urdf/ur3.urdf": "the robot has no <link>",
    "mjcf/test_assets/test_model.xml": "'diaginertia' or 'fullinertia' is needed",
    "brax/test_data/world_body_transform.xml": "only a body of the world may have a free joint",
    "assets/build_fruitfly/fruitfly.xml": "the mass of a mesh needs its file: 'thorax_body.msh' is not given",
    # what the engines refuse, too, or would read otherwise than it says
    "pybullet_data/bicycle/bike.urdf": "'xyz' is no finite number: '0.07,'",
    "pybullet_data/biped/biped2d_pybullet.urdf": "'lower' is no finite number: '-1.57.'",
    "pybullet_data/humanoid/humanoid.urdf": "not well-formed",
    "pybullet_data/husky/husky.urdf": "$(optenv HUSKY_IMU_RPY",
    "quadruped/microtaur/microtaur.urdf": "'rpy' needs 3 numbers",
    "pybullet_data/quadruped/spirit40newer.urdf": "a second <axis>",
    "pybullet_data/torus_deform.urdf": "the robot has no <link>",
    "pybullet_data/mjcf/hopper.xml": "coordinate='global' is no longer in MJCF",
    "pybullet_data/mjcf/walker2d.xml": "coordinate='global' is no longer in MJCF",
    "pybullet_data/mjcf/humanoid_fixed.xml": "type='fixed' is none of hinge, slide, ball, free",
}
#: what the other engine does not read
UNREAD = {
    "assets/dog_v2/scene.xml": "repeated name 'grid' in texture",
    "build_fruitfly/assets/drosophila.xml": "Error opening file 'assets/head_body.msh'",
    "pybullet_data/spherical_joint_limit.urdf": "does not contain a valid URDF model",
    "pybullet_data/mjcf/half_cheetah.xml": "required attribute missing: 'pos'",
    "pybullet_data/mjcf/humanoid_symmetric.xml": "material 'geom' not found",
    "pybullet_data/mjcf/swimmer.xml": "unrecognized attribute: 'collision'",
    "assets/bases/null_mobile_base.xml": "mass and inertia of moving bodies must be larger than mjMINVAL",
    "assets/bases/rethink_minimal_mount.xml": "material 'pedestal_mat' not found",
    "assets/grippers/robotiq_gripper_85.xml": "repeated name 'robotiq_arg2f_base_link' in mesh",
    "assets/grippers/xarm7_gripper.xml": "unrecognized attribute: 'group'",
}
SAMPLE = (
    "ur_description/urdf/ur5_robot.urdf",
    "panda_description/urdf/panda.urdf",
    "baxter_description/urdf/baxter.urdf",
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
FILES = all_files()
PACKAGES = "pip install --no-deps example-robot-data dm_control brax airo-models pybullet robosuite"


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
        assert UNREAD.get(name, "") in row.unread
        assert bool(row.unread) == (name in UNREAD)
        assert row.error < (SINGLE if name in MESHES else TOLERANCE)


@pytest.mark.parametrize(
    "name",
    [
        "panda_description/urdf/panda.urdf",
        "baxter_description/urdf/baxter.urdf",
        "tiago_pro_description/robots/tiago_pro.urdf",
        "romeo_description/urdf/romeo.urdf",
        "pr2_description/urdf/pr2.urdf",
        "talos_data/robots/talos_full_v2.urdf",
        "panda_description/urdf/hand.urdf",
        "pybullet_data/xarm/xarm6_with_gripper.urdf",
    ],
)
def test_robots_with_fingers_have_the_coordinates_that_they_have(name: str) -> None:
    """As many as their joints that move and follow no other."""
    if name not in FILES:
        pytest.skip(PACKAGES)
    path = FILES[name]
    layout = topology(Definition.read(import_file(path.read_bytes(), included=included(path)).definition))
    root = ElementTree.parse(path).getroot()  # noqa: S314 -- a file of an installed package
    moving = [x for x in root.findall("joint") if x.get("type") != "fixed"]
    assert len(layout.joints) == len(moving)
    assert len(layout.coordinates) == sum(joint.find("mimic") is None for joint in moving) < len(moving)


def test_the_robotiq_gripper_has_one_coordinate() -> None:
    """Six joints, of which five follow the one that is driven."""
    name = "robotiq_2f_85/urdf/robotiq_2f_85.urdf"
    if name not in FILES:
        pytest.skip(PACKAGES)
    layout = topology(Definition.read(import_file(FILES[name].read_bytes()).definition))
    assert (len(layout.joints), len(layout.coordinates)) == (6, 1)
