"""That no wrong program is served beside the stored ones: each is certified when made (certificate.md, section 4)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
import pytest
import random_cuts
from damaged import KINDS, as_json, damages
from in_depth import deep
from random_trees import Kind, Plain, random_definition, with_parameters

from substructures import Definition, Model, Part, Program, TreeSpec, couple, derive, evaluate
from substructures.analysis.closed import work
from substructures.analysis.control import adjoint
from substructures.analysis.control.problem import Cost
from substructures.analysis.equations import curvature, first_integrals, perturbation, routh, steady
from substructures.analysis.equations.nonholonomic import linearised, quasi_velocities, solved
from substructures.analysis.equations.nonholonomic.quasi_equations import QuasiEquations
from substructures.analysis.equations.nonholonomic.velocity_constraints import Closed, KnifeEdge, Linear, Rolling
from substructures.analysis.identification import base_parameters as base
from substructures.analysis.motion import parameter_sensitivity, right_hand_side, variation
from substructures.certificate import compare
from substructures.documents import read_json
from substructures.errors import VerificationFailed
from substructures.expr.differentiate import in_directions
from substructures.expr.graph import Expr
from substructures.mechanics.factorisation import Factors
from substructures.part import outputs as part_outputs
from substructures.quantities import centroidal, derivatives, formulas, of_parts, regressor
from substructures.quantities.numbers.workspace import Workspace

MASS = {"mass": "m", "com": [0.1, "l", 0.2], "inertia": {"xx": 1, "yy": 1.2, "zz": 0.9, "xy": 0.1}}
BODIES = [
    {"name": "a", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x", "theta": 0.4}} | MASS,
    {"name": "b", "parent": "a", "joint": {"type": "revolute", "coordinate": "y", "theta": 1.1, "d": "l"}} | MASS,
]
LOADS = [
    {"type": "joint", "coordinate": "x", "force": "-k*x*y - 0.3*x'*y' + u*y + sin(t)"},
    {"type": "force", "body": "b", "at": [0.2, "l", 0.1], "vector": ["k", "-2*y'", "u"]},
]
PART: Plain = {
    "name": "a",
    "parameters": {"k": {"value": 1.7}, "l": {"value": 0.6}, "m": {"value": 2}},
    "inputs": {"u": {}},
    "bodies": BODIES,
    "loads": LOADS,
    "ports": [{"name": "tip", "body": "b", "position": [0.3, "l", 0.1], "rotation": {"rpy": [0.1, 0.2, 0.3]}}],
}
MOUNTS = [
    {"name": "x", "substructure": "a"},
    {"name": "y", "substructure": "a", "at": "x.b", "placement": {"position": [0.2, 0.1, 0], "rpy": [0.3, 0.2, 0.1]}},
]
ROD = {"name": "r", "type": "rod", "from": "y.b", "to": "world", "length": 0.7}
#: without loads and gravity: momenta and energy are constant
FREE: Plain = PART | {"loads": []}
CONTROLS = ("tau.x.x", "y.u")
CONSTRAINTS = (
    KnifeEdge("skate", "y.tip"),
    Linear("linear", "sin(x.y)*x.x' - 0.3*y.x' - x.k*y.y'"),
)


@cache
def part(free: bool = False) -> Part:
    return derive(Definition.read(read_json(as_json(FREE if free else PART))))


@cache
def tree(closed: bool = False, free: bool = False) -> tuple[TreeSpec, dict[str, Part], Model]:
    gravity, closures = [0, 0, 0] if free else [1, 2, -9], [ROD] if closed else []
    plain = {"name": "t", "gravity": gravity, "instances": MOUNTS, "closures": closures}
    spec, parts = TreeSpec.read(read_json(as_json(plain))), {"x": part(free), "y": part(free)}
    return spec, parts, couple(spec, parts)


def model(closed: bool = False, free: bool = False) -> Model:
    return tree(closed, free)[2]


def rolling() -> Any:
    sphere = Rolling("ball", "y.tip", 0.3, "sphere", (0.2, 0.1, 1))
    return quasi_velocities.quasi_velocity_equations(model(), [sphere])


def regressor_of() -> Any:
    regressor.regressor(*tree()[:2])


#: what makes a program, by name of the program and of an output that tells it from others
MAKERS: dict[str, tuple[Callable[[], Any], str]] = {
    **{
        name: (lambda name=name: formulas.derived(model(), name), "")
        for name in formulas.DERIVED
        if "forward" not in name
    },
    "forward_dynamics": (lambda: formulas.derived(model(), "forward_dynamics"), "pivots"),
    "forward_dynamics_derivative": (
        lambda: formulas.derived(model(), "forward_dynamics_derivative"),
        "forward_dynamics_derivative",
    ),
    "perturbation": (lambda: perturbation.perturbation(model()), "stiffness"),
    "perturbation of closed loops": (lambda: perturbation.perturbation(model(closed=True)), "closure.jacobian_rate"),
    "state space": (lambda: perturbation.state_space(model(), ["x.x*y.y' + x.u^2", "sin(y.x)"], CONTROLS), "A"),
    "sensitivity": (lambda: parameter_sensitivity.sensitivity_formulas(model(), ["x.l", "y.k"]), "metric:x.l"),
    "variation": (lambda: variation.variational(model(), ["x.l"]), "variation"),
    "curvature": (lambda: curvature.curvature(model()), "riemann"),
    "first integrals": (lambda: first_integrals.first_integrals(model(free=True)), "power"),
    "first integrals of closed loops": (lambda: first_integrals.first_integrals(model(closed=True)), "power"),
    "routhian": (lambda: routh.routh(model(free=True)), "routhian"),
    "motion": (lambda: right_hand_side.forward_dynamics(model(), ["x.u"]), "power"),
    "adjoint": (
        lambda: adjoint.adjoint_equations(model(), CONTROLS, Cost("tau.x.x^2*y.x'", "x.y^2*y.y'*x.l"), ["x.l"]),
        "adjoint_q",
    ),
    "adjoint of closed loops": (
        lambda: adjoint.adjoint_equations(model(closed=True), CONTROLS, Cost("tau.x.x^2*y.x'", "y.y'*x.l"), ["x.l"]),
        "adjoint_qd",
    ),
    "velocity equations": (
        lambda: quasi_velocities.quasi_velocity_equations(
            model(), CONSTRAINTS, velocities={"v": "cos(x.y)*x.x' + x.y'", "w": "y.y'"}
        ),
        "hamel_bias",
    ),
    "velocity equations with given velocities": (
        lambda: quasi_velocities.quasi_velocity_equations(
            model(), [Linear("turned", "sin(x.y)*x.x' - 0.3*y.x' - x.k*y.y' + x.l*cos(t*x.x)")]
        ),
        "constraint_power",
    ),
    "linearised velocity equations": (
        lambda: linearised.linearised(model(), CONSTRAINTS, (None, ("x.x", "y.y"), None)),
        "rates_by_position",
    ),
    "motion with velocity constraints": (lambda: solved.solved(tied(), ["x.u"]), "second"),
    "state space with velocity constraints": (
        lambda: solved.state_space(tied(), ["x.x*y.y' + x.u^2", "sin(y.x)*x.x'"], CONTROLS), "A",
    ),
    "variation with velocity constraints": (lambda: solved.varied(tied(), ["x.l"]), "rates_variation"),
    "velocity equations of closed loops": (
        lambda: quasi_velocities.quasi_velocity_equations(model(closed=True), [Closed("r")]),
        "gaps",
    ),
    "velocity equations of rolling": (rolling, "gaps"),
    "steady motions": (lambda: steady.steady_formulas(model(closed=True), [0, 2]), "by_rate"),
    "closed motions": (lambda: work.with_power(model(closed=True), ["metric", "bias"], ["x.u"]), "lost_power"),
    "own inertia": (lambda: part_outputs.with_own_inertia(part(), part().program), ""),
    "regressor": (regressor_of, "regressor"),
    "mass centre": (lambda: centroidal.centroidal(*tree()[:2]), "mass_centre_position"),
    "base parameters": (lambda: base.base_parameters(regressor.regressor(*tree()[:2]), ["armature"]), "grouping"),
}  # fmt: skip
MODULES = (
    *(adjoint, base, curvature, first_integrals, parameter_sensitivity, perturbation, quasi_velocities, of_parts),
    *(routh, steady, work, linearised, solved, variation),
)


@cache
def tied() -> quasi_velocities.QuasiVelocities:
    """The constraints move, so that they do work."""
    turned = Linear("turned", "sin(x.y)*x.x' - 0.3*y.x' - x.k*y.y' + x.l*cos(t*x.x)")
    return quasi_velocities.quasi_velocity_equations(model(), [turned])


@dataclass
class Fault:
    """Puts another program in the place of the one that has an output of this name."""

    output: str
    wrong: Program | None = None
    right: Program | None = None

    def collected(self, collect: Callable[..., Program]) -> Callable[..., Program]:
        def planted(*arguments: Any) -> Program:
            found = collect(*arguments)
            if self.output and self.output not in found.outputs:
                return found
            self.right = found
            return found if self.wrong is None else self.wrong

        return planted


@pytest.mark.parametrize("kinds", [1, *deep(len(KINDS))])
@pytest.mark.parametrize("name", MAKERS)
def test_no_wrong_program_is_served(name: str, kinds: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every output damaged in one way drawn, or in all: sign, factor, exchange, 1e-6, left out.

    Still a slow one: each program is made and certified anew for each of its damages.
    """
    make, output = MAKERS[name]
    fault = Fault(output)
    monkeypatch.setattr(Workspace, "program", fault.collected(Workspace.program))
    for module in MODULES:
        monkeypatch.setattr(module, "program", fault.collected(module.program))
    monkeypatch.setattr(part_outputs, "collect", fault.collected(part_outputs.collect))
    clear()
    make()
    assert fault.right is not None
    right, tried = fault.right, 0
    for kind, place, wrong in damages(right, np.random.default_rng(1), kinds=kinds):
        fault.wrong = wrong
        clear()
        with pytest.raises(VerificationFailed) as found:
            make()
        assert place.partition("[")[0] in str(found.value) or "grouping" in place, (kind, place)
        tried += 1
    assert tried >= 0.8 * kinds * len([x for x in right.outputs.values() if x.entries]) - 2
    clear()


