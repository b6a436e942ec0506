"""Shapes of what is told of versions: lists of them, what uses them, how two of them differ."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from service.schemas.shapes import Digest, Links, Shape, Time


class VersionItem(Shape):
    """A version in the list of its name."""

    name: str
    version: int
    digest: Digest
    created: Time
    author: str = Field(description="id of the API key that submitted it; empty in older stores")
    owner: str
    note: str
    origin: str = Field(description="definition, import, catalogue, tree; empty in older stores")
    derived_from: str | None
    tree: str | None = Field(description="the revision of a tree that was published as this version")
    dof: int
    operations: dict[str, Any]
    is_withdrawn: bool
    withdrawn_at: Time | None
    withdrawal_reason: str | None
    successor: str | None
    links: Links


class VersionList(Shape):
    """Versions, the newest first."""

    items: list[VersionItem]
    next_page_token: str | None
    links: Links


class RevisionItem(Shape):
    """A revision in the list of its tree."""

    name: str
    revision: int
    digest: Digest
    created: Time
    author: str
    owner: str
    note: str
    based_on: int | None
    dof: int
    links: Links


class RevisionList(Shape):
    """Revisions, the newest first."""

    items: list[RevisionItem]
    next_page_token: str | None
    links: Links


class UseView(Shape):
    """Something that uses a part."""

    kind: Literal["derived", "part", "tree"] = Field(
        description="a version made from it, a version that is a published tree with it, a revision of a tree"
    )
    name: str
    number: int = Field(description="of the version or revision")
    instances: dict[str, int] = Field(description="by name of the instance the version that it is")
    links: Links


class UsePage(Shape):
    """What uses a part, as far as one sees it."""

    items: list[UseView]
    next_page_token: str | None
    links: Links


class LevelItem(Shape):
    """Another level of a part."""

    name: str
    version: int
    level: Literal["full", "reduced", "abbreviated"] = Field(
        description="full: this one was made from it; made from this one are: reduced, with fewer coordinates, and "
        "abbreviated, with fewer operations in the same ones"
    )
    dof: int
    operations: dict[str, Any]
    error: dict[str, float | None] = Field(
        description="of the shorter of both, by quantity that is not the same: the largest change of an entry relative "
        "to its largest number at random states, 1 where only one has it, null where there are no numbers"
    )
    rms: dict[str, float | None] = Field(description="the same over the root of the mean square of the states")
    links: Links


class LevelList(Shape):
    """The other levels of a version."""

    items: list[LevelItem]
    states: int = Field(description="random states at which errors are computed, evenly in range")
    range: tuple[float, float] = Field(description="of coordinates, velocities and accelerations [rad, m, s]")
    links: Links


class FieldChange(Shape):
    """A field of the documents that differs."""

    place: str = Field(description="names in place of numbers where a list has them: /bodies/link3/mass")
    change: Literal["changed", "new", "gone"]
    a: Any
    b: Any
    words: str


class EntryChange(Shape):
    """An entry of a quantity that is not the same."""

    place: list[str | int] = Field(description="coordinates, bodies and ports by name, components by number")
    state: Literal["equal", "changed", "new", "gone"] = Field(description="of the formula")
    change: float | None = Field(description="of its numbers at the defaults, relative; null where there is no number")


class QuantityChange(Shape):
    """A quantity of both, entry by entry."""

    entries: int = Field(description="independent ones; all where the axes differ")
    equal: int = Field(description="with the same formula, by fingerprint")
    changed: int
    new: int
    gone: int
    moved: int = Field(description="with other numbers at the defaults of both, at random states")
    change: float | None = Field(description="the largest relative change of numbers")
    rms: float | None = Field(description="the largest root mean square of the changes of an entry over the states")
    differing: list[EntryChange] = Field(description="the first 200 of which anything differs")


class DifferenceView(Shape):
    """How two versions, or two revisions, differ."""

    a: str
    b: str
    same: bool
    words: list[str] = Field(description="what changed, and what it means for the equations of motion")
    definition: list[FieldChange]
    quantities: dict[str, QuantityChange]
