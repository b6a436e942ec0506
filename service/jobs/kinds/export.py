"""export: an item is ``{"tree", "quantity", "format", "form", "bind", "options"}``; its outcome is the text.

The fields mean what they mean for ``GET /v1/trees/{tree}/{quantity}``; ``form``, ``bind`` and ``options`` (lists of
texts by name, for quantities such as ``state_space``) may be left out.
"""

from __future__ import annotations

from service.analyses.formulas import QUANTITIES, made
from service.jobs.engine import Outcome
from service.jobs.kinds.decoded import model_of, pinned_model, source_of
from service.jobs.kinds.kind import Blobs, Item, Kind, Progress, check_fields, known_tree
from service.jobs.kinds.library import Library
from service.printing import Style, bound, check_quantity, described, made_text, model_quantity, text_of
from service.settings import Limits
from substructures.errors import Fault, InvalidDocument
from substructures.evaluation import Sources
from substructures.model import Model
from substructures.printers import FORMATS
from substructures.printers.render import FORMS


def _spread(item: Item, limits: Limits, _library: Library) -> list[Item]:
    check_fields(item, ("tree", "quantity", "format"), ("form", "bind", "options"))
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
    return [{**given, "nodes": limits.job_nodes}]


def _is_options(given: object) -> bool:
    """Whether these are lists of texts by name."""
    lists = list(given.values()) if isinstance(given, dict) else [None]
    return all(isinstance(texts, list) and all(isinstance(text, str) for text in texts) for texts in lists)


def _resolve(item: Item, library: Library) -> tuple[Item, tuple[str, ...]]:
    tree = known_tree(item, library)
    pinned = {"tree": f"{tree.name}@{tree.digest}", "program": tree.program, "model": pinned_model(tree)}
    return {**item, **pinned}, (tree.program,)


def _run(item: Item, blobs: Blobs, _progress: Progress) -> Outcome:
    """File ``text``. Raises Refused, TooLarge."""
    model, quantity = model_of(item, blobs), item["quantity"]
    style = Style(item["format"], item["form"], item["bind"])
    text = (_followed if quantity in QUANTITIES else _stored)(model, item, style).encode()
    summary = {"tree": item["tree"], "quantity": quantity, "media_type": FORMATS[style.format], "bytes": len(text)}
    return Outcome(summary, {"text": text})


def _stored(model: Model, item: Item, style: Style) -> str:
    quantity, sources = item["quantity"], Sources(model)
    check_quantity(model, quantity)
    members, parameters = described(sources, quantity)
    program = bound(model_quantity(sources, quantity), parameters, style.bind)
    return text_of(program, style, model.coordinates, members, item["nodes"])


def _followed(model: Model, item: Item, style: Style) -> str:
    """A quantity that follows from the formulas of the model."""
    source = source_of(item, model, {"program_nodes": item["nodes"]})
    options = {name: tuple(texts) for name, texts in item["options"].items()}
    return made_text(made(source, item["quantity"], options), model.parameters, style, item["nodes"])


EXPORT = Kind(_spread, _resolve, _run)
