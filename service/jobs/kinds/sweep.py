"""sweep: numbers of all combinations of parts and samples of one tree, in items that are ranges of rows.

The submission is one document (:mod:`substructures.sweeps.document`); of an item the references to parts are pinned,
and its outcome has the rows that fit as columns of an npz file, ``rows``.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from io import BytesIO
from math import prod
from random import SystemRandom
from typing import Any

import numpy as np

from service.content.cache import Cache
from service.content.derivation import software
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, stored_definition
from service.jobs.kinds.library import Library, StoredVersion
from service.messages.refusals import NotDerived, Refused, problem
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_model, write_json
from substructures.errors import Fault, InvalidDocument, InvalidInput
from substructures.formats.arrays import read_npz, write_npz
from substructures.part.definition import Definition
from substructures.sweeps.block import (
    AT_ONCE,
    Block,
    OptionOf,
    Refusals,
    ShapeOf,
    compute,
    disagreement,
    joined,
    rounding,
    shape_maker,
    slow_columns,
)
from substructures.sweeps.document import Query, SweepDocument
from substructures.sweeps.names import ROW, check_names
from substructures.sweeps.plan import Plan, check_size, check_template, given_options
from substructures.sweeps.shapes import Option, Shape, option_of

#: items of a sweep whose rows are quick; shapes of one item, each of which is coupled
ITEMS, SHAPES = 500, 16
#: items of a sweep with motions, of so many rows at least: about a second of work
ITEMS_OF_MOTIONS, MOTIONS = 2000, 128
#: options of all instances
MOST_OPTIONS = 20_000
#: members of a submission that are not the sweep's own
OWN = tuple(SweepDocument.model_fields)
_definitions: Cache[Definition] = Cache(1000, lambda _: 1)


def _spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
    document = read_model(SweepDocument, item)
    options, programs = _pinned(document, library)
    check_size(document, [len(each) for each in options])
    check_template(document, options)
    plan = Plan(document, tuple(tuple(each) for each in options))
    known = {digest: _definition(digest, library) for digest in _first_digests(options)}
    check_names(plan, [[known[_digest(one)] for one in each] for each in options])
    rows = plan.rows
    most, least = (ITEMS_OF_MOTIONS, MOTIONS) if plan.columns.of_motions else (ITEMS, AT_ONCE)
    size = max(least, -(-rows // most // least) * least)
    shapes = prod(len({programs[_digest(one)] for one in each}) for each in options)
    if shapes > SHAPES:
        size = max(1, min(size, rows * SHAPES // shapes))
    size = max(size, -(-rows // limits.job_items))
    proven = sorted(SystemRandom().sample(range(rows), min(document.proof, rows)))
    common = {
        "sweep": {name: item[name] for name in OWN if name in item},
        "order": {"columns": list(document.columns), "of": list(document.samples.of) if document.samples else []},
        "options": options,
        "programs": programs,
        "nodes": limits.job_nodes,
    }
    ranges = [(start, min(start + size, rows)) for start in range(0, rows, size)]
    return [{**common, "rows": [a, b], "proof": [row for row in proven if a <= row < b]} for a, b in ranges]


def _pinned(document: SweepDocument, library: Library) -> tuple[list[list[dict[str, Any]]], dict[str, str]]:
    """The options of each instance, references pinned, and the program of every definition."""
    found: list[list[dict[str, Any]]] = []
    programs: dict[str, str] = {}
    faults: list[Fault] = []
    for each in given_options(document):
        here: list[dict[str, Any]] = []
        for place, fields in _searched(each, library):
            reference = fields.get("substructure")
            version = library.version(reference) if isinstance(reference, str) else None
            if version is None:
                told = "an instance of a sweep is a stored part: name its 'substructure'"
                message = told if reference is None else library.absent("substructure", str(reference))
                faults.append(Fault(place, "unknown-substructure", message))
                continue
            programs[version.digest] = _program(version)
            here.append({**fields, "substructure": f"{version.name}@{version.digest}"})
        found.append(here)
    if faults:
        raise InvalidDocument(faults)
    if sum(map(len, found)) > MOST_OPTIONS:
        message = f"{sum(map(len, found)):,} parts to choose from; the limit is {MOST_OPTIONS:,}"
        raise InvalidDocument.at("/choices", "too-many-choices", message)
    return found, programs


def _program(version: StoredVersion) -> str:
    if version.software != software():
        raise NotDerived("part", version.digest)
    return version.program


def _searched(
    options: Sequence[tuple[str, Mapping[str, Any]]], library: Library
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Options, with what a query finds in its place."""
    for place, fields in options:
        query = fields.get("query")
        if not isinstance(query, Query):
            yield place, dict(fields)
            continue
        references = library.search(query.model_dump(exclude_none=True))
        if not references:
            raise InvalidDocument.at(f"{place}/query", "nothing-found", "no part of the catalogue is like this")
        rest = {name: x for name, x in fields.items() if name not in ("query", "definition")}
        yield from ((place, {**rest, "substructure": reference}) for reference in references)


def _digest(fields: Mapping[str, Any]) -> str:
    return str(fields["substructure"]).partition("@")[2]


