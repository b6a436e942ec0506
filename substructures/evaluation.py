"""Numbers of a model for one state or many (the HTTP contract, section 4)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.errors import Fault, InvalidDocument
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.model import KINEMATICS, Model
from substructures.solve import cholesky_solve
from substructures.states import Array, States, read_states, symbol_values

FIELDS = frozenset(("quantities", "parameters", "q", "qd", "qdd", "inputs", "t"))


@dataclass
class Batch:
    """A request being answered: outputs of the program are computed once and shared by the quantities."""

    model: Model
    states: States
    values: dict[str, Any]
    outputs: dict[str, Array]

    def output(self, name: str) -> Array:
        """An output of the program, (N, ...)."""
        return self.outputs[name]


@dataclass(frozen=True)
class Quantity:
    """A quantity of the contract: outputs of the program that it needs, and how it follows from them."""

    needs: tuple[str, ...]
    compute: Callable[[Batch], Any]


def _inverse_dynamics(b: Batch) -> Array:
    if b.states.qdd is None:
        raise InvalidDocument.at("/qdd", "missing", "inverse_dynamics needs accelerations 'qdd'")
    return np.einsum("nab,nb->na", b.output("metric"), b.states.qdd) + b.output("bias") - b.output("forces")


def _forward_dynamics(b: Batch) -> Array:
    """q'' from g q'' = Q - Gamma q' q'; NaN where the metric is singular (the state is listed in the failures)."""
    return cholesky_solve(b.output("metric"), b.output("forces") - b.output("bias"))


def _momentum(b: Batch) -> dict[str, Array]:
    return {
        "linear": np.einsum("nai,na->ni", b.output("linear_momentum"), b.states.qd),
        "angular": np.einsum("nai,na->ni", b.output("angular_momentum"), b.states.qd),
    }


def _kinetic_energy(b: Batch) -> Array:
    return 0.5 * np.einsum("nab,na,nb->n", b.output("metric"), b.states.qd, b.states.qd)


def _output(name: str) -> Quantity:
    return Quantity((name,), lambda b: b.output(name))


QUANTITIES: dict[str, Quantity] = {
    **{name: _output(name) for name in ("metric", "christoffel", "forces", "gravity", "bias", "potential_energy")},
    "coriolis": Quantity(("christoffel",), lambda b: np.einsum("nabc,nc->nab", b.output("christoffel"), b.states.qd)),
    "inverse_dynamics": Quantity(("metric", "bias", "forces"), _inverse_dynamics),
    "forward_dynamics": Quantity(("metric", "bias", "forces"), _forward_dynamics),
    "kinetic_energy": Quantity(("metric",), _kinetic_energy),
    "kinematics": Quantity(KINEMATICS, lambda b: {name: b.output(name) for name in KINEMATICS}),
    "momentum": Quantity(("linear_momentum", "angular_momentum"), _momentum),
}

# dimensions of the answer for one state; what is not listed has one
_DIMENSIONS = {
    "metric": 2,
    "coriolis": 2,
    "christoffel": 3,
    "kinetic_energy": 0,
    "potential_energy": 0,
}


def numbers_per_state(quantities: Iterable[str], dof: int, frames: int) -> int:
    """How many numbers the answer holds for one state of a model with so many coordinates and frames."""
    n = max(1, dof)
    sizes = {"kinematics": frames * (12 + 6 * n)} | {name: n**k for name, k in _DIMENSIONS.items()}
    return sum(sizes.get(name, n) for name in quantities)


ADVICE = {
    "forward_dynamics": "the metric is singular or not positive definite: check masses, inertias and coordinates",
}


#: outputs of a program for (program, values, names, number of states)
Engine = Callable[[Program, Mapping[str, Any], list[str], int], dict[str, Array]]


def interpreted(program: Program, values: Mapping[str, Any], names: list[str], states: int) -> dict[str, Array]:
    """The engine that needs nothing: the reference interpreter, in blocks of states."""
    return interpret_in_blocks(program, values, names, states)


def evaluate(
    model: Model, request: Mapping[str, Any], limit: int | None = None, engine: Engine = interpreted
) -> dict[str, Any]:
    """Evaluate quantities for states.

    ``request``: the JSON body of the contract (lists, numbers) or the same with arrays. The answer holds numpy arrays,
    leading axis N dropped if ``q`` was (n,); ``failures`` lists states with a result that is not finite.
    Raises InvalidDocument (with pointers) and MissingValue (a parameter without a value).
    """
    quantities = read_quantities(request)
    states = read_states(model, request, limit)
    needs = sorted({name for q in quantities for name in QUANTITIES[q].needs})
    values = symbol_values(model, request, states, needs)
    batch = Batch(model, states, values, engine(model.program, values, needs, len(states.q)))
    answer: dict[str, Any] = {
        "coordinates": list(model.coordinates),
        "count": len(states.q),
        "digest": model.program.digest,
    }
    results = {name: QUANTITIES[name].compute(batch) for name in quantities}
    if "kinematics" in results:
        answer["frames"] = list(model.frames)
    answer |= {name: _single(value) if states.single else value for name, value in results.items()}
    return answer | {"failures": _failures(results)}


def _single(value: Any) -> Any:
    return {name: v[0] for name, v in value.items()} if isinstance(value, dict) else value[0]


def _failures(results: Mapping[str, Any]) -> list[dict[str, Any]]:
    failures = []
    for name, value in results.items():
        arrays = value.values() if isinstance(value, dict) else (value,)
        bad = np.zeros(0, dtype=np.int64)
        for some in arrays:
            finite = np.isfinite(some).reshape(len(some), -1).all(axis=1)
            bad = np.union1d(bad, np.flatnonzero(~finite))
        message = ADVICE.get(name, "the result is not finite")
        failures += [{"state": int(i), "quantity": name, "code": "not-finite", "message": message} for i in bad]
    return failures


def read_quantities(request: Mapping[str, Any]) -> list[str]:
    """The quantities that a request asks for, each once. Raises InvalidDocument, also for unknown fields."""
    faults = [Fault(f"/{key}", "unknown-field", f"unknown field '{key}'") for key in request if key not in FIELDS]
    names = request.get("quantities")
    if not isinstance(names, (list, tuple)) or not names:
        faults.append(Fault("/quantities", "missing", "a list of quantities is needed"))
        names = []
    for i, name in enumerate(names):
        if not isinstance(name, str) or name not in QUANTITIES:
            known = ", ".join(QUANTITIES)
            faults.append(
                Fault(f"/quantities/{i}", "unknown-quantity", f"unknown quantity {str(name)[:80]!r}; there are {known}")
            )
    if faults:
        raise InvalidDocument(faults)
    return list(dict.fromkeys(names))
