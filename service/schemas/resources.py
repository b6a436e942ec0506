"""Shapes of answers and of the small requests, for OpenAPI and for validation; units are in the descriptions.

Definitions and trees are described by the science package (``Definition``, ``TreeSpec``).
"""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.schemas.entries import Visibility
from service.schemas.shapes import Digest, Links, Shape, Time, Warned
from substructures.documents.fields import Words
from substructures.tree.document import REFERENCE

DERIVED = "whether this server derived it of its document and stores it so; false in lists alone, until it is asked for"


class ProblemError(Shape):
    """One thing wrong."""

    pointer: str = Field(description="RFC 6901 pointer into the request document")
    code: str
    message: str


class Problem(BaseModel):
    """RFC 9457 problem document; every answer that is not a success has this shape."""

    type: str
    title: str
    status: int
    detail: str
    instance: str
    code: str
    request_id: str
    errors: list[ProblemError]


class ParameterView(BaseModel):
    """A named constant and its default value."""

    value: float | int | str | None = Field(None, description="default, in SI")
    unit: str = Field("", description="SI")
    description: str = ""
    given: dict[str, Any] | None = Field(None, description="value and unit, where they were given in another unit")


class InputView(ParameterView):
    """A named input of loads and its default value."""

    default: float | int | str | None = Field(None, description="where it is not given, in SI; 0 without one")


class WithdrawnView(Shape):
    """An instance whose part is withdrawn."""

    instance: str
    substructure: str = Field(description="name and version")
    reason: str
    successor: str | None = Field(description="what to take instead")


class VersionView(Shape):
    """A version of a substructure."""

    name: str
    version: int
    digest: Digest
    title: str
    description: str
    tags: list[str]
    dof: int = Field(description="number of coordinates")
    joints: str = Field(description="R or P for every coordinate, in order")
    mass: float | None = Field(description="kg, of all bodies at the defaults; null where a parameter has none")
    coordinates: list[str]
    bodies: list[str]
    ports: list[str]
    parameters: dict[str, ParameterView]
    operations: dict[str, Any] = Field(description="operation counts of the stored program")
    certificate: dict[str, Any] = Field(description="what was checked when this was stored, with figures")
    warnings: list[Warned]
    program: Digest
    derived_here: bool = Field(description=DERIVED)
    created: Time
    aliases: list[str]
    is_withdrawn: bool
    withdrawn_at: Time | None
    withdrawal_reason: str | None
    author: str = Field(description="id of the API key that submitted it; empty in older stores")
    note: str = Field(description="why it was submitted, in words")
    origin: str = Field(description="what it came as: definition, import, catalogue, tree; empty in older stores")
    derived_from: str | None = Field(description="the version that it was made from")
    tree: str | None = Field(description="the revision of a tree that was published as this version")
    successor: str | None = Field(description="what to take in place of a withdrawn version")
    withdrawn: list[WithdrawnView] = Field(
        [], description="of a published tree, its instances whose parts are withdrawn; in the answer about one version"
    )
    owner: str = Field(description="whose the name is; catalogue: shipped")
    visibility: Visibility
    links: Links


class VersionPage(Shape):
    """A page of latest versions."""

    items: list[VersionView]
    facets: dict[Literal["tags", "joints", "dof"], dict[str, int]] | None = Field(
        None, description="counts over all pages, with facets=true"
    )
    instead: dict[str, str] | None = Field(None, description="words that were taken in place of those that are nowhere")
    next_page_token: str | None
    links: Links


class FormulaView(Shape):
    """A stored formula."""

    quantity: str
    body: str | None
    coordinate: str | None
    shape: list[int]
    symmetry: str
    operations: int = Field(description="operations to compute this alone")
    output: str = Field(description="output of the stored program")
    entry: list[int] = Field(description="its leading index within the output")


class FormulaIndex(Shape):
    """All stored formulas of a version."""

    name: str
    version: int
    digest: Digest
    program: Digest
    count: int
    formulas: list[FormulaView]
    links: Links


class AliasRequest(Shape):
    """Where an alias shall point to."""

    version: int = Field(ge=1, le=10**9, strict=True)


class AliasChange(Shape):
    """One change of an alias."""

    revision: int
    version: int
    changed: Time
    principal: str = Field(description="id of the API key, or local")


class AliasView(Shape):
    """An alias with its history, the newest change first."""

    name: str
    alias: str
    version: int
    revision: int
    changed: Time
    history: list[AliasChange]
    links: Links


