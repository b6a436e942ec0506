"""Versions, revisions, uses and differences, on the pages of parts and trees and on one of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from service.operations.differences import Level
from service.pages.html import Content, Html, html, joined, link, table, tag
from service.pages.layout import document
from service.queries.catalogue import Version
from service.queries.uses import Use, Withdrawn
from service.queries.versions import RevisionEntry, VersionEntry
from substructures.documents import read_json
from substructures.interchange.difference.formulas import RANGE, STATES

SHOWN = 20  # versions, revisions, uses
MOST_COMPARED = 10_000  # operations of parts whose levels are compared while their page is made, about two seconds


def versions_section(entries: Sequence[VersionEntry]) -> list[Html]:
    """The newest versions of a part, each with its difference from the one before."""
    rows = [
        (
            link(f"@{each.version}", f"/substructures/{each.name}@{each.version}"),
            each.created[:10],
            _whence(each),
            each.note,
            _compared("substructures", each.name, each.before or 0, each.version),
        )
        for each in entries[:SHOWN]
    ]
    address = f"/v1/substructures/{entries[0].name}/versions" if entries else ""
    return _section("Versions", ("version", "stored", "from", "note", ""), rows, len(entries) > SHOWN, address)


def revisions_section(entries: Sequence[RevisionEntry]) -> list[Html]:
    """The newest revisions of a tree."""
    rows = [
        (
            link(f"@{each.revision}", f"/trees/{each.name}@{each.revision}"),
            each.created[:10],
            each.note,
            _compared("trees", each.name, each.based_on or (older.revision if older else 0), each.revision),
        )
        for each, older in zip(entries[:SHOWN], [*entries[1:], None], strict=False)
    ]
    address = f"/v1/trees/{entries[0].name}/revisions" if entries else ""
    return _section("Revisions", ("revision", "stored", "note", ""), rows, len(entries) > SHOWN, address)


def levels_section(levels: Sequence[Level]) -> list[Html]:
    """The other levels of a part, each with the errors of the shorter one."""
    rows = [
        (
            link(f"{each.version.name}@{each.version.version}", version_page(each.version)),
            each.level,
            each.version.dof,
            read_json(each.version.operations.encode())["total"],
            link(
                _error(each),
                f"{version_page(each.full)}/difference?to={each.shorter.name}@{each.shorter.version}",
            ),
        )
        for each in levels
    ]
    measured = f"error of the shorter at {STATES} states, q and q' from {RANGE[0]:g} to {RANGE[1]:g}: largest (rms)"
    return _section("Levels", ("", "level", "coordinates", "operations", measured), rows, False, "", "levels")


def _error(level: Level) -> str:
    """The errors of the quantities that the equations of motion are made of; ``none``: they are the same."""
    if level.error is None or level.rms is None:
        return "what changed"
    told = {"metric": "M", "christoffel": "Gamma", "applied": "Q", "potential": "V"}
    shown = {letter: (level.error[name], level.rms[name]) for name, letter in told.items() if name in level.error}
    return ", ".join(f"{k} {_percent(x)} ({_percent(rms)})" for k, (x, rms) in shown.items()) or "none"


def _percent(x: float | None) -> str:
    if x is None:
        return "?"
    return f"{100 * x:.2g} %" if x < 0.1 else f"{100 * x:.0f} %"


def version_page(version: Version) -> str:
    """The address of the page of a version."""
    return f"/substructures/{version.name}@{version.version}"


def uses_section(uses: Sequence[Use], reference: str) -> list[Html]:
    """What is built of a part."""
    if not uses:
        return []
    kinds = {"tree": "trees", "part": "substructures", "derived": "substructures"}
    words = {"tree": "tree", "part": "part of a tree", "derived": "made from it"}
    rows = [
        (
            link(f"{use.name}@{use.number}", f"/{kinds[use.kind]}/{use.name}@{use.number}"),
            words[use.kind],
            joined([f"{instance} is @{version}" for instance, version in use.instances.items()]),
        )
        for use in uses[:SHOWN]
    ]
    address = f"/v1/substructures/{reference}/uses"
    return _section("Used by", ("", "as", "instances"), rows, len(uses) > SHOWN, address, "uses")


def withdrawn_section(withdrawn: Sequence[Withdrawn]) -> list[Html]:
    """Parts of a tree, or of a part that was one, that are withdrawn."""
    return [
        tag(
            "p",
            f"Instance {each.instance}: ",
            link(f"{each.name}@{each.version}", f"/substructures/{each.name}@{each.version}"),
            f" is withdrawn{f': {each.reason}' if each.reason else ''}",
            html("; take ", link(each.successor, f"/substructures/{each.successor}")) if each.successor else None,
            class_="warn",
        )
        for each in withdrawn
    ]


def difference_page(kind: str, a: str, b: str, found: Mapping[str, Any]) -> bytes:
    """The bytes of the page about a difference; ``kind``: ``substructures`` or ``trees``."""
    fields = [(tag("code", each["place"]), each["words"]) for each in found["definition"]]
    quantities = [_quantity(name, each) for name, each in found["quantities"].items() if each["differing"]]
    address = f"/v1/{kind}/{a}/difference?to={b}"
    return document(
        f"{a} and {b} - substructures",
        tag("h1", link(a, f"/{kind}/{a}"), " and ", link(b, f"/{kind}/{b}")),
        tag("ul", [tag("li", words) for words in found["words"]], class_="plain"),
        *([tag("h2", "Fields"), table(("place", "change"), fields)] if fields else []),
        *([tag("h2", "Formulas"), table(COLUMNS, quantities)] if quantities else []),
        tag("p", "Entry by entry: ", link("JSON", address)),
        crumbs=[("trees", "/trees") if kind == "trees" else ("catalogue", "/"), (a, f"/{kind}/{a}")],
    )


COLUMNS = ("quantity", "entries", "changed", "new", "gone", "other numbers at the defaults", "at most")


def _quantity(name: str, each: Mapping[str, Any]) -> tuple[Content, ...]:
    size = "" if each["change"] is None else _percent(float(each["change"]))
    counts = [each[state] for state in ("changed", "new", "gone")]
    return tag("code", name), each["entries"], *counts, each["moved"], size


def _whence(entry: VersionEntry) -> Html:
    """What a version came as, of what, and whether it is withdrawn."""
    said: list[Content] = []
    if entry.tree:
        said.append(html("the tree ", link(entry.tree, f"/trees/{entry.tree}")))
    if entry.derived_from:
        said.append(link(entry.derived_from, f"/substructures/{entry.derived_from}"))
    if entry.withdrawn_at:
        instead = f"; take {entry.successor}" if entry.successor else ""
        reason = f": {entry.withdrawal_reason}" if entry.withdrawal_reason else ""
        said.append(tag("span", f"withdrawn{reason}{instead}", class_="warn"))
    return joined(said or [entry.origin])


def _compared(kind: str, name: str, before: int, number: int) -> Content:
    if before < 1:
        return None
    return link(f"what changed since @{before}", f"/{kind}/{name}@{before}/difference?to={name}@{number}")


def _section(
    title: str,
    columns: Sequence[str],
    rows: Sequence[Sequence[Content]],
    more: bool,
    address: str,
    anchor: str | None = None,
) -> list[Html]:
    note = tag("p", "There are more: ", link("all", address), ".", class_="quiet") if more else Html()
    return [tag("h2", title, id=anchor), table(columns, rows), note] if rows else []
