"""Identified inertia that belongs to a distribution of mass, and new versions of parts with it."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from substructures import Definition, InvalidInput, Model, TreeSpec, couple, derive
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.consistent import consistent_inertia
from substructures.analysis.identification.findings import ConsistentInertia, Identification, pseudo_inertia
from substructures.analysis.identification.fit import identify
from substructures.analysis.identification.new_versions import new_versions
from substructures.array import Array
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel

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


MASS = {"name": "b", "parent": "base", "mass": 2, "joint": {"type": "prismatic", "coordinate": "s"}}


def of_a_mass(force: str) -> tuple[Model, RegressorModel, BaseParameters]:
    """On a slide without gravity, under a force of its own."""
    loads = [{"type": "joint", "coordinate": "s", "force": force}]
    part = {"name": "m", "bodies": [MASS], "loads": loads, "parameters": {"k": {"value": 1, "unit": "N/m"}}}
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "m"}]})
    parts = {"x": derive(part)}
    Y = regressor(spec, parts)
    return couple(spec, parts), Y, base_parameters(Y)


def test_what_is_known_has_the_parameters_that_are_given() -> None:
    """tau = m q'' + k q, also as one number for each state; k is no parameter of the base parameters."""
    model, _, base = of_a_mass("-k*s")
    q, qdd = np.array([0.1, 0.5, -0.2, 0.3]), np.array([1.0, -2, 3, 1])
    for tau in (2 * qdd + 5 * q, (2 * qdd + 5 * q)[:, None]):
        found = identify(base, q, None, qdd, tau, model=model, parameters={"x.k": 5})
        np.testing.assert_allclose(found.values, [2], rtol=1e-14)
    with pytest.raises(InvalidInput, match=r"unknown parameter 'x\.c'"):
        identify(base, q, None, qdd, qdd, model=model, parameters={"x.c": 5})
    with pytest.raises(InvalidInput, match=r"unknown parameter 'x\.k'"):
        identify(base, q, None, qdd, qdd, parameters={"x.k": 5})


def test_known_loads_do_not_depend_on_a_time_that_samples_lack() -> None:
    model, _, base = of_a_mass("-k*s*sin(t)")
    with pytest.raises(InvalidInput, match="depend on the time"):
        identify(base, [0, 1], None, [1, 2], [2, 4], model=model)


def test_a_force_that_is_explained_to_the_last_bit_has_consistent_inertia() -> None:
    """Deviations are 0 then."""
    _, Y, base = of_a_mass("-k*s")
    found = identify(base, [0, 1], None, [1, 2], [2, 4])
    assert found.deviations == [0]
    inertia = consistent_inertia(base, Y, found)
    assert inertia.is_right
    assert inertia.values[0] == pytest.approx(2, rel=1e-3)
