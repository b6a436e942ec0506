"""Shapes of evaluations, kernels and analyses, for OpenAPI; units are in the descriptions."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from service.schemas.shapes import Digest, Shape

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
