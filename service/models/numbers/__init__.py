"""Analyses in numbers, by the names of their endpoints: the body of a request in, a result out."""

from __future__ import annotations

from typing import TYPE_CHECKING

from substructures.late import Table
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

if TYPE_CHECKING:  # what an analysis needs is imported when it is first asked for
    from service.models.numbers.analysis import Analysis

_MODULES = {
    "abbreviations": "abbreviations",
    "simulations": "motions",
    "ensembles": "ensembles",
    "sensitivities": "motions",
    "periodic-orbits": "orbits",
    "poincare-sections": "orbits",
    "lyapunov-exponents": "orbits",
    "linearisations": "stability",
    "frequency-responses": "stability",
    "regulators": "stability",
    "equilibria": "stability",
    "steady-motions": "stability",
    "root-loci": "stability",
    "curvatures": "geometry",
    "cost-gradients": "control",
    "optimal-controls": "control",
    "optimal-parameters": "optimum",
    "loop-states": "loops",
    "reduced-equations": "loops",
    "excitations": "identification",
    "identifications": "identification",
}


def analysis_of(name: str, model: Model) -> Analysis:
    """The analysis of a model. Raises InvalidDocument where it would ignore velocity constraints of the tree."""
    require_untied(model, name)
    return ANALYSES[name]


ANALYSES: Table[Analysis] = Table("ANALYSES", {name: f"{__name__}.{module}" for name, module in _MODULES.items()})
