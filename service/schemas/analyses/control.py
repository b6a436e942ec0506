"""Problems of optimal control as they are sent: bodies of requests, items of jobs, documents on the command line; SI
units, angles in rad.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from service.schemas.measured import BY_NAME, COORDINATES, SECONDS, VELOCITIES
from service.schemas.parts import RequestPart
from substructures.analysis.control import demands, problem
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC

LIMIT = "largest relative error by the size of steps in a right result, by a second run with steps half as long"

Finite = Annotated[float, Field(allow_inf_nan=False), NUMERIC]
#: a number, or no demand
Wanted = Annotated[float, NUMERIC] | None
Constants = Annotated[dict[str, Finite], BY_NAME]
#: one number, or one for each node
ByControl = Annotated[dict[str, Any], BY_NAME]


class Cost(RequestPart):
    """l and phi."""

    running: str = Field("0", description="l(q, q', u, t, parameters), per second")
    terminal: str = Field("0", description="phi(q, q', t, parameters)")

    def value(self) -> problem.Cost:
        """As the science takes it."""
        return problem.Cost(self.running, self.terminal)


class ControlProblem(DocumentPart):
    """The parts of a request that say what is controlled, and how the equations of motion are discretised.

    A control is constant in each of the ``intervals`` (``hold``: constant) or linear between its ends (linear);
    ``steps``: Runge-Kutta steps in each of them.
    """

    controls: tuple[str, ...] = Field(description="names of inputs; none where something else is sought alone")
    cost: Cost = Cost()
    horizon: Annotated[float, Field(gt=0, allow_inf_nan=False), NUMERIC, SECONDS] = Field(description="s")
    intervals: Annotated[int, Field(ge=1, le=problem.MAX_INTERVALS), NUMERIC]
    steps: Annotated[int, Field(ge=1, le=10_000), NUMERIC] = Field(1, description="Runge-Kutta steps in each interval")
    hold: Literal["constant", "linear"] = "linear"
    q: Annotated[Any, COORDINATES] = Field(description="where the motion starts: (n,) or by coordinate; rad, m")
    qd: Annotated[Any, VELOCITIES] = Field(None, description="rad/s, m/s; default: at rest")
    t: Annotated[Finite, SECONDS] = Field(0.0, description="when it starts, s")
    inputs: Constants = Field({}, description="constant values of the other inputs; default: their own, or zero")
    parameters: Constants = Field({}, description="instead of their defaults")


#: of requests with a second run
ErrorLimit = Annotated[float, Field(gt=0, allow_inf_nan=False, description=LIMIT), NUMERIC]


class GradientRequest(ControlProblem):
    """A problem with controls."""

    values: ByControl = Field(
        {}, description="by control: one number, or one for each node; default: their own, or zero"
    )
    vary: tuple[str, ...] = Field((), description="parameters by which the cost is differentiated")
    error_limit: ErrorLimit = problem.ERROR_LIMIT


class End(RequestPart):
    """Demands on the last state: a list with null where nothing is demanded, or some by coordinate."""

    q: Annotated[list[Wanted] | dict[str, Wanted], COORDINATES] = Field({}, description="rad, m")
    qd: Annotated[list[Wanted] | dict[str, Wanted], VELOCITIES] = Field({}, description="rad/s, m/s")

    def value(self) -> demands.End:
        """As the science takes it."""
        return demands.End(self.q, self.qd)


class OptimalControlRequest(ControlProblem):
    """A problem with demands, bounds, limits along the motion and a guess; the horizon and parameters may be free."""

    end: End = End()
    bounds: Annotated[dict[str, tuple[Wanted, Wanted]], BY_NAME] = Field(
        {}, description="least and largest value by control"
    )
    guess: ByControl = Field({}, description="controls to begin with: one number, or one for each node")
    path: dict[str, tuple[Finite | None, Finite | None]] = Field(
        {}, description="least and largest value by expression in q, q', u, t and parameters, at all nodes; SI"
    )
    free_parameters: Annotated[dict[str, tuple[Wanted, Wanted]], BY_NAME] = Field(
        {}, description="unknown beside the controls: least and largest value by parameter"
    )
    free_horizon: Annotated[tuple[Finite, Finite] | None, SECONDS] = Field(
        None, description="least and largest horizon, s: it is unknown, 'horizon' is where the search begins"
    )
    warm_start: dict[str, Any] | None = Field(
        None, description="an earlier answer (names, horizon, parameters, trajectory with series) to begin with"
    )
    segments: Annotated[int, Field(ge=1), NUMERIC] | None = Field(
        None, description="divides intervals; default: the largest such up to 10"
    )
    iterations: Annotated[int, Field(ge=1, le=100_000), NUMERIC] = 500
    tolerance: Annotated[float, Field(gt=0, lt=1), NUMERIC] = Field(
        1e-8, description="change of the cost at which the search ends"
    )
    error_limit: ErrorLimit = problem.ERROR_LIMIT
