"""Loads between frames of a tree: textbook systems, theorems, certificates, faults (notation.md, section 7)."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from damaged import damages, errors_of, found_in_tree
from random_trees import Plain

from substructures import Definition, InvalidDocument, Model, Part, TreeSpec, couple, derive
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.simulate import simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.certificate.compare import TOLERANCE
from substructures.errors import VerificationFailed
from substructures.pictures.tree import picture
from substructures.quantities.numbers.evaluation import evaluate

#: a cart on rails along the first axis of the world: rpy of its base turns the joint axis there
ALONG = {"position": [0, 0, 0], "rpy": [0, "pi/2", 0]}
CART: Plain = {
    "name": "cart",
    "parameters": {"m": {"value": 2, "unit": "kg"}},
    "bodies": [{"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x"}, "mass": "m"}],
}
#: a mass point on a rod of length l that hangs along -y and swings about the third axis
PENDULUM: Plain = {
    "name": "pendulum",
    "parameters": {"l": {"value": 0.8, "unit": "m"}, "m": {"value": 1.5, "unit": "kg"}},
    "bodies": [
        {"name": "rod", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": "m",
         "com": [0, "-l", 0]},
    ],
    "ports": [{"name": "bob", "body": "rod", "position": [0, "-l", 0]}],
}  # fmt: skip
#: two links whose axes are skew
ARM: Plain = {
    "name": "arm",
    "bodies": [
        {"name": "u", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1", "theta": 0.3}, "mass": 2,
         "com": [0.3, 0.1, 0], "inertia": {"xx": 0.2, "yy": 0.3, "zz": 0.4}},
        {"name": "v", "parent": "u", "joint": {"type": "revolute", "coordinate": "q2", "d": 0.6, "theta": 1.1},
         "mass": 1, "com": [0.2, 0, 0.1], "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2}},
    ],
    "ports": [{"name": "tip", "body": "v", "position": [0.5, 0.1, 0.2], "rotation": {"rpy": [0.2, -0.1, 0.4]}}],
}  # fmt: skip
PARTS: dict[str, Part] = {x["name"]: derive(Definition.read(x)) for x in (CART, PENDULUM, ARM)}


def tree(kind: str, *loads: Plain, apart: float = 1.0, **more: Any) -> tuple[TreeSpec, dict[str, Part]]:
    """Two instances a and b of a part beside each other."""
    rpy = ALONG["rpy"] if kind == "cart" else [0, 0, 0]
    instances = [
        {"name": name, "substructure": kind, "placement": {"position": [place, 0, 0], "rpy": rpy}}
        for name, place in (("a", 0), ("b", apart))
    ]
    spec = {"name": "t", "gravity": [0, "-9.81", 0], "instances": instances, "loads": list(loads), **more}
    return TreeSpec.read(spec), {"a": PARTS[kind], "b": PARTS[kind]}


def model_of(kind: str, *loads: Plain, **more: Any) -> Model:
    return couple(*tree(kind, *loads, **more))


def load(kind: str, **fields: Any) -> Plain:
    return {"name": fields.pop("name", kind), "type": kind} | {k.rstrip("_"): x for k, x in fields.items()}


def test_two_carts_and_a_spring() -> None:
    """m x'' = k (y - x) ...: frequency sqrt(2 k/m) of one against the other, and their momentum is constant."""
    model = model_of("cart", load("spring", from_="a.b", to="b.b", stiffness=50, length=1))
    found = linearise(model, q=[0, 0])
    assert np.allclose(found.K, 50 * np.array([[1, -1], [-1, 1]]))
    assert {i.name for i in first_integrals(model).integrals} >= {"energy", "linear_momentum.x"}
    motion = simulate(model, q=[0, 0.1], span=(0, 3))
    w = np.sqrt(2 * 50 / 2)
    assert np.allclose(motion.q[:, 1] - motion.q[:, 0], 0.1 * np.cos(w * motion.t), atol=1e-8)
    assert np.allclose(motion.q.sum(axis=1), 0.1, atol=1e-9)


def test_coupled_pendulums() -> None:
    """In phase w^2 = g/l, against each other w^2 = g/l + 2 k a^2/(m l^2), the spring at a below the axes.

    A. Sommerfeld, Mechanics (Lectures on Theoretical Physics 1), section 20: sympathetic oscillations.
    """
    k, a, m, length = 3.0, 0.5, 1.5, 0.8
    points = {"from_at": [0, -a, 0], "to_at": [0, -a, 0]}
    model = model_of("pendulum", load("spring", from_="a.rod", to="b.rod", stiffness=k, length=1, **points))
    frequencies = [abs(mode.eigenvalue.imag) for mode in linearise(model, q=[0, 0]).modes]
    expected = np.sqrt([9.81 / length, 9.81 / length + 2 * k * a**2 / (m * length**2)])
    assert np.allclose(frequencies, expected, rtol=1e-10)


def slope(model: Model, q: np.ndarray, h: float = 1e-3, **more: Any) -> np.ndarray:
    """dV/dq by central differences of fourth order."""
    rows = []
    for e in np.eye(model.dof):
        V = [evaluate(model, ["potential_energy"], q=q + s * h * e, **more)["potential_energy"] for s in (-2, -1, 1, 2)]
        rows.append((8 * (V[2] - V[1]) - (V[3] - V[0])) / (12 * h))
    return np.array(rows)


CONSERVATIVE = {
    "spring": load("spring", from_="a.tip", to="b.tip", stiffness="k", length=0.4),
    "spring to the world": load("spring", to="b.tip", to_at=[0, 0.1, "k/10"], stiffness=3),
    "bushing": load("bushing", from_="a.tip", to="b.v", stiffness=[1, 2, "k"], angular_stiffness=["k", 3, 1]),
    "dead force": load("force", to="b.tip", at=[0.1, 0, 0], vector=[1, "k", -2], axes="world"),
    "potential": load("potential", potential="k*distance(a.tip, b.tip)^3 + sin(a.q1)*b.q2^2 - t*a.q2"),
    "angle": load("potential", potential="k*angle(b.u, a.u)^2/2"),
}


@pytest.mark.parametrize("name", CONSERVATIVE)
def test_potentials_are_those_of_the_forces(name: str) -> None:
    model = model_of("arm", CONSERVATIVE[name], parameters={"k": {"value": 7}})
    for q in ([0.3, -0.4, 0.2, 0.9], [-1.0, 0.4, 0.8, 0.1]):
        Q = evaluate(model, ["forces"], q=q, t=0.7)["forces"]
        assert np.allclose(slope(model, np.array(q), t=0.7), -Q, atol=1e-7)
    assert np.abs(Q).max() > 0.1


def test_a_stiff_bushing_is_a_weld() -> None:
    """Two planar arms, tip at tip: they rest where the welded ones do, but for 1/k."""
    link = {"mass": 1, "com": [0.3, 0.02, 0], "inertia": {"xx": 0.05, "yy": 0.05, "zz": 0.05}}
    bodies = [
        {"name": "u", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1"}, **link},
        {"name": "v", "parent": "u", "joint": {"type": "revolute", "coordinate": "q2", "d": 0.6}, **link},
    ]
    ports = [{"name": "tip", "body": "v", "position": [0.6, 0, 0]}]
    part = derive(Definition.read({"name": "planar", "bodies": bodies, "ports": ports}))
    instances = [
        {"name": name, "substructure": "planar", "placement": {"position": [x, 0, 0]}}
        for name, x in (("a", 0), ("b", 1))
    ]
    given = {"name": "t", "gravity": [0, "-9.81", 0], "instances": instances}
    weld = {"name": "w", "type": "weld", "from": "a.tip", "to": "b.tip"}
    closed = couple(TreeSpec.read({**given, "closures": [weld]}), {"a": part, "b": part})
    start = [-1.0, -0.3, -1.5, 0.5]
    rest = equilibria(closed, starts=[start], count=0).found[0].q
    apart = []
    for k in (1e5, 1e6, 1e7):
        bushing = load("bushing", from_="a.tip", to="b.tip", stiffness=[k, k, k], angular_stiffness=[k, k, k])
        model = couple(TreeSpec.read({**given, "loads": [bushing]}), {"a": part, "b": part})
        found = equilibria(model, starts=[rest.tolist()], count=0).found
        apart.append(min(float(np.abs(each.q - rest).max()) for each in found))
    assert 0 < apart[0] < 1e-2
    assert np.allclose([apart[0] / apart[1], apart[1] / apart[2]], 10, rtol=0.05)


def test_reaction_has_no_moment_about_the_common_motion() -> None:
    """A load between two bodies of a free mechanism changes neither momentum nor moment of momentum."""
    FREE: Plain = {
        "name": "free",
        "bodies": [
            {"name": "b", "parent": "base", "joint": {"type": "free", "coordinate": ["x", "y", "z", "c", "d", "e"]},
             "mass": 2, "inertia": {"xx": 1, "yy": 2, "zz": 2.5}},
        ],
    }  # fmt: skip
    part = derive(Definition.read(FREE))
    loads = [
        load("bushing", from_="a.b", to="b.b", stiffness=[1, 2, 3], damping=[1, 0, 2], angular_stiffness=[1, 1, 2]),
        load("force", from_="a.b", to="b.b", at=[0.3, 0.2, 0.1], vector=[1, 2, "sin(t)"]),
        load("torque", from_="a.b", to="b.b", vector=[1, 2, "a.x'"], axes="from"),
        load("spring", from_="a.b", from_at=[0, 0, 1], to="b.b", stiffness=2, damping=1, length=0.3),
    ]
    instances = [{"name": name, "substructure": "free"} for name in ("a", "b")]
    spec = TreeSpec.read({"name": "t", "instances": instances, "loads": loads})
    model = couple(spec, {"a": part, "b": part})
    found = {i.name for i in first_integrals(model).integrals if i.rule == "constant"}
    assert found >= {f"{kind}_momentum.{e}" for kind in ("linear", "angular") for e in "xyz"}


LOADS = [
    *CONSERVATIVE.values(),
    load("spring", name="s2", from_="a.v", to="b.tip", stiffness="k*(1 + a.q1^2)", damping=0.3, length="k/20 + u/9"),
    load("bushing", name="b2", from_="a.tip", to="b.v", damping=[1, 2, "k"], angular_damping=[0.1, 0.2, 0.3]),
    load("force", name="f2", from_="a.u", to="b.tip", vector=["u", 1, "b.q1'"], axes="from"),
    load("torque", name="t2", from_="a.u", to="b.tip", vector=["distance'(a.u, b.tip)", 1, "t"]),
    load("joint", name="j1", coordinate="b.q1", force="-tanh(b.q1'/0.1) - max(0, b.q1)^1.5 + min(t, 2)*abs(a.q2)"),
    load(
        "spring",
        name="s3",
        from_="a.u",
        to="b.u",
        stiffness="k*step(distance(a.u, b.u), 1, 3) + exp(-t)",
        damping="table(a.q1; -1: 0.2, 0.1: 1, 1: 4; monotone) + table(b.q1; -1: 0.2, 0.3: 2, 1: 4; smooth)",
    ),
    load("joint", coordinate="b.q2", force="-k*angle'(a.u, b.u) + distance(a.tip, world)"),
]


def test_damage_of_loads_is_found() -> None:
    """Every output that they change, in all ways."""
    loads = [{**each, "name": f"l{i}"} for i, each in enumerate(LOADS)]
    spec, parts = tree("arm", *loads, parameters={"k": {"value": 7}}, inputs={"u": {"unit": "N"}})
    model = couple(spec, parts)
    errors = errors_of(model.certificate)
    assert errors.keys() == model.program.outputs.keys()
    assert all(error is not None and error <= TOLERANCE for error in errors.values())
    rng = np.random.default_rng(5)
    for kind, place, wrong in damages(model.program, rng, elements=2):
        if place.partition("[")[0] in ("forces", "inverse_dynamics", "potential_energy"):
            assert found_in_tree(spec, parts, model, wrong) is not None, (kind, place)


def test_a_law_that_moves_has_no_potential_and_says_so() -> None:
    model = model_of("arm", load("spring", from_="a.v", to="b.tip", stiffness="2 + a.q1^2"))
    assert [w["code"] for w in model.certificate["warnings"]] == ["no-potential"]


def test_energy_balance_of_a_motion() -> None:
    """H' is the power of what has no potential: a drive and dampers between the parts."""
    loads = [{**each, "name": f"l{i}"} for i, each in enumerate(LOADS)]
    model = model_of("arm", *loads, parameters={"k": {"value": 7}}, inputs={"u": {"unit": "N"}})
    motion = simulate(model, q=[0.1, 0.4, -0.3, 0.2], qd=[0.3, 0, 0.2, 0], span=(0, 1), inputs={"u": 2})
    assert motion.status == "finished", motion.message
    assert motion.is_right, motion.checks


