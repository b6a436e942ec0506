"""simulate, optimise, analyse: numbers that follow from the equations of motion of a tree, one request an item.

An item given is ``{"tree", "request", "format"}``, or ``{"tree", "requests", "format"}``, which stands for as many; for
``analyse`` also ``"analysis"``, the name of an endpoint such as ``linearisations`` or ``root-loci``. ``request`` is the
body for that endpoint; ``format`` is json (default), npz, or what else the result can be.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import orjson

from service.analyses.numbers import ANALYSES
from service.analyses.results import JSON, MEDIA_TYPES, Answered, trajectory_of, written
from service.jobs.engine import Outcome
from service.jobs.kinds.decoded import summary_of
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, check_fields, inside, known_tree
from service.jobs.kinds.library import Library
from service.jobs.kinds.trees import pinned, source_of
from service.jobs.kinds.values import check_analysis, without_formulas
from service.refusals import Refused, problem
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.errors import InvalidDocument, meant

#: analyses that begin at one state, and those whose coordinates are only where something is looked for
MOTIONS = ("simulations", "sensitivities", "cost-gradients", "optimal-controls", "loop-states")
NEAR = ("equilibria", "root-loci", "steady-motions")
TOLD = ("status", "message", "is_right", "cost", "warnings")


def analysis_kind(name: str | None = None) -> Kind:
    """The kind for one analysis; without a name every item says which."""

    def spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
        """One item for each request."""
        which = ("analysis",) if name is None else ()
        what = "requests" if "requests" in item else "request"
        check_fields(item, ("tree", what, *which), ("format",))
        common = {"tree": item["tree"], "analysis": name or item["analysis"], "format": item.get("format", "json")}
        _check(common)
        summary = summary_of(known_tree(item, library).summary)
        requests = _requests(common["analysis"], item, summary)
        return [{**common, "request": each, **_limits(limits)} for each in requests]

    return Kind(spread, _resolve, _run)


def _limits(limits: Limits) -> ItemDocument:
    return {"limits": {"program_nodes": limits.job_nodes, "binary_bytes": limits.binary_bytes}}


def _check(item: ItemDocument) -> None:
    name, form = item["analysis"], item["format"]
    if name not in tuple(ANALYSES):
        what = f"unknown analysis '{name[:40]}'" if isinstance(name, str) else "the analysis is no text"
        message = f"{what}; there are {', '.join(ANALYSES)}{meant(str(name), ANALYSES)}"
        raise InvalidDocument.at("/analysis", "unknown-analysis", message)
    known = [form for form, media in MEDIA_TYPES.items() if media in ANALYSES[name].media]
    if form not in known:
        what = f"unknown format '{form[:40]}'" if isinstance(form, str) else "the format is no text"
        message = f"{what}; '{name}' can be {', '.join(known)}{meant(str(form), known)}"
        raise InvalidDocument.at("/format", "unknown-format", message)


def _requests(name: str, item: ItemDocument, summary: Mapping[str, Any]) -> list[Any]:
    """The requests that an item stands for, each of the right shape and for coordinates and parameters of the tree."""
    if "requests" not in item:
        given, places = [item["request"]], ["/request"]
    elif isinstance(item["requests"], list) and item["requests"]:
        given = item["requests"]
        places = [f"/requests/{k}" for k in range(len(given))]
    else:
        raise InvalidDocument.at("/requests", "empty", "a list of at least one request is needed")
    for request, place in zip(given, places, strict=True):
        with inside(place):
            read = ANALYSES[name].read(request, without_formulas(summary))
            if name not in NEAR:
                check_analysis(summary, read, name in MOTIONS, not ANALYSES[name].needs_parts)
    return given


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    request = item["request"]
    needed = any(map(request.get, ("reactions", "powers"))) or request.get("friction") == "loaded"
    has_parts = ANALYSES[item["analysis"]].needs_parts or needed
    return pinned(item, library, item["limits"]["program_nodes"], has_parts)


def _run(item: ItemDocument, blobs: Blobs, progress: ItemProgress) -> Outcome:
    """File ``result``, also of what has failed or is wrong, beside a problem that says so. An item of a request is
    ``answered``, and has a folder of ``kernels`` if there is one. Raises InvalidDocument
    (pointers into the request), MissingValue, TooLarge.
    """
    source, name = source_of(item, blobs, item["limits"]), item["analysis"]
    if item.get("kernels"):
        source = replace(source, folder=Path(item["kernels"]))
    model = source.model
    result = ANALYSES[name].compute(source, item["request"], lambda share: progress(float(share)))
    media = MEDIA_TYPES[item["format"]]
    data = written(result, media, model)
    told = orjson.loads(data if media == JSON else written(_brief(result), JSON, model))
    summary = {"tree": item["tree"], "analysis": name, "media_type": media, "bytes": len(data)}
    summary |= {key: told[key] for key in TOLD if key in told}
    motion = trajectory_of(result)
    if item.get("answered"):  # whatever a result says of itself, a request got it
        more = {} if motion is None else {"motion": {"status": motion.status, "is_right": motion.is_right}}
        return Outcome(summary | more, {"result": data})
    fault = fault_of(name, told)
    return Outcome(summary, {"result": data}, None if fault is None else problem(fault))


def fault_of(name: str, told: Mapping[str, Any]) -> Refused | None:
    """What is wrong with a result, by what it says of itself: it ends early, or a necessary condition is violated."""
    if told.get("status") == "failed":
        return Refused(422, "analysis-failed", f"'{name}' failed: {told.get('message') or 'the result says no more'}")
    if told.get("is_right") is False:
        violated = [each["name"] for each in told.get("checks", ()) if each["holds"] is False]
        which = f": {', '.join(violated)}" if violated else ""
        return Refused(422, "analysis-wrong", f"'{name}' is WRONG, a necessary condition is violated{which}")
    return None


def _brief(found: Answered) -> Answered:
    motion = trajectory_of(found)
    return found if motion is None else Answered(motion.summary(), found.warnings)
