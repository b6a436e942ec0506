"""JSON of resources. Stored JSON is spliced in as it is, so exact numbers stay exact and nothing is parsed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import orjson

from service.messages.addresses import BASE, tree_path, version_path
from service.operations.searches import Page
from service.queries.aliases import Alias, AliasHistoryEntry
from service.queries.audit import AuditEntry
from service.queries.catalogue import Version
from service.queries.searching.formulas import FormulaRow
from service.queries.trees import Tree
from service.queries.uses import Withdrawn
from substructures.expr.units.unit_check import Notice
from substructures.part.parameters import uncounted
from substructures.tree.model import no_coordinates

#: what there is at addresses below that of a version
_BELOW = ("definition", "formulas", "picture", "scene", "report", "uses", "levels")
_STORED = ("tags", "coordinates", "bodies", "ports", "parameters", "operations", "certificate")


def part_warnings(version: Version) -> list[Notice]:
    """Warnings about a definition; of one that was stored when units were texts, also about these."""
    certificate = orjson.loads(version.certificate)
    old = [] if "converted" in certificate else uncounted(orjson.loads(version.parameters))
    return [*certificate.get("warnings", ()), *old]


def tree_warnings(tree: Tree) -> Sequence[Mapping[str, str]]:
    """Warnings about a tree."""
    stored: list[Notice] = orjson.loads(tree.summary)["certificate"].get("warnings", [])
    return [*stored, *no_coordinates(tree.dof)]


def version_view(
    version: Version, aliases: Sequence[str], withdrawn: Sequence[Withdrawn] | None = None
) -> dict[str, Any]:
    """A version (HTTP contract, section 2); ``withdrawn``: of the parts that it is built of, where looked up."""
    path = version_path(version)
    built_of = {} if withdrawn is None else {"withdrawn": withdrawn_view(withdrawn)}
    return built_of | {
        "name": version.name,
        "version": version.version,
        "digest": version.digest,
        "title": version.title,
        "description": version.description,
        "dof": version.dof,
        "joints": version.joints,
        "mass": version.mass,
        **{name: orjson.Fragment(getattr(version, name)) for name in _STORED},
        "warnings": part_warnings(version),
        "program": version.program,
        "derived_here": version.is_derived,
        "created": version.created,
        "aliases": aliases,
        "is_withdrawn": version.withdrawn_at is not None,
        "withdrawn_at": version.withdrawn_at,
        "withdrawal_reason": version.withdrawal_reason,
        **provenance_view(version),
        "owner": version.owner,
        "visibility": version.visibility,
        "links": {
            "self": path,
            **{each: f"{path}/{each}" for each in _BELOW},
            "latest": f"{BASE}/substructures/{version.name}",
            "aliases": f"{BASE}/substructures/{version.name}/aliases",
            "versions": f"{BASE}/substructures/{version.name}/versions",
        },
    }


def provenance_view(version: Version) -> dict[str, Any]:
    """Where a version comes from, and what takes its place."""
    names = ("author", "note", "origin", "derived_from", "tree", "successor")
    return {name: getattr(version, name) for name in names}


def page_view(page: Page[Version], aliases: Sequence[Sequence[str]], next_link: str | None) -> dict[str, Any]:
    """A page of versions."""
    told = {"facets": page.facets, "instead": page.instead or None}
    return {name: x for name, x in told.items() if x is not None} | {
        "items": [version_view(version, names) for version, names in zip(page.items, aliases, strict=True)],
        "next_page_token": page.next_token,
        "links": {"next": next_link},
    }


def formulas_view(version: Version, rows: Sequence[FormulaRow]) -> dict[str, Any]:
    """The index of the stored formulas."""
    path = f"{version_path(version)}/formulas"
    return {
        "name": version.name,
        "version": version.version,
        "digest": version.digest,
        "program": version.program,
        "count": len(rows),
        "formulas": [_formula(row) for row in rows],
        "links": {"quantities": {q: f"{path}/{q}" for q in dict.fromkeys(row.quantity for row in rows)}},
    }


def _formula(row: FormulaRow) -> dict[str, Any]:
    return {
        "quantity": row.quantity,
        "body": row.body,
        "coordinate": row.coordinate,
        "shape": orjson.Fragment(row.shape),
        "symmetry": row.symmetry,
        "operations": row.operations,
        "output": row.output,
        "entry": orjson.Fragment(row.entry),
    }


def alias_view(name: str, alias: Alias, history: Sequence[AliasHistoryEntry]) -> dict[str, Any]:
    """An alias with its history, the newest change first."""
    return {
        "name": name,
        "alias": alias.alias,
        "version": alias.version,
        "revision": alias.revision,
        "changed": alias.changed,
        "history": [
            {"revision": c.revision, "version": c.version, "changed": c.changed, "principal": c.principal}
            for c in history
        ],
        "links": {"version": f"{BASE}/substructures/{name}@{alias.version}"},
    }


def withdrawn_view(withdrawn: Sequence[Withdrawn]) -> list[dict[str, Any]]:
    """Instances whose parts are withdrawn."""
    return [
        {
            "instance": each.instance,
            "substructure": f"{each.name}@{each.version}",
            "reason": each.reason,
            "successor": each.successor,
        }
        for each in withdrawn
    ]


def tree_view(tree: Tree, withdrawn: Sequence[Withdrawn] = ()) -> bytes:
    """The JSON of a tree (HTTP contract, section 3): names and links, then the stored summary as it is."""
    path = tree_path(tree)
    quantities = ("metric", "christoffel", "forces", "gravity", "coriolis", "kinematics")
    names = {
        "name": tree.name,
        "revision": tree.revision,
        "digest": tree.digest,
        "dof": tree.dof,
        "mass": tree.mass,
        "program": tree.program,
        "derived_here": tree.is_derived,
        "created": tree.created,
        "based_on": tree.based_on,
        "author": tree.author,
        "note": tree.note,
        "owner": tree.owner,
        "visibility": tree.visibility,
        "warnings": tree_warnings(tree),
        "withdrawn": withdrawn_view(withdrawn),
        "links": {"self": path, "latest": f"{BASE}/trees/{tree.name}", "evaluations": f"{path}/evaluations"}
        | {"kernels": f"{path}/kernels"}
        | {name: f"{path}/{name}" for name in (*quantities, "picture", "scene", "report")},
    }
    return dump(names)[:-1] + b"," + tree.summary.encode()[1:]


def tree_item(tree: Tree) -> dict[str, Any]:
    """A tree in a list."""
    names = ("name", "revision", "digest", "dof", "joints", "mass", "created", "owner", "visibility")
    told = {**{name: getattr(tree, name) for name in names}, "derived_here": tree.is_derived}
    return {**told, "links": {"self": tree_path(tree)}}


def tree_page_view(page: Page[Tree], next_link: str | None) -> dict[str, Any]:
    """A page of trees."""
    items = [tree_item(tree) for tree in page.items]
    told = {"instead": page.instead} if page.instead else {}
    return told | {"items": items, "next_page_token": page.next_token, "links": {"next": next_link}}


def audit_view(entry: AuditEntry) -> dict[str, Any]:
    """An act."""
    names = [name for name in AuditEntry.__slots__ if name != "detail"]
    return {**{name: getattr(entry, name) for name in names}, "detail": orjson.Fragment(entry.detail)}


def dump(view: Any) -> bytes:
    """The JSON bytes of a view."""
    return orjson.dumps(view)
