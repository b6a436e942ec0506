"""Bodies of requests for analyses become the arguments of functions of the science: same names, same defaults."""

from __future__ import annotations

from collections.abc import Callable
from inspect import Parameter
from typing import Any

import pytest

from service.models.numbers import ANALYSES
from service.models.requests import arguments, read_request
from substructures import InvalidDocument
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.demands import End
from substructures.analysis.control.optimal_control import optimal_control
from substructures.analysis.control.problem import Cost
from substructures.analysis.equations.curvature import curvature_values
from substructures.analysis.identification.fit import excitation, identify
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.root_locus import root_locus
from substructures.analysis.stability.steady_motions import steady_motions
from substructures.documents import DocumentPart

from .flat_arguments import flat_arguments

#: functions, and what of their arguments no body has
FUNCTIONS: dict[str, tuple[Callable[..., Any], set[str]]] = {
    "linearisations": (linearise, {"model", "form"}),
    "equilibria": (equilibria, {"model"}),
    "steady-motions": (steady_motions, {"model"}),
    "root-loci": (root_locus, {"model"}),
    "curvatures": (curvature_values, {"model", "limit", "engine", "formulas"}),
    "cost-gradients": (cost_gradient, {"model"}),
    "optimal-controls": (optimal_control, {"model", "progress"}),
    "excitations": (excitation, {"base", "closed"}),
    "identifications": (identify, {"base", "model", "closed"}),
}
#: fields that say what base parameters are found from, what is known of the model, and where the motion stands
OF_BASE = {"log", "drives", "known", "consistent", "prior_deviation"}
CONTROL = {"controls": ["u"], "horizon": 1, "intervals": 2, "q": [0]}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_fields_are_arguments(name: str) -> None:
    function, others = FUNCTIONS[name]
    parameters = {key: value for key, value in flat_arguments(function).items() if key not in others}
    fields = {key: value for key, value in ANALYSES[name].schema.model_fields.items() if key not in OF_BASE}
    assert fields.keys() == parameters.keys()
    for key, field in fields.items():
        default = parameters[key]
        if field.is_required():
            assert default is Parameter.empty
        elif default is not Parameter.empty:
            value = field.default.value() if isinstance(field.default, DocumentPart) else field.default
            assert default == value or (default is None and value in ({}, End()))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_fields_that_there_are_not(name: str) -> None:
    with pytest.raises(InvalidDocument) as error:
        read_request(ANALYSES[name].schema, {"speed": 1})
    assert ("/speed", "extra-forbidden") in [(fault.pointer, fault.code) for fault in error.value.faults]


def test_parts_become_values_of_the_science() -> None:
    body = CONTROL | {"cost": {"running": "u^2"}, "end": {"q": [1, None]}}
    found = arguments(read_request(ANALYSES["optimal-controls"].schema, body))
    assert found == CONTROL | {"controls": ("u",), "cost": Cost("u^2"), "end": End([1, None])}
