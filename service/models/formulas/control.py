"""The adjoint equations."""

from __future__ import annotations

from service.models.formulas.entry import Made, Options, Quantity
from service.models.source import Source
from substructures.analysis.control.adjoint import adjoint_equations
from substructures.analysis.control.problem import Cost
from substructures.analysis.equations.formulas import inputs_of


def _adjoint(source: Source, options: Options) -> Made:
    cost = Cost(**{name: ",".join(options[name]) for name in ("running", "terminal") if name in options})
    controls, varied = options.get("controls", tuple(inputs_of(source.model))), options.get("parameters", ())
    found = adjoint_equations(source.model, controls, cost, varied)
    names = {"coordinates": found.coordinates, "controls": found.controls, "parameters": found.varied}
    names |= {"positions": found.positions} if source.model.balls else {}
    return Made(found.program, {name: list(value) for name, value in names.items()})


QUANTITIES = {
    "adjoint": Quantity(_adjoint, ("controls", "running", "terminal", "parameters"), (), {"parameters": "varied"})
}
