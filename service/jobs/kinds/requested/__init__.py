"""What requests let runners compute beside what jobs are made of: files are read, trees become parts, and what is to be
read by people is written. No submission names these kinds; their items come from the service itself.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from io import BytesIO

from service.content.summaries import part_content
from service.content.unzipped import unzipped
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import tree_parts
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.kind import Blobs, admitted
from service.jobs.kinds.requested.derived import derived_of
from service.jobs.kinds.requested.drawn import picture_of, scene_of
from service.jobs.kinds.requested.previewed import preview_of
from service.jobs.kinds.requested.renewed import RENEWED
from service.jobs.kinds.requested.reported import difference_of, report_of
from service.jobs.kinds.requested.shown import entry_of, integrals_of, origins_of, program_of
from service.models.printing import Style, names_of_steps, text_of, with_numbers
from service.schemas.jobs import ItemDocument
from service.schemas.publishing import PublishRequest
from substructures.documents import read_model
from substructures.errors import InvalidArgument
from substructures.export import interface_of_part
from substructures.expr.program import Program
from substructures.interchange.as_part import Options
from substructures.interchange.files.archive import Beside, main_of
from substructures.interchange.importing import import_file
from substructures.part.outputs import with_own_inertia
from substructures.part.parameters import described_inputs
from substructures.tree.glossary import part_glossary
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

BODY = "body"  # file of an outcome that is an answer
ZIP = b"PK\x03\x04"
MOST_FILES = 2000


def _read_file(item: ItemDocument, blobs: Blobs) -> Outcome:
    """The document of a robot file, with the report. Raises InvalidDocument with line and element, or with pointers
    into the query."""
    options = Options(item["parameters"], item["fixed"], item["base"], item["rotations"])
    data, called, beside = _opened(blobs[item["file"]], item["called"], item["unpacked"])
    about = {"name": item["name"], "file": called, "license_of_file": item["license"], "included": beside}
    try:
        found = import_file(data, options, kind=item["kind"], cut=item["cut"], **about)
    except InvalidArgument as error:
        raise error.below("/query") from None
    return Outcome(found.plain())


def _opened(data: bytes, called: str, most: int) -> tuple[bytes, str, Mapping[str, bytes]]:
    """A robot file, its name, and what lies about it in a zip of at most so many bytes. Raises InvalidDocument, Refused
    422."""
    if not data.startswith(ZIP):
        return data, called, {}
    files = unzipped(BytesIO(data), MOST_FILES, most, lambda _: most)
    main = main_of(files, files.__getitem__, called)
    return files[main], main, Beside(main, files, files.__getitem__)


def publication_of(request: PublishRequest, name: str) -> Publication:
    """What a tree shall become; ``name``: of the part."""
    return Publication({"name": name, **request.about()}, request.ports, tuple(request.free), request.defaults)


def _publish(item: ItemDocument, blobs: Blobs) -> Outcome:
    """What is stored of the part that a tree becomes."""
    spec, parts = tree_parts(item["parts"], blobs)
    found = published(spec, parts, publication_of(read_model(PublishRequest, item["request"]), item["name"]))
    part = published_part(found, parts, item["nodes"], admitted(item))
    return Outcome(files=part_content(part, item["recipe"]).files())


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


REQUESTED: Mapping[str, Callable[[ItemDocument, Blobs], Outcome]] = {
    "import": _read_file,
    "preview": preview_of,
    "publish": _publish,
    "print-part": _print_part,
    "report": report_of,
    "difference": difference_of,
    "program": program_of,
    "origins": origins_of,
    "entry": entry_of,
    "integrals": integrals_of,
    "picture": picture_of,
    "scene": scene_of,
    "derived": derived_of,
    **RENEWED,
}
