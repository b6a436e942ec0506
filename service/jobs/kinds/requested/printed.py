"""Formulas of parts as text: a work of requests."""

from __future__ import annotations

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.kind import Blobs
from service.models.printing import Style, names_of_steps, text_of, with_numbers
from service.schemas.jobs import ItemDocument
from substructures.export import interface_of_part
from substructures.expr.program import Program
from substructures.part.outputs import with_own_inertia
from substructures.part.parameters import described_inputs
from substructures.tree.glossary import part_glossary

BODY = "body"  # file of an outcome that is an answer


def _print_part(item: ItemDocument, blobs: Blobs) -> Outcome:
    """Formulas of a part that were ``selected``, in the style chosen."""
    part = part_of(item["digest"], item["program"], blobs)
    selected = Program.from_bytes(blobs[item["selected"]]).marked(item["not_judged"])
    style, quantity = Style(**item["style"]), item["quantity"]
    own = with_own_inertia(part, selected) if item["own"] else selected
    inputs = described_inputs(part.definition.inputs)
    program = with_numbers(own, part.parameters, inputs, style)
    named = names_of_steps(style, part.parameters, inputs, lambda: part_glossary(part))
    text = text_of(program, style, quantity, interface_of_part(part, digest=item["digest"]), glossary=named)
    return Outcome(files={BODY: text.encode()})


REQUESTED = {"print-part": _print_part}