def _first_digests(options: Sequence[Sequence[Mapping[str, Any]]]) -> list[str]:
    return list(dict.fromkeys(_digest(one) for each in options for one in each))


def _definition(digest: str, library: Library) -> Definition:
    return _definitions.once(digest, lambda: stored_definition(digest, library))


def _resolve(item: ItemDocument, _library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    plan = plan_of(item)
    size, (start, stop) = plan.sampler.size, item["rows"]
    first, last = start // size, (stop - 1) // size
    if last - first + 1 >= max(len(each) for each in plan.options):
        chosen = _first_digests(plan.options)
    else:
        places = [plan.chosen(each) for each in range(first, last + 1)]
        chosen = list(dict.fromkeys(_digest(plan.options[i][k]) for row in places for i, k in enumerate(row)))
    return item, (*chosen, *dict.fromkeys(item["programs"][digest] for digest in chosen))


@dataclass
class _Prepared:
    """A sweep with what its items share in one process."""

    plan: Plan
    options: dict[tuple[int, int], Option] = field(default_factory=dict)
    shapes: dict[tuple[str, ...], Shape] = field(default_factory=dict)


_plans: Cache[_Prepared] = Cache(4, lambda _: 1)


def plan_of(item: ItemDocument) -> Plan:
    """The plan of the sweep that an item is of."""
    return _prepared(item).plan


def _prepared(item: ItemDocument) -> _Prepared:
    order = item.get("order", {})
    key = hashlib.sha256(write_json([item["sweep"], item["options"], order])).hexdigest()

    def made() -> _Prepared:
        """The plan, read."""
        document = read_model(SweepDocument, _in_order(item["sweep"], order))
        return _Prepared(Plan(document, tuple(tuple(each) for each in item["options"])))

    return _plans.once(key, made)


def _in_order(sweep: Mapping[str, Any], order: Mapping[str, Sequence[str]]) -> dict[str, Any]:
    """The document with columns and samples as they were written: items are kept with sorted names."""
    found = dict(sweep)
    if order.get("columns"):
        found["columns"] = {name: sweep["columns"][name] for name in order["columns"]}
    if order.get("of"):
        of = sweep["samples"]["of"]
        found["samples"] = {**sweep["samples"], "of": {name: of[name] for name in order["of"]}}
    return found


def _run(item: ItemDocument, blobs: Blobs, progress: ItemProgress) -> Outcome:
    """File ``rows``: number and columns of every row that fits."""
    prepared, (start, stop) = _prepared(item), item["rows"]
    plan, refusals, finite, blocks = prepared.plan, Refusals(), [0], list[Block]()

    def option(instance: int, index: int) -> Option:
        """The option, its part decoded once a process."""
        key = instance, index
        if key not in prepared.options:
            fields = plan.options[instance][index]
            digest = _digest(fields)
            prepared.options[key] = option_of(part_of(digest, item["programs"][digest], blobs), fields)
        return prepared.options[key]

    shape_of = shape_maker(plan, prepared.shapes, item["nodes"])
    for first in range(start, stop, AT_ONCE):
        blocks.append(compute(plan, first, min(first + AT_ONCE, stop), option, shape_of, refusals, finite))
        progress(0.95 * (min(first + AT_ONCE, stop) - start) / (stop - start))
    found = joined(plan, blocks, stop - start, is_whole=False)
    wrong, proven = _proven(plan, found, item, option, shape_of)
    summary = {
        "rows": [start, stop],
        "kept": len(found.rows),
        "finite": sum(finite),
        "refused": refusals.by_code,
        "proven": proven,
        "ways": refusals.ways,
        "media_type": "application/x-npz",
    }
    files = {"rows": b"".join(write_npz({ROW: found.rows, **found.columns}).pieces)}
    if wrong:
        detail = f"row {wrong[0]}: {wrong[1]}; nothing of these rows is to be believed"
        return Outcome(summary, files, problem(Refused(500, "proof-failed", detail)))
    return Outcome(summary, files)


def _proven(
    plan: Plan, found: Block, item: ItemDocument, option: OptionOf, shape_of: ShapeOf
) -> tuple[tuple[int, str] | None, int]:
    """A row that differs from the slow way, if there is one, and how many were compared."""
    done = 0
    places = {int(row): k for k, row in enumerate(found.rows)}
    for row in (each for each in item["proof"] if each in places):
        chosen = plan.chosen(row // plan.sampler.size)
        options = [option(i, k) for i, k in enumerate(chosen)]
        try:
            slow, condition = slow_columns(plan, row, [each.part for each in options], item["nodes"])
        except InvalidInput as error:
            return (row, f"its tree is refused: {error}"), done
        fast = {name: float(found.columns[name][places[row]]) for name in slow}
        moved = partial(rounding, plan, row, options, shape_of)
        if told := disagreement(fast, slow, condition, plan.columns.of_motions, moved):
            return (row, told), done
        done += 1
    return None, done


def rows_of(content: bytes) -> dict[str, np.ndarray[Any, Any]]:
    """The arrays of the file ``rows`` of an item."""
    return read_npz(BytesIO(content), len(content))


KINDS = {"sweep": Kind(_spread, _resolve, _run)}