class AliasList(Shape):
    """All aliases of a substructure."""

    items: list[AliasView]


class WithdrawalRequest(Shape):
    """Why a version is withdrawn."""

    reason: Words = Field("", max_length=2000)
    successor: str | None = Field(None, pattern=REFERENCE, description="reference to what to take instead")


class TreeView(Shape):
    """A revision of a tree."""

    name: str
    revision: int
    digest: Digest
    dof: int
    mass: float | None = Field(description="kg, of all bodies at the defaults; null where a parameter has none")
    coordinates: list[str] = Field(description="instance.coordinate, in the order of all arrays")
    joints: str = Field(description="R or P for every coordinate, in order")
    frames: list[str] = Field(description="instance.body and instance.port, in the order of kinematic arrays")
    parameters: dict[str, ParameterView]
    gravity: Any = Field(description="acceleration in world axes, m/s^2")
    instances: list[dict[str, Any]] = Field(description="references pinned to digests")
    closures: list[dict[str, Any]] = Field(
        [], description="loops: name, type, from, to and rows of each; left out if none"
    )
    reduction: dict[str, Any] = Field(
        {}, description="independent coordinates, start and ranges, as the parts say; left out if none does"
    )
    loads: list[dict[str, Any]] = Field([], description="of the tree, as they were given; left out if none")
    driven: list[str] = Field([], description="coordinates whose motion is given; left out if none is")
    ignored: list[str] = Field([], description="cyclic coordinates whose momentum is given; left out if none is")
    velocity_constraints: list[dict[str, Any]] = Field(
        [], description="of motions of the tree, numbers in SI as texts; left out if none"
    )
    contacts: list[dict[str, Any]] = Field(
        [], description="points of the tree that do not pass through planes, in simulations; left out if none"
    )
    balls: list[dict[str, list[str]]] = Field(
        [], description="names of the positions and velocities of joints with quaternions; left out if none"
    )
    reduced: list[dict[str, Any]] = Field(
        [], description="instances whose loops are in the formulas: their coordinates and closures; left out if none"
    )
    numbers: dict[str, str] = Field(
        {}, description="what symbols of the program stand for in this tree, exact: bound parameters, places"
    )
    limited: list[str] = Field([], description="coordinates with limits, which are the quantity limits")
    operations: dict[str, Any]
    certificate: dict[str, Any]
    warnings: list[Warned]
    inputs: dict[str, InputView] = Field({}, description="of loads, whether or not a formula depends on them")
    program: Digest
    derived_here: bool = Field(description=DERIVED)
    created: Time
    based_on: int | None = Field(description="the revision that was changed")
    author: str = Field(description="id of the API key that made it; empty in older stores")
    note: str = Field(description="why it was made, in words")
    withdrawn: list[WithdrawnView] = Field(description="instances whose parts are withdrawn")
    owner: str = Field(description="whose the name is; catalogue: shipped")
    visibility: Visibility
    links: Links


class TreeItem(Shape):
    """A tree in a list."""

    name: str
    revision: int
    digest: Digest
    dof: int
    joints: str = Field(description="R or P for every coordinate, in order")
    mass: float | None = Field(description="kg, of all bodies at the defaults; null where a parameter has none")
    created: Time
    owner: str = Field(description="whose the name is; catalogue: shipped")
    visibility: Visibility
    derived_here: bool = Field(description=DERIVED)
    links: Links


class TreePage(Shape):
    """A page of trees, the latest revision of each."""

    items: list[TreeItem]
    instead: dict[str, str] | None = Field(None, description="words that were taken in place of those that are nowhere")
    next_page_token: str | None
    links: Links


class AuditView(Shape):
    """Something that was done."""

    seq: int
    time: Time
    key: str = Field(description="id of the API key; local: without keys, console: a command on the store")
    owner: str
    action: str = Field(description="what: substructure.submit, alias.set, tree.store, job.cancel, key.revoke, ...")
    subject: str = Field(description="to what")
    detail: dict[str, Any]


class AuditPage(Shape):
    """Acts, the latest first."""

    items: list[AuditView]
    next_page_token: str | None
    links: Links


class LimitsView(BaseModel):
    """Every limit with its value."""

    model_config = ConfigDict(extra="allow")


class Health(Shape):
    """State of the server."""

    status: Literal["ok"]
