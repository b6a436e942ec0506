"""Ball and free joints of robot files with quaternions: beside MuJoCo and Pinocchio, and what is refused."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ball_trees import random_balls, random_position
from in_depth import seeds
from related import reduction

from substructures import Definition, Model, TreeSpec, couple, derive, evaluate
from substructures.errors import InvalidDocument
from substructures.interchange.equivalence import equivalence
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file
from substructures.interchange.sides import Side

sys.path.insert(0, str(Path(__file__).parent))
from engines import Numbers, Reduced, deviation, in_our_coordinates

Array = Any
QUANTITIES = ["metric", "gravity", "bias", "inverse_dynamics", "forward_dynamics"]
GRAVITY = (0.3, -0.4, -9.81)
QUATERNIONS = Options("none", rotations="quaternions")


def numbers(rng: np.random.Generator, n: int, digits: int = 2) -> str:
    """Of a file, all different from zero."""
    return " ".join(str(round(float(x), digits) or 0.5) for x in rng.uniform(-1, 1, n))


def random_file(rng: np.random.Generator, bodies: int, with_equality: bool) -> str:
    """A file of MJCF with free, ball, hinge and slide joints, perhaps with one that moves with another one."""
    texts = [""] * bodies
    parents = [-1, *(int(rng.integers(-1, i)) for i in range(1, bodies))]
    kinds = ["free" if p < 0 and rng.random() < 0.7 else str(rng.choice(["ball", "hinge", "slide"])) for p in parents]
    kinds = [kinds[0], "ball", "hinge", "slide", *kinds[4:]]
    single = [f"j{i}" for i, kind in enumerate(kinds) if kind in ("hinge", "slide")]
    for i, kind in enumerate(kinds):
        where = "" if kind == "free" else f' pos="{numbers(rng, 3)}"'
        axis = f' axis="{numbers(rng, 3)}" ref="{numbers(rng, 1)}"' if kind in ("hinge", "slide") else ""
        axis += f' armature="1.{i}"' if kind != "free" else ""
        joint = f'<joint name="j{i}" type="{kind}"{where}{axis} damping="{round(float(rng.uniform(0, 2)), 2)}"/>'
        inertial = f'pos="{numbers(rng, 3)}" quat="{numbers(rng, 4)}" mass="{2 + i}" diaginertia="1.1 1.3 1.{i}"'
        texts[i] = f'<body pos="{numbers(rng, 3)}" quat="{numbers(rng, 4)}">{joint}<inertial {inertial}/>'
    for i in reversed(range(bodies)):
        texts[i] += "</body>"
        if parents[i] >= 0:
            texts[parents[i]] += texts[i]
    polynomial = f'polycoef="{numbers(rng, 2)} 0 0 0"'
    bound = f'<joint joint1="{single[-1]}" joint2="{single[0]}" {polynomial}/>' if with_equality else ""
    inside = "".join(text for text, parent in zip(texts, parents, strict=True) if parent < 0)
    return f'<mujoco><compiler angle="radian"/><worldbody>{inside}</worldbody><equality>{bound}</equality></mujoco>'


class MujocoTwin:
    """The file in MuJoCo at states of ours; the velocity of a free joint is there one in the axes of the world."""

    def __init__(self, text: str, names: dict[str, str], positions: list[str], rates: list[str]) -> None:
        mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the extra 'bench'")
        self.mujoco, self.model = mujoco, mujoco.MjModel.from_xml_string(text)
        self.model.opt.gravity[:] = GRAVITY
        self.joints = [self._place(j, names, positions, rates) for j in range(self.model.njnt)]

    def _place(self, j: int, names: dict[str, str], positions: list[str], rates: list[str]) -> Any:
        m, name = self.model, self.model.joint(j).name
        ours = names[f"joint {name}"].split(", ")
        own = names.get(f"velocities {name}", ", ".join(ours)).split(", ")
        there = int(m.jnt_qposadr[j]), int(m.jnt_dofadr[j])
        return j, there, [positions.index(x) for x in ours], [rates.index(x) for x in own]

    def numbers(self, q: Array, qd: Array, qdd: Array) -> Numbers:
        """At a state of ours."""
        m, data = self.model, self.mujoco.MjData(self.model)
        T, dT = np.zeros((m.nv, m.nv)), np.zeros((m.nv, m.nv))
        for j, (p, v), ours, own in self.joints:
            data.qpos[p : p + len(ours)] = q[ours]
            T[range(v, v + len(own)), own] = 1
            if len(ours) == 7:
                R0, R = self._rotation(m.body_quat[m.jnt_bodyid[j]]), self._rotation(q[ours[3:]])
                data.qpos[p : p + 3] = m.body_pos[m.jnt_bodyid[j]] + R0 @ q[ours[:3]]
                self.mujoco.mju_mulQuat(data.qpos[p + 3 : p + 7], m.body_quat[m.jnt_bodyid[j]], q[ours[3:]])
                x, y, z = qd[own[3:]]
                T[v : v + 3, own[:3]] = R0 @ R
                dT[v : v + 3, own[:3]] = R0 @ R @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        data.qvel[:] = T @ qd
        self.mujoco.mj_forward(m, data)
        M = np.zeros((m.nv, m.nv))
        self.mujoco.mj_fullM(m, data, M)
        both, passive = data.qfrc_bias.copy(), data.qfrc_passive.copy()
        data.qvel[:] = 0
        self.mujoco.mj_forward(m, data)
        gravity = -data.qfrc_bias
        return in_our_coordinates(T, dT, qd, M, gravity, both + gravity, passive, qdd)

    def _rotation(self, quaternion: Array) -> Array:
        R = np.zeros(9)
        self.mujoco.mju_quat2Mat(R, np.ascontiguousarray(quaternion))
        return R.reshape(3, 3)


def at_world(definition: Any) -> Model:
    """The tree of a part alone."""
    spec = TreeSpec.read({"name": "t", "gravity": list(GRAVITY), "instances": [{"name": "x", "substructure": "p"}]})
    return couple(spec, {"x": derive(Definition.read(definition))})


def order_of(definition: Any) -> tuple[list[str], list[str]]:
    """The names of all positions and rates, those of joints that follow others as well."""
    joints = [body["joint"] for body in definition["bodies"]]
    several = [x if isinstance(x, list) else [x] for joint in joints for x in [joint.get("coordinate", [])]]
    rates = [joint.get("velocities", names) for joint, names in zip(joints, several, strict=True)]
    return [x for names in several for x in names], [x for names in rates for x in names]


def worst_beside_mujoco(seed: int, with_equality: bool) -> tuple[float, dict[str, Any]]:
    """The largest relative deviation of a random file at random states."""
    rng = np.random.default_rng(seed)
    text = random_file(rng, int(rng.integers(4, 7)), with_equality)
    found = import_file(text.encode(), QUATERNIONS)
    model = at_world(found.definition)
    positions, rates = order_of(found.definition)
    twin: Any = MujocoTwin(text, found.names, positions, rates)
    left, left_rates = ([x.removeprefix("x.") for x in names] for names in (model.positions, model.coordinates))
    q = np.array([random_position(rng, model) for _ in range(2)])
    qd, qdd = rng.uniform(-1.2, 1.2, (2, 2, model.dof))
    answer = evaluate(model, QUANTITIES, q, qd, qdd)
    (N, q0), (own, _) = reduction(found.definition, positions, left), reduction(found.definition, rates, left_rates)
    reduced = Reduced(twin, own, q0, N)
    expected = [reduced.numbers(q[i], qd[i], qdd[i]) for i in range(2)]
    return max(deviation(answer, each, i) for i, each in enumerate(expected)), found.definition


@pytest.mark.parametrize("with_equality", [False, True])
@pytest.mark.parametrize("seed", seeds([1], 40))
def test_random_files_are_what_mujoco_makes_of_them(seed: int, with_equality: bool) -> None:
    error, definition = worst_beside_mujoco(seed, with_equality)
    assert "ball" in {body["joint"]["type"] for body in definition["bodies"]}
    assert ("relations" in definition) == with_equality
    assert error < 1e-10


URDF = """<robot name="r"><link name="ground"/>
<link name="a"><inertial><origin xyz=".1 .2 .3" rpy=".3 .2 .1"/><mass value="2"/>
<inertia ixx=".5" iyy=".6" izz=".7" ixy=".01" ixz=".02" iyz="0"/></inertial></link>
<joint name="f" type="floating"><parent link="ground"/><child link="a"/><origin xyz="1 2 3" rpy=".1 .2 .3"/></joint>
<link name="b"><inertial><origin xyz=".1 0 0"/><mass value="1"/>
<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="h" type="continuous"><parent link="a"/><child link="b"/><origin xyz="0 .2 0"/><axis xyz="0 1 1"/></joint>
</robot>"""


def test_a_floating_joint_of_urdf_is_the_free_flyer_of_pinocchio() -> None:
    pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
    model = at_world(import_file(URDF.encode(), QUATERNIONS).definition)
    engine = pin.buildModelFromXML(URDF)
    engine.gravity.linear = np.array(GRAVITY)
    data, q = engine.createData(), random_position(np.random.default_rng(2), model)
    qd = np.linspace(-1, 1, model.dof)
    # w, x, y, z here, x, y, z, w there, and continuous joints as cosine and sine
    there = np.array([*q[:3], *q[4:7], q[3], np.cos(q[7]), np.sin(q[7])])
    found = evaluate(model, ["metric", "bias", "gravity"], q, qd)
    np.testing.assert_allclose(found["metric"], _whole(pin.crba(engine, data, there)), atol=1e-12)
    ours = found["bias"] - found["gravity"]
    np.testing.assert_allclose(ours, pin.nonLinearEffects(engine, data, there, qd), atol=1e-12)


def _whole(upper: Array) -> Array:
    return np.triu(upper) + np.triu(upper, 1).T


SDF = """<sdf version="1.9"><model name="m"><link name="a"/><link name="b"><pose>0 0 1 0 0 0.5</pose></link>
<joint name="j" type="ball"><pose>0 0 -0.5 0 0 0</pose><parent>a</parent><child>b</child></joint></model></sdf>"""


def test_models_of_sdf_that_nothing_holds_float() -> None:
    """The ball turns about the origin of its joint; the root moves from where the file puts it."""
    definition = import_file(SDF.encode(), Options("none", base="floating", rotations="quaternions")).definition
    a, b = definition["bodies"]
    assert (a["joint"]["type"], b["joint"]["type"], b["parent"]) == ("floating", "ball", "a")
    assert [float(x) for x in b["joint"]["placement"]["position"]] == [0, 0, 0.5]
    model = at_world(definition)
    assert model.dof == 9
    # q: 12 positions, both bodies of the default inertia: M v = p, and the mass centre of b stays where it is
    q = np.array([1, 2, 3, 1, 0, 0, 0, 1, 0, 0, 0], dtype=float)
    M = evaluate(model, ["metric"], q)["metric"]
    np.testing.assert_allclose(M[:3, :3], 2 * np.eye(3), atol=1e-15)
    # about the ball: 1 + m l^2 across the line to the mass centre, 1 about it
    np.testing.assert_allclose(np.diag(M)[6:], [1.25, 1.25, 1], atol=1e-15)


BODY = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'
REFUSED = {
    "spring": (f'<body name="a"><joint type="ball" stiffness="3"/>{BODY}</body>', "", "no-angles"),
    "rotor": (f'<body name="a"><joint type="free" armature="3"/>{BODY}</body>', "", "no-angles"),
    "loop": (
        f'<body name="a"><freejoint/>{BODY}</body><body name="b"><joint/>{BODY}</body>',
        '<equality><connect body1="a" body2="b" anchor="0 0 0"/></equality>',
        "has-balls",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_quaternions_do_not_go_with_is_refused_with_place_and_way_out(name: str) -> None:
    inside, tail, code = REFUSED[name]
    text = f"<mujoco>\n<worldbody>{inside}</worldbody>{tail}</mujoco>".encode()
    with pytest.raises(InvalidDocument, match=r"line 2: <.*take rotations=angles") as caught:
        import_file(text, QUATERNIONS)
    assert caught.value.faults[0].code == code
    import_file(text)


def test_names_of_states_and_of_rates_are_told_of_cut_files_too() -> None:
    text = f'<mujoco><worldbody><body name="a"><freejoint name="f"/>{BODY}<body name="b"><joint name="j" type="ball"/>'
    cut = import_file(f"{text}{BODY}</body></body></worldbody></mujoco>".encode(), QUATERNIONS, cut=["b"])
    assert cut.tree is not None
    assert cut.names["joint j"] == "b.j_qw, b.j_qx, b.j_qy, b.j_qz"
    assert cut.names["velocities j"] == "b.j_wx, b.j_wy, b.j_wz"
    assert cut.names["velocities f"].startswith("robot.f_vx, ")
    parts = {each["name"]: derive(Definition.read(each["definition"])) for each in cut.tree["instances"]}
    model = couple(TreeSpec.read(cut.tree), parts)
    assert model.coordinates[-3:] == ("b.j_wx", "b.j_wy", "b.j_wz")


@pytest.mark.parametrize("seed", seeds([5], 20))
def test_equivalence_is_told_of_quaternions_too(seed: int) -> None:
    """Bodies in another order are the same; a damping that is another is named, and what turns otherwise."""
    definition, _ = random_balls(seed, depth=3)
    turned = definition | {"bodies": definition["bodies"][::-1]}
    sides = [Side.of_part(derive(Definition.read(each))) for each in (definition, turned)]
    found = equivalence(*sides)
    assert (found.equal, found.level) == (True, "formulas"), found
    body = next(b for b in definition["bodies"] if "velocities" in b["joint"])

    def with_other(**changes: Any) -> Side:
        other = {**body, **changes}
        bodies = [other if each is body else each for each in definition["bodies"]]
        return Side.of_part(derive(Definition.read({**definition, "bodies": bodies})))

    damped = equivalence(sides[0], with_other(joint={**body["joint"], "damping": 7}))
    assert {(c.body, c.parameter) for c in damped.culprits} == {(x, "damping") for x in body["joint"]["velocities"]}
    chain = {"ball": "spherical", "floating": "free"}[body["joint"]["type"]]
    joint = {**body["joint"], "type": chain, "coordinate": body["joint"]["velocities"]}
    joint.pop("velocities")
    angles = equivalence(sides[0], with_other(joint=joint))
    assert not angles.equal
    assert angles.first_difference is not None
    assert angles.first_difference["quantity"] == "balls"


def test_a_body_of_another_mass_is_named_behind_a_ball() -> None:
    text = random_file(np.random.default_rng(3), 4, with_equality=False)
    one, other = (
        import_file(each.encode(), QUATERNIONS).definition for each in (text, text.replace('mass="5"', 'mass="6"'))
    )
    same = [Side.of_part(derive(Definition.read(each))) for each in (one, one, other)]
    assert equivalence(*same[:2]).equal
    found = equivalence(*same[1:])
    assert {c.body for c in found.culprits} == {"body4"}
    assert "mass" in {c.parameter for c in found.culprits}
