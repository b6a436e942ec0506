"""Routh's reduced systems as trees: textbook amended potentials, and the motions of the trees with all coordinates."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from simulated import simulated

from substructures import InvalidDocument, Model, couple, derive, evaluate
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.orbits.periodic import Shooting, periodic_orbits
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.steady_motions import steady_motions

Plain = dict[str, Any]
G, M, L, I1, I3 = 9.81, 0.7, 0.4, 0.3, 0.05
AT: Plain = {"position": [0, 0, 0]}


def joint(coordinate: str, axis: list[int]) -> Plain:
    return {"type": "revolute", "coordinate": coordinate, "axis": axis, "placement": AT}


#: a point mass on a rod, by its azimuth and its angle from below
PENDULUM: Plain = {
    "name": "pendulum",
    "bodies": [
        {"name": "arm", "parent": "base", "joint": joint("azimuth", [0, 0, 1])},
        {"name": "bob", "parent": "arm", "mass": str(M), "com": [0, 0, str(-L)], "joint": joint("angle", [1, 0, 0])},
    ],
}
#: Euler's angles z-x-z, moments of inertia about the point that is fixed
TOP: Plain = {
    "name": "top",
    "bodies": [
        {"name": "first", "parent": "base", "joint": joint("precession", [0, 0, 1])},
        {"name": "second", "parent": "first", "joint": joint("nutation", [1, 0, 0])},
        {
            "name": "rotor",
            "parent": "second",
            "mass": str(M),
            "com": [0, 0, str(L)],
            "inertia": {"xx": f"{I1} - {M}*{L}^2", "yy": f"{I1} - {M}*{L}^2", "zz": str(I3)},
            "joint": joint("spin", [0, 0, 1]),
        },
    ],
}


def model(definition: Plain | str, ignored: Plain, parameters: Plain | None = None) -> Model:
    source = {"substructure": definition} if isinstance(definition, str) else {"definition": definition}
    tree: Plain = {"name": "tree", "gravity": [0, 0, str(-G)], "instances": [{"name": "x", **source}]}
    tree |= {"parameters": parameters} if parameters else {}
    return couple({**tree, "ignored": ignored}, {"x": derive(definition)})


def amended(m: Model, q: float, **more: Any) -> float:
    """V + 1/2 p g_cc^-1 p = V - T_0."""
    found = evaluate(m, ["potential_energy", "T_0"], q=[q], **more)
    return float(found["potential_energy"] - found["T_0"])


def test_spherical_pendulum() -> None:
    """p^2/(2 m l^2 sin^2 theta) - m g l cos theta; conical motion at g/(l cos theta) of the azimuth, small oscillations
    at w^2 = g (1 + 3 cos^2 theta)/(l cos theta) (E. T. Whittaker, Analytical Dynamics, 1937, section 55).
    """
    p = {"h": {"value": 0.5, "unit": "kg*m^2/s"}}
    m, theta = model(PENDULUM, {"x.azimuth": "h"}, p), 0.8
    assert (m.coordinates, m.ignored) == (("x.angle",), ("x.azimuth",))
    for x in (0.3, 1.2, 2.5):
        expected = 0.5**2 / (2 * M * L**2 * np.sin(x) ** 2) - M * G * L * np.cos(x)
        assert amended(m, x) == pytest.approx(expected, rel=1e-13)
    rate = np.sqrt(G / (L * np.cos(theta)))
    conical = {"h": M * L**2 * np.sin(theta) ** 2 * rate}
    (found,) = equilibria(m, starts=[[0.6]], count=1, parameters=conical).found
    np.testing.assert_allclose(found.q, [theta], rtol=1e-12)
    turning = evaluate(m, ["ignored_rates"], q=found.q, qd=[0], parameters=conical)["ignored_rates"]
    np.testing.assert_allclose(turning, [rate], rtol=1e-12)
    at = linearise(m, found.q, parameters=conical)
    assert at.modes is not None
    assert at.stability is not None
    w2 = G * (1 + 3 * np.cos(theta) ** 2) / (L * np.cos(theta))
    assert at.modes[0].eigenvalue == pytest.approx(1j * np.sqrt(w2), rel=1e-10)
    assert at.stability.verdict == "stable"
    assert "amended potential" in at.stability.reason
    energy = first_integrals(m).integrals[0]
    assert (energy.name, energy.rule) == ("energy", "constant")


@pytest.mark.parametrize("share", [0.6, 0.95, 1.05])
def test_sleeping_top(share: float) -> None:
    """With p_phi = p_psi = p the top leaves the vertical below p^2 = 4 I1 M g l, to (1 + cos theta)^2 = p^2/(I1 M g l)
    (H. Goldstein, Classical Mechanics, 1980, section 5-7).
    """
    m, p = model(TOP, {"x.precession": "h", "x.spin": "s"}, {"h": {}, "s": {}}), 2 * share * np.sqrt(I1 * M * G * L)
    given, c = {"h": p, "s": p}, 2 * share - 1
    for x in (0.4, 1.3):
        expected = p**2 * (1 - np.cos(x)) ** 2 / (2 * I1 * np.sin(x) ** 2) + p**2 / (2 * I3) + M * G * L * np.cos(x)
        assert amended(m, x, parameters=given) == pytest.approx(expected, rel=1e-12)
    found = [e for e in equilibria(m, starts=[[0.5]], count=12, reach=2, parameters=given).found if 0.01 < e.q[0] < 3]
    if share > 1:
        assert not found
        return
    np.testing.assert_allclose([np.cos(e.q[0]) for e in found], [c], rtol=1e-9)
    assert found[0].verdict == "stable"


CASES: dict[str, tuple[Plain | str, Plain, list[float], list[float]]] = {
    "pendulum": (PENDULUM, {"x.azimuth": "0.5"}, [0.7], [0.4]),
    "top": (TOP, {"x.precession": "1/2", "x.spin": "0.8"}, [0.9], [-0.3]),
    "gimbals": ("gimbal-gyroscope", {"x.precession": "0.01", "x.spin": "0.05"}, [0.9], [0.4]),
    "one of two": ("gimbal-gyroscope", {"x.spin": "0.05"}, [0.1, 0.9], [2, 0.4]),
    "governor": ("flyball-governor", {"x.turn": "0.3"}, [0.3, 0.35, 0.01], [0.1, 0, 0]),
}


@pytest.mark.parametrize("name", CASES)
def test_reduced_motions_are_those_of_all_coordinates(name: str) -> None:
    definition, ignored, q, qd = CASES[name]
    here, whole = model(definition, ignored), model(definition, {})
    rates = evaluate(here, ["ignored_rates"], q=q, qd=qd)["ignored_rates"]
    start = dict(zip(here.coordinates, q, strict=True)) | dict.fromkeys(here.ignored, 0.0)
    speeds = {**dict(zip(here.coordinates, qd, strict=True)), **dict(zip(here.ignored, rates, strict=True))}
    options: Plain = {"span": (0, 1), "count": 6, "relative_tolerance": 1e-11, "absolute_tolerance": 1e-12}
    reduced = simulated(here, q=q, qd=qd, **options)
    every = simulated(whole, q=start, qd=speeds, **options)
    assert reduced.is_right
    assert every.is_right
    rest = [whole.coordinates.index(name) for name in here.coordinates]
    np.testing.assert_allclose(reduced.q, every.q[:, rest], atol=2e-8)
    np.testing.assert_allclose(reduced.qd, every.qd[:, rest], atol=2e-7)
    assert reduced.checks[0].name == "energy"


@pytest.mark.parametrize("name", ["pendulum", "top", "gimbals"])
def test_nutations_come_back_after_what_their_energy_says(name: str) -> None:
    """Of one coordinate that is left: shooting beside the integral over the amended potential."""
    definition, ignored, q, _ = CASES[name]
    m = model(definition, ignored)
    moved = simulated(m, q=q, span=(0, 3), count=3001)
    turned = np.flatnonzero((moved.qd[:-1, 0] * moved.qd[1:, 0] < 0) & (moved.t[1:] > 1e-3))
    shooting = Shooting(float(2 * moved.t[turned[0]]), hold=(m.coordinates[0], f"{m.coordinates[0]}'"))
    (orbit,) = periodic_orbits(m, q, shooting).found
    assert orbit.is_right, orbit.message
    assert "quadrature" in [check.name for check in orbit.checks]


def test_equilibria_of_a_governor_are_its_steady_motions() -> None:
    """With the same frequencies and verdicts."""
    here, whole = model("flyball-governor", {"x.turn": "0.3"}), model("flyball-governor", {})
    rests = equilibria(here, starts=[[0.3, 0.3, 0]], count=12, reach=0.4).found
    assert {e.verdict for e in rests} == {"stable", "unstable"}
    for rest in rests:
        rate = float(evaluate(here, ["ignored_rates"], q=rest.q, qd=[0] * 3)["ignored_rates"][0])
        start = dict(zip(here.coordinates, rest.q, strict=True))
        steady = steady_motions(whole, rates={"x.turn": rate}, starts=[[0, *start.values()]], count=1)
        (found,) = (x for x in steady.found if np.allclose(x.q[1:], rest.q, atol=1e-8))
        assert found.verdict == rest.verdict
        assert rest.at.modes is not None
        assert found.modes is not None
        ours, theirs = ([mode.eigenvalue for mode in each] for each in (rest.at.modes, found.modes))
        np.testing.assert_allclose(sorted(ours, key=_order), sorted(theirs, key=_order), rtol=1e-7, atol=1e-5)


def test_bifurcations_over_the_momentum_are_those_of_steady_motions() -> None:
    """Folds and a pitchfork of a governor, over a parameter of the reduced system, or over the momentum."""
    here, whole = model("flyball-governor", {"x.turn": "h"}, {"h": {"value": 0.3}}), model("flyball-governor", {})
    options: Plain = {"between": (0.05, 0.4), "steps": 20, "count": 8}
    ours = steady_motions(here, rates={}, vary="h", starts=[[0.3, 0.3, 0.01]], **options)
    theirs = steady_motions(whole, momenta={}, vary="x.turn", starts=[[0, 0.3, 0.3, 0.01]], **options)
    assert sorted(each.kind for each in ours.bifurcations) == ["fold", "fold", "fold", "pitchfork"]
    for one, other in zip(ours.bifurcations, theirs.bifurcations, strict=True):
        assert one.kind == other.kind
        assert one.at.value == pytest.approx(other.at.value, rel=1e-7)
        np.testing.assert_allclose(one.at.q, other.at.q[1:], atol=1e-5)
    assert [x.verdict for x in ours.found] == [x.verdict for x in theirs.found]


def test_another_cyclic_coordinate_is_refused() -> None:
    with pytest.raises(InvalidDocument) as caught:
        steady_motions(model("gimbal-gyroscope", {"x.spin": "0.05"}), rates={"x.precession": 1.0})
    assert caught.value.faults[0].code == "has-ignored"


def _order(z: complex) -> tuple[float, float]:
    return round(z.imag, 4), round(z.real, 4)
