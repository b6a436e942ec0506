"""Base parameters: the literature's counts, exactness, generic rank, and recovery from simulated motion."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import deep, seeds
from random_trees import Kind, Plain, random_definition, tree_of, with_parameters

from substructures import Definition, InvalidInput, TooLarge, TreeSpec, couple, derive
from substructures.analysis.equations import dependencies
from substructures.analysis.identification import columns
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.fit import excitation, identify
from substructures.export import FORMATS, Interface, render
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel

from .identified_motions import IN_PLANE, UP, base_of, motion, tree


def numeric_rank(model: RegressorModel, samples: int = 60, seed: int = 0) -> int:
    """Rank of the regressor stacked over random states, by singular values, for general parameters."""
    rng, n = np.random.default_rng(seed), len(model.coordinates)
    states: Plain = {name: rng.uniform(-2, 2, (samples, n)) for name in ("q", "qd", "qdd")}
    states["parameters"] = {name: float(rng.uniform(0.4, 1.2)) for name in model.parameters}
    stacked = model.evaluate(**states)["regressor"].reshape(-1, len(model.names))
    values = np.linalg.svd(stacked, compute_uv=False)
    return int(np.sum(values > 1e-9 * values[0]))


@pytest.mark.parametrize(
    ("name", "gravity", "count"),
    [
        # 7 N - 4 beta - 2: axis 1 along gravity, beta = 1 link of the first group of parallel axes
        ("puma560", UP, 36),
        ("ur5", UP, 36),
        *deep(("kuka-iiwa-14", UP, 43)),
        ("spherical-wrist", UP, 15),
        # 7 N - 4 beta, beta = N = 3: axes across gravity; two less where they are along it
        ("planar-3r", IN_PLANE, 9),
        ("planar-3r", UP, 7),
        ("planar-2r", IN_PLANE, 6),
        # all ten of a free body
        ("free-body", UP, 10),
    ],
)
def test_published_counts(name: str, gravity: tuple[Any, ...], count: int) -> None:
    """H. Mayeda, K. Yoshida and K. Osuka, Base parameters of manipulator dynamic models, IEEE Transactions on Robotics
    and Automation 6(3), 1990: 7 N - 4 beta, less 2 where the first axis is along gravity; without rotors."""
    base = base_of(name, gravity)
    assert base.count == count
    assert numeric_rank(regressor(*tree(name, gravity))) == count


def test_general_arm_of_six_revolute_joints() -> None:
    """With free twists, lengths and offsets, in an oblique field of gravity: 7 N - 4 = 38."""
    bodies, rows = [], ("theta", "d", "tau", "phi")
    for k in range(1, 7):
        row = {name: f"{name}{k}" for name in rows}
        joint = {"type": "revolute", "coordinate": f"q{k}", **row}
        bodies.append({"name": f"b{k}", "parent": f"b{k - 1}" if k > 1 else "base", "joint": joint})
    free = {f"{name}{k}": {} for name in rows for k in range(1, 7)}
    document: Plain = {"name": "arm", "bodies": bodies, "parameters": free}
    base = base_parameters(regressor(tree_of(document), {"x": derive(Definition.read(document))}))
    assert base.count == 38
    assert base.count == numeric_rank(regressor(tree_of(document), {"x": derive(Definition.read(document))}))


OBLIQUE = ("0.3", "1.7", "-9.81")


def general(kinds: str, parents: tuple[int, ...]) -> Plain:
    """Oblique axes of decimals, with two roots each, anywhere; one letter for every joint."""
    types = {"R": "revolute", "P": "prismatic", "S": "spherical", "U": "universal", "C": "cylindrical", "F": "free"}
    bodies = []
    for k, (kind, parent) in enumerate(zip(kinds, parents, strict=True)):
        placement = {"position": [f"0.{17 + 3 * k}", f"x{k}", f"-0.{29 - k}"], "rpy": [f"0.{k + 1}", "-0.4", f"a{k}"]}
        joint = {"type": types[kind], "placement": placement}
        if kind in "RP":
            joint["axis"] = [f"0.{317 + 211 * k}", f"-0.{523 + 97 * k}", f"0.{119 + 301 * k}"]
        bodies.append({"name": f"b{k}", "parent": f"b{parent}" if parent >= 0 else "base", "joint": joint})
    free = {f"{name}{k}": {"value": f"0.{k + 3}"} for name in "ax" for k in range(len(kinds))}
    return {"name": "arm", "bodies": bodies, "parameters": free}


@pytest.mark.parametrize(
    ("kinds", "parents", "count"),
    [
        # 7 N - 4: three of every revolute joint move to the link before; the first link has four
        ("RRR", (-1, 0, 1), 17),
        ("RRRR", (-1, 0, 1, 1), 24),
        *deep(("RRRRRR", (-1, 0, 1, 2, 3, 4), 38)),
        # all ten of a free body; of a link beyond a prismatic joint m and s, of a compound joint all but what stays
        ("FPRS", (-1, 0, 1, 0), 10 + 4 + 7 + 9),
        ("FUC", (-1, 0, 1), 10 + 9 + 9),
    ],
)
def test_general_axes(kinds: str, parents: tuple[int, ...], count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """All relations follow from the joints, in the first field: nothing is searched for.

    Counts: H. Mayeda, K. Yoshida and K. Osuka, 1990 (revolute joints); M. Gautier and W. Khalil, 1990.
    """
    monkeypatch.setattr(columns, "MAX_FIELDS", 1)
    document = general(kinds, parents)
    Y = regressor(tree_of(document, OBLIQUE), {"x": derive(Definition.read(document))})
    monkeypatch.setattr(dependencies, "MAX_SAMPLES", 0 if kinds[0] == "F" else dependencies.COARSE)
    base = base_parameters(Y)
    assert base.count == count
    assert base.count == numeric_rank(Y)


@pytest.mark.parametrize("joints", [2, *deep(3)])
def test_what_is_fixed_to_an_interface_counts_with_its_host(joints: int) -> None:
    """All ten of it, also over several instances without joints of their own."""
    plate: Plain = {"name": "plate", "bodies": [{"name": "p", "parent": "base", "joint": {"type": "fixed"}, "mass": 1}]}
    plate["ports"] = [{"name": "top", "body": "p", "position": ["0.1", "0.2", "0.3"], "rotation": {"rpy": [1, 2, 3]}}]
    arm, last = general("R" * joints, tuple(range(-1, joints - 1))), joints - 1
    tip: Plain = {"name": "tip", "body": f"b{last}", "rotation": {"rpy": ["0.3", "a1", 0]}}
    arm["ports"] = [tip | {"position": ["0.4", f"x{last}", 0]}]
    chain = [("x", "arm", None), ("y", "plate", "x.tip"), ("z", "plate", "y.top"), ("w", "arm", "z.top")]
    instances = [{"name": n, "substructure": s} | ({"at": at} if at else {}) for n, s, at in chain]
    spec = TreeSpec.read({"name": "t", "gravity": list(OBLIQUE), "instances": instances})
    parts = {name: derive(Definition.read(arm if s == "arm" else plate)) for name, s, _ in chain}
    Y = regressor(spec, parts)
    assert [name for name in Y.names if name.endswith(".m")][joints : joints + 2] == ["y.base.m", "z.base.m"]
    base = base_parameters(Y)
    assert base.count == 7 * 2 * joints - 4
    assert base.count == numeric_rank(Y)


def test_combinations_of_the_planar_arm() -> None:
    """ZZ_j + l_j^2 (masses beyond), MX_j + l_j (masses beyond), MY_j; Theta_zz = Jxx + Jyy."""
    found = base_of("planar-3r", IN_PLANE).combinations()
    assert found["x.link1.sx"] == {"x.link1.sx": "1", "x.link2.m": "x.l1", "x.link3.m": "x.l1"}
    assert found["x.link2.Jxx"] == {"x.link2.Jxx": "1", "x.link2.Jyy": "1", "x.link3.m": "x.l2^2"}
    assert list(found) == [f"x.link{k}.{e}" for k in (1, 2, 3) for e in ("sx", "sy", "Jxx")]


def test_combinations_of_the_puma() -> None:
    """With free kinematic parameters a2, d3, a3, d4; the masses of the wrist count with those of the links before."""
    base = base_of("puma560")
    found = base.combinations()
    assert found["x.link3.Jyy"] == {
        "x.link3.Jyy": "1",
        "x.link4.m": "x.d4^2",
        "x.link4.sz": "2*x.d4",
        "x.link4.Jzz": "1",
        "x.link5.m": "x.d4^2",
        "x.link6.m": "x.d4^2",
    }
    assert found["x.link6.Jxz"] == {"x.link6.Jxz": "1"}
    assert set(base.unseen) >= {"x.link1.m", "x.link1.sx", "x.link1.sy", "x.link1.sz", "x.link1.Jzz", "x.link2.m"}
    assert len(base.unseen) == 10
    # rotors: those of joints 1 and 2 count with moments of links about the same axes
    assert base_of("puma560", UP, ("armature",)).count == 40


@pytest.mark.parametrize("seed", seeds(5, 30))
def test_random_trees(seed: int) -> None:
    """Y_B beta = Y pi, and as many as the singular values say; parameters free or bound, any joints."""
    rng = np.random.default_rng(8200 + seed)
    definition: Plain = {"bodies": []}
    while not 2 <= sum(np.size(b["joint"].get("coordinate", [])) for b in definition["bodies"]) <= 5:
        definition = random_definition(rng, Kind(4, chain=seed % 2 == 0, laws=False))
    document = with_parameters(rng, definition, 0.25 * (seed % 3))
    Y = regressor(tree_of(document), {"x": derive(Definition.read(document))})
    base = base_parameters(Y)
    n = len(Y.coordinates)
    assert base.count == numeric_rank(Y, 40 if n > 3 else 60, seed)
    states = {name: rng.uniform(-1, 1, (3, n)) for name in ("q", "qd", "qdd")}
    values: Plain = {name: float(rng.uniform(0.4, 1.2)) for name in Y.parameters}
    full = Y.evaluate(**states, parameters=dict(values))
    for primes, x in (("", states["q"]), ("'", states["qd"]), ("''", states["qdd"])):
        values |= {f"{name}{primes}": x[:, a] for a, name in enumerate(Y.coordinates)}
    found = interpret(base.program, values)
    expected = np.einsum("nai,ni->na", full["regressor"], full["inertial_parameters"])
    scale = max(float(np.abs(expected).max()), 1)
    force = np.einsum("nab,nb->na", found["base_regressor"], found["base_parameters"])
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-10 * scale)
    # for any standard parameters, not only those of the model
    pi = rng.uniform(-1, 1, len(Y.names))
    beta = np.einsum("nbi,i->nb", found["grouping"], pi)
    np.testing.assert_allclose(
        np.einsum("nab,nb->na", found["base_regressor"], beta), full["regressor"] @ pi, rtol=0, atol=1e-9 * scale
    )


def test_drives() -> None:
    """Friction is always independent; an offset is no gravity force of a revolute joint, but one of a lift."""
    drives = ("armature", "viscous", "coulomb", "offset")
    base = base_of("planar-3r", IN_PLANE, drives)
    # the rotor of joint 1 counts with link 1
    assert base.count == 9 + 4 * 3 - 1
    assert base.units[base.standard.index("x.q2.viscous")] == "N m s/rad"
    lift = {"type": "prismatic", "coordinate": "z"}
    document: Plain = {"name": "lift", "bodies": [{"name": "b", "parent": "base", "joint": lift, "mass": 2}]}
    Y = regressor(tree_of(document, UP), {"x": derive(Definition.read(document))})
    # m (q'' + g), q'', 1: two of them independent
    assert base_parameters(Y).count == 1
    driven = base_parameters(Y, ("armature", "offset"))
    assert driven.names == ("x.b.m", "x.z.armature")
    assert {s.name: s.unit for s in driven.program.symbols}["x.z''"] == "m/s^2"
    found = base_parameters(Y, drives).program
    for form in FORMATS:
        assert render(found, form, interface=Interface.of_symbols(found.symbols))


def own_values(base: BaseParameters) -> Any:
    values = {name: default_number(p["value"]) for name, p in base.parameters.items()}
    return interpret(base.program, values, ["base_parameters"])["base_parameters"]


def test_recovery_of_the_puma() -> None:
    """From forces with noise of 0.05 N m: within four standard deviations; without noise to 1e-7. Rotors are known."""
    base, model = base_of("puma560"), couple(*tree("puma560"))
    data = motion(6, 500)
    clean = np.asarray(evaluate(model, **(data | {"quantities": ["inverse_dynamics"]}))["inverse_dynamics"])
    beta = own_values(base)
    exact = identify(base, **data, tau=clean, model=model)
    np.testing.assert_allclose(exact.values, beta, rtol=0, atol=1e-7)
    noise = np.random.default_rng(4).normal(0, 0.05, clean.shape)
    found = identify(base, **data, tau=clean + noise, model=model)
    assert found.status == "identified"
    assert found.excitation.is_good
    assert np.abs(found.values - beta).max() > 1e-6
    assert np.all(np.abs(found.values - beta) < 4 * found.deviations)
    assert np.mean(np.abs(found.values - beta) < found.deviations) > 0.5
    np.testing.assert_allclose(found.residual, 0.05, rtol=0.15)
    assert found.units[0] == "kg m^2"


def test_recovery_with_friction() -> None:
    """Viscous and dry friction of a planar arm, identified together with its links."""
    base, model = base_of("planar-3r", IN_PLANE, ("viscous", "coulomb")), couple(*tree("planar-3r", IN_PLANE))
    data = motion(3, 200)
    tau = np.asarray(evaluate(model, **(data | {"quantities": ["inverse_dynamics"]}))["inverse_dynamics"])
    tau = tau + 0.3 * data["qd"] + 0.2 * np.sign(data["qd"])
    found = identify(base, **data, tau=tau)
    expected = own_values(base)
    expected[9:] = np.repeat([0.3, 0.2], 3)
    np.testing.assert_allclose(found.values, expected, rtol=1e-8, atol=1e-12)


def test_joints_are_weighted_by_what_they_leave_unexplained() -> None:
    """With a force sensor a thousand times as noisy as another: normal equations in two passes, and their inverse."""
    base, model = base_of("planar-3r", IN_PLANE), couple(*tree("planar-3r", IN_PLANE))
    data = motion(3, 100)
    clean = np.asarray(evaluate(model, **(data | {"quantities": ["inverse_dynamics"]}))["inverse_dynamics"])
    tau = clean + np.random.default_rng(2).normal(0, 1, clean.shape) * [1e-3, 1, 0.03]
    found = identify(base, **data, tau=tau)
    values: Plain = {name: default_number(p["value"]) for name, p in base.parameters.items()}
    for primes, x in (("", data["q"]), ("'", data["qd"]), ("''", data["qdd"])):
        values |= {f"{name}{primes}": x[:, a] for a, name in enumerate(base.coordinates)}
    W = interpret(base.program, values, ["base_regressor"])["base_regressor"]

    def fitted(weight: Any) -> tuple[Any, Any]:
        normal = np.einsum("nab,a,nac->bc", W, weight, W)
        return np.linalg.solve(normal, np.einsum("nab,a,na->b", W, weight, tau)), normal

    first, _ = fitted(np.ones(3))
    weight = 1 / np.mean((tau - W @ first) ** 2, axis=0)
    second, normal = fitted(weight)
    np.testing.assert_allclose(found.values, second, rtol=1e-7)
    assert np.abs(second - first).max() > 1e-3
    left = tau - W @ second
    variance = np.sum(weight * left**2) / (tau.size - base.count)
    np.testing.assert_allclose(found.deviations, np.sqrt(variance * np.diag(np.linalg.inv(normal))), rtol=1e-7)
    np.testing.assert_allclose(found.residual, np.sqrt(np.mean(left**2, axis=0)), rtol=1e-9)


def test_excitation() -> None:
    """One joint alone excites little, and the advice names what is missing."""
    base, n = base_of("puma560"), 6
    assert excitation(base, **motion(n, 300)).is_good
    lazy = motion(n, 300)
    lazy = {name: x * (np.arange(n) == 1) for name, x in lazy.items()}
    judged = excitation(base, **lazy)
    assert judged.rank < 36
    assert judged.condition == np.inf
    assert "x.link6.Jxz" in judged.advice
    failed = identify(base, **lazy, tau=np.zeros((300, n)))
    assert failed.status == "failed"
    assert failed.message == judged.advice
    assert np.isinf(failed.deviations).all()


def test_weak_are_those_of_a_dependency_and_the_worst_come_first() -> None:
    """q1' = (1 + 3 s)/2 with s = +-1 equally often: viscous = offset/2 + 3/2 coulomb, of columns of length one
    sqrt(5/2) : 1/2 : 3/2, in a unit vector 0.71, 0.22 and 0.67, of which 0.22 is too small a part to be named.
    """
    base, data = base_of("planar-2r", IN_PLANE, ("viscous", "coulomb", "offset")), motion(2, 60)
    s = np.tile([1, -1], 30)
    data["qd"][:, 0] = (1 + 3 * s) / 2
    judged = excitation(base, **data)
    assert judged.weak == ("x.q1.viscous", "x.q1.coulomb")
    assert (judged.rank, judged.condition) == (base.count - 1, np.inf)


def test_refusals(monkeypatch: pytest.MonkeyPatch) -> None:
    base, data = base_of("planar-3r", IN_PLANE), motion(3, 20)
    cases: list[tuple[Plain, str, str]] = [
        (data | {"tau": None}, "/tau", "missing"),
        (data | {"tau": np.zeros((4, 3))}, "/tau", "wrong-length"),
        (data | {"qdd": None, "tau": [0] * 3}, "/qdd", "missing"),
        (data | {"tau": data["q"], "parameters": {"x.nothing": 1}}, "/parameters/x.nothing", "unknown-parameter"),
        ({"q": [0] * 3, "qd": None, "qdd": [0] * 3, "tau": [0] * 3}, "/q", "too-few"),
    ]
    for request, pointer, code in cases:
        with pytest.raises(InvalidInput) as error:
            identify(base, **request)
        assert [(f.pointer, f.code) for f in error.value.faults] == [(pointer, code)]
    with pytest.raises(InvalidInput) as error:
        base_parameters(regressor(*tree("planar-2r")), ("stiction",))
    assert error.value.faults[0].pointer == "/drives/0"
    monkeypatch.setattr(dependencies, "MAX_SAMPLES", 0)
    monkeypatch.setattr(dependencies, "SMALL", 0)
    with pytest.raises(TooLarge):
        base_parameters(regressor(*tree("puma560")))
