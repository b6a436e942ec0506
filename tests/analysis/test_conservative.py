"""Conservative forces: what energy and stability say where forces are given as formulas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_trees import Plain, model_of

from substructures import Model
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.integral import Integral
from substructures.analysis.simulate import Outputs, simulate
from substructures.analysis.stability.equilibria import equilibria

DIRICHLET = "the potential energy has a strict minimum (Lagrange, Dirichlet)"


def slide(*loads: Plain, **joint: Any) -> Model:
    body = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"} | joint}
    return model_of({"name": "a", "bodies": [body], "loads": list(loads)}, (0, 0, 0))


def plane(x: str, y: str) -> Model:
    """A mass on two slides across each other with springs 4 and 5, and forces besides."""
    bodies: list[Plain] = [
        {"name": "a", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x", "stiffness": 4}},
        {
            "name": "b",
            "parent": "a",
            "mass": 2,
            "joint": {"type": "prismatic", "coordinate": "y", "theta": "pi/2", "stiffness": 5},
        },
    ]
    loads = [{"type": "joint", "coordinate": c, "force": f} for c, f in (("x", x), ("y", y))]
    return model_of({"name": "a", "bodies": bodies, "loads": loads}, (0, 0, 0))


def law(force: str) -> Plain:
    return {"type": "joint", "coordinate": "x", "force": force}


def energy(model: Model) -> Integral:
    return next(i for i in first_integrals(model).integrals if i.kind == "energy")


def at_zero(model: Model) -> Any:
    found = equilibria(model, count=0).found
    assert len(found) == 1
    return found[0].at.stability


SPRING = {"type": "spring", "from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "b"}}


@pytest.mark.parametrize(
    "model",
    [
        slide(law("-4*x")),
        slide(law("-4*sin(x) - x^3")),
        slide(stiffness="4*(1 + x^2)"),
        slide({"type": "potential", "potential": "2*x^2"}),
        slide(SPRING | {"stiffness": "4*(1 + x^2)"}),
        plane("-x*y^2", "-x^2*y"),
    ],
)
def test_a_force_with_a_potential(model: Model) -> None:
    assert energy(model).rule == "constant"
    assert at_zero(model).verdict == "stable"
    assert at_zero(model).reason == DIRICHLET
    motion = simulate(model, [0.4] * model.dof, (0, 3), qd=[1.0] * model.dof, outputs=Outputs(count=5))
    assert motion.is_right
    assert [(c.name, c.rule) for c in motion.checks] == [("energy", "constant"), ("steps", "accurate")]


def test_a_potential_that_is_not_in_closed_form_still_decides() -> None:
    """A spring of rest length 0.3 with k = 4 (1 + x^2): the energy is balanced, the verdict is that of Dirichlet."""
    model = slide(SPRING | {"stiffness": "4*(1 + x^2)", "length": 0.3})
    assert energy(model).rule == "balance"
    assert "'x.x' have a potential, but none in closed form" in energy(model).reason
    assert at_zero(model).verdict == "stable"
    assert simulate(model, [0.4], (0, 3), qd=[1.0], outputs=Outputs(count=5)).is_right


def test_a_curl_away_from_the_place_of_rest_is_seen() -> None:
    """x y on x alone: K is symmetric and positive definite at 0, and yet there is no potential to speak of."""
    model = plane("x*y", "0")
    assert energy(model).rule == "balance"
    assert "at rest those on 'x.x'" in energy(model).reason
    assert at_zero(model).verdict == "undecided"
    # with its partner x^2/2 on y it has one: V = -x^2 y/2
    whole = plane("x*y", "x^2/2")
    assert energy(whole).rule == "constant"
    assert at_zero(whole).verdict == "stable"


def test_dampers_beside_a_law() -> None:
    """-4 x - 0.3 x' in one formula; a damper that depends on the place takes the proof away, not the energy's rule."""
    both = slide(law("-4*x - 0.3*x'"))
    assert energy(both).rule == "falling"
    assert at_zero(both).verdict == "asymptotically stable"
    local = slide(law("-4*x - x^2*x'"))
    assert energy(local).rule == "falling"
    assert at_zero(local).verdict == "undecided"


@pytest.mark.parametrize("force", ["-2*(sqrt(x'^2) - x')", "-3*(sqrt((x - 9)^2) + x - 9)*x'"])
def test_a_force_that_acts_on_one_side_only_is_not_zero(force: str) -> None:
    """It vanishes for x' > 0, or for x < 9, and was taken for nothing where only such states were looked at."""
    found = first_integrals(slide(law(force)))
    assert {i.name: i.rule for i in found.integrals} == {"energy": "falling"}


def test_a_two_sided_damper_is_even_where_a_one_sided_one_is_not() -> None:
    """|x'| has no derivative at rest: the linearisation says so; a stop far away is no part of the motion near 0."""
    assert equilibria(slide(law("-sqrt(x'^2)"), stiffness=1), count=0).found[0].at.status == "failed"
    smooth = equilibria(slide(law("-sqrt(x'^2)*x'"), stiffness=1), count=0).found[0].at
    assert smooth.status == "finished"
    np.testing.assert_allclose(smooth.D, 0, atol=1e-8)
    far = slide(law("-3*(sqrt((x - 9)^2) + x - 9)*x'"), stiffness=1)
    assert at_zero(far).verdict == "stable"
    np.testing.assert_allclose(equilibria(far, count=0).found[0].at.D, 0, atol=1e-12)
