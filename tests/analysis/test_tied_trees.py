"""Velocity constraints as part of a tree: motions and linearisations have them by themselves, all else says so."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain
from rolling_bodies import BLADE, FORWARD, FRONT, REAR, bicycle_part, sleigh, sleigh_part

from substructures import (
    ConstrainedMotion,
    Model,
    catalogue,
    linearise,
    simulate,
)
from substructures.analysis.equations.nonholonomic.independent_rows import check_constraints, constraints_of
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.from_fields import linearisation_arguments, motion_arguments
from substructures.analysis.simulate import Closed, Linear, TreeMotion
from substructures.analysis.stability.linearisation_result import ConstrainedLinearisation
from substructures.documents import read_json
from substructures.errors import InvalidInput, VerificationFailed
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.certificate import certify_tree
from substructures.tree.document import TreeSpec

EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}


def tied(part: Plain, constraints: list[Plain], gravity: Any = (0, 0, 0), **more: Any) -> Model:
    tree = {"gravity": list(gravity), "instances": [{"name": "s", "substructure": "p"}], **more}
    return tree_model({**tree, "velocity_constraints": constraints}, {"p": part})


def wheels() -> list[Plain]:
    return [
        {"name": "rear", "type": "rolling", "frame": "s.rear_axle", "radius": {"value": 300, "unit": "mm"}},
        {"name": "front", "type": "rolling", "frame": "s.front_axle", "radius": FRONT},
    ]


def test_a_bicycle_has_its_wheels() -> None:
    """The benchmark bicycle as a tree with two rolling wheels: its linearisation has the eigenvalues of the paper
    (table 2, 5 m/s; J. P. Meijaard et al., Proc. R. Soc. A 463, 2007), and its simulation rolls.
    """
    model = tied(bicycle_part(), wheels(), [0, 0, -9.81])
    check_constraints(model)
    q, kind = [0, 0, REAR, 0, 0, 0, 0, 0, 0], ["s.lean", "s.steer", "s.rear"]
    fields = linearisation_arguments(model, q=q, independent=kind, v={"s.rear'": 5 / REAR})
    found = linearise(model, **fields)
    assert isinstance(found, ConstrainedLinearisation)
    published = [-14.07838969279822, -0.77534188219585 + 4.46486771378823j, -0.32286642900409]
    eigenvalues = sorted((mode.eigenvalue for mode in found.modes if abs(mode.eigenvalue) > 1e-9), key=lambda z: z.real)
    np.testing.assert_allclose(eigenvalues, published, rtol=1e-12)
    assert isinstance(linearise(model, q), ConstrainedLinearisation)
    asked: Plain = {"span": (0, 0.5), "count": 3, "independent": kind, "v": {"s.rear'": 5 / REAR, "s.lean'": 0.1}}
    motion = simulate(model, q, **motion_arguments(model, **asked))
    assert motion.is_right
    assert np.abs(motion.series["constraints"]).max() < 1e-9


def test_motions_are_those_with_the_same_constraints_beside_the_tree() -> None:
    model, start = tied(sleigh_part(), [EDGE]), {"q": [0, 0, 0.4], "span": (0, 2)}
    check_constraints(model)
    assert model.program.digest == sleigh().program.digest
    told = {"velocities": FORWARD, "v": {"u": 2, "w": 1}}
    own = simulate(model, **motion_arguments(model, **start, **told))
    beside = simulate(sleigh(), **start, kind=ConstrainedMotion([BLADE], **told))
    np.testing.assert_array_equal(own.q, beside.q)
    assert simulate(model, **start).is_right
    equations, others = (quasi_velocity_equations(m, c) for m, c in ((model, ()), (sleigh(), (BLADE,))))
    assert equations.program.digest == others.program.digest
    # a model out of a store has them, too
    again = Model.load(read_json(b'{"velocity_constraints": []}') | model.summary(), model.program.to_bytes())
    assert again.velocity_constraints == model.velocity_constraints


def test_what_is_left_of_it() -> None:
    """Formulas are those of the tree without them, and what is of its motion says so."""
    model = tied(sleigh_part(), [EDGE])
    assert evaluate(model, ["metric", "inverse_dynamics"], [0, 0, 0], qdd=[0, 0, 0])
    refused = [
        lambda: evaluate(model, ["forward_dynamics"], [0, 0, 0]),
        lambda: simulate(model, [0, 0, 0], (0, 1), kind=TreeMotion()),
        lambda: simulate(model, [0, 0, 0], (0, 1), kind=ConstrainedMotion([Linear("x", "s.x'")])),
        lambda: motion_arguments(model, q=[0, 0, 0], span=(0, 1), constraints=(BLADE, BLADE)),
        lambda: quasi_velocity_equations(model, [Linear("x", "s.x'")]),
    ]
    for each in refused:
        with pytest.raises(InvalidInput) as caught:
            each()
        assert caught.value.faults[0].code == "has-velocity-constraints"


@pytest.mark.parametrize(
    ("given", "pointer", "code"),
    [
        ({**EDGE, "frame": "s.c"}, "/frame", "unknown-frame"),
        ({"name": "x", "type": "linear", "expression": "s.x'^2"}, "/expression", "not-linear"),
        ({"name": "x", "type": "linear", "expression": "s.z'"}, "/expression", "unknown-name"),
        ({"name": "blade", "type": "linear", "expression": "s.x'"}, "/name", "duplicate-name"),
        ({"name": "r", "type": "rolling", "frame": "s.b", "radius": "rr"}, "/radius", "unknown-name"),
    ],
)
def test_faults_have_their_place(given: Plain, pointer: str, code: str) -> None:
    model = tied(sleigh_part(), [EDGE, given])
    for checked in (check_constraints, quasi_velocity_equations):
        with pytest.raises(InvalidInput) as caught:
            checked(model)
        assert (f"/velocity_constraints/1{pointer}", code) in [(f.pointer, f.code) for f in caught.value.faults]


def test_units_and_contradictions() -> None:
    wrong = {"name": "r", "type": "rolling", "frame": "s.b", "radius": {"value": 1, "unit": "kg"}}
    with pytest.raises(InvalidInput) as caught:
        tied(sleigh_part(), [wrong])
    assert caught.value.faults[0].pointer == "/velocity_constraints/0/radius"
    pairs = (("a", "s.x'"), ("b", "s.x' - 1"))
    twice = [{"name": name, "type": "linear", "expression": text} for name, text in pairs]
    with pytest.raises(InvalidInput) as caught:
        check_constraints(tied(sleigh_part(), twice))
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/velocity_constraints", "contradiction")
    with pytest.raises(InvalidInput) as caught:
        check_constraints(tied(sleigh_part(), [EDGE], driven={"s.f": {"input": True}}))
    assert caught.value.faults[0].code == "has-driven"


def test_a_summary_with_others_is_found() -> None:
    """The certificate tells what constraints there are from the document."""
    model = tied(sleigh_part(), [EDGE])
    tree = {"name": "loop", "gravity": [0, 0, 0], "instances": [{"name": "s", "definition": sleigh_part()}]}
    spec = TreeSpec.read({**tree, "velocity_constraints": [EDGE]})
    definitions = {"s": spec.instances[0].definition}
    assert definitions["s"] is not None
    summary = model.described()
    certify_tree(spec, definitions, summary, model.program)  # type: ignore[arg-type]
    summary["velocity_constraints"] = [{**EDGE, "frame": "s.base"}]
    with pytest.raises(VerificationFailed, match="velocity_constraints"):
        certify_tree(spec, definitions, summary, model.program)  # type: ignore[arg-type]


def test_closures_are_among_them() -> None:
    """A slider-crank beside a sleigh: all loops stay closed without being named."""
    wrist = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    instances = [{"name": name, "substructure": part} for name, part in (("x", "slider-crank"), ("s", "p"))]
    tree: Plain = {"gravity": [0, 0, 0], "instances": instances, "closures": [wrist]}
    parts = {"slider-crank": catalogue.load("slider-crank"), "p": sleigh_part()}
    own, beside = tree_model({**tree, "velocity_constraints": [EDGE]}, parts), tree_model(tree, parts)
    assert constraints_of(own) == (BLADE, Closed("wrist"))
    equations = [quasi_velocity_equations(m, c) for m, c in ((own, ()), (beside, (BLADE, Closed("wrist"))))]
    assert equations[0].program.digest == equations[1].program.digest
