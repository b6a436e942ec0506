"""The regressor Y of a tree as a value: its program, what its columns are, and its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.mechanics.state_names import BallRow, positions_of
from substructures.quantities.numbers.result import Evaluation, ParameterColumns, failures_of
from substructures.quantities.numbers.states import StateInput, ValueInput, read_states, symbol_values
from substructures.tree.cuts import ClosureRows
from substructures.tree.model import Model

OUTPUTS = ("regressor", "inertial_parameters")


@dataclass(frozen=True)
class RegressorModel:
    """Y and pi of a tree.

    ``program``: outputs ``regressor`` (n, 10 links) [SI units per unit of the parameter], a function of q, q', q'' and
    the free parameters, ``inertial_parameters`` (10 links,), pi, and ``moments_of_inertia`` (links, 3, 3) [kg m^2],
    Theta about the origin of the body frame in its axes, with products of inertia -integral x y dm beside the diagonal;
    both functions of the free parameters.
    ``names`` and ``units``: of the columns, ``instance.body.m`` [kg], ``.sx .sy .sz`` = m times the mass centre [kg m],
    ``.Jxx .Jyy .Jzz .Jxy .Jxz .Jyz`` = integral of x x^T dm [kg m^2] (Theta = tr(J) 1 - J), about the origin of the
    body frame in its axes. A link is a moving body with all that is fixed to it in the same part; ``instance.base``
    is what is fixed to the interface of an instance on a host, in the interface frame. Massless bodies inside compound
    joints are no links. ``parameters``: the free parameters with default, unit and description. ``closures``: of the
    tree; their forces, which Y pi has to balance with the actuators, are not part of it; ``driven``: coordinates whose
    motion is given, which have no rows; ``reduced``: instances whose loops are in the formulas, ``followed``: those
    of these loops that are met by steps of Newton's method. ``regrouping``: output ``relations`` (r, 10 links + k):
    coefficients, functions of the free parameters, with which columns of Y add up to zero, whatever moves; the last k
    columns are those of massless carriers (:mod:`.regrouping`).
    """

    program: Program
    coordinates: tuple[str, ...]
    joints: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    regrouping: Program
    closures: tuple[ClosureRows, ...] = ()
    driven: tuple[str, ...] = ()
    balls: tuple[BallRow, ...] = field(default=(), hash=False)
    reduced: tuple[str, ...] = ()
    followed: tuple[str, ...] = ()

    @property
    def positions(self) -> tuple[str, ...]:
        """What states q are, as those of a model."""
        return positions_of(self.coordinates, self.balls)

    @property
    def labels(self) -> Mapping[str, Any]:
        """Names by axis."""
        links = tuple(name.removesuffix(".m") for name in self.names[::10])
        return {"columns": ParameterColumns(self.names, self.units), "links": links}

    def evaluate(
        self,
        q: StateInput | None,
        qd: StateInput | None = None,
        qdd: StateInput | None = None,
        *,
        parameters: ValueInput | None = None,
        limit: int | None = None,
    ) -> Evaluation:
        """Numbers: ``regressor`` (N, n, 10 links) and ``inertial_parameters`` (N, 10 links).

        Arguments as for :func:`substructures.quantities.numbers.evaluation.evaluate`; N is dropped for one state with
        ``q`` (n,). Raises InvalidArgument (``qdd`` is needed) and MissingValue.
        """
        model = Model(self.program, self.coordinates, self.joints, (), self.parameters, {}, balls=self.balls)
        given = {"q": q, "qd": qd, "qdd": qdd, "parameters": parameters}
        states = read_states(model, given, limit)
        if states.qdd is None and model.dof:
            raise InvalidArgument.at("/qdd", "missing", "the regressor needs accelerations 'qdd'")
        values = symbol_values(model, given, states, OUTPUTS)
        results = interpret_in_blocks(self.program, values, OUTPUTS, states.count)
        return Evaluation(
            self.coordinates,
            states.count,
            self.program.digest,
            {name: x[0] if states.single else x for name, x in results.items()},
            failures_of(results, lambda _name, _state: ("not-finite", "the result is not finite")),
            labels=self.labels,
            single=states.single,
        )
