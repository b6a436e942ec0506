"""export: an item is ``{"tree", "quantity", "format", "form", "bind"}``; its outcome is the text.

The fields mean what they mean for ``GET /v1/trees/{tree}/{quantity}``; ``form`` and ``bind`` may be left out.
"""

from __future__ import annotations

from service.jobs.engine import Outcome
from service.jobs.kinds.decoded import model_of, pinned_model
from service.jobs.kinds.kind import Blobs, Item, Kind, Progress, check_fields, known_tree
from service.jobs.kinds.library import Library
from service.printing import Style, bound, check_quantity, described, model_quantity, text_of
from service.settings import Limits
from substructures.errors import Fault, InvalidDocument
from substructures.evaluation import Sources
from substructures.printers import FORMATS
from substructures.printers.render import FORMS


def _spread(item: Item, limits: Limits, _library: Library) -> list[Item]:
    check_fields(item, ("tree", "quantity", "format"), ("form", "bind"))
    given = {"form": FORMS[0], "bind": "", **item}
    faults = [
        Fault(f"/{name}", "string-expected", "a text is needed")
        for name in ("quantity", "bind")
        if not isinstance(given[name], str)
    ]
    for name, known in (("format", FORMATS), ("form", FORMS)):
        if given[name] not in tuple(known):
            message = f"unknown {name} {str(given[name])[:40]!r}; there are {', '.join(known)}"
            faults.append(Fault(f"/{name}", f"unknown-{name}", message))
    if faults:
        raise InvalidDocument(faults)
    return [{**given, "nodes": limits.job_nodes}]


def _resolve(item: Item, library: Library) -> tuple[Item, tuple[str, ...]]:
    tree = known_tree(item, library)
    pinned = {"tree": f"{tree.name}@{tree.digest}", "program": tree.program, "model": pinned_model(tree)}
    return {**item, **pinned}, (tree.program,)


def _run(item: Item, blobs: Blobs, _progress: Progress) -> Outcome:
    """File ``text``. Raises Refused, TooLarge."""
    model, quantity = model_of(item, blobs), item["quantity"]
    check_quantity(model, quantity)
    sources = Sources(model)
    members, parameters = described(sources, quantity)
    program = bound(model_quantity(sources, quantity), parameters, item["bind"])
    style = Style(item["format"], item["form"], item["bind"])
    text = text_of(program, style, model.coordinates, members, item["nodes"]).encode()
    summary = {"tree": item["tree"], "quantity": quantity, "media_type": FORMATS[style.format], "bytes": len(text)}
    return Outcome(summary, {"text": text})


EXPORT = Kind(_spread, _resolve, _run)
