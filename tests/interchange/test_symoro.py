"""SYMORO files with loops: the published SR400 with its closed solution, in Pinocchio, and what is refused or told."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from independent import value
from made_once import derived_once

from substructures import Model, couple, evaluate
from substructures.analysis.closed.loops import loop_state
from substructures.errors import InvalidDocument
from substructures.interchange.importing import import_file

Array = Any
#: geometry of SR400.par of SYMORO+ (OpenSYMORO): a parallelogram of links 2, 3, 7 and 8; dynamic parameters are made up
SR400 = """(* Robotname = 'SR400' *)
NL = 8
NJ = 9
NF = 10
Type = 2 (* Closed *)
ant = {0,1,2,3,4,5,1,7,8,3}
Sigma = {0,0,0,0,0,0,0,0,0,2}
B = {0,0,0,0,0,
     0,0,0,0,0}
d = {0,4,8,-2,0,0,4,10,8,-10}
R = {0,0,0,10,0,0,0,0,0,0}
gamma = {0,0,0,0,0,0,0,0,0,1.57079632679490}
Alpha = {0,-Pi/2,0,-Pi/2,Pi/2,-Pi/2,-Pi/2,0,0,0}
Mu = {1,1,0,1,1,1,1,0,0,0}
Theta = {th1,th2,th3,th4,th5,th6,th7,th8,th9,0}
XX = {1,2,3,3,1,1,2,2}
XY = {0,0.1,-1.8,0,0,0,0.1,0}
YY = {1,19,14,1,1,1,15,10}
YZ = {0,0,0.2,0,0,0.3,0,0.1}
ZZ = {1.5,20,16,3,1,1,16,11}
MX = {0,8,6,0,0,0,5,4}
MY = {0,0,1,2,0,0,0,0}
M = {9,4,3,2,1,1,2,2}
"""
GRAVITY = [0.3, -1.0, -9.81]
NAMES = [f"th{k}" for k in range(1, 9)]


def model_of(text: str) -> Model:
    part = derived_once(import_file(text.encode()).definition)
    return couple({"name": "t", "gravity": GRAVITY, "instances": [{"name": "x", "substructure": "y"}]}, {"x": part})


def parallelogram(free: Array) -> Array:
    """All coordinates by th1, th2, th4, th5, th6, th7 (W. Khalil and E. Dombre, 2002, chapter 7)."""
    th1, th2, th4, th5, th6, th7 = free
    return np.array([th1, th2, np.pi / 2 - th2 + th7, th4, th5, th6, th7, th2 - th7])


#: its Jacobian
N = np.zeros((8, 6))
N[[0, 1, 3, 4, 5, 6], range(6)] = 1
N[2, [1, 5]], N[7, [1, 5]] = (-1, 1), (1, -1)


def test_the_loop_closes_as_published() -> None:
    model, rng = model_of(SR400), np.random.default_rng(1)
    assert model.coordinates == tuple(f"x.{name}" for name in NAMES)
    assert [(rows.name, rows.type) for rows in model.closures] == [("x.joint9", "pin")]
    for _ in range(3):
        found = evaluate(model, ["closure.residual", "closure.jacobian"], q=parallelogram(rng.uniform(-3, 3, 6)))
        assert np.abs(found["closure.residual"]).max() < 1e-12
        assert np.abs(found["closure.jacobian"] @ N).max() < 1e-12
    state = loop_state(model, parallelogram(np.array([0.1, -0.8, 0.4, 0.3, 0.2, 0.3])))
    assert (state.mobility.degrees_of_freedom, state.mobility.counted) == (6, 3)


@pytest.mark.parametrize("wrong", [("0,1.57079632679490", "0,1.5"), ("8,-10", "8,-9"), ("7,8,3}", "7,7,3}")])
def test_a_wrong_frame_of_the_cut_joint_is_seen(wrong: tuple[str, str]) -> None:
    q = parallelogram(np.array([0.1, -0.8, 0.4, 0.3, 0.2, 0.3]))
    found = evaluate(model_of(SR400.replace(*wrong)), ["closure.residual"], q=q)
    assert np.abs(found["closure.residual"]).max() > 0.1


def placed(gamma: float, b: float, alpha: float, d: float, theta: float = 0, r: float = 0) -> pin.SE3:
    """Rz(gamma) Tz(b) Rx(alpha) Tx(d) Rz(theta) Tz(r)."""
    X, Z = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
    steps = [(gamma, Z, b * Z), (alpha, X, d * X), (theta, Z, r * Z)]
    found = pin.SE3.Identity()
    for angle, axis, shift in steps:
        found = found * pin.SE3(pin.AngleAxis(angle, axis).toRotationMatrix(), shift)
    return found


def numbers(text: str) -> dict[str, list[str]]:
    """The lists of the file, read apart."""
    found = {}
    for line in text.replace(",\n", ",").replace("Pi", "pi").splitlines():
        name, _, given = line.partition(" = ")
        found[name.lower()] = [x.strip() for x in given.strip("{}").split(",")]
    return found


def in_pinocchio(text: str) -> tuple[pin.Model, list[tuple[int, pin.SE3]]]:
    """The tree, and both frames of the joint that is cut by their joints."""
    rows = numbers(text)
    model = pin.Model()
    model.gravity.linear = np.array(GRAVITY)
    ends = []
    for k in range(10):
        geometry = [value(rows[name][k]) for name in ("gamma", "b", "alpha", "d")]
        parent, r = int(rows["ant"][k]), float(rows["r"][k])
        if k >= 8:
            ends.append((parent, placed(*geometry, 0, r)))
            continue
        # what is along the axis stands before the turn
        joint = model.addJoint(parent, pin.JointModelRZ(), placed(*geometry, 0, r), f"th{k + 1}")
        given = {name: float(rows.get(name, ["0"] * 8)[k]) for name in ("xx", "xy", "xz", "yy", "yz", "zz")}
        first = np.array([float(rows.get(name, ["0"] * 8)[k]) for name in ("mx", "my", "mz")])
        mass = float(rows["m"][k])
        c = first / mass
        tensor = np.array([[given["".join(sorted(i + j))] for j in "xyz"] for i in "xyz"])
        tensor -= mass * (c @ c * np.eye(3) - np.outer(c, c))
        model.appendBodyToJoint(joint, pin.Inertia(mass, c, tensor), pin.SE3.Identity())
    return model, ends


def closed_acceleration(text: str, q: Array, qd: Array) -> Array:
    """q'' by Pinocchio's M, h and J of d, which is zero between the ends: M q'' + h = J^T f, J q'' + J' q' = 0."""
    model, ends = in_pinocchio(text)
    data, order = model.createData(), pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    M = pin.crba(model, data, q)
    M = np.triu(M) + np.triu(M, 1).T
    h = pin.rnea(model, data, q, qd, np.zeros(8))
    frames = [model.addFrame(pin.Frame(f"end{k}", joint, 0, at, pin.OP_FRAME)) for k, (joint, at) in enumerate(ends)]
    data = model.createData()
    pin.forwardKinematics(model, data, q, qd, np.zeros(8))
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    one, other = (data.oMf[frame].translation for frame in frames)
    assert np.abs(one - other).max() < 1e-12
    J = np.subtract(*(pin.getFrameJacobian(model, data, frame, order)[:3] for frame in frames))
    rate = np.subtract(*(pin.getFrameClassicalAcceleration(model, data, frame, order).linear for frame in frames))
    K = np.block([[M, -J.T], [J, np.zeros((3, 3))]])
    return np.linalg.lstsq(K, np.concatenate([-h, -rate]), rcond=1e-12)[0][:8]


