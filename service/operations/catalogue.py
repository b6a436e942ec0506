"""Submit, find, name and withdraw substructures."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from service.content.summaries import PartContent, part_content
from service.database.connections import Connection
from service.jobs.worker import Worker
from service.messages.references import ALIAS, Reference, parse_reference
from service.messages.refusals import Refused, not_found, unprocessable
from service.messages.viewer import Viewer
from service.operations import owners
from service.operations.preconditions import ANY, Expected, require, require_part, tag_of
from service.operations.sharing.provenance import Origin, derived_from, pinned, provenance
from service.queries import aliases, audit, catalogue, content, folders, uses
from service.queries.owners import is_version, ownership
from service.queries.searching.formulas import FormulaRow
from service.schemas.entries import PLAIN, PartEntry
from service.store.store import Store
from substructures.documents import read_json
from substructures.part.definition import Definition
from substructures.part.derive import derive

SUBMITTED = Origin()


@dataclass(frozen=True, slots=True)
class PartSubmission:
    """A definition ready to be stored; ``content`` is None when that is stored already. ``is_mended``: what is stored
    is damaged, or was not derived here, and the content takes its place. ``number``: that the version has elsewhere, by
    default the next one. ``expected``: what the part has to be when it is stored."""

    name: str
    digest: str
    content: PartContent | None
    is_mended: bool = False
    entry: PartEntry = PLAIN
    origin: Origin = SUBMITTED
    number: int | None = None
    expected: Expected = ANY


def prepare(
    store: Store,
    viewer: Viewer,
    definition: Definition,
    entry: PartEntry,
    origin: Origin = SUBMITTED,
    make: Callable[[], PartContent] | None = None,
    expected: Expected = ANY,
) -> PartSubmission:
    """Derive, verify and certify a definition unless its content is known and sound; ``make``: what does so, by default
    here and with whatever time it takes.

    Raises InvalidDocument, TooLarge, TimeoutError, Refused 403 for a name of others, 409, 412, 422.
    """
    is_mended = False
    name, digest = definition.name, definition.digest
    with store.database.read() as connection:
        require_part(connection, viewer, name, expected)
        if not _is_there(connection, viewer, name, digest):
            owners.wanted(connection, viewer, "substructure", name, entry)
        derived_from(connection, viewer, entry)
        try:
            known = content.get_part(connection, digest)
        except Refused:  # damaged, or gone in part
            is_mended = True
        else:
            if known is not None and known.is_derived:
                return PartSubmission(name, digest, None, entry=entry, origin=origin, expected=expected)
            is_mended = known is not None
    found = make() if make else part_content(derive(definition, store.settings.limits.program_nodes))
    return PartSubmission(name, digest, found, is_mended, entry, origin, expected=expected)


def derived(worker: Worker, definition: Definition, limits: Mapping[str, int]) -> PartContent:
    """What is stored of a definition, derived by a worker; ``limits``: as :attr:`Store.work_limits`.

    Raises InvalidDocument, TooLarge, TimeoutError.
    """
    outcome = worker("derive", {"definition": read_json(definition.canonical()), **limits})
    return PartContent.of_files(outcome.files)


def _is_there(connection: Connection, viewer: Viewer, name: str, digest: str) -> bool:
    """Whether the viewer sees a version with this content: then nobody's right to add one is needed."""
    found = ownership(connection, "substructure", name)
    is_seen = found is not None and viewer.sees(found.owner, found.visibility)
    return is_seen and is_version(connection, name, digest)


def store_part(connection: Connection, part: PartContent) -> None:
    """Write a part with its program and formulas; content that is there already stays as it is."""
    content.put_program(connection, part.row["program"], part.program, part.nodes)
    content.put_part(connection, part.row, [FormulaRow(*values) for values in part.formulas])


def mend_part(connection: Connection, part: PartContent) -> None:
    """Write a part that was derived anew over what is stored."""
    formulas = [FormulaRow(*values) for values in part.formulas]
    content.replace_part(connection, part.row, part.program, part.nodes, formulas)


def submit(connection: Connection, viewer: Viewer, submission: PartSubmission) -> tuple[catalogue.Version, bool]:
    """Store a submission; the version, and whether it is new. Raises Refused 403 for a name of others, 409, also for a
    number that another content has, 412."""
    name, digest = submission.name, submission.digest
    if not _is_there(connection, viewer, name, digest) or submission.entry.visibility is not None:
        owners.claimed(connection, viewer, "substructure", name, submission.entry)
    require_part(connection, viewer, name, submission.expected)
    if submission.content is not None:
        (mend_part if submission.is_mended else store_part)(connection, submission.content)
    origin = submission.origin
    told = provenance(connection, viewer, submission.entry, origin)
    if submission.number is not None:
        _require_free(connection, name, submission.number, digest)
    number, is_new = catalogue.add_version(connection, name, digest, viewer.key, told, submission.number)
    if is_new:
        uses.put(connection, digest, origin.uses)
        audit.note(connection, viewer, "substructure.submit", f"{name}@{number}", digest=digest)
    return _resolved(connection, viewer, Reference(name, number=number)), is_new


def _require_free(connection: Connection, name: str, number: int, digest: str) -> None:
    """Raise Refused 409 where a number means another content here than elsewhere. The name is locked."""
    here = catalogue.digest_of_number(connection, name, number)
    if here not in (None, digest) and not is_version(connection, name, digest):
        detail = f"{name}@{number} is {here} here, and {digest} there: submit one of them under another name"
        raise Refused(409, "version-taken", detail, here=here, there=digest)


