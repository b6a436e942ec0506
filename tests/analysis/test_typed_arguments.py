"""Arguments of simulate, couple and derive that cannot be meant are refused where they are made, by name and value."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from analysis_models import catalogue_model
from closed_trees import four_bar

import substructures
from substructures import (
    ClosedMotion,
    ConstrainedMotion,
    ControlProblem,
    Definition,
    Event,
    FixedStep,
    Geodesic,
    Integrator,
    InvalidArgument,
    InvalidDocument,
    Linear,
    Outputs,
    TreeMotion,
    TreeSpec,
    catalogue,
    couple,
    derive,
    linearise,
    regulator,
    sensitivities,
    simulate,
    simulate_ensemble,
    steady_motions,
)
from substructures.analysis.from_fields import motion_arguments
from substructures.analysis.orbits.orbit import Shooting

TREE = {"name": "clock", "instances": [{"name": "p", "substructure": "simple-pendulum"}]}
PENDULUM = catalogue_model("simple-pendulum")
ROD = Linear("rod", "p.q1'")


def fault(make: Callable[[], Any]) -> tuple[str, str]:
    """Pointer and text of the only fault."""
    with pytest.raises(InvalidArgument) as caught:
        make()
    (found,) = caught.value.faults
    return found.pointer, found.message


WRONG: list[tuple[Callable[[], Any], str, str]] = [
    (lambda: Integrator(FixedStep(0.1), max_step=0.2), "/max_step", "0.2"),
    (lambda: Integrator("Euler"), "/method", "'Euler'"),
    (lambda: Integrator(drift_limit=0), "/drift_limit", "greater than 0"),
    (lambda: Outputs(times=[0, 1], count=5), "/times", "one of 'times', 'step' and 'count'"),
    (lambda: Outputs(times=[1, 0]), "/times", "increase"),
    (lambda: Outputs(count=1), "/count", "found 1"),
    (lambda: Event("top", "p.q1", count=0), "/count", "found 0"),
    (lambda: Event("top", "p.q1", count=1.5), "/count", "1.5"),  # type: ignore[arg-type]
    (lambda: TreeMotion("loaded"), "/friction", "'bearings'"),
    (lambda: TreeMotion(bearings=object()), "/bearings", "'regularised'"),  # type: ignore[arg-type]
    (lambda: TreeMotion("dry"), "/friction", "'dry'"),  # type: ignore[arg-type]
    (lambda: ClosedMotion(friction="loaded"), "/friction", "'loaded'"),  # type: ignore[arg-type]
    (lambda: ClosedMotion(reduction="none"), "/reduction", "'none'"),  # type: ignore[arg-type]
    (lambda: ConstrainedMotion([]), "/constraints", "none"),
    (lambda: ConstrainedMotion([ROD, "rod"]), "/constraints/1", "'rod'"),  # type: ignore[list-item]
    (lambda: TreeMotion(contacts="foot"), "/contacts", "'foot'"),  # type: ignore[arg-type]
    (lambda: Outputs(events=[{"name": "top"}]), "/events/0", "'top'"),  # type: ignore[list-item]
    (lambda: simulate_ensemble(PENDULUM, [[1]], (0, 1), events=["top"]), "/events/0", "'top'"),  # type: ignore[list-item]
    (lambda: Outputs(events=Event("top", "p.q1")), "/events", "Event(...)"),  # type: ignore[arg-type]
    (lambda: Shooting(1.0, turns={"p.q1": 0.5}), "/turns/p.q1", "0.5"),  # type: ignore[dict-item]
    (lambda: ConstrainedMotion([ROD], form="lagrange"), "/form", "'lagrange'"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("make", "pointer", "text"), WRONG)
def test_what_is_wrong_is_not_made(make: Callable[[], Any], pointer: str, text: str) -> None:
    where, message = fault(make)
    assert where == pointer
    assert text in message


@pytest.mark.parametrize(
    ("argument", "value"), [("kind", Geodesic), ("kind", "geodesic"), ("integrator", "RK45"), ("outputs", {"count": 5})]
)
def test_what_is_no_value_of_its_class_is_not_passed_over(argument: str, value: Any) -> None:
    """Geodesic is none, Geodesic() is one."""
    where, message = fault(lambda: simulate(catalogue_model("simple-pendulum"), [1], (0, 1), **{argument: value}))
    assert where == f"/{argument}"
    assert repr(value)[:80] in message


BY_NAME: dict[str, Callable[[Any], Any]] = {
    "series": lambda x: Outputs(series=x),
    "prescribed": lambda x: ClosedMotion(prescribed=x),
    "inputs": lambda x: simulate(PENDULUM, [1], (0, 1), inputs=x),
    "parameters": lambda x: simulate(PENDULUM, [1], (0, 1), parameters=x),
    "outputs": lambda x: linearise(PENDULUM, [0], outputs=x),
    "weights": lambda x: regulator(PENDULUM, [0], weights=x),
    "momenta": lambda x: steady_motions(PENDULUM, momenta=x),
    "columns": lambda x: simulate_ensemble(PENDULUM, [[1]], (0, 1), columns=x),
}


OF_NAMES: dict[str, Callable[[Any], Any]] = {
    "of_inputs": lambda x: linearise(PENDULUM, [0], of_inputs=x),
    "by": lambda x: sensitivities(PENDULUM, [1], (0, 1), by=x),
    "controls": lambda x: ControlProblem(controls=x, horizon=1, intervals=2, q=[0]),
}


@pytest.mark.parametrize("given", ["p.q1", 5], ids=repr)
@pytest.mark.parametrize("argument", OF_NAMES)
def test_names_are_given_in_a_list(argument: str, given: Any) -> None:
    assert fault(lambda: OF_NAMES[argument](given))[0] == f"/{argument}"


@pytest.mark.parametrize("given", [["p.q1"], "p.q1", 5], ids=repr)
@pytest.mark.parametrize("argument", BY_NAME)
def test_what_is_given_by_name_is_no_list(argument: str, given: Any) -> None:
    where, message = fault(lambda: BY_NAME[argument](given))
    assert where == f"/{argument}"
    assert repr(given) in message


@pytest.mark.parametrize("kind", [TreeMotion(), "rolling"])
def test_linearisations_and_sensitivities_are_with_constraints_or_without(kind: Any) -> None:
    model = catalogue_model("simple-pendulum")
    assert fault(lambda: linearise(model, [0], kind=kind))[0] == "/kind"
    assert fault(lambda: sensitivities(model, [0], (0, 1), kind=kind))[0] == "/kind"


def test_a_model_moves_as_it_can() -> None:
    tree, closed = catalogue_model("simple-pendulum"), four_bar()
    for model, kind in (
        (tree, ClosedMotion(fixed=["x.q1"])),
        (closed, TreeMotion()),
        (closed, Geodesic()),
    ):
        where, message = fault(lambda model=model, kind=kind: simulate(model, [0] * model.dof, (0, 1), kind=kind))
        assert where == "/kind"
        assert type(kind).__name__ in message


def test_flat_fields_say_the_same_as_typed_arguments() -> None:
    model = catalogue_model("simple-pendulum")
    flat = motion_arguments(model, q=[0.3], span=(0, 1), method="RK45", max_steps=9, count=5, friction="exact")
    assert flat == {
        "q": [0.3],
        "span": (0, 1),
        "kind": TreeMotion("exact"),
        "integrator": Integrator("RK45", max_steps=9),
        "outputs": Outputs(count=5),
    }
    assert motion_arguments(model, fixed_step=FixedStep(0.1), max_step=1)["integrator"] == Integrator(FixedStep(0.1))
    assert isinstance(motion_arguments(model, constraints=[ROD])["kind"], ConstrainedMotion)
    assert motion_arguments(model, geodesic=True, friction="regularised")["kind"] == Geodesic()
    assert fault(lambda: motion_arguments(model, geodesic=True, friction="exact"))[0] == "/friction"
    assert fault(lambda: motion_arguments(model, prescribed={"x.q1": "t"}, fixed_step=FixedStep(1)))[0] == "/fixed_step"


def test_plain_documents_and_names_of_the_catalogue() -> None:
    document = catalogue.load("simple-pendulum")
    parts = [derive("simple-pendulum"), derive(document), derive(Definition.read(document))]
    assert len({part.program.digest for part in parts}) == 1
    models = [couple(tree, {"p": parts[0]}) for tree in (TREE, TreeSpec.read(TREE))]
    assert models[0].program.digest == models[1].program.digest
    where, message = fault(lambda: derive("simple-pendulun"))
    assert where == "/definition"
    assert "did you mean 'simple-pendulum'" in message
    with pytest.raises(InvalidDocument):
        couple({"name": "clock", "instance": []}, {})


def test_few_arguments() -> None:
    most = {"simulate": 9, "evaluate": 9, "sensitivities": 10, "cost_gradient": 9, "optimal_control": 9}
    for name, number in most.items():
        assert len(inspect.signature(getattr(substructures, name)).parameters) <= number, name


def test_steps_of_a_fixed_size_are_halved_to_judge_them() -> None:
    assert FixedStep(0.1, "semi-implicit-euler").halved() == replace(FixedStep(0.05), method="semi-implicit-euler")
