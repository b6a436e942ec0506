"""First integrals of trees with velocity constraints: energy where they do not move, and what Noether leaves."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain
from rolling_bodies import disc_part, sleigh_part

from substructures import ConstrainedMotion, Model, simulate
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.nonholonomic.constrained_formulas import ConstrainedFormulas
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret

EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
FLOOR = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}


def tied(part: Plain, constraints: list[Plain], gravity: Any = (0, 0, 0)) -> Model:
    tree = {"gravity": list(gravity), "instances": [{"name": "s", "substructure": "p"}]}
    return tree_model({**tree, "velocity_constraints": constraints}, {"p": part})


def test_a_sleigh_keeps_its_energy_alone() -> None:
    """Without the blade it also keeps momentum and angular momentum; with it neither."""
    found = first_integrals(tied(sleigh_part(), [EDGE]))
    assert [(i.name, i.rule) for i in found.integrals] == [("energy", "constant")]
    assert "'blade' do no work" in found.integrals[0].reason
    assert found.cyclic == ()
    assert "velocity constraints" in found.searched


def test_what_the_constraint_leaves_free() -> None:
    """A rail along x for the origin of a body: p_x stays, p_y does not (Noether's theorem with constraints)."""
    rail = {"name": "rail", "type": "linear", "expression": "s.y'"}
    model = tied(sleigh_part(), [rail])
    found = first_integrals(model)
    assert {i.name for i in found.integrals} == {"energy", "linear_momentum.x", "galilei.x"}
    assert found.cyclic == ("s.x",)
    kind = ConstrainedMotion(constraints_of(model), v=[0.7, 1.3], independent=["s.x", "s.f"])
    motion = simulate(model, [0, 0, 0.4], (0, 2), kind=kind)
    values: dict[str, Any] = {s.name: 0.0 for s in found.program.symbols}
    values |= {name: x["value"] for name, x in model.parameters.items() if name in values}
    values = {name: float(x) for name, x in values.items()}
    values |= dict(zip(model.coordinates, motion.q.T, strict=True))
    values["t"] = motion.t
    values |= dict(zip((f"{name}'" for name in model.coordinates), motion.qd.T, strict=True))
    for integral in found.integrals:
        along = interpret(found.program, values, [integral.name])[integral.name]
        assert np.ptp(along) < 1e-9, integral.name


def test_constraints_that_move_do_work() -> None:
    """A belt that carries a body along y: p_x stays, and its speed along y costs power."""
    belt = {"name": "belt", "type": "linear", "expression": "s.y' - 1"}
    found = first_integrals(tied(sleigh_part(), [belt]))
    assert {i.name for i in found.integrals} == {"linear_momentum.x", "galilei.x"}


def test_a_rolling_disc_keeps_its_energy() -> None:
    """In the plane of the floor its momenta are those of the contact, which pushes."""
    found = first_integrals(tied(disc_part(), [FLOOR], (0, 0, -9.81)))
    assert [(i.name, i.rule) for i in found.integrals] == [("energy", "constant")]


def test_the_certificate_finds_what_the_constraints_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """Momenta that are taken for constant though the blade pushes, and an energy though a belt works."""
    monkeypatch.setattr(ConstrainedFormulas, "constraint_rows", {})
    oblique = {"name": "oblique", "type": "linear", "expression": "s.x' + 2*s.y'"}
    with pytest.raises(VerificationFailed, match="changes along the motion"):
        first_integrals(tied(sleigh_part(), [oblique]))
    monkeypatch.undo()
    monkeypatch.setattr(ConstrainedFormulas, "is_scleronomic", True)
    belt = {"name": "belt", "type": "linear", "expression": "s.y' - 2"}
    with pytest.raises(VerificationFailed, match="do work"):
        first_integrals(tied(sleigh_part(), [belt]))
