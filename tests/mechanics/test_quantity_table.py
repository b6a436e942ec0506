"""The table of quantities: what its rows say is what programs, answers, exports and printers do."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from closed_trees import four_bar, slider_crank
from random_trees import Kind, random_definition, random_states, tree_of

from substructures import Definition, Model, couple, derive
from substructures.certificate.derived.model_formulas import SERVED
from substructures.client.numbers import Evaluation as Answer
from substructures.errors import InvalidArgument
from substructures.export import exported_model, interface_of_model, render
from substructures.export.fmu.variables import layout_of
from substructures.export.interface import Interface, signature
from substructures.printers.names import LETTERS, RAISED
from substructures.quantities import quantity as table
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.quantity import DERIVED, QUANTITIES, TABLE, askable, labels_of
from substructures.quantities.sources import Sources, of_parts

#: what a function has that lists of their own had forgotten
SIGNATURES = {
    "lagrangian": "t q qd p",
    "condition": "q p",
    "inertial_parameters": "p",
    "moments_of_inertia": "p",
    "nonlinear_effects": "q qd p",
    "regressor": "q qd qdd p",
    "forward_dynamics_derivative": "t q qd u p",
    "closure.jacobian": "q p",
    "closure.residual": "q p",
    "closure.acceleration": "q qd p",
    "riemann": "q p",
    "ricci": "q p",
    "scalar_curvature": "q p",
    "base_parameters": "p",
    "metric[1,2]": "q p",
    "what_nobody_knows": "t q qd qdd u p",
}


def sources(seed: int, dof: int = 3) -> Sources:
    definition = random_definition(
        np.random.default_rng(seed), Kind(dof, joints=("revolute", "prismatic"), massive=True)
    )
    spec, parts = tree_of(definition), {"x": derive(Definition.read(definition))}
    return Sources(couple(spec, parts), of_parts=of_parts(spec, parts))


def answer(given: Sources, names: list[str]) -> Evaluation:
    state = random_states(np.random.default_rng(3), 2, given.model.dof)
    return evaluate(given, names, **state, options=EvaluationOptions(along=Direction(q=state["q"])))


@pytest.mark.parametrize("name", SIGNATURES)
def test_signatures_that_were_forgotten(name: str) -> None:
    assert signature(name) == tuple(SIGNATURES[name].split())


@pytest.mark.parametrize("seed", range(4))
def test_every_function_has_what_it_depends_on(seed: int) -> None:
    """Of all quantities; a row with too few arguments is refused by the export."""
    given = sources(seed)
    names = [name for name in askable(given.model.program.outputs) if name in TABLE]
    exported = exported_model(given, interface_of_model(given.model), names, "demo")
    for function in exported.functions:
        wanted = set(TABLE[function.quantity].arguments)
        if not exported.interface.has_time:  # then what depends on it all the same, as reactions may, has it alone
            wanted -= {"t"} - {symbol.name for symbol in function.program.symbols}
        assert set(function.arguments) - {"x"} == wanted
        assert not {"pivots", "inertias"} & {*function.program.outputs}


def test_outputs_of_functions_have_one_order() -> None:
    """That of the program, by name, alone and in exports: arguments of functions must not be exchanged."""
    given = sources(0)
    order = ["reaction_force", "reaction_force_world", "reaction_moment", "reaction_moment_world"]
    exported = exported_model(given, interface_of_model(given.model), ["reactions", "total_momentum"], "demo")
    assert [list(function.program.outputs) for function in exported.functions] == [order, ["angular", "linear"]]
    text = render(given.formulas("reactions"), "c", interface=interface_of_model(given.model), quantity="reactions")
    assert ", ".join(f"double *{name}" for name in order) in text


def test_every_program_is_made_and_judged() -> None:
    """A row cannot be without a certificate of its own."""
    assert set(DERIVED) == set(SERVED)
    assert all(callable(made.function) for made in table.PROGRAMS.values())
    sourced = {row.source for row in TABLE.values()} - {table.MODEL, table.CONDITION, table.ANALYSIS, table.PART}
    assert sourced == set(table.PROGRAMS)


@pytest.mark.parametrize("seed", range(2))
def test_axes_are_those_of_arrays(seed: int) -> None:
    """Each axis has the length of what it is named by, and the answer has the names."""
    given = sources(seed)
    found = answer(given, list(QUANTITIES))
    told = Answer(found.plain())
    for name, row in QUANTITIES.items():
        arrays = found[name] if row.fields else {"": found[name]}
        for array in row.arrays:
            key = f"{name}.{array.field}" if array.field else name
            labels = labels_of(key, told)
            lengths = [len(names) or int(axis) for names, axis in zip(labels, array.axes, strict=True)]
            assert list(np.shape(arrays[array.field])[1:]) == lengths, key
    columns = told.columns()
    for place in ("metric.x.q1.x.q1", "momentum.linear.y", "moments_of_inertia.x.", "limits."):
        assert any(name.startswith(place) for name in columns) is (place != "limits.")


def test_what_not_every_tree_has() -> None:
    model = sources(1).model
    for name, row in TABLE.items():
        if row.only:
            with pytest.raises(InvalidArgument, match=f"there is no '{name}': {row.only}") as error:
                evaluate(model, ["metric", name], np.zeros(model.dof))
            assert [fault.pointer for fault in error.value.faults] == ["/quantities/1"]


@pytest.mark.parametrize("model", [slider_crank(), four_bar()])
def test_rows_of_closures_have_numbers(model: Model) -> None:
    """The Jacobian is the derivative of the residual, by differences; q'^a G_a is its rate, and its rows have names."""
    q = np.random.default_rng(7).uniform(-1, 1, model.dof)
    names = ["closure.residual", "closure.jacobian"]
    found, step = evaluate(model, names, q), 1e-6
    assert found.labels["rows"] == tuple(f"{rows.name}.{row}" for rows in model.closures for row in rows.rows)
    sides = [
        [evaluate(model, names[0], q + sign * step * unit)[names[0]] for unit in np.eye(model.dof)] for sign in (1, -1)
    ]
    slope = (np.array(sides[0]) - np.array(sides[1])).T / (2 * step)
    assert found[names[1]].shape == slope.shape
    np.testing.assert_allclose(found[names[1]], slope, atol=1e-8)