def find(connection: Connection, viewer: Viewer, text: str) -> catalogue.Version:
    """The version that a reference means. Raises Refused 404."""
    ref = parse_reference(text)
    if ref is None:
        raise not_found(f"'{text[:80]}' is no reference; expected name, name@3, name@alias or name@sha256:...")
    return _resolved(connection, viewer, ref, text)


def _resolved(connection: Connection, viewer: Viewer, ref: Reference, text: str = "") -> catalogue.Version:
    version = catalogue.resolve(connection, viewer, ref)
    if version is None:
        raise not_found(owners.absent_part(connection, viewer, text), "unknown-substructure")
    return version


def used(connection: Connection, viewer: Viewer, text: str) -> tuple[str, int | None]:
    """The name and the version whose uses are wanted, None for all versions, of a bare name. Raises Refused 404."""
    ref = parse_reference(text)
    if ref is None or ref.is_pinned or ref.alias is not None:
        version = find(connection, viewer, text)
        return version.name, version.version
    owners.seen(connection, viewer, "substructure", ref.name)
    return ref.name, None


def set_alias(
    connection: Connection, viewer: Viewer, name: str, alias: str, version: int, expected: Expected = ANY
) -> aliases.Alias:
    """Point an alias to a version; to move an existing one, its ETag has to be expected. Raises Refused."""
    if not re.fullmatch(ALIAS, alias):
        raise unprocessable(
            "alias-name", f"an alias is a letter and up to 63 letters, digits, '-', '_': '{alias[:80]}'"
        )
    owner = check_name(connection, viewer, name)
    owners.require(viewer, owner, name, "moves its aliases")
    target = catalogue.resolve(connection, viewer, Reference(name, number=version))
    if target is None:
        why = owners.absent_part(connection, viewer, f"{name}@{version}")
        raise unprocessable("unknown-version", why, "/version")
    current = aliases.get_alias(connection, name, alias)
    tag = None if current is None else alias_tag(current)
    require(f"the alias '{alias}'", tag, expected)
    if current is not None and expected.if_match is None:
        detail = f"the alias '{alias}' exists; send its ETag in If-Match to move it"
        raise Refused(428, "precondition-required", detail, headers={"ETag": alias_tag(current)})
    if current is not None and current.version == version:
        return current
    changed = aliases.set_alias(connection, name, alias, version, current.revision if current else 0, viewer.key)
    if changed is None:
        raise Refused(412, "precondition-failed", f"the alias '{alias}' was changed meanwhile")
    audit.note(connection, viewer, "alias.set", f"{name}@{alias}", version=version)
    return changed


def check_name(connection: Connection, viewer: Viewer, name: str) -> str:
    """The owner of a substructure. Raises Refused 404 unless the viewer sees one of this name."""
    found = ownership(connection, "substructure", name)
    if found is not None and viewer.sees(found.owner, found.visibility):
        return found.owner
    raise not_found(owners.absent_part(connection, viewer, name), "unknown-substructure")


def alias_tag(alias: aliases.Alias) -> str:
    """The ETag of an alias."""
    return f'"{alias.revision}"'


def withdraw(
    connection: Connection,
    viewer: Viewer,
    text: str,
    reason: str,
    successor: str | None = None,
    if_match: str | None = None,
) -> catalogue.Version:
    """Withdraw a version: it stays where it is used, and no longer is anybody's latest; ``successor``: reference to
    what to take instead. Raises Refused 404, 403, 412, 422.
    """
    version = find(connection, viewer, text)
    owners.require(viewer, version.owner, version.name, "withdraws its versions")
    require(f"the part '{text}'", tag_of(connection, viewer, version), Expected(if_match))
    instead = None if successor is None else pinned(connection, viewer, successor, "/successor")
    if instead == (version.name, version.version):
        raise unprocessable("own-successor", f"'{text[:80]}' cannot take its own place", "/successor")
    catalogue.withdraw(connection, version.name, version.version, reason, instead)
    told = {"reason": reason} | ({} if instead is None else {"successor": "{}@{}".format(*instead)})
    audit.note(connection, viewer, "substructure.withdraw", f"{version.name}@{version.version}", **told)
    return _resolved(connection, viewer, Reference(version.name, number=version.version))


#: why a version of a file is withdrawn
GONE, EARLIER = "its file is gone", "its file has the content of an earlier version again"


def follow(connection: Connection, viewer: Viewer, name: str, version: int) -> str:
    """Let the version that a file has become be the latest of its name, as far as only ``viewer`` has stored others; a
    remark where another one is.
    """
    for each in folders.versions_of(connection, name, viewer.key):
        if each.withdrawal_reason == GONE or (each.withdrawal_reason == EARLIER and each.version <= version):
            catalogue.offer(connection, name, each.version)
            audit.note(connection, viewer, "substructure.offer", f"{name}@{each.version}")
        if each.version > version and each.withdrawal_reason in (None, GONE):
            catalogue.withdraw(connection, name, each.version, EARLIER, (name, version))
            told = {"reason": EARLIER, "successor": f"{name}@{version}"}
            audit.note(connection, viewer, "substructure.withdraw", f"{name}@{each.version}", **told)
    latest = folders.latest(connection, name)
    offered = "none is" if latest is None else f"{name}@{latest} is"
    return "" if latest == version else f"others have withdrawn it, or stored a later one: {offered} offered"


def withdraw_all(connection: Connection, viewer: Viewer, name: str) -> list[int]:
    """Withdraw all versions of a file that is gone; only those that ``viewer`` stored, of which the numbers."""
    found = [each.version for each in folders.versions_of(connection, name, viewer.key) if each.withdrawn_at is None]
    for number in found:
        catalogue.withdraw(connection, name, number, GONE)
        audit.note(connection, viewer, "substructure.withdraw", f"{name}@{number}", reason=GONE)
    return found
