"""Steady motions with ball joints: sleeping tops, and rotors that hold pendulums up."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from substructures import Model, couple, derive, simulate, steady_motions
from substructures.errors import InvalidInput

Plain = dict[str, Any]
G, MASS, ARM, A, C = 9.81, 2.0, 0.3, 0.5, 0.2
UPRIGHT, HANGING = 1.0, -1.0


def model_of(*bodies: Plain, gravity: Any = (0, 0, "-9.81")) -> Model:
    tree = {"name": "t", "gravity": list(gravity), "instances": [{"name": "x", "substructure": "d"}]}
    return couple(tree, {"x": derive({"name": "d", "bodies": list(bodies)})})


def top(more: str = "0") -> Plain:
    """A about its point across its axis, C about it; ``more``: what a rotor has of both."""
    across = f"1/2-2*(3/10)^2-{more}"
    inertia = {"xx": across, "yy": across, "zz": f"1/5-{more}"}
    joint = {"type": "ball"}
    return {"name": "b", "parent": "base", "mass": 2, "com": [0, 0, "3/10"], "inertia": inertia, "joint": joint}


def verdicts(model: Model, rates: dict[str, float]) -> dict[float, Any]:
    """Of the places by the cosine of the tilt."""
    found = steady_motions(model, rates=rates, count=8)
    assert found.is_right
    places = {}
    for each in found.found:
        w, x, y, z = each.q[:4]
        places[round(float(1 - 2 * (x * x + y * y) / (w * w + x * x + y * y + z * z)), 9)] = each
    return places


@pytest.mark.parametrize(("share", "expected"), [(0.9, "unstable"), (1.1, "stable")])
def test_a_top_sleeps_when_it_is_fast(share: float, expected: str) -> None:
    """C^2 w^2 > 4 A m g l (J. L. Lagrange; N. G. Chetaev's proof by integrals); hanging it is stable at any rate."""
    w = share * np.sqrt(4 * A * MASS * G * ARM) / C
    found = verdicts(model_of(top()), {"x.w_b_z": w})
    assert {*found} == {UPRIGHT, HANGING}
    assert found[UPRIGHT].verdict == expected
    assert found[HANGING].verdict == "stable"
    assert found[UPRIGHT].moving == ("x.w_b_z",)
    np.testing.assert_allclose(found[UPRIGHT].momenta, [C * w], rtol=1e-12)
    motion = simulate(model_of(top()), found[UPRIGHT].q, (0, 5), qd=[0.001, 0, w])
    tilt = np.hypot(motion.q[:, 1], motion.q[:, 2]).max()
    assert (tilt < 0.01) == (expected == "stable")


@pytest.mark.parametrize(("share", "expected"), [(0.9, "unstable"), (1.1, "stable")])
def test_a_rotor_holds_a_pendulum_up(share: float, expected: str) -> None:
    """It alone turns, with the momentum h: h^2 > 4 A m g l, whatever the body is about its axis."""
    rotor = {
        "name": "rotor",
        "parent": "b",
        "inertia": {"xx": "1/20", "yy": "1/20", "zz": "1/10"},
        "joint": {"type": "revolute", "coordinate": "turn"},
    }
    h = share * np.sqrt(4 * A * MASS * G * ARM)
    found = verdicts(model_of(top("1/20"), rotor), {"x.turn": h / 0.1})
    assert found[UPRIGHT].moving == ("x.w_b_z", "x.turn")
    np.testing.assert_allclose(found[UPRIGHT].momenta, [h, h], rtol=1e-12)
    assert found[UPRIGHT].verdict == expected
    assert found[HANGING].verdict == "stable"


def test_what_is_not_known_says_so() -> None:
    model = model_of(top())
    with pytest.raises(InvalidInput, match="no cyclic rate; there are: x"):
        steady_motions(model, rates={"x.w_b_x": 1})


@pytest.mark.parametrize("length", ["1/1000", "1000"])
def test_a_top_of_any_size_sleeps_when_it_is_fast(length: str) -> None:
    """C^2 w^2 > 4 A m g l, of mass l^3."""
    across, along = (f"{x}*({length})^5" for x in (0.32, 0.2))
    body: Plain = {"name": "b", "parent": "base", "mass": f"2*({length})^3", "com": [0, 0, f"3/10*({length})"]}
    model = model_of(body | {"inertia": {"xx": across, "yy": across, "zz": along}, "joint": {"type": "ball"}})
    slowest = np.sqrt(4 * 0.5 * 2 * G * 0.3 / float(Fraction(length))) / 0.2
    assert verdicts(model, {"x.w_b_z": 1.1 * slowest})[UPRIGHT].verdict == "stable"