def test_the_closed_robot_moves_as_in_pinocchio() -> None:
    model, rng = model_of(SR400), np.random.default_rng(2)
    for _ in range(3):
        q, qd = parallelogram(rng.uniform(-1, 1, 6)), N @ rng.uniform(-1, 1, 6)
        wanted = closed_acceleration(SR400, q, qd)
        found = evaluate(model, ["forward_dynamics"], q=q, qd=qd)["forward_dynamics"]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())


#: geometry of TwoLoops.par of SYMORO+: two parallelograms one on the other, with symbols
TWO = """NL = 8
NJ = 10
NF = 12
ant = {0,1,2,3,4,1,4,3,7,6,8,8}
sigma = {0,0,0,0,0,0,0,0,0,0,2,2}
b = {0,0,0,0,0,b,0,0,0,0,0,0}
d = {0,0,d3,d4,0,-d6,d7,0,d4,d3,d7,sqrt(b**2 + d6**2)}
r = {0,0,0,0,0,0,0,0,0,0,0,0}
gamma = {0,0,0,0,0,0,pi/2,0,0,0,pi/2,-atan2(b, d6) + pi}
alpha = {0,pi/2,0,0,pi/2,pi/2,0,0,0,0,0,0}
theta = {th1,th2,th3,th4,th5,th6,th7,th8,th9,th10,0,0}
M = {1,1,1,1,1,1,1,1}
G = {0,0,G3}
Z = {1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1}
"""


