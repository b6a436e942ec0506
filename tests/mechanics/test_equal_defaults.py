"""Parameters whose defaults are equal to numbers of a definition stay parameters, and the numbers stay numbers."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from in_depth import seeds
from random_trees import Kind, Plain, random_definition

from substructures import Definition, InvalidInput, Model, TreeSpec, couple, derive
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.regressor import regressor

TREE: Plain = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "a", "substructure": "part"}]}


#: xx, yy, xy of a body whose zz is 0.25, and p = 0.25
CASES = [case for case in product([0.25, "p"], [0.25, "p"], [0, "p"]) if "p" in case] + [(1.0, "p", "p")]


def coupled(definition: Plain) -> tuple[TreeSpec, dict[str, Any], Model]:
    spec, parts = TreeSpec.read(TREE), {"a": derive(Definition.read(definition | {"name": "part"}))}
    return spec, parts, couple(spec, parts)


@pytest.mark.parametrize(("xx", "yy", "xy"), CASES)
def test_a_literal_of_an_inertia_that_equals_a_default(xx: Any, yy: Any, xy: Any) -> None:
    """The certificate of every tree with such a part ended in a KeyError: one had been put for the other."""
    inertia: Plain = {"xx": xx, "yy": yy, "zz": 0.25, "xy": xy}
    body = {"name": "b", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 1}
    definition = {"parameters": {"p": {"value": 0.25}}, "bodies": [body | {"inertia": inertia}]}
    spec, parts, model = coupled(definition)
    assert evaluate(model, ["metric"], q=[0.3], parameters={"a.p": 0.75})["metric"].tolist() == [[0.25]]
    found = regressor(spec, parts).evaluate([0.3], [0], [0], parameters={"a.p": 0.2})
    moments = np.asarray(found["inertial_parameters"]).reshape(-1, 10)[0, 4:]
    # J = tr(Theta)/2 - Theta, whatever the order of the moments and the sign of the product
    x, y, product_ = (0.2 if x == "p" else x for x in (xx, yy, xy))
    half = (x + y + 0.25) / 2
    expected = np.abs([half - x, half - y, half - 0.25, product_, 0, 0])
    assert sorted(np.abs(moments)) == pytest.approx(sorted(expected))


@pytest.mark.parametrize("seed", seeds(12, 300))
def test_random_parts_with_few_different_numbers(seed: int) -> None:
    rng = np.random.default_rng([seed, 5])
    definition = random_definition(rng, Kind(bodies=int(rng.integers(1, 4)), loads=1, springs=0))
    values = [0.5, 1, 2, 0.25, 0.1]
    parameters = {f"p{i}": {"value": float(rng.choice(values))} for i in range(int(rng.integers(1, 4)))}

    def drawn() -> Any:
        kind = rng.random()
        name = str(rng.choice(list(parameters)))
        return name if kind < 0.4 else f"2*{name}" if kind < 0.6 else float(rng.choice(values))

    for body in definition["bodies"]:
        if "mass" in body:
            body |= {"mass": drawn(), "com": [drawn() if rng.random() < 0.6 else 0 for _ in range(3)]}
        for entry in ("xx", "yy", "zz", "xy", "xz", "yz"):
            if "inertia" in body and rng.random() < 0.6:
                body["inertia"][entry] = drawn()
    try:
        _, _, model = coupled(definition | {"parameters": parameters})
    except InvalidInput as refused:
        if {fault.code for fault in refused.faults} <= {"impossible-inertia", "negative-mass"}:
            return
        raise
    # defaults or the same numbers given: the same mass matrix
    q = rng.uniform(-1, 1, model.dof)
    given = {f"a.{name}": each["value"] for name, each in parameters.items()}
    by_default, by_hand = (evaluate(model, ["metric"], q=q, **x)["metric"] for x in ({}, {"parameters": given}))
    np.testing.assert_array_equal(by_default, by_hand)
