"""First integrals, and the Routhian."""

from __future__ import annotations

from typing import Any

from service.models.formulas.entry import Made, Options, Quantity
from service.models.source import Source
from substructures.analysis.equations.first_integrals import acting_inputs, first_integrals
from substructures.analysis.equations.routh import routh


def _first_integrals(source: Source, options: Options) -> Made:
    named = dict.fromkeys((*options.get("inputs", ()), *acting_inputs(source.model)))
    degree: Any = options.get("degree", ("2",))[0]
    wanted: Any = int(degree) if degree in ("1", "2") else degree
    found = first_integrals(source.model, named, options.get("zero", ()), wanted)
    return Made(found.program, found.summary())


def _routhian(source: Source, options: Options) -> Made:
    found = routh(source.model, options.get("cyclic"))
    names = {"coordinates": found.coordinates, "cyclic": found.cyclic, "momenta": found.momenta}
    return Made(found.program, {name: list(value) for name, value in names.items()})


QUANTITIES = {
    "first_integrals": Quantity(_first_integrals, ("inputs", "zero", "degree"), (), {"zero": "parameters"}),
    "routhian": Quantity(_routhian, ("cyclic",), (), {"cyclic": "coordinates"}),
}
