"""Shapes of answers and of the small requests, for OpenAPI and for validation; units are in the descriptions.

Definitions and trees are described by the science package (``Definition``, ``TreeSpec``).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

Digest = Annotated[str, Field(pattern=r"^sha256:[0-9a-f]{64}$", description="sha256 of the canonical bytes")]
Time = Annotated[str, Field(description="UTC, ISO 8601")]
Links = dict[str, Any]


class Shape(BaseModel):
    """Base: no unknown fields."""

    model_config = ConfigDict(extra="forbid")


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

    value: float | int | str | None = Field(None, description="default, in the unit given")
    unit: str = ""
    description: str = ""


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
    coordinates: list[str]
    bodies: list[str]
    ports: list[str]
    parameters: dict[str, ParameterView]
    operations: dict[str, Any] = Field(description="operation counts of the stored program")
    certificate: dict[str, Any] = Field(description="what was checked when this was stored, with figures")
    program: Digest
    created: Time
    aliases: list[str]
    yanked: bool
    yanked_at: Time | None
    yank_reason: str | None
    links: Links


class VersionPage(Shape):
    """A page of latest versions."""

    items: list[VersionView]
    facets: dict[Literal["tags", "joints", "dof"], dict[str, int]] = Field(description="counts over all pages")
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


class YankRequest(Shape):
    """Why a version is withdrawn."""

    reason: str = Field("", max_length=2000)


class TreeView(Shape):
    """A revision of a tree."""

    name: str
    revision: int
    digest: Digest
    dof: int
    coordinates: list[str] = Field(description="instance.coordinate, in the order of all arrays")
    joints: str = Field(description="R or P for every coordinate, in order")
    frames: list[str] = Field(description="instance.body and instance.port, in the order of kinematic arrays")
    parameters: dict[str, ParameterView]
    gravity: Any = Field(description="acceleration in world axes, m/s^2")
    instances: list[dict[str, Any]] = Field(description="references pinned to digests")
    closures: list[dict[str, Any]] = Field(
        [], description="loops: name, type, from, to and rows of each; left out if none"
    )
    operations: dict[str, Any]
    certificate: dict[str, Any]
    program: Digest
    created: Time
    based_on: int | None = Field(description="the revision that was changed")
    links: Links


class TreeItem(Shape):
    """A tree in a list."""

    name: str
    revision: int
    digest: Digest
    dof: int
    created: Time
    links: Links


class TreePage(Shape):
    """A page of trees, the latest revision of each."""

    items: list[TreeItem]
    next_page_token: str | None
    links: Links


Column = float | list[float]


class Direction(BaseModel):
    """The direction of a derivative, zero where nothing is given; one row for all states, or one for each."""

    q: list[float] | list[list[float]] | dict[str, Column] | None = None
    qd: list[float] | list[list[float]] | dict[str, Column] | None = None
    qdd: list[float] | list[list[float]] | dict[str, Column] | None = Field(None, description="of inverse dynamics")
    inputs: dict[str, Column] = {}


class EvaluationRequest(BaseModel):
    """States to evaluate; SI units, angles in rad.

    ``forward_dynamics`` of a tree with closures are the accelerations on them, in states that meet them; all other
    quantities are those of the tree without its closures (``inverse_dynamics``: what actuators and closures exert).
    """

    quantities: list[str]
    parameters: dict[str, Column] = Field({}, description="values in place of defaults; one, or one for every state")
    q: list[float] | list[list[float]] | dict[str, Column] = Field(description="(n,), (N, n) or columns by name")
    qd: list[float] | list[list[float]] | dict[str, Column] | None = None
    qdd: list[float] | list[list[float]] | dict[str, Column] | None = None
    inputs: dict[str, Column] = Field({}, description="tau.<coordinate> (N m or N) and inputs of loads")
    t: Column = Field(0, description="s")
    along: Direction | None = Field(None, description="direction of inverse_ and forward_dynamics_derivative")


class EvaluationResult(BaseModel):
    """Arrays by quantity, states first; a state without a finite result is null and listed in failures."""

    model_config = ConfigDict(extra="allow")

    coordinates: list[str]
    count: int
    digest: Digest
    failures: list[Any] = []
    frames: list[str] = Field([], description="with kinematics: instance.body and instance.port by row")
    columns: dict[Literal["names", "units"], list[str]] = Field({}, description="with regressor: of the parameters")


class KernelsRequest(Shape):
    """Quantities that will be evaluated together."""

    quantities: list[str]


class KernelView(Shape):
    """A program compiled for some of its outputs."""

    program: str = Field(description="model, or the derived quantity")
    outputs: list[str]
    operations: int
    new: bool = Field(description="compiled now, or read from the folder of kernels")
    machine_code: bool = Field(description="false where the interpreter has to do")
    seconds: float


class KernelsView(Shape):
    """What a tree is compiled for."""

    digest: Digest
    kernels: list[KernelView]


class AnalysisResult(BaseModel):
    """The result of an analysis. What goes wrong on the way is a value: ``status`` and ``message``, with advice.

    A trajectory has ``coordinates``, ``t`` (K,) in s, ``q``, ``qd`` (K, n), ``series`` by name, and ``checks``: each
    with ``name``, ``rule``, ``reason``, ``unit``, ``worst``, ``scale``, ``limit``, ``holds`` and ``time``, when it was
    violated first; ``is_right`` is false when one is violated. Numbers that are not finite are null.
    """

    model_config = ConfigDict(extra="allow")


class LimitsView(BaseModel):
    """Every limit with its value."""

    model_config = ConfigDict(extra="allow")


class Health(Shape):
    """State of the server."""

    status: Literal["ok"]
