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

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.decoded import summary_of
from service.jobs.kinds.items import Analysed, Requested
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, inside, known_tree
from service.jobs.kinds.library import Library
from service.jobs.kinds.trees import pinned, source_of
from service.jobs.kinds.values import check_analysis, without_formulas
from service.messages.refusals import Refused, problem
from service.models.numbers import ANALYSES, OFFERED, analysis_of
from service.models.results import JSON, MEDIA_TYPES, Answered, trajectory_of, written
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_model
from substructures.errors import InvalidDocument, meant

#: analyses that begin at one state, those whose coordinates are only where something is looked for, and those of many
MOTIONS = (
    *("simulations", "sensitivities", "cost-gradients", "optimal-controls", "loop-states"),
    *("periodic-orbits", "poincare-sections", "lyapunov-exponents"),
)
NEAR = ("equilibria", "root-loci", "steady-motions", "reduced-equations")
MANY = ("ensembles", "optimal-parameters")
TOLD = ("status", "message", "is_right", "cost", "value", "parameters", "warnings")


def _kind(name: str | None = None) -> Kind:
    """The kind for one analysis; without a name every item says which."""

    def spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
        """One item for each request."""
        read = read_model(Requested if name else Analysed, item)
        called = read.analysis if isinstance(read, Analysed) else str(name)
        _check_format(called, read.format)
        requests = _requests(called, read, summary_of(known_tree(item, library).summary))
        common = {"tree": read.tree, "analysis": called, "format": read.format, **_limits(limits)}
        return [{**common, "request": each} for each in requests]

    return Kind(spread, _resolve, _run)


def _limits(limits: Limits) -> ItemDocument:
    return {"limits": {"program_nodes": limits.job_nodes, "binary_bytes": limits.binary_bytes}}


def _check_format(name: str, form: str) -> None:
    known = [form for form, media in MEDIA_TYPES.items() if media in OFFERED[name].media]
    if form not in known:
        message = f"unknown format '{form[:40]}'; '{name}' can be {', '.join(known)}{meant(form, known)}"
        raise InvalidDocument.at("/format", "unknown-format", message)


def _requests(name: str, item: Requested, summary: Mapping[str, Any]) -> list[ItemDocument]:
    """The requests that an item stands for, each of the right shape and for coordinates and parameters of the tree."""
    given = {"/request": item.request} if item.request is not None else {}
    given |= {f"/requests/{k}": each for k, each in enumerate(item.requests or [])}
    for place, request in given.items():
        with inside(place):
            model = without_formulas(summary)
            read = analysis_of(name, model).read(request, model)
            if name not in (*NEAR, *MANY):
                check_analysis(summary, read, name in MOTIONS, not ANALYSES[name].needs_parts)
    return list(given.values())


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
    result = analysis_of(name, model).compute(source, item["request"], lambda share: progress(float(share)))
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


KINDS = {"simulate": _kind("simulations"), "optimise": _kind("optimal-controls"), "analyse": _kind()}
