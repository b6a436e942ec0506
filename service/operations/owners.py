"""Whose names are: who may add to them, who sees them, and what a tree that others see may be built of."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from service.database.connections import Connection
from service.messages.references import parse_reference
from service.messages.refusals import Refused, not_found
from service.messages.viewer import CATALOGUE, OPEN, PRIVATE, PUBLIC, Viewer
from service.queries import audit, catalogue, owners, trees, uses
from service.queries.owners import Kind, Ownership
from service.schemas.entries import Entry
from substructures.errors import Fault, meant

#: what a reference means that may be one to a part or a tree
EITHER = "substructure or tree"


def wanted(connection: Connection, viewer: Viewer, kind: Kind, name: str, entry: Entry) -> Ownership:
    """Whose a name is or would be. Raises Refused 403 for one of others, 409 for one of another visibility."""
    return may_have(viewer, kind, name, owners.ownership(connection, kind, name), entry)


def may_have(viewer: Viewer, kind: Kind, name: str, found: Ownership | None, entry: Entry) -> Ownership:
    """As :func:`wanted`, of a name whose owner, if it has one, was ``found``."""
    return _checked(viewer, kind, name, found or _new(viewer, entry), entry)


def claimed(connection: Connection, viewer: Viewer, kind: Kind, name: str, entry: Entry) -> Ownership:
    """As :func:`wanted`, and the name is taken, and locked until the transaction ends."""
    return _checked(viewer, kind, name, owners.claim(connection, kind, name, _new(viewer, entry)), entry)


def _new(viewer: Viewer, entry: Entry) -> Ownership:
    return Ownership(viewer.owner, entry.visibility or PUBLIC)


def _checked(viewer: Viewer, kind: Kind, name: str, found: Ownership, entry: Entry) -> Ownership:
    if not viewer.may_change(found.owner):
        # of a private name nothing is told but that it cannot be had, be it there or not any more
        whose = f"belongs to '{found.owner}'" if found.visibility == PUBLIC else "cannot be had"
        advice = f"take another name, for example '{_suggested(name, viewer.owner)}'"
        advice += ", and 'derived_from' to say what it was made from" if kind == "substructure" else ""
        raise Refused(403, "name-taken", f"the name '{name}' of a {kind} {whose}; {advice}")
    if entry.visibility not in (None, found.visibility):
        way = "what was public stays public" if found.visibility == PUBLIC else _way(kind, name)
        raise Refused(409, "visibility-differs", f"'{name}' is {found.visibility} already: {way}")
    return found


def _suggested(name: str, owner: str) -> str:
    return f"{name[: max(1, 63 - len(owner))]}-{owner}"[:64]


def _way(kind: Kind, name: str) -> str:
    return f"PUT /v1/{kind}s/{name}/visibility makes it public"


def require(viewer: Viewer, owner: str, name: str, what: str) -> None:
    """Raise Refused 403 unless something of an owner may be changed; ``what``: "moves its aliases", ..."""
    if not viewer.may_change(owner):
        raise Refused(403, "not-owner", f"'{name}' belongs to '{owner}': only its owner or an admin {what}")


def candidates(connection: Connection, viewer: Viewer, kind: Kind, text: str) -> str:
    """What may have been meant by a reference to something that is not there, of what the viewer sees."""
    name = text.partition("@")[0]
    return meant(name, [each for each in owners.names_like(connection, viewer, kind, name) if each != text])


def absent_part(connection: Connection, viewer: Viewer, text: str, what: str = "substructure") -> str:
    """Why a reference to a part means nothing that the viewer sees, and what may help; ``what``: it could be."""
    ref = parse_reference(text)
    last = None if ref is None else catalogue.last(connection, viewer, ref.name)
    if ref is not None and last is not None and ref.number is not None:
        return f"there is no {what} '{text[:80]}'; the last version is {last.name}@{last.version}"
    if last is not None and text == last.name:
        why = f": {last.withdrawal_reason}" if last.withdrawal_reason else ""
        instead = f"; take {last.successor}" if last.successor else ""
        return f"all versions of '{last.name}' are withdrawn, the last one as {last.name}@{last.version}{why}{instead}"
    return f"there is no {what} '{text[:80]}'{candidates(connection, viewer, 'substructure', text)}"


def absent_tree(connection: Connection, viewer: Viewer, text: str) -> str:
    """Why a reference to a tree means nothing that the viewer sees, and what may help."""
    ref = parse_reference(text)
    if ref is not None and ref.number is not None:
        found = owners.ownership(connection, "tree", ref.name)
        is_seen = found is not None and viewer.sees(found.owner, found.visibility)
        if is_seen and ref.number <= trees.latest_revision(connection, ref.name):
            return f"the tree '{text}' was removed"
    return f"there is no tree '{text[:160]}'{candidates(connection, viewer, 'tree', text)}"


def absent_either(connection: Connection, viewer: Viewer, text: str) -> str:
    """As :func:`absent_part` of a reference that could mean a tree, too."""
    why = absent_part(connection, viewer, text, EITHER)
    return why if why.endswith("?") else why + candidates(connection, viewer, "tree", text)


def seen(connection: Connection, viewer: Viewer, kind: Kind, name: str) -> Ownership:
    """Whose a name is. Raises Refused 404 for what the viewer does not see."""
    found = owners.ownership(connection, kind, name)
    if found is None or not viewer.sees(found.owner, found.visibility):
        like = candidates(connection, viewer, kind, name)
        raise not_found(f"there is no {kind} '{name[:80]}'{like}", f"unknown-{kind}")
    return found


def set_visibility(connection: Connection, viewer: Viewer, kind: Kind, name: str, visibility: str) -> Ownership:
    """Let others see a name; what is public stays so. Raises Refused 404, 403, 409."""
    found = seen(connection, viewer, kind, name)
    require(viewer, found.owner, name, "changes who sees it")
    if visibility == found.visibility:
        return found
    if visibility == PRIVATE:
        raise Refused(409, "was-public", f"'{name}' is public, and others may have used it: it stays public")
    owners.claim(connection, kind, name, found)  # locked, so that no private part comes in meanwhile
    hidden = (
        owners.private_parts_of_tree(connection, name) if kind == "tree" else uses.private_parts_of(connection, name)
    )
    for part, _ in hidden.values():
        raise Refused(409, "private-part", f"'{name}' is built of '{part}', which is private: make that public first")
    changed = Ownership(found.owner, PUBLIC)
    owners.change(connection, kind, name, changed)
    audit.note(connection, viewer, f"{kind}.publish", name)
    return changed


def private_parts(
    tree: Ownership,
    instances: Collection[Mapping[str, Any]],
    digests: Mapping[str, str],
    hidden: Mapping[str, tuple[str, str]],
) -> Iterator[Fault]:
    """Faults of parts that a tree may not have: others' private ones, and private ones where others see the tree.

    ``instances``: documents; ``digests``: of their parts, by instance; ``hidden``: name and owner of those of the parts
    that are private, by digest.
    """
    for k, instance in enumerate(instances):
        part, owner = hidden.get(digests[instance["name"]], ("", tree.owner))
        is_reference, place = bool(instance.get("substructure")), f"instance '{instance['name']}'"
        if owner != tree.owner and is_reference:  # who sends a definition as a copy may have made it as well
            message = f"{place}: '{part}' is private to '{owner}', and the tree belongs to '{tree.owner}'"
        elif part and owner == tree.owner and tree.visibility == PUBLIC:
            message = f"{place}: {_private_in_public(part)}"
        else:
            continue
        step = "substructure" if is_reference else "definition"
        yield Fault(f"/instances/{k}/{step}", "private-part", message)


def require_public_parts(connection: Connection, tree: Ownership, digests: Collection[str]) -> None:
    """Raise Refused 409 where others see a tree that is about to be stored and that has a private part."""
    if tree.visibility == PUBLIC:
        for part, owner in owners.private_parts(connection, digests).values():
            if owner == tree.owner:
                raise Refused(409, "private-part", _private_in_public(part))


def _private_in_public(part: str) -> str:
    return (
        f'\'{part}\' is private, and the tree would be public; send the tree with "visibility": "private",'
        f" or make the part public (PUT /v1/substructures/{part}/visibility)"
    )


def ship(connection: Connection, name: str, digest: str) -> bool:
    """Give a name that was stored before names had owners to the catalogue; False where somebody else has it."""
    found = owners.ownership(connection, "substructure", name)
    if found is None or found.owner != OPEN or not owners.is_version(connection, name, digest):
        return False
    owners.change(connection, "substructure", name, Ownership(CATALOGUE, PUBLIC))
    return True
