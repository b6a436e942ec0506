"""export: an item is ``{"tree", "quantity", "format", "form", "bind", "options"}``; its outcome is the text.

The fields mean what they mean for ``GET /v1/trees/{tree}/{quantity}``; ``form``, ``bind`` and ``options`` (lists of
texts by name, for quantities such as ``state_space``) may be left out. For ``velocity-equations`` there is also
``request``, the body of its endpoint.
"""

from __future__ import annotations

from service.analyses.formulas import QUANTITIES, WITH_DOCUMENT, made
from service.analyses.source import Source
from service.jobs.engine import Outcome
from service.jobs.kinds.kind import Blobs, Item, Kind, Progress, check_fields
from service.jobs.kinds.library import Library
from service.jobs.kinds.trees import pinned, source_of
from service.printing import Style, bound, check_quantity, described, made_text, model_quantity, needs_parts, text_of
from service.settings import Limits
from substructures.errors import Fault, InvalidDocument
from substructures.evaluation import Sources
from substructures.printers import FORMATS
from substructures.printers.render import FORMS


def _spread(item: Item, limits: Limits, _library: Library) -> list[Item]:
    body = ("request",) if item.get("quantity") in tuple(WITH_DOCUMENT) else ()
    check_fields(item, ("tree", "quantity", "format", *body), ("form", "bind", "options"))
    given = {"form": FORMS[0], "bind": "", "options": {}, **item}
    faults = [
        Fault(f"/{name}", "string-expected", "a text is needed")
        for name in ("quantity", "bind")
        if not isinstance(given[name], str)
    ]
    for name, known in (("format", FORMATS), ("form", FORMS)):
        if given[name] not in tuple(known):
            message = f"unknown {name} {str(given[name])[:40]!r}; there are {', '.join(known)}"
            faults.append(Fault(f"/{name}", f"unknown-{name}", message))
    if not _is_options(given["options"]):
        faults.append(Fault("/options", "options-expected", "lists of texts by name are needed"))
    if faults:
        raise InvalidDocument(faults)
    if body:
        _check_document(given["quantity"], given["request"])
    return [{**given, "nodes": limits.job_nodes}]


def _check_document(quantity: str, request: object) -> None:
    check, _ = WITH_DOCUMENT[quantity]
    try:
        check(request)
    except InvalidDocument as error:
        raise InvalidDocument(Fault("/request" + f.pointer, f.code, f.message) for f in error.faults) from None


def _is_options(given: object) -> bool:
    """Whether these are lists of texts by name."""
    lists = list(given.values()) if isinstance(given, dict) else [None]
    return all(isinstance(texts, list) and all(isinstance(text, str) for text in texts) for texts in lists)


def _resolve(item: Item, library: Library) -> tuple[Item, tuple[str, ...]]:
    return pinned(item, library, item["nodes"], needs_parts(item["quantity"]))


def _run(item: Item, blobs: Blobs, _progress: Progress) -> Outcome:
    """File ``text``. Raises Refused, TooLarge."""
    source, quantity = source_of(item, blobs, {"program_nodes": item["nodes"]}), item["quantity"]
    style = Style(item["format"], item["form"], item["bind"])
    is_stored = quantity not in (*QUANTITIES, *WITH_DOCUMENT)
    text = (_stored if is_stored else _followed)(source, item, style).encode()
    summary = {"tree": item["tree"], "quantity": quantity, "media_type": FORMATS[style.format], "bytes": len(text)}
    return Outcome(summary, {"text": text})


def _stored(source: Source, item: Item, style: Style) -> str:
    quantity, model, sources = item["quantity"], source.model, Sources(source.model, regressor=source.regressor)
    check_quantity(model, quantity)
    members, parameters = described(sources, quantity)
    program = bound(model_quantity(sources, quantity), parameters, style.bind)
    return text_of(program, style, model.coordinates, members, item["nodes"])


def _followed(source: Source, item: Item, style: Style) -> str:
    """A quantity that follows from the formulas of the model, or from its parts."""
    name, options = item["quantity"], {name: tuple(texts) for name, texts in item["options"].items()}
    if name in WITH_DOCUMENT:
        _, follow = WITH_DOCUMENT[name]
        found = follow(source, item["request"])
    else:
        found = made(source, name, options)
    return made_text(found, source.model.parameters, style, item["nodes"])


EXPORT = Kind(_spread, _resolve, _run)