def test_regularised_friction_between_parts_is_linear_at_rest() -> None:
    """-F tanh(v/v0) of the relative velocity: the damping F/v0 between both."""
    loads = [
        load("joint", name=name, coordinate=f"{name}.x", force=f"-0.3*tanh(({name}.x' - {other}.x')/0.05)")
        for name, other in (("a", "b"), ("b", "a"))
    ]
    found = linearise(model_of("cart", *loads), q=[0, 0.3], qd=[0.4, 0.4])
    assert np.allclose(found.D, 0.3 / 0.05 * np.array([[1, -1], [-1, 1]]))


def test_corners_are_refused_where_derivatives_are_needed() -> None:
    model = model_of("cart", load("joint", coordinate="a.x", force="-min(abs(a.x'), 2)"))
    with pytest.raises(InvalidDocument) as raised:
        linearise(model, q=[0, 0.3])
    assert raised.value.faults[0].code == "not-smooth"


def test_lagrange_equations_from_the_lagrangian() -> None:
    """d/dt dL/dq'^a - dL/dq^a = Q_a + d_a V along a motion; p_a = dL/dq'^a. All by differences."""
    model = model_of("arm", *LOADS[1:4], parameters={"k": {"value": 7}})
    q, qd = np.array([0.3, -0.4, 0.2, 0.9]), np.array([0.5, 0.1, -0.6, 0.4])
    h = 1e-4

    def lagrangian(x: np.ndarray, v: np.ndarray) -> float:
        return float(evaluate(model, ["lagrangian"], q=x, qd=v)["lagrangian"])

    def p(x: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.asarray(evaluate(model, ["generalised_momenta"], q=x, qd=v)["generalised_momenta"])

    by_rate = [(lagrangian(q, qd + h * e) - lagrangian(q, qd - h * e)) / (2 * h) for e in np.eye(4)]
    assert np.allclose(p(q, qd), by_rate, atol=1e-7)
    qdd = evaluate(model, ["forward_dynamics"], q=q, qd=qd)["forward_dynamics"]
    ends = [p(q + s * qd + s * s / 2 * qdd, qd + s * qdd) for s in (h, -h)]
    by_place = [(lagrangian(q + h * e, qd) - lagrangian(q - h * e, qd)) / (2 * h) for e in np.eye(4)]
    assert np.allclose((ends[0] - ends[1]) / (2 * h), by_place, atol=1e-6)


def test_picture() -> None:
    spec, parts = tree("arm", load("spring", from_="a.tip", to="b.tip", stiffness=1))
    assert "<polyline" in picture(spec, parts, couple(spec, parts))


SPRING = load("spring", from_="a.tip", to="b.tip", stiffness=1)
BAD: list[tuple[str, Plain, str, str, str]] = [
    ("unknown instance", {**SPRING, "to": "c.tip"}, "/loads/0/to", "unknown-instance", "c"),
    ("unknown frame", {**SPRING, "to": "b.hand"}, "/loads/0/to", "unknown-port", "tip"),
    ("point to itself", {**SPRING, "to": "a.tip"}, "/loads/0", "coincident-ends", "spring"),
    ("wrong unit", {**SPRING, "stiffness": {"value": 1, "unit": "N"}}, "/loads/0/stiffness", "unit-mismatch", "N/m"),
    ("wrong unit in a law", {**SPRING, "length": "k"}, "/loads/0/length", "unit-mismatch", "k"),
    ("unknown name", {**SPRING, "stiffness": "kk"}, "/loads/0/stiffness", "unknown-name", "kk"),
    ("moving point", {**SPRING, "to_at": ["a.q1", 0, 0]}, "/loads/0/to_at/0", "unknown-name", "a.q1"),
    ("unknown frame of a measure", load("joint", coordinate="a.q1", force="distance(a.tip, b.x)"), "/loads/0/force",
     "unknown-port", "tip"),
    ("no common axis", load("joint", coordinate="a.q1", force="angle(a.tip, b.u)"), "/loads/0/force",
     "no-common-axis", "angle"),
    ("measure of a point and itself", load("joint", coordinate="a.q1", force="distance(a.u, a.u)"), "/loads/0/force",
     "coincident-ends", "a.u"),
    ("unknown coordinate", load("joint", coordinate="a.q3", force=1), "/loads/0/coordinate", "unknown-coordinate",
     "a.q1"),
    ("velocity in a potential", load("potential", potential="k*a.q1'"), "/loads/0/potential", "velocity-in-potential",
     "a.q1'"),
    ("rate in a potential", load("potential", potential="distance'(a.tip, b.tip)"), "/loads/0/potential",
     "velocity-in-potential", "distance'"),
    ("potential of a constant zero", load("potential", potential="1/(k - k)"), "/loads/0/potential", "bad-expression",
     "zero"),
    ("unknown type", load("magnet", to="a.tip"), "/loads/0", "union-tag-invalid", "magnet"),
    ("no name", {"type": "joint", "coordinate": "a.q1", "force": 1}, "/loads/0/name", "missing", ""),
]  # fmt: skip


@pytest.mark.parametrize(("bad", "pointer", "code", "culprit"), [x[1:] for x in BAD], ids=[x[0] for x in BAD])
def test_bad_loads(bad: Plain, pointer: str, code: str, culprit: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        model_of("arm", bad, parameters={"k": {"value": 1, "unit": "N/m"}})
    found = [(f.pointer, f.code) for f in raised.value.faults]
    assert any(p.startswith(pointer) and c == code for p, c in found), found
    assert any(culprit in f.message for f in raised.value.faults), raised.value.faults


@pytest.mark.parametrize(
    ("more", "pointer", "code"),
    [
        ({"inputs": {"k": {}}, "parameters": {"k": {"value": 1}}}, "/inputs/k", "duplicate-name"),
        ({"inputs": {"a": {}}}, "/inputs/a", "duplicate-name"),
        ({"inputs": {"t": {}}}, "/inputs/t", "reserved-name"),
        ({"inputs": {"u": {"unit": "newtonian"}}}, "/inputs/u/unit", "unknown-unit"),
    ],
)
def test_bad_inputs(more: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        model_of("arm", SPRING, **more)
    assert (pointer, code) in [(f.pointer, f.code) for f in raised.value.faults]


def test_two_loads_of_one_name() -> None:
    with pytest.raises(InvalidDocument) as raised:
        model_of("arm", SPRING, SPRING)
    assert ("/loads/1/name", "duplicate-name") in [(f.pointer, f.code) for f in raised.value.faults]


def test_zero_distance_is_told() -> None:
    """Two carts that meet with a spring of a length between them: its force has no direction."""
    model = model_of("cart", load("spring", from_="a.b", to="b.b", stiffness=50, length=1))
    answer = evaluate(model, ["forces"], q=[[0, 0], [1, 0]])
    assert np.isfinite(answer["forces"][0]).all()
    assert [(f.state, f.code) for f in answer.failures] == [(1, "not-finite")]


def test_a_root_of_what_is_cut_off_says_what_to_take_instead() -> None:
    """Its force is infinite at the edge; with a small number below the root it has energy to lose."""
    spec, parts = tree("cart", {"type": "potential", "name": "edge", "potential": "max(0, a.x)^0.5"})
    with pytest.raises(VerificationFailed, match=r"infinite slope there, .* take sqrt\(max\(0, x\) \+ 1e-6\)"):
        couple(spec, parts)
    spec, parts = tree("cart", {"type": "potential", "name": "edge", "potential": "sqrt(max(0, a.x) + 1e-6)"})
    motion = simulate(couple(spec, parts), [0.5, 0], (0, 3))
    assert motion.is_right
    # m v^2/2 = V(0.5) - V(0), m = 2 kg
    np.testing.assert_allclose(motion.qd[-1, 0] ** 2, (0.5 + 1e-6) ** 0.5 - 1e-3, rtol=1e-8)
