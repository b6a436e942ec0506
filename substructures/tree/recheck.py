"""The certificate of a stored tree made anew: program and summary as they are stored, against the documents."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from substructures.documents.fields import in_si
from substructures.errors import VerificationFailed
from substructures.expr.program import Program
from substructures.part.certificate import require_no_less
from substructures.part.definition import Definition
from substructures.tree.certificate import certify_tree
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

#: what is stored beside the program, but for the certificate
SUMMARY = ("coordinates", "joints", "frames", "closures", "limited", "parameters", "operations")


def recheck_tree(
    spec: TreeSpec, definitions: Mapping[str, Definition], summary: Mapping[str, Any], program: Program
) -> dict[str, Any]:
    """The certificate. ``definitions``: by instance; ``summary``: of :data:`SUMMARY`, as it was read from JSON.

    Raises VerificationFailed when program or summary disagree with the documents.
    """
    certificate = certify_tree(spec, definitions, summary, program)
    require_no_less(summary.get("certificate", {}), certificate)
    defaults = {name: in_si(p.value) for name, p in spec.parameters.items()}
    for instance, definition in definitions.items():
        defaults |= {f"{instance}.{name}": in_si(p.value) for name, p in definition.parameters.items()}
    used = {s.name for s in program.symbols if s.kind == "parameter"}
    said = {name: given.get("value") for name, given in summary["parameters"].items()}
    # older versions left out what no formula depends on
    if not used <= said.keys() <= defaults.keys() or any(said[name] != defaults[name] for name in said):
        raise VerificationFailed("the parameters of the model and their defaults are not those of the documents")
    model = Model.load({**summary, "certificate": certificate}, program.to_bytes())
    if dict(summary.get("operations", model.operations)) != model.operations:
        raise VerificationFailed("the operation counts of the model are not those of its program")
    return certificate
