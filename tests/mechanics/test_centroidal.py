"""The mass centre of a tree: against an independent engine, textbook values, and what momentum has to be."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_trees import GRAVITY, Kind, random_definition, random_states, tree_of

from substructures import Definition, TreeSpec, couple, derive
from substructures.certificate.compare import VerificationFailed
from substructures.errors import InvalidArgument
from substructures.quantities import centroidal as module
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.sources import Sources, of_parts

Plain = dict[str, Any]


def sources_of(definition: Plain, gravity: Any = GRAVITY) -> Sources:
    spec, parts = tree_of(definition, gravity), {"x": derive(Definition.read(definition))}
    return Sources(couple(spec, parts), of_parts=of_parts(spec, parts))


def moving(seed: int) -> Plain:
    rng = np.random.default_rng(seed)
    definition = random_definition(rng, Kind(int(rng.integers(1, 5)), bool(rng.integers(2)), depth=6))
    while not any(b["joint"]["type"] != "fixed" and b.get("mass") for b in definition["bodies"]):
        definition = random_definition(rng, Kind(3, depth=6))
    return definition


@pytest.mark.parametrize("seed", range(6))
def test_against_an_engine(seed: int) -> None:
    """Position, velocity and momentum matrix of random trees at two states."""
    pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
    from pinocchio_trees import engine_of  # noqa: PLC0415 -- the engine is optional

    definition = moving(seed)
    sources = sources_of(definition)
    model = sources.model
    states = random_states(np.random.default_rng(seed), 2, model.dof)
    answer = evaluate(sources, ["mass_centre", "centroidal_momentum_matrix"], **states)
    found, matrix = answer["mass_centre"], answer["centroidal_momentum_matrix"]
    engine = engine_of(definition, GRAVITY)
    order = engine.order([c.removeprefix("x.") for c in model.coordinates])
    place = np.argsort(order)
    for i in range(2):
        data, q, qd = engine.model.createData(), states["q"][i][place], states["qd"][i][place]
        np.testing.assert_allclose(matrix[i], pin.ccrba(engine.model, data, q, qd)[:, order], rtol=1e-11, atol=1e-11)
        np.testing.assert_allclose(matrix[i] @ states["qd"][i], data.hg.vector, rtol=1e-10, atol=1e-10)
        centre = pin.centerOfMass(engine.model, data, q, qd)
        np.testing.assert_allclose(found["position"][i], centre, rtol=1e-11, atol=1e-11)
        np.testing.assert_allclose(found["velocity"][i], data.vcom[0], rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_theorems(seed: int) -> None:
    """r' is the derivative of r; gravity does the work m g . r'; the momentum is m r'; A q' is the momentum, with L
    about the mass centre: L_0 = r x p + L."""
    definition = moving(seed + 20)
    sources = sources_of(definition)
    model, rng = sources.model, np.random.default_rng(seed)
    q, qd = rng.uniform(-1, 1, (2, model.dof))
    names = ["mass_centre", "momentum", "gravity", "inertial_parameters", "centroidal_momentum_matrix"]
    found, h = evaluate(sources, names, q, qd), 1e-6
    sides = [evaluate(sources, "mass_centre", q + s * h * qd)["mass_centre"] for s in (1, -1)]
    velocity = found["mass_centre"]["velocity"]
    np.testing.assert_allclose((sides[0]["position"] - sides[1]["position"]) / (2 * h), velocity, atol=1e-7)
    m = found["inertial_parameters"][::10].sum()
    np.testing.assert_allclose(found["momentum"]["linear"], m * velocity, rtol=1e-10, atol=1e-12)
    h_q = found["centroidal_momentum_matrix"] @ qd
    np.testing.assert_allclose(h_q[:3], found["momentum"]["linear"], rtol=1e-10, atol=1e-12)
    carried = np.cross(found["mass_centre"]["position"], h_q[:3])
    np.testing.assert_allclose(carried + h_q[3:], found["momentum"]["angular"], rtol=1e-9, atol=1e-10)
    assert found["gravity"] @ qd == pytest.approx(m * velocity @ np.array(GRAVITY, dtype=float), rel=1e-9, abs=1e-9)


def test_two_masses_on_a_rod() -> None:
    """Point masses m1, m2 at l1, l2 of a pendulum: r = (m1 l1 + m2 l2) / (m1 + m2) along the rod."""
    rod = {
        "name": "rod",
        "parent": "base",
        "joint": {"type": "revolute", "coordinate": "q"},
        "mass": 1,
        "com": [1, 0, 0],
    }
    tip = {"name": "tip", "parent": "rod", "joint": {"type": "fixed"}, "mass": 3, "com": [2, 0, 0]}
    still = {"name": "stand", "parent": "base", "joint": {"type": "fixed"}, "mass": 50, "com": [7, 8, 9]}
    sources = sources_of({"name": "pendulum", "bodies": [rod, tip, still]})
    found = evaluate(sources, "mass_centre", [0.5], [2])["mass_centre"]
    r = 7 / 4
    np.testing.assert_allclose(found["position"], [r * np.cos(0.5), r * np.sin(0.5), 0], atol=1e-15)
    np.testing.assert_allclose(found["velocity"], [-2 * r * np.sin(0.5), 2 * r * np.cos(0.5), 0], atol=1e-15)
    # about the mass centre: m1 (r - l1)^2 + m2 (l2 - r)^2
    matrix = evaluate(sources, "centroidal_momentum_matrix", [0.5])["centroidal_momentum_matrix"]
    expected = [-4 * r * np.sin(0.5), 4 * r * np.cos(0.5), 0, 0, 0, (r - 1) ** 2 + 3 * (2 - r) ** 2]
    np.testing.assert_allclose(matrix[:, 0], expected, atol=1e-14)


def test_of_several_parts() -> None:
    """A part on a port of another: as the same bodies in one part."""
    rod: Plain = {"parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 2, "com": [0.5, 0.1, 0]}
    one = {
        "name": "one",
        "bodies": [{"name": "a", **rod}],
        "ports": [{"name": "end", "body": "a", "position": [1, 0, 0]}],
    }
    base = {"name": "plate", "parent": "base", "joint": {"type": "fixed"}, "mass": 5, "com": [0, 0.3, 0.2]}
    two = {"name": "two", "bodies": [base, {"name": "b", **rod}]}
    shift: Plain = {"position": [1, 0, 0], "rpy": [0, 0, 0]}
    joint = {"type": "revolute", "coordinate": "p", "placement": shift}
    plate = {**base, "parent": "a", "joint": {"type": "fixed", "placement": shift}}
    whole = {
        "name": "whole",
        "bodies": [{"name": "a", **rod}, plate, {"name": "b", **rod, "parent": "a", "joint": joint}],
    }
    spec = TreeSpec.read(
        {
            "name": "t",
            "instances": [
                {"name": "x", "definition": one},
                {"name": "y", "definition": two, "at": "x.end"},
            ],
        }
    )
    parts = {name: derive(Definition.read(each)) for name, each in (("x", one), ("y", two))}
    pieces, alone = Sources(couple(spec, parts), of_parts=of_parts(spec, parts)), sources_of(whole)
    a, b = (evaluate(s, "mass_centre", [0.4, -0.7], [1, 2])["mass_centre"] for s in (pieces, alone))
    for name in ("position", "velocity"):
        np.testing.assert_allclose(a[name], b[name], rtol=1e-13, atol=1e-13)


def test_nothing_that_moves_has_mass() -> None:
    body = {"name": "b", "parent": "base", "joint": {"type": "revolute", "coordinate": "q", "armature": 1}}
    sources = sources_of({"name": "rotor", "bodies": [body]})
    with pytest.raises(InvalidArgument, match="no mass centre"):
        evaluate(sources, "mass_centre", [0.5])


def test_wrong_formulas_are_not_served(monkeypatch: pytest.MonkeyPatch) -> None:
    """A mass that is left out is seen by the certificate."""
    given = module._masses
    monkeypatch.setattr(module, "_masses", lambda *known: list(given(*known))[:-1])
    rod: Plain = {"joint": {"type": "revolute"}, "mass": 2, "com": [0.5, 0.1, 0]}
    bodies = [{"name": "a", "parent": "base", **rod}, {"name": "b", "parent": "a", **rod}]
    sources = sources_of({"name": "two", "bodies": bodies})
    with pytest.raises(VerificationFailed, match="mass centre"):
        evaluate(sources, "mass_centre", [0.1, 0.2])