def test_moments_of_inertia_are_those_of_binet() -> None:
    """Theta = tr(J) 1 - J of every link."""
    found = answer(sources(5), ["inertial_parameters", "moments_of_inertia"])
    pi = np.asarray(found["inertial_parameters"]).reshape(2, -1, 10)
    xx, yy, zz, xy, xz, yz = np.moveaxis(pi[..., 4:], -1, 0)
    rows = [[yy + zz, -xy, -xz], [-xy, zz + xx, -yz], [-xz, -yz, xx + yy]]
    expected = np.moveaxis(np.array(rows), (0, 1), (2, 3))
    np.testing.assert_allclose(found["moments_of_inertia"], expected, rtol=1e-12, atol=1e-12)
    assert found.labels["links"] == tuple(name[:-2] for name in found.columns.names[::10])  # type: ignore[union-attr]


def test_a_rod_has_its_textbook_moments() -> None:
    """A homogeneous rod of mass m and length l along x, about its end: m l^2 / 3 about y and z, 0 about x."""
    inertia: dict[str, Any] = {"yy": "m*l^2/12", "zz": "m*l^2/12"}
    body = {"name": "rod", "parent": "base", "joint": {"type": "revolute"}, "mass": "m", "com": ["l/2", 0, 0]}
    definition = {"name": "rod", "parameters": {"m": {"value": 3}, "l": {"value": 2}}, "bodies": [body]}
    body["inertia"] = inertia
    spec, parts = tree_of(definition), {"x": derive(Definition.read(definition))}
    given = Sources(couple(spec, parts), of_parts=of_parts(spec, parts))
    found = evaluate(given, ["moments_of_inertia"], [0.3])
    np.testing.assert_allclose(found["moments_of_inertia"], [np.diag([0, 4, 4])], rtol=1e-14, atol=1e-14)


def test_outputs_of_an_fmu_have_the_units_of_the_rows() -> None:
    given = sources(3)
    interface = interface_of_model(given.model)
    names = ["forward_dynamics", "position", "lagrangian", "power", "total_momentum", "mass_centre"]
    exported = exported_model(given, interface, names, "demo")
    found = layout_of(replace(exported, interface=with_numbers(interface))).variables
    units = {each.name: each.unit for each in found if each.causality == "output"}
    expected = {"lagrangian": "J", "power": "W", "linear": "kg m/s", "mass_centre_velocity": "m/s"}
    assert expected.items() <= units.items()
    assert units[f"{given.model.frames[1]}.position"] == "m"


def with_numbers(interface: Interface) -> Interface:
    """All parameters with a value."""
    p = interface.vectors["p"]
    return replace(interface, vectors={**interface.vectors, "p": replace(p, defaults=(1.0,) * len(p))})


def test_letters_are_in_the_rows() -> None:
    letters = {"metric": "g", "christoffel": r"\Gamma", "energy": "E", "riemann": "R", "power": "P"}
    assert letters.items() <= LETTERS.items()
    assert RAISED == {"inverse_metric": 2, "christoffel_second": 1}
