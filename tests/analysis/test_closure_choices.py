"""Which rows and coordinates of closures are chosen, and where motions end, does not hang on the last bits."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest
from closed_trees import at, bricard, closed_entry, governor, parallelogram, slides
from in_depth import deep, seeds
from random_trees import Plain
from simulated import simulated

from substructures import Model
from substructures.analysis.closed.branches import change, singular_part
from substructures.analysis.closed.constrained import Singular
from substructures.analysis.closed.jacobian import Rows
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.closed.pivoting import pivoted
from substructures.analysis.simulate import ClosedMotion, Integrator, Outputs, simulate

from .closed_motions import METHODS, right

PIN: Plain = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
PLANAR = ("pin.z", "pin.rx", "pin.ry")
#: of Bricard's linkage with two angles: cos a + cos b + cos a cos b = 0
A = 1.9
B = float(np.arccos(-np.cos(A) / (1 + np.cos(A))))
Noise = Callable[[float], float]


def bar(*lengths: float, closures: tuple[Plain, ...] = (PIN,)) -> Callable[[Noise], Model]:
    """A four-bar linkage: frame, crank, coupler, rocker [m]."""

    def make(noise: Noise) -> Model:
        return closed_entry("four-bar", list(closures), **{f"l{k}": noise(x) for k, x in enumerate(lengths)})

    return make


#: model, position, dependent rows, independent coordinates: of equal ones the first is dependent
SYMMETRIC: dict[str, tuple[Callable[[Noise], Model], list[float], tuple[str, ...], tuple[str, ...]]] = {
    "two cranks and a rod": (lambda _: parallelogram(), [0.4, 0.4], (), ("x.b",)),
    "parallelogram": (bar(0.3, 0.2, 0.3, 0.2), [0.5, -0.5, 0.5], PLANAR, ("x.rocker",)),
    "rhombus": (bar(0.3, 0.3, 0.3, 0.3), [0.5, -0.5, 0.5], PLANAR, ("x.rocker",)),
    "square": (bar(0.3, 0.3, 0.3, 0.3), [np.pi / 2, -np.pi / 2, np.pi / 2], PLANAR, ("x.rocker",)),
    "two equal pins": (
        bar(0.3, 0.2, 0.3, 0.2, closures=(PIN, PIN | {"name": "again"})),
        [0.5, -0.5, 0.5],
        (*PLANAR, *(f"again.{row}" for row in ("x", "y", "z", "rx", "ry"))),
        ("x.rocker",),
    ),
    "trapezium": (bar(0.4, 0.2, 0.2, 0.2), [np.pi / 3, -np.pi / 3, 2 * np.pi / 3], PLANAR, ("x.coupler",)),
    "slides": (lambda _: slides(), [np.sqrt(0.5), np.sqrt(0.5)], (), ("x.y",)),
    "bricard": (lambda noise: bricard(size=noise(1.0)), [A, B, A, B, A], ("hinge.y",), ("l3.q",)),
    "governor": (lambda _: governor(), [0.5, 0.5, 0.5, 0.5], (), ("x.turn", "x.left")),
}


@pytest.mark.parametrize("name", SYMMETRIC)
def test_of_equal_rows_and_coordinates_the_first_is_dependent(name: str) -> None:
    make, q, dependent, independent = SYMMETRIC[name]
    rng = np.random.default_rng(3)
    for k in range(10):
        place = loop_state(make(partial(_noisy, rng, k)), [_noisy(rng, k, x) for x in q]).mobility
        assert (place.dependent, place.independent_coordinates) == (dependent, independent), k


def _noisy(rng: np.random.Generator, size: int, x: float) -> float:
    """Some units in the last place away."""
    return float(x * (1 + size * 1e-16 * rng.uniform(-1, 1)))


@pytest.mark.parametrize("seed", seeds(1, 4))
@pytest.mark.parametrize("method", METHODS)
def test_no_step_passes_a_dead_centre(method: str, seed: int) -> None:
    """Parallelograms swing to where all their links are in line, however long the steps are and wherever they begin."""
    rng = np.random.default_rng(seed)
    lengths = [(0.3, 0.2, 0.3, 0.2), (0.3, 0.3, 0.3, 0.3), (1.0, 0.1, 1.0, 0.1)]
    for k in range(9):
        model = bar(*lengths[k % 3])(float)
        angle, speed, tolerance = rng.uniform(0.2, 1.5), rng.uniform(1, 8), 10 ** rng.uniform(-10, -3)
        motion = simulate(
            model,
            at(model, crank=angle, coupler=-angle, rocker=angle),
            (0, 2 * angle / speed),
            qd=at(model, crank=-speed),
            kind=ClosedMotion(fixed=["x.crank"], reduction=method),
            integrator=Integrator(relative_tolerance=tolerance, absolute_tolerance=tolerance / 100),
            outputs=Outputs(count=5),
        )
        assert motion.status == "failed"
        assert "singular" in motion.message or "dead centre" in motion.message
        # the velocities of parallelograms without loads are constant
        np.testing.assert_allclose(motion.t[-1], angle / speed, rtol=0.03)


@pytest.mark.parametrize("longer", [1.001, 0.999, *deep(1.02, 0.98)])
@pytest.mark.parametrize("method", METHODS)
def test_beside_a_dead_centre_a_motion_stays_on_its_branch(method: str, longer: float) -> None:
    """With a coupler beside its length nothing branches: a longer one turns the crank back where it is in line with the
    rocker, cos a = (l0^2 + l1^2 - (l2 - l3)^2) / (2 l0 l1), and a shorter one lets it through.
    """
    model = bar(0.3, 0.2, 0.3 * longer, 0.2)(float)
    request: Plain = {"q": at(model, crank=0.5, coupler=-0.5, rocker=0.5), "qd": at(model, crank=-3)}
    motion = simulated(model, **request, span=(0, 0.4), fixed=["x.crank"], reduction=method, count=1001)
    right(motion)
    limit = (0.3**2 + 0.2**2 - (0.3 * longer - 0.2) ** 2) / (2 * 0.3 * 0.2)
    least = motion.q[:, 0].min()
    if longer > 1:
        np.testing.assert_allclose(least, np.arccos(limit), atol=1e-3)
    else:
        assert least < -0.2


def rows(x: float, y: float) -> Rows:
    """G of phi = x y, whose branches are both axes; they cross in the origin."""
    return Rows(np.array([[y, x]]))


def test_how_far_one_branch_reaches() -> None:
    """Along an axis G changes by its own length up to the origin, and farther to any place on the other axis."""
    assert change(rows(1, 0), rows(0.75, 0)) == pytest.approx(1 / 3)
    assert change(rows(1, 0), rows(-1, 0)) == pytest.approx(2)
    assert min(change(rows(1, 0), rows(0, y)) for y in np.linspace(-3, 3, 61)) > 1
    # rows in other units, or added to each other, say the same
    mixing = np.array([[1e3, 0], [3, 1e-2]])
    one, other = np.array([[1, 2, 0], [0, 1, 1.0]]), np.array([[1.1, 2, 0.1], [0, 0.9, 1.0]])
    found = change(Rows(one), Rows(other))
    assert found < 0.5
    assert change(Rows(mixing @ one), Rows(mixing @ other)) == pytest.approx(found, rel=1e-6)
    # a bound is enough where it is below what is asked for, and never below the change
    for enough in np.linspace(0, 1, 11):
        bound = change(Rows(one), Rows(other), enough)
        assert bound == pytest.approx(found) or found < bound <= enough


def along(part: float) -> Rows | None:
    """From (1, 0) through the origin to (-1, 0)."""
    return None if abs(1 - 2 * part) < 1e-3 else rows(1 - 2 * part, 0)


def leaping(part: float) -> Rows:
    """From one axis to the other, beside the origin."""
    return rows(1 - part, 0) if part < 0.3 else rows(0, 1 - part)


def hyperbola(part: float) -> Rows:
    """Along x y = 0.01, which has no singular position."""
    u = 3 - 6 * part
    return rows(0.1 * np.exp(u), 0.1 * np.exp(-u))


def test_steps_are_looked_into() -> None:
    passed = singular_part(along, rows(1, 0), rows(-1, 0))
    assert passed is not None
    assert abs(passed - 0.5) < 1e-3
    with pytest.raises(Singular):
        singular_part(leaping, leaping(0), leaping(1))

    assert singular_part(hyperbola, hyperbola(0), hyperbola(1)) is None


def test_columns_in_the_order_of_what_they_add() -> None:
    """As of a QR decomposition with pivoting, where no two are equal; of equal ones the first."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        columns = rng.standard_normal((4, 7))
        order = pivoted(columns, 4)
        assert sorted(order) == list(range(7))
        left = columns.copy()
        for k in range(4):
            sizes = np.linalg.norm(left, axis=0)
            assert order[k] == sizes.argmax()
            basis = np.linalg.qr(columns[:, order[: k + 1]])[0]
            left = columns - basis @ (basis.T @ columns)
    equal = np.array([[1, 1 + 1e-15, 0], [0, 0, 1 + 1e-14]])
    assert pivoted(equal, 2).tolist() == [0, 2, 1]
