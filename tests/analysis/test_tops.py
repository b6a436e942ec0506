"""The integrable tops: Euler's and Lagrange's in elliptic functions, Kovalevskaya's integral of degree four."""

from __future__ import annotations

from typing import Any

import numpy as np
from closed_trees import tree_model
from random_trees import Plain
from scipy.special import ellipj, ellipk

from substructures import Model, simulate
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.simulate import Outputs
from substructures.quantities.numbers.evaluation import evaluate

GRAVITY = 9.81
FINE = Integrator(relative_tolerance=1e-12, absolute_tolerance=1e-13)
Numbers = np.ndarray[Any, Any]


def top(inertia: list[float], com: list[float], gravity: float = GRAVITY) -> Model:
    """1 kg about a fixed point, with moments of ``inertia`` about this point."""
    x, y, z = com
    steiner = [y * y + z * z, x * x + z * z, x * x + y * y]
    own = {k: i - s for k, i, s in zip(("xx", "yy", "zz"), inertia, steiner, strict=True)}
    joint = {"type": "spherical", "coordinate": ["a", "b", "c"]}
    body: Plain = {"name": "top", "parent": "base", "joint": joint, "mass": 1, "com": com, "inertia": own}
    tree: Plain = {"gravity": [0, 0, -gravity], "instances": [{"name": "s", "substructure": "p"}]}
    return tree_model(tree, {"p": {"name": "top", "bodies": [body]}})


def moved(model: Model, q: list[float], rates: list[float], end: float) -> tuple[Numbers, Numbers, Numbers]:
    """Times, rates of rotation (K, 3), and the vertical (K, 3), in the axes of the body, from ``rates`` on."""

    def columns(at: Any) -> Any:
        """Omega (K, 3, 3), column by column, and the rotation to the world."""
        found = evaluate(model, "kinematics", at)["kinematics"]
        k = model.frames.index("s.top")
        return np.swapaxes(found["Omega"][..., k, :, :], -1, -2), found["rotation"][..., k, :, :]

    qd = np.linalg.solve(columns(q)[0], rates)
    found = simulate(model, q, (0, end), qd=qd, integrator=FINE, outputs=Outputs(count=41))
    assert found.is_right, found.checks
    turning, rotation = columns(found.q)
    return found.t, (turning @ found.qd[:, :, None])[:, :, 0], rotation[:, 2, :]


def test_eulers_top() -> None:
    """No torque: rates are cn, sn, dn of the time (L. D. Landau, E. M. Lifshitz, Mechanics, section 37)."""
    A, B, C = inertia = [0.5, 0.8, 1.1]  # noqa: N806
    p, r = 0.9, 1.3
    t, found, _ = moved(top(inertia, [0, 0, 0], 0), [0, 0, 0], [p, 0, r], 4)
    E, M = A * p * p + C * r * r, A * A * p * p + C * C * r * r  # noqa: N806 -- twice the energy, momentum squared
    assert M > E * B
    pace = np.sqrt((C - B) * (M - E * A) / (A * B * C))
    sn, cn, dn, _ = ellipj(pace * t, (B - A) * (E * C - M) / ((C - B) * (M - E * A)))
    q = np.sqrt((E * C - M) / (B * (C - B)))
    np.testing.assert_allclose(found, np.stack([p * cn, q * sn, r * dn], axis=1), atol=1e-10)


def test_lagranges_top() -> None:
    """cos of the tilt is u1 + (u2 - u1) sn^2, between roots of u'^2 = (e - b u)(1 - u^2) - (c - a u)^2 (the same book,
    section 35; H. Goldstein, Classical Mechanics, section 5-7), let go without precession.
    """
    A, C, length, spin, tilt = 0.6, 0.2, 0.4, 20.0, 0.5  # noqa: N806
    model = top([A, A, C], [0, 0, length])
    t, rates, vertical = moved(model, [0, 0, tilt], [0, 0, spin], 1.5)
    np.testing.assert_allclose(rates[:, 2], spin, atol=1e-9)
    u2 = np.cos(tilt)
    a, b = C * spin / A, 2 * GRAVITY * length / A
    c, e = a * u2, b * u2
    roots = np.sort(np.roots([b, -e - a * a, 2 * a * c - b, e - c * c]).real)
    assert np.isclose(roots, u2).any()
    u1, _, u3 = roots
    part = (u2 - u1) / (u3 - u1)
    sn = ellipj(ellipk(part) + np.sqrt(b * (u3 - u1)) / 2 * t, part)[0]
    np.testing.assert_allclose(vertical[:, 2], u1 + (u2 - u1) * sn**2, atol=1e-10)
    assert np.ptp(vertical[:, 2]) > 0.05


def test_kovalevskayas_top() -> None:
    """A = B = 2 C, the mass centre on the first axis: |(p + i q)^2 - (m g l / C)(g1 + i g2)|^2 is constant for the
    vertical g in the axes of the body (S. Kowalevski, Acta Mathematica 12, 1889).
    """
    C, length = 1.0, 0.5  # noqa: N806
    t, rates, vertical = moved(top([2 * C, 2 * C, C], [length, 0, 0]), [0.2, 0.1, 0.7], [0.5, -0.4, 0.9], 3)
    w = rates[:, 0] + 1j * rates[:, 1]
    found = np.abs(w**2 - GRAVITY * length / C * (vertical[:, 0] + 1j * vertical[:, 1])) ** 2
    np.testing.assert_allclose(found, found[0], rtol=1e-9)
    assert np.ptp(np.abs(w)) > 0.3
    assert len(t) == len(found)
