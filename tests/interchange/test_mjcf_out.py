"""MJCF files that are written: in MuJoCo they have our metric, gravity, bias and joint laws; read again they are the
same.
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ball_trees import random_balls, random_position
from catalogue_entries import CHAINS, open_entry, shipped_part
from in_depth import seeds
from independent import value
from random_trees import GRAVITY, Kind, random_definition
from related import with_relations

from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.analysis.closed.loops import loop_state
from substructures.errors import InvalidArgument, MissingValue, TooLarge
from substructures.export.robots import file_of_part, file_of_tree
from substructures.export.robots.mjcf import MOST
from substructures.export.robots.urdf import rpy_of
from substructures.interchange.equivalence import equivalence
from substructures.interchange.files.wanted import Options
from substructures.interchange.importing import import_file
from substructures.interchange.sides import Side
from substructures.part.part import Part
from substructures.quantities.numbers.evaluation import evaluate

sys.path.insert(0, str(Path(__file__).parent))
from engines import in_our_coordinates
from test_urdf_out import numbers_of, two_arms

mujoco = pytest.importorskip("mujoco", reason="MuJoCo is in the test extra")
NAMES = ("metric", "gravity", "bias", "inverse_dynamics")
EXACT = 1e-11


def in_tree(part: Part) -> tuple[TreeSpec, dict[str, Part], Model]:
    """The part on the world, its instance is x, with all coordinates of its loops."""
    instance = {"name": "x", "substructure": part.name, "level": "full"}
    plain = {"name": "t", "gravity": list(GRAVITY), "instances": [instance]}
    spec = TreeSpec.read(plain)
    return spec, {"x": part}, couple(spec, {"x": part})


def mjcf_of(part: Part) -> bytes:
    return file_of_part("mjcf", part, "robot", f"{part.name}@1", part.definition.digest, numbers_of(part.parameters))


def of_tree(spec: TreeSpec, parts: dict[str, Part], parameters: Any) -> bytes:
    return file_of_tree("mjcf", spec, parts, "robot", "t@1", spec.digest, numbers_of(parameters))


class Twin:
    """A file in MuJoCo at a state of ours: v = T q', with T' where bodies float or turn as balls."""

    def __init__(self, text: bytes, model: Model) -> None:
        self.m, self.ours = mujoco.MjModel.from_xml_string(text.decode()), model
        self.data = mujoco.MjData(self.m)

    def numbers(self, q: np.ndarray, qd: np.ndarray, qdd: np.ndarray) -> Any:
        m, data = self.m, self.data
        T, dT = self._placed(q, qd)
        M, found = np.zeros((m.nv, m.nv)), []
        for v in (T @ qd, np.zeros(m.nv)):
            data.qvel[:] = v
            mujoco.mj_forward(m, data)
            found.append((data.qfrc_bias.copy(), data.qfrc_spring + data.qfrc_damper))
        mujoco.mj_fullM(m, data, M)
        (both, passive), (against, _) = found
        return in_our_coordinates(T, dT, qd, M, -against, both - against, passive, qdd)

    def _placed(self, q: np.ndarray, qd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        m, state = self.m, dict(zip(self.ours.positions, q.tolist(), strict=True))
        place = {name: a for a, name in enumerate(self.ours.coordinates)}
        T, dT = np.zeros((2, m.nv, len(qd)))
        self.data.qpos[:] = m.qpos0
        for j in range(m.njnt):
            name = m.joint(j).name
            if name in state:
                self.data.qpos[m.jnt_qposadr[j]], T[m.jnt_dofadr[j], place[name]] = state[name], 1
        for _ in range(m.neq):  # followers of followers
            for e in (e for e in range(m.neq) if m.eq_type[e] == mujoco.mjtEq.mjEQ_JOINT):
                one, of, (c0, c1) = m.eq_obj1id[e], m.eq_obj2id[e], m.eq_data[e][:2]
                self.data.qpos[m.jnt_qposadr[one]] = c0 + c1 * self.data.qpos[m.jnt_qposadr[of]]
                T[m.jnt_dofadr[one]] = c1 * T[m.jnt_dofadr[of]]
        for ball in self.ours.balls:
            self._ball(ball, state, {name: place[name] for name in ball["velocities"]}, (T, dT), qd)
        return T, dT

    def _ball(self, ball: Any, state: Any, place: Any, rates: Any, qd: np.ndarray) -> None:
        m, (T, dT), rows = self.m, rates, list(place.values())
        name = ball["positions"][-4].removeprefix("x.q_").removesuffix("_w")
        body = m.body(f"x.{name}")
        first, count = int(body.jntadr[0]), int(body.jntnum[0])
        at, v, there = m.jnt_qposadr[first], m.jnt_dofadr[first], [state[name] for name in ball["positions"]]
        R, R0 = matrix(there[-4:]), np.eye(3)
        if count == 1 and len(there) == 7:
            R0 = matrix(body.quat)
            turned = np.zeros(4)
            mujoco.mju_mulQuat(turned, body.quat, np.array(there[-4:]))
            there = [*(body.pos + R0 @ there[:3]), *turned]
        self.data.qpos[at : at + len(there)] = there
        omega = qd[rows[-3:]]
        if len(there) == 7:
            slides = np.ix_(range(v, v + 3), rows[:3])
            T[slides], dT[slides], v = R0 @ R, R0 @ R @ skew(omega), v + 3
        T[np.ix_(range(v, v + 3), rows[-3:])] = np.eye(3)


def skew(x: np.ndarray) -> np.ndarray:
    return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])


def matrix(wxyz: Any) -> np.ndarray:
    R = np.zeros(9)
    mujoco.mju_quat2Mat(R, np.array(wxyz, dtype=float))
    return R.reshape(3, 3)


def worst(text: bytes, model: Model, rng: np.random.Generator) -> float:
    """The largest deviation, of the metric relative to its largest element, of forces to that of inverse dynamics."""
    twin, found = Twin(text, model), 0.0
    for _ in range(2):
        q, (qd, qdd) = random_position(rng, model), rng.uniform(-1, 1, (2, model.dof))
        theirs = twin.numbers(q, qd, qdd)
        ours = evaluate(model, NAMES, q[None], qd[None], qdd[None])
        forces = np.abs(theirs.inverse_dynamics).max(initial=1e-6)
        for name in NAMES:
            expected = getattr(theirs, name)
            scale = np.abs(expected).max(initial=1e-6) if name == "metric" else forces
            found = max(found, float(np.abs(ours[name][0] - expected).max(initial=0) / scale))
    return found


@pytest.mark.parametrize("seed", seeds([1, 2], 60))
def test_random_mechanisms_with_balls_have_the_same_numbers_in_mujoco(seed: int) -> None:
    """Also bodies that float on others."""
    definition, rng = random_balls(seed)
    for body in definition["bodies"]:
        damping = body["joint"].get("damping", 0)
        if "velocities" in body["joint"] and isinstance(damping, list):
            # what differs by direction is left out, but of bodies that float on others sliding may differ from turning
            slides = damping[0] if body["parent"] == "base" else damping[2]
            body["joint"]["damping"] = [slides] * len(damping[:-3]) + [damping[0]] * 3
    spec, parts, model = in_tree(derive(Definition.read(definition)))
    assert worst(of_tree(spec, parts, model.parameters), model, rng) < EXACT


@pytest.mark.parametrize("seed", seeds([3, 4], 60))
def test_random_mechanisms_with_compound_joints_and_relations_have_the_same_numbers_in_mujoco(seed: int) -> None:
    rng = np.random.default_rng(seed)
    definition = with_relations(rng, random_definition(rng, Kind(loads=0, springs=0)), int(rng.integers(3)))
    spec, parts, model = in_tree(derive(Definition.read(definition)))
    assert worst(of_tree(spec, parts, model.parameters), model, rng) < EXACT


def test_a_tree_with_hosts_placements_and_bindings_has_the_same_numbers() -> None:
    spec, parts = two_arms()
    model = couple(spec, parts)
    assert worst(of_tree(spec, parts, model.parameters), model, np.random.default_rng(8)) < EXACT


def without_acting(name: str) -> Part:
    """A shipped part without what MJCF cannot say."""
    plain = open_entry(name)
    for body in plain["bodies"]:
        for law in ("friction", "limits_act"):
            body["joint"].pop(law, None)
    return derive(Definition.read({**plain, "loads": []}))


def comes_back(name: str) -> None:
    """With springs, dampers, armatures, limits; the numbers of some measured tensors are no ones of MuJoCo."""
    part = without_acting(name)
    text = mjcf_of(part)
    again = derive(Definition.read(import_file(text).definition))
    assert b"left out" not in text
    assert equivalence(Side.of_part(part), Side.of_part(again)).equal or b"MuJoCo takes no such mass" in text


@pytest.mark.parametrize("name", ["scara", "drive-train", "free-body", "kuka-iiwa-14"])
def test_read_again_they_are_the_same(name: str) -> None:
    comes_back(name)


@pytest.mark.deep
@pytest.mark.parametrize("name", CHAINS)
def test_all_shipped_parts_come_back(name: str) -> None:
    comes_back(name)


@pytest.mark.parametrize("name", ["puma560", "robotiq-2f85", "satellite"])
def test_shipped_parts_are_loaded(name: str) -> None:
    assert mujoco.MjModel.from_xml_string(mjcf_of(shipped_part(name)).decode()).njnt


@pytest.mark.deep
@pytest.mark.parametrize("name", catalogue.names())
def test_all_shipped_parts_are_loaded(name: str) -> None:
    part = shipped_part(name)
    assert mujoco.MjModel.from_xml_string(mjcf_of(part).decode()).nv >= part.dof


def test_lesser_moments_are_raised_and_told() -> None:
    """A plane part has a moment about the third axis alone, which is the one that remains."""
    body = {"name": "b", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "inertia": {"zz": "J"}}
    plain = {"name": "rotor", "parameters": {"J": {"value": 0.25}}, "bodies": [body]}
    part = derive(Definition.read(plain))
    text = mjcf_of(part).decode()
    assert 'mass="1e-12" diaginertia="0.249999999999 1e-12 0.25"' in text
    assert "MuJoCo takes no such mass and moments of 'b': 0 kg, 0 0 0.25 0 0 0 kg m^2; here 1e-12 kg" in text


def test_what_cannot_be_said_is_told() -> None:
    text = mjcf_of(shipped_part("delta-robot")).decode()
    assert text.index("left out, as MJCF cannot say it") < text.index("(rod)") < text.index("<compiler")
    joint = {"type": "ball", "damping": [1, 2, 3]}
    body = {"name": "world", "parent": "base", "joint": joint, "mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1}}
    part = derive(Definition.read({"name": "top", "bodies": [body]}))
    text = mjcf_of(part).decode()
    assert "<!-- the damping of the joint of 'world', which differs by direction -->" in text
    assert '<body name="world_">' in text
    assert '<joint name="world_ball" type="ball" />' in text


def rows(text: bytes, model: Model, q: np.ndarray) -> tuple[float, np.ndarray]:
    """The largest residual of the closures, and their Jacobian, in MuJoCo."""
    twin = Twin(text, model)
    twin.m.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    T, _ = twin._placed(q, np.zeros(model.dof))
    mujoco.mj_forward(twin.m, twin.data)
    one = mujoco.mjtEq.mjEQ_JOINT
    held = [
        i for i in range(twin.data.nefc) if twin.m.eq_type[twin.data.efc_id[i]] != one and twin.data.efc_type[i] == 0
    ]
    return np.abs(twin.data.efc_pos[held]).max(), twin.data.efc_J.reshape(-1, twin.m.nv)[held] @ T


def same_closures(text: bytes, model: Model, q: np.ndarray) -> None:
    """They are closed, and let the same motions free."""
    gap, theirs = rows(text, model, q)
    (ours,) = evaluate(model, ["closure.jacobian"], q[None])["closure.jacobian"]
    assert gap < 1e-9
    ranks = [np.linalg.matrix_rank(x, tol=1e-8) for x in (ours, theirs, np.vstack((ours, theirs)))]
    assert ranks[0] == ranks[1] == ranks[2] > 0


def start_of(name: str, model: Model) -> list[float]:
    """Near a closed position."""
    start = {f"x.{c}": value(x) for c, x in catalogue.load(name).get("start", {}).items()}
    return [start.get(c, 0.0) for c in model.coordinates]


@pytest.mark.parametrize("name", ["five-bar", "robotiq-2f85"])
def test_closures_of_shipped_parts_are_connects(name: str) -> None:
    spec, parts, model = in_tree(shipped_part(name))
    state = loop_state(model, start_of(name, model))
    text = of_tree(spec, parts, model.parameters)
    same_closures(text, model, state.consistent.q)
    found = import_file(text).tree
    assert [each["type"] for each in found["closures"]] == ["ball", "ball"] * (len(found["closures"]) // 2)


@pytest.mark.parametrize("kind", ["weld", "ball", "pin"])
def test_closures_of_trees_are_connects_and_welds(kind: str) -> None:
    """A chain of eight joints with its end at a place of the world where it may be."""
    rng = np.random.default_rng(5)
    laws = Kind(8, True, ("revolute", "revolute", "prismatic"), massive=True, laws=False, loads=0, springs=0)
    spec, parts, model = in_tree(derive(Definition.read(random_definition(rng, laws))))
    q = rng.uniform(-1, 1, model.dof)
    twin = Twin(of_tree(spec, parts, model.parameters), model)
    twin.numbers(q, 0 * q, 0 * q)
    end = twin.data.body("x.b8")
    place = {"position": end.xpos.tolist(), "rpy": rpy_of(end.xmat.reshape(3, 3)).tolist()}
    closure = {"name": "c", "type": kind, "from": "x.b8", "placement": place}
    closed = TreeSpec.read({**spec.model_dump(exclude_defaults=True, by_alias=True), "closures": [closure]})
    text = of_tree(closed, parts, model.parameters)
    same_closures(text, couple(closed, parts), q)
    again = import_file(text, Options("none")).tree
    assert {each["type"] for each in again["closures"]} == {"weld" if kind == "weld" else "ball"}
    read = couple(*tree_of(again))
    (ours,) = evaluate(read, ["closure.residual"], [list(q)])["closure.residual"]
    assert np.abs(ours).max() < 1e-9


def tree_of(plain: Any) -> tuple[TreeSpec, dict[str, Part]]:
    spec = TreeSpec.read(plain)
    return spec, {each.name: derive(each.definition) for each in spec.instances}


def test_a_parameter_without_a_number_is_named() -> None:
    plain = catalogue.load("simple-pendulum")
    (name, *_) = plain["parameters"]
    plain["parameters"][name] = {}
    with pytest.raises(MissingValue, match=name):
        mjcf_of(derive(Definition.read(plain)))


def test_bodies_in_too_many_others_are_refused() -> None:
    """MuJoCo still takes the most that are written."""
    bodies = [
        {"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": {"type": "fixed"}, "mass": 1}
        for k in range(MOST + 1)
    ]
    most = derive(Definition.read({"name": "stack", "bodies": bodies[:-1]}))
    assert mujoco.MjModel.from_xml_string(mjcf_of(most).decode()).nbody == MOST + 1
    with pytest.raises(TooLarge, match=f"b{MOST}"):
        mjcf_of(derive(Definition.read({"name": "stack", "bodies": bodies})))


def test_numbers_that_are_not_finite_are_refused() -> None:
    plain = {"name": "t", "gravity": [0, 0, "-g^2"], "parameters": {"g": {"value": "1e200"}}}
    spec = TreeSpec.read({**plain, "instances": [{"name": "x", "substructure": "scara"}]})
    parts = {"x": shipped_part("scara")}
    with pytest.raises(InvalidArgument, match="'gravity' of 't' is not finite"):
        of_tree(spec, parts, couple(spec, parts).parameters)
