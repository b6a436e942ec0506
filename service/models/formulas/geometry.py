"""The curvature of the configuration space."""

from __future__ import annotations

from service.models.formulas.entry import Made, Options, Quantity
from service.models.source import Source
from substructures.analysis.equations.curvature import curvature

#: of R_abcd, by which the independent elements that are given determine all others
RIEMANN = "R_abcd = -R_bacd = -R_abdc = R_cdab, R_abcd + R_acdb + R_adbc = 0"


def _curvature(source: Source, _: Options) -> Made:
    members = {"coordinates": list(source.model.coordinates), "symmetry_rule": RIEMANN}
    return Made(curvature(source.model, source.limits.program_nodes), members)


QUANTITIES = {
    "curvature": Quantity(_curvature),
    "riemann": Quantity(_curvature, (), ("riemann",)),
    "ricci": Quantity(_curvature, (), ("ricci",)),
    "scalar_curvature": Quantity(_curvature, (), ("scalar_curvature",)),
}
