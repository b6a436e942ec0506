"""Submit, find, search, name and yank substructures."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from service.database.connections import Connection
from service.paging import read_token, write_token
from service.queries import aliases, catalogue, content
from service.queries.formulas import FormulaRow
from service.references import ALIAS, Reference, parse_reference
from service.refusals import Refused, not_found, unprocessable
from service.store import Store
from service.summaries import PartContent, part_content
from substructures.part.definition import Definition
from substructures.part.part import derive


@dataclass(frozen=True, slots=True)
class PartSubmission:
    """A definition ready to be stored; ``content`` is None when that is stored already. ``is_mended``: what is stored
    is damaged, and the content takes its place."""

    name: str
    digest: str
    content: PartContent | None
    is_mended: bool = False


@dataclass(frozen=True, slots=True)
class Page:
    """A page of versions, their aliases, the counts of the whole search, and where the next page begins."""

    versions: Sequence[catalogue.Version]
    facets: Mapping[str, Mapping[str, int]]
    next_token: str | None


def prepare(store: Store, definition: Definition) -> PartSubmission:
    """Derive, verify and certify a definition unless its content is known and sound.

    Raises InvalidDocument, TooLarge, LongWork.
    """
    is_mended = False
    with store.database.read() as connection:
        try:
            if content.get_part(connection, definition.digest) is not None:
                return PartSubmission(definition.name, definition.digest, None)
        except Refused:  # damaged, or gone in part
            is_mended = True
    part = derive(definition, store.settings.limits.program_nodes, store.admit)
    store.remember_part(part)
    return PartSubmission(definition.name, definition.digest, part_content(part), is_mended)


def store_part(connection: Connection, part: PartContent) -> None:
    """Write a part with its program and formulas; content that is there already stays as it is."""
    content.put_program(connection, part.row["program"], part.program, part.nodes)
    content.put_part(connection, part.row, part.tags, [FormulaRow(*values) for values in part.formulas])


def mend_part(connection: Connection, part: PartContent) -> None:
    """Write a part that was derived anew over what is stored."""
    formulas = [FormulaRow(*values) for values in part.formulas]
    content.replace_part(connection, part.row, part.program, part.nodes, formulas)


def submit(connection: Connection, submission: PartSubmission) -> tuple[catalogue.Version, bool]:
    """Store a submission; the version, and whether it is new."""
    if submission.content is not None:
        (mend_part if submission.is_mended else store_part)(connection, submission.content)
    number, is_new = catalogue.add_version(connection, submission.name, submission.digest)
    return _resolved(connection, Reference(submission.name, number=number)), is_new


def find(connection: Connection, text: str) -> catalogue.Version:
    """The version that a reference means. Raises Refused 404."""
    ref = parse_reference(text)
    if ref is None:
        raise not_found(f"'{text[:80]}' is no reference; expected name, name@3, name@alias or name@sha256:...")
    return _resolved(connection, ref, text)


def _resolved(connection: Connection, ref: Reference, text: str = "") -> catalogue.Version:
    version = catalogue.resolve(connection, ref)
    if version is None:
        raise not_found(f"there is no substructure '{text}'", "unknown-substructure")
    return version


def search(connection: Connection, wanted: catalogue.CatalogueSearch, size: int, token: str | None) -> Page:
    """A page of the latest versions. Raises Refused 422 for a token of another search."""
    column = wanted.sort.lstrip("-")
    after = read_token(wanted, token, int if column == "dof" else str, str)
    found = catalogue.page(connection, wanted, after, size + 1)
    last = found[size - 1] if len(found) > size else None
    following = write_token(wanted, getattr(last, column), last.name) if last else None
    return Page(found[:size], catalogue.facets(connection, wanted), following)


def set_alias(
    connection: Connection, name: str, alias: str, version: int, if_match: str | None, principal: str
) -> aliases.Alias:
    """Point an alias to a version; to move an existing one, ``if_match`` has to be its ETag. Raises Refused."""
    if not re.fullmatch(ALIAS, alias):
        raise unprocessable(
            "alias-name", f"an alias is a letter and up to 63 letters, digits, '-', '_': '{alias[:80]}'"
        )
    check_name(connection, name)
    target = catalogue.resolve(connection, Reference(name, number=version))
    if target is None:
        raise unprocessable("unknown-version", f"there is no substructure '{name}@{version}'", "/version")
    current = aliases.get_alias(connection, name, alias)
    if current is not None and if_match is None:
        detail = f"the alias '{alias}' exists; send its ETag in If-Match to move it"
        raise Refused(428, "precondition-required", detail, headers={"ETag": alias_tag(current)})
    if if_match is not None and (current is None or if_match not in ("*", alias_tag(current))):
        raise Refused(412, "precondition-failed", f"the alias '{alias}' is not what If-Match says")
    if current is not None and current.version == version:
        return current
    changed = aliases.set_alias(connection, name, alias, version, current.revision if current else 0, principal)
    if changed is None:
        raise Refused(412, "precondition-failed", f"the alias '{alias}' was changed meanwhile")
    return changed


def check_name(connection: Connection, name: str) -> None:
    """Raise Refused 404 unless there is a substructure of this name."""
    if catalogue.resolve(connection, Reference(name, number=1)) is None:
        raise not_found(f"there is no substructure '{name[:80]}'", "unknown-substructure")


def alias_tag(alias: aliases.Alias) -> str:
    """The ETag of an alias."""
    return f'"{alias.revision}"'


def yank(connection: Connection, text: str, reason: str) -> catalogue.Version:
    """Withdraw a version: it stays where it is used, and no longer is anybody's latest."""
    version = find(connection, text)
    catalogue.yank(connection, version.name, version.version, reason)
    return _resolved(connection, Reference(version.name, number=version.version))
