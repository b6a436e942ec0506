"""Identified inertia that belongs to a distribution of mass, and new versions of parts with it."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from substructures import Definition, InvalidInput, couple, derive
from substructures.analysis.identification.consistent import consistent_inertia
from substructures.analysis.identification.findings import ConsistentInertia, Identification, pseudo_inertia
from substructures.analysis.identification.fit import identify
from substructures.analysis.identification.new_versions import new_versions
from substructures.array import Array
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.states import default_numbers
from substructures.quantities.regressor import regressor

from .identified_motions import IN_PLANE, base_of, motion, tree

ARM = ("planar-3r", IN_PLANE)


def forces(samples: int = 120) -> Array:
    found = evaluate(couple(*tree(*ARM)), ["inverse_dynamics"], **motion(3, samples))["inverse_dynamics"]
    return np.asarray(found, dtype=np.float64)


@cache
def identified(noise: float, samples: int = 120) -> tuple[Identification, ConsistentInertia]:
    tau = forces(samples)
    tau = tau + np.random.default_rng(3).normal(0, noise, tau.shape)
    base = base_of(*ARM)
    found = identify(base, **motion(3, samples), tau=tau, model=couple(*tree(*ARM)), held_out=0.25)
    return found, consistent_inertia(base, regressor(*tree(*ARM)), found)


def test_pseudo_inertia_of_points() -> None:
    """Of points of mass it is sum m (x, 1)(x, 1)^T, positive; the triangle inequality alone would allow more."""
    rng = np.random.default_rng(1)
    x, m = rng.normal(size=(5, 3)), rng.uniform(0.1, 1, 5)
    y = np.concatenate([x, np.ones((5, 1))], axis=1)
    P = np.einsum("k,ki,kj->ij", m, y, y)
    ten = np.array([P[3, 3], *P[3, :3], P[0, 0], P[1, 1], P[2, 2], P[0, 1], P[0, 2], P[1, 2]])
    np.testing.assert_allclose(pseudo_inertia(ten), P)
    assert np.linalg.eigvalsh(P)[0] > 0


@pytest.mark.parametrize("noise", [0, 0.5, 20])
def test_every_body_is_consistent(noise: float) -> None:
    """Whatever the noise; where it is large, the best base parameters are those of no bodies."""
    found, inertia = identified(noise)
    assert inertia.is_right
    assert all(np.linalg.eigvalsh(inertia.of(link))[0] > 0 for link in inertia.links)
    base = base_of(*ARM)
    values = default_numbers(base.parameters)
    beta = interpret(base.program, values, ["grouping"])["grouping"] @ inertia.values
    # as near as noise allows: chi^2 of b parameters
    assert inertia.misfit < 4
    assert np.all(np.abs(beta - found.values) < 5 * found.deviations + 1e-4 * np.abs(found.values).max())


def test_samples_that_are_held_out() -> None:
    found, _ = identified(0.5)
    assert found.held_out is not None
    np.testing.assert_allclose(found.held_out, 0.5, rtol=0.3)
    assert "held-out force" in [check.name for check in found.checks]
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), found.deviations)
    with pytest.raises(InvalidInput, match="held_out"):
        identify(base_of(*ARM), **motion(3, 20), tau=forces(20), held_out=1)


def test_a_new_version_moves_as_was_measured() -> None:
    """The stored definition is derived, and its inverse dynamics explains the forces without noise."""
    spec, parts = tree(*ARM)
    _, inertia = identified(0.5)
    document = new_versions(spec, parts, inertia)["x"]
    assert document.pop("derived_from") == "planar-3r"
    model = couple(spec, {"x": derive(Definition.read(document))})
    clean, data = forces(), motion(3, 120)
    tau = evaluate(model, ["inverse_dynamics"], **data)["inverse_dynamics"]
    left, size = np.sqrt(np.mean((tau - clean) ** 2, axis=0)), np.sqrt(np.mean(clean**2, axis=0))
    assert np.all(left < 0.5)
    assert np.all(left < 0.1 * size)
    # the inertia of the document is that which was found, with known viscous friction and the like beside it
    again = regressor(spec, {"x": derive(Definition.read(document))})
    values = default_numbers(again.parameters)
    told = interpret(again.program, values, ["inertial_parameters"])["inertial_parameters"]
    np.testing.assert_allclose(told, inertia.values, rtol=1e-9, atol=1e-12)


def test_what_is_not_excited_is_refused() -> None:
    base = base_of(*ARM)
    still = {"q": np.zeros((20, 3)), "qd": np.zeros((20, 3)), "qdd": np.zeros((20, 3))}
    found = identify(base, **still, tau=np.zeros((20, 3)))
    with pytest.raises(InvalidInput, match="move more joints") as error:
        consistent_inertia(base, regressor(*tree(*ARM)), found)
    assert error.value.faults[0].code == "not-excited"