def test_symbols_of_two_loops_stay_parameters() -> None:
    """Links 8 and 4 keep their direction: th2 + th3 + th8 = 0 = th2 + th3 + th4, and links 6, 7 that of links 2, 3."""
    read = import_file(TWO.encode())
    ends = [(closure["from"], closure["to"]) for closure in read.definition["closures"]]
    assert ends == [("frame9", "frame11"), ("frame10", "frame12")]
    assert [r["message"] for r in read.report] == ['gravity is that of a tree: give it "gravity": [0, 0, G3]']
    part = derived_once(read.definition)
    model = couple({"name": "t", "instances": [{"name": "x", "substructure": "y"}]}, {"x": part})
    values = {f"x.{name}": x for name, x in {"b": 0.3, "d3": 1, "d4": 0.8, "d6": 0.4, "d7": 0.25}.items()}
    for th2, th3 in ((0.7, 0.4), (-0.4, 1.3)):
        q = [0.2, th2, th3, -th2 - th3, 0.1, th2, th2 + th3 + np.pi / 2, -th2 - th3]
        mobility = loop_state(model, q, parameters=values).mobility
        assert (mobility.degrees_of_freedom, mobility.counted) == (4, -2)
        found = evaluate(model, ["closure.residual"], q=q, parameters=values)
        assert np.abs(found["closure.residual"]).max() < 1e-15


def test_a_robot_that_is_cut_has_its_closures_in_the_tree() -> None:
    read = import_file(SR400.encode(), cut=["link7"])
    assert read.tree is not None
    assert [(c["from"], c["to"]) for c in read.tree["closures"]] == [("link7.frame9", "robot.frame10")]
    parts = {each["name"]: derived_once(each["definition"]) for each in read.tree["instances"]}
    instances = [each | {"substructure": each["name"]} for each in read.tree["instances"]]
    for each in instances:
        del each["definition"]
    model = couple(read.tree | {"gravity": GRAVITY, "instances": instances}, parts)
    q = dict(zip(NAMES, parallelogram(np.array([0.1, -0.8, 0.4, 0.3, 0.2, 0.3])), strict=True))
    found = evaluate(model, ["closure.residual"], q=[q[name.rpartition(".")[2]] for name in model.coordinates])
    assert np.abs(found["closure.residual"]).max() < 1e-12


BAD = {
    "frames": (SR400.replace("NF = 10", "NF = 9"), "line 4: NF: 9 frames, 9 joints, 8 links: NF = 2 NJ - NL"),
    "moving": (SR400.replace("0,0,2}", "0,0,0}"), r"line 7: sigma\[10\]: frame 10 is fixed in the link at the other"),
    "one link": (SR400.replace("8,3}", "8,8}"), r"line 6: ant\[10\]: joint 9 is fixed in link8 at both sides"),
    "no link": (SR400.replace("8,3}", "8,9}"), r"line 6: ant\[10\]: '9' is no number of a link before link 9"),
    "twice": (SR400.replace("th9,0", "th8,0"), r"line 15: theta\[9\]: 'th8' moves theta\[8\] already"),
    "both": (SR400.replace("{0,4,8,", "{0,4,th9,"), r"line 15: theta\[9\]: 'th9' stands for a coordinate, and where"),
    "open": (SR400.replace("th9,0}", "th9,0"), "line 15: theta: the list 'theta' has no '}' at its end"),
    "mobile": (SR400 + "is_mobile = 1\n", "line 24: is_mobile: the lists of a base that moves begin with the base"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_loops_are_refused_with_their_place(name: str) -> None:
    text, message = BAD[name]
    with pytest.raises(InvalidDocument, match=message):
        import_file(text.encode())


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("W0 = {0,0,w}", "the base stands still here"),
        ("Z = {1,0,0,2,0,1,0,0,0,0,1,0,0,0,0,1}", "frame 0 is the interface here"),
        ("IA = {0,0,0,0,0,0,0,0,3}", "there is no link 9: the entry is left out"),
        ("stiff = {1}", "'stiff' is not known, and left out"),
    ],
)
def test_what_no_equation_has_is_told(more: str, message: str) -> None:
    read = import_file(f"{SR400}{more}\n".encode())
    assert message in read.definition["left_out"][0]["message"]
