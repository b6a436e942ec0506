"""export: an item is ``{"tree", "quantity", "format", "form", "bind", "options", "name", "group"}``; its outcome is the
text. Or ``{"tree", "target", "quantities", "name", "bind", "together", "packed", "fmi", "precision", "ranges",
"stages", "standard", "independent"}``: what is got by ``GET /v1/trees/{tree}/export``; with ``substructure`` in place
of ``tree``, by ``GET /v1/substructures/.../export``.

The fields mean what they mean for ``GET /v1/trees/{tree}/{quantity}``; ``form``, ``bind``, ``options`` (lists of texts
by name, for quantities such as ``state_space``) and ``group`` may be left out. For ``velocity-equations`` there is
also ``request``, the body of its endpoint. Pointers of a problem are relative to the item.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import lru_cache
from typing import Any

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import tree_parts
from service.jobs.kinds.decoded import part_of, summary_of
from service.jobs.kinds.items import Packed, Written, members
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, inside, known_part, known_tree
from service.jobs.kinds.library import Library
from service.jobs.kinds.trees import pinned, source_of
from service.messages.refusals import moved
from service.models.binding import DEFAULTS, bindings, unit_faults
from service.models.exporting import (
    WITH_PARTS,
    ZIP,
    Package,
    part_package,
    read_item,
    tree_package,
)
from service.models.formulas import OPTIONS, QUANTITIES, WITH_DOCUMENT, made, makers
from service.models.grouping import QUANTITIES as GROUPED
from service.models.grouping import grouped_text
from service.models.printing import (
    Style,
    check_quantity,
    described,
    has_parts,
    made_text,
    options_of_quantity,
    source_glossary,
    text_of,
    with_numbers,
    with_options,
)
from service.models.source import Source
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import pointer_step, read_model
from substructures.documents.fields import Quantity, quantity_of
from substructures.errors import Fault, InvalidDocument, TooLarge, among, meant
from substructures.export import FORMATS, Interface, interface_of_model
from substructures.expr.graph import Graph
from substructures.expr.parse import parse
from substructures.expr.steps import ExpressionError
from substructures.quantities.quantity import REGRESSOR, TABLE, askable

PART = "substructure"


def _spread(item: ItemDocument, limits: Limits, _library: Library) -> list[ItemDocument]:
    if "target" in item:
        return [{**members(read_model(Packed, item)), "nodes": limits.job_nodes}]
    read = read_model(Written, item)
    if read.request is not None:
        check, _ = WITH_DOCUMENT[read.quantity]
        with inside("/request"):
            check(read.request)
    return [{**members(read), "nodes": limits.job_nodes}]


def _quantity_faults(item: ItemDocument, summary: Mapping[str, Any]) -> Iterator[Fault]:
    """An unknown quantity, and options that it cannot have."""
    quantity, options = item["quantity"], item["options"]
    outputs = [name for name in summary["operations"] if name != "total"]
    known = dict.fromkeys([*askable(outputs), *QUANTITIES, *WITH_DOCUMENT])
    if quantity not in known:
        message = f"there is no quantity '{quantity[:80]}'; there are {', '.join(known)}{meant(quantity, known)}"
        yield Fault("/quantity", "unknown-quantity", message)
        return
    if item["group"] and quantity not in GROUPED:
        yield Fault("/group", "not-grouped", f"'{quantity[:80]}' has no formulas in grouped symbols")
    taken = tuple(OPTIONS) if quantity in QUANTITIES else options_of_quantity(quantity)
    for name, texts in options.items():
        if texts and name not in taken:
            message = f"'{quantity}' has no option '{name[:80]}'{among(name, taken)}"
            yield Fault("/options" + pointer_step(name), "unknown-option", message)


def _is_of_regressor(quantity: str) -> bool:
    return quantity in TABLE and TABLE[quantity].source == REGRESSOR


def _bind_faults(item: ItemDocument, summary: Mapping[str, Any]) -> Iterator[Fault]:
    """What is no ``name:value``, unknown parameters, and units that do not fit; the regressor has more parameters than
    the other formulas."""
    known = summary["parameters"]
    for name, given in bindings(item["bind"]):
        if given is None and name == DEFAULTS:
            continue
        value = "" if given is None else quantity_of(given)
        if not _is_expression(value.value if isinstance(value, Quantity) else value):
            yield Fault("/bind", "bind", f"'{(name if given is None else f'{name}:{given}')[:80]}' is not name:value")
        elif name not in known and not _is_of_regressor(item["quantity"]) and not item["group"]:
            message = f"there is no parameter '{name[:80]}'{among(name, known)}"
            yield Fault("/bind", "unknown-parameter", message)
        else:
            yield from (replace(fault, pointer="/bind") for fault in unit_faults(name, value, known))


@lru_cache(maxsize=10_000)
def _is_expression(text: Any) -> bool:
    """Whether this is a number or an expression in any names."""
    graph = Graph()
    try:
        parse(graph, text, graph.symbol)
    except (ExpressionError, ArithmeticError, TooLarge):
        return False
    return True


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    if PART in item:
        part = known_part(item, library)
        told = {"not_judged": list(part.not_judged)} if part.not_judged else {}
        pinned_part = {PART: f"{part.name}@{part.digest}", "program": part.program, **told}
        return {**item, **pinned_part}, (part.digest, part.program)
    summary = summary_of(known_tree(item, library).summary)
    if "target" in item:
        item = {**item, "called": item["tree"].partition("@")[0]}
        return pinned(
            item, library, item["nodes"], item["target"] in WITH_PARTS or any(map(has_parts, item["quantities"]))
        )
    faults = [*_quantity_faults(item, summary), *_bind_faults(item, summary)]
    if faults:
        raise InvalidDocument(faults)
    return pinned(item, library, item["nodes"], item.get("group", False) or has_parts(item["quantity"]))


def _run(item: ItemDocument, blobs: Blobs, _progress: ItemProgress) -> Outcome:
    """File ``text``, or ``archive`` of a target with several. Raises Refused, TooLarge."""
    if "target" in item:
        return _exported(item, blobs)
    source, quantity = source_of(item, blobs, {"program_nodes": item["nodes"]}), item["quantity"]
    style = Style(item["format"], item["form"], item["bind"], item["name"]).of(item["tree"].partition("@")[0], quantity)
    is_stored = quantity not in (*QUANTITIES, *WITH_DOCUMENT)
    with moved(_place):
        write = _grouped if item.get("group") else _stored if is_stored else _followed
        text = write(source, item, style).encode()
    summary = {"tree": item["tree"], "quantity": quantity, "media_type": FORMATS[style.format], "bytes": len(text)}
    return Outcome(summary, {"text": text})


def _exported(item: ItemDocument, blobs: Blobs) -> Outcome:
    with moved(_place):
        made = _part_package(item, blobs) if PART in item else _tree_package(item, blobs)
    of = PART if PART in item else "tree"
    summary = {of: item[of], "target": item["target"], "name": made.name, "media_type": made.media}
    kind = "archive" if made.media == ZIP else "text"
    return Outcome({**summary, "bytes": len(made.data)}, {kind: made.data})


def _part_package(item: ItemDocument, blobs: Blobs) -> Package:
    digest = item[PART].partition("@")[2]
    reference, part = str(item.get("reference", item[PART])), part_of(digest, item["program"], blobs)
    part = replace(part, program=part.program.marked(item.get("not_judged", ())))
    return part_package(part, reference, digest, read_item(item), item["nodes"])


def _tree_package(item: ItemDocument, blobs: Blobs) -> Package:
    source = source_of(item, blobs, {"program_nodes": item["nodes"]})
    request = read_item(item)
    return tree_package(
        source.sources,
        item["called"],
        str(item.get("reference", item["tree"])),
        source.digest,
        request,
        item["nodes"],
        lambda: tree_parts(item["parts"], blobs),
        makers(source, request.independent),
    )


def _place(pointer: str) -> str:
    """A pointer into a query as one into the item."""
    if pointer in ("/query/bind", "/query/group"):
        return pointer.removeprefix("/query")
    return "/options" + pointer.removeprefix("/query") if pointer.startswith("/query") else pointer


def _stored(source: Source, item: ItemDocument, style: Style) -> str:
    quantity, model, sources = item["quantity"], source.model, source.sources
    check_quantity(model, quantity)
    sources = with_options(sources, quantity, {name: tuple(texts) for name, texts in item["options"].items()})
    members, parameters = described(sources, quantity)
    program = with_numbers(sources.formulas(quantity), parameters, model.inputs, style)
    named = source_glossary(source, style, parameters)
    return text_of(program, style, quantity, _interface(source), members, item["nodes"], glossary=named)


def _grouped(source: Source, item: ItemDocument, style: Style) -> str:
    """A quantity in grouped symbols."""
    return grouped_text(source, item["quantity"], style, _interface(source), item["nodes"])


def _followed(source: Source, item: ItemDocument, style: Style) -> str:
    """A quantity that follows from the formulas of the model, or from its parts."""
    name, options = item["quantity"], {name: tuple(texts) for name, texts in item["options"].items()}
    if name in WITH_DOCUMENT:
        _, follow = WITH_DOCUMENT[name]
        with inside("/request"):
            found = follow(source, item["request"])
    else:
        found = made(source, name, options)
    return made_text(found, name.replace("-", "_"), _interface(source), source, style, item["nodes"])


def _interface(source: Source) -> Interface:
    return interface_of_model(source.model, digest=source.digest)


KINDS = {"export": Kind(_spread, _resolve, _run)}
