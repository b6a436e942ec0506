"""Requests and answers of evaluations, kernels and analyses; units are in the descriptions.

Requests for evaluations are read here, whatever format they came in: fields are checked, and the numbers stay as they
came (lists of exact numbers, or arrays of any size), because the science looks at every one of them anyway.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, SkipValidation, StrictBool, ValidationError

from service.schemas.measured import WithUnits
from service.schemas.shapes import Digest, Shape, Warned
from substructures.documents import message_of, pointer_step, require_object
from substructures.errors import Fault, InvalidDocument, InvalidInput, meant
from substructures.quantities import derivative_directions
from substructures.quantities.measured import si_values
from substructures.quantities.numbers.states import argument_units
from substructures.quantities.sources import read_quantities
from substructures.tree.model import Model

Column = float | list[float]


#: numbers that the science looks at, with its units: see :func:`substructures.quantities.numbers.states.argument_units`
ValueColumns = Annotated[dict[str, Column], SkipValidation, WithUnits()]
StateColumns = Annotated[list[float] | list[list[float]] | dict[str, Column] | None, SkipValidation, WithUnits()]
_NEEDED = {
    "quantities": "a list of quantities is needed",
    "along": "the direction 'along' is needed: q, qd, qdd and inputs",
}


def _values(description: str | None = None) -> Any:
    """An empty object by default, made anew: pydantic would copy one, which takes longer than all the rest."""
    return Field(default_factory=dict, description=description, json_schema_extra={"default": {}})


class Direction(Shape):
    """The direction of a derivative, zero where nothing is given; one row for all states, or one for each."""

    q: StateColumns = None
    qd: StateColumns = None
    qdd: StateColumns = Field(None, description="of inverse dynamics")
    inputs: ValueColumns = _values()


def _needs_states(schema: dict[str, Any]) -> None:
    """Trees have coordinates; where a request does without, it goes with a grid or a sample."""
    q = schema["properties"]["q"]
    q["anyOf"].remove({"type": "null"})
    del q["default"]
    schema["required"].append("q")


class EvaluationRequest(Shape):
    """States to evaluate; SI units, angles in rad.

    ``forward_dynamics`` of a tree with closures are the accelerations on them, in states that meet them; all other
    quantities are those of the tree without its closures (``inverse_dynamics``: what actuators and closures exert).
    """

    model_config = ConfigDict(extra="forbid", json_schema_extra=_needs_states)

    quantities: Annotated[list[str], SkipValidation]
    parameters: ValueColumns = _values("values in place of defaults; one, or one for every state")
    q: StateColumns = Field(None, description="(n,), (N, n) or columns by name")
    qd: StateColumns = None
    qdd: StateColumns = None
    inputs: ValueColumns = _values("tau.<coordinate> (N m or N) and inputs of loads")
    t: Annotated[Column, SkipValidation, WithUnits()] = Field(0, description="s")
    along: Direction | None = Field(None, description="direction of inverse_ and forward_dynamics_derivative")
    packed: StrictBool = Field(False, description="of metric and christoffel the independent elements alone")
    float32: StrictBool = Field(False, description="results in single precision")
    joints: list[str] | None = Field(
        None, description="rows of reactions: coordinates, and instance.base; all by default"
    )

    @classmethod
    def read(cls, data: Any) -> EvaluationRequest:
        """From plain data, in which numbers may be arrays.

        Raises InvalidDocument for fields that are missing or unknown, with the faults of the quantities.
        """
        require_object(data)
        try:
            request = cls.model_validate(data)
        except ValidationError as error:
            raise InvalidDocument(_faults(error, data)) from None
        if isinstance(request.quantities, str):  # a list of one, as MATLAB writes it
            request.quantities = [request.quantities]
        if not isinstance(request.quantities, list | tuple):
            raise InvalidDocument.at("/quantities", "missing", _NEEDED["quantities"])
        return request

    def given(self) -> dict[str, Any]:
        """The fields that were given, as plain data and arrays."""
        found = {name: getattr(self, name) for name in type(self).model_fields if name in self.model_fields_set}
        if self.along is not None:
            along = self.along
            found["along"] = {
                name: getattr(along, name) for name in Direction.model_fields if name in along.model_fields_set
            }
        return found

    def in_si(self, model: Model) -> EvaluationRequest:
        """The request with numbers of SI in the places of those with units. Raises InvalidArgument with pointers."""
        return EvaluationRequest.read(si_values(self.given(), argument_units(model), ""))

    def arguments(self) -> dict[str, Any]:
        """Arguments of :func:`substructures.quantities.numbers.evaluation.evaluate` by name."""
        along = self.along
        return {
            "quantities": self.quantities,
            "q": self.q,
            "qd": self.qd,
            "qdd": self.qdd,
            "inputs": self.inputs,
            "parameters": self.parameters,
            "t": self.t,
            "packed": self.packed,
            "float32": self.float32,
            "joints": self.joints,
            "along": None
            if along is None
            else derivative_directions.Direction(along.q, along.qd, along.qdd, along.inputs),
        }


def _faults(error: ValidationError, data: Mapping[str, Any]) -> list[Fault]:
    """What is wrong with the fields, then with the quantities."""
    faults = []
    for found in error.errors(include_url=False):
        pointer, name = "".join(map(pointer_step, found["loc"])), str(found["loc"][-1])
        if found["type"] == "extra_forbidden":
            like = meant(name, EvaluationRequest.model_fields)
            faults.append(Fault(pointer, "unknown-field", f"unknown field '{name[:80]}'{like}"))
        elif name != "quantities":
            faults.append(Fault(pointer, "missing", _NEEDED.get(name) or message_of(found)))
    try:
        read_quantities(given if isinstance(given := data.get("quantities"), list) else ())
    except InvalidInput as wrong:
        faults += wrong.faults
    return faults


class EvaluationResult(BaseModel):
    """Arrays by quantity, states first; a state without a finite result is null and listed in failures, one whose
    accelerations are doubtful, as the metric is nearly singular there, in warnings.
    """

    model_config = ConfigDict(extra="allow")

    coordinates: list[str]
    count: int
    digest: Digest
    failures: list[Any] = []
    warnings: list[Warned] = []
    frames: list[str] = Field([], description="with kinematics: instance.body and instance.port by row")
    columns: dict[Literal["names", "units"], list[str]] = Field({}, description="with regressor: of the parameters")
    joints: list[str] = Field([], description="with reactions: coordinates of joints, and instance.base, by row")
    loads: list[str] = Field([], description="with powers: what each is of")
    links: list[str] = Field([], description="with moments of inertia: instance.body by row")
    rates: list[str] = Field([], description="with a floating base: its velocities, and those of the joints")
    rows: list[str] = Field([], description="with closures: closure.row by row")


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
    violated first. ``is_right`` is true when at least one check was made and all hold, false when one is violated, null
    when nothing could be checked or the computation did not finish. Numbers that are not finite are null.
    """

    model_config = ConfigDict(extra="allow")