def clear() -> None:
    """What was made before is made anew."""
    perturbation._perturbation.cache_clear()
    quasi_velocities._equations.cache_clear()
    linearised._perturbed.cache_clear()
    first_integrals._found.cache_clear()
    variation._variational.cache_clear()
    steady._steady_formulas.cache_clear()
    solved._solved.cache_clear()
    solved._varied.cache_clear()
    solved._state_space.cache_clear()


def halved(function: Callable[..., list[Expr]]) -> Callable[..., list[Expr]]:
    return lambda *arguments, **named: [x / 2 for x in function(*arguments, **named)]


def turned(function: Callable[..., Mapping[Any, Expr]]) -> Callable[..., Mapping[Any, Expr]]:
    return lambda *arguments, **named: {index: -x for index, x in function(*arguments, **named).items()}


#: faults in the lines that make programs: the module or class, the function, and what it becomes
FAULTS: dict[str, tuple[Any, str, Callable[..., Any]]] = {
    "coriolis": (Workspace, "velocity_symbol", lambda f, _: f.graph.symbol(f"{f.model.coordinates[0]}'")),
    "forward_dynamics": (Factors, "solve", lambda factors, f: [x * y for x, y in zip(f, factors.inverse, strict=True)]),
    "inverse_dynamics_derivative": (derivatives, "directional", halved(derivatives.directional)),
    "kinetic_energy": (
        Workspace,
        "times_velocity",
        lambda f, g: {(a,): x * f.velocity_symbol(a) for (a, _), x in g.items()},
    ),
    "perturbation": (
        derivatives,
        "in_directions",
        lambda rows, ways: [[x / 2 for x in row] for row in in_directions(rows, ways)],
    ),
    "perturbation of closed loops": (perturbation, "directional", halved(perturbation.directional)),
    "sensitivity": (parameter_sensitivity, "directional", halved(parameter_sensitivity.directional)),
    "variation": (variation, "directional", halved(variation.directional)),
    "motion with velocity constraints": (solved, "directional", halved(solved.directional)),
    "variation with velocity constraints": (solved, "directional", halved(solved.directional)),
    "curvature": (curvature._Space, "_dot", lambda s, x, _: s.graph.sum(p * p for p in x)),
    "adjoint": (adjoint, "pullback", halved(adjoint.pullback)),
    "routhian": (routh._Reduction, "_metric", lambda r, a, b: r.g.get((r.rest[a], r.rest[b]), r.zero)),
    "velocity equations": (QuasiEquations, "_structure", turned(QuasiEquations._structure)),
    "regressor": (regressor, "pairing", lambda *_: 0),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_in_what_makes_a_program_is_found(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    make, _ = MAKERS[name]
    clear()
    make()
    clear()
    monkeypatch.setattr(*FAULTS[name])
    with pytest.raises(VerificationFailed, match="by the documents"):
        make()
    clear()


def test_what_is_called_constant_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """A coordinate that is taken for cyclic: its momentum is what it says, and not constant."""
    monkeypatch.setattr(first_integrals.VanishingOnAllSides, "__call__", lambda *_: True)
    clear()
    with pytest.raises(VerificationFailed, match="changes along the motion"):
        first_integrals.first_integrals(model())
    clear()


def test_a_power_of_zero_needs_no_further_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is small beside the power of gravity, which is what the potential energy loses."""
    spec = TreeSpec.read({"name": "heavy", "gravity": [1, 2, -9], "instances": MOUNTS})
    heavy = couple(spec, tree(free=True)[1])
    monkeypatch.setattr(compare, "PRECISIONS", (128, None))
    right_hand_side.forward_dynamics(heavy)
    assert first_integrals.first_integrals(heavy).integrals[0].rule == "constant"


def slides_and_hinges(*joints: str) -> list[Plain]:
    types = {"r": "revolute", "p": "prismatic"}
    parents = ["base", *(f"b{k}" for k in range(len(joints)))]
    return [{"name": f"b{k}", "parent": parents[k], "joint": {"type": types[x]}} for k, x in enumerate(joints)]


def test_what_leaves_its_domain_before_the_documents_is_served() -> None:
    """With k < 0 a length sqrt(k) is none; a recursion that has it in an element where it cancels is right all the
    same."""
    first: Plain = {"name": "one", "bodies": slides_and_hinges("r", "p", "r"), "ports": [{"name": "p0", "body": "b2"}]}
    bodies = slides_and_hinges("p", "r")
    bodies[1] |= {"mass": "3.0342", "com": [0, 0, "sqrt(k)"]}
    second: Plain = {"name": "two", "bodies": bodies, "parameters": {"k": {"value": "0.0221^2"}}}
    placement = {"position": [0.525, 0.336, 0.318], "rpy": [-1.407, 1.037, -0.105]}
    instances = [
        {"name": "i0", "substructure": "one"},
        {"name": "i1", "substructure": "two", "at": "i0.p0", "placement": placement},
    ]
    spec = TreeSpec.read({"name": "z", "gravity": [0, 0, -9.81], "instances": instances})
    coupled = couple(spec, {"i0": derive(Definition.read(first)), "i1": derive(Definition.read(second))})
    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, coupled.dof))
    found = evaluate(coupled, ["inverse_dynamics", "metric", "bias", "forces"], q=q, qd=qd, qdd=qdd)
    needed = found["metric"] @ qdd + found["bias"] - found["forces"]
    assert found["inverse_dynamics"] == pytest.approx(needed, abs=1e-12)


@pytest.mark.parametrize("number", range(12))
def test_right_trees_with_roots_and_products_of_parameters_are_served(number: int) -> None:
    rng = np.random.default_rng([126, number])
    kind = Kind(bodies=3, loads=1, springs=1, depth=4, massive=True)
    definition = with_parameters(rng, random_definition(rng, kind), 0.35, odd=True)
    cut = (definition["bodies"][-1]["name"],)
    coupled = random_cuts.coupled(random_cuts.cut_tree(rng, definition, cut))
    for quantity in formulas.DERIVED:
        assert formulas.derived(coupled, quantity).outputs
