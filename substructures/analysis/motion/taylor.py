"""Taylor series of the motion to high order, compiled by heyoka (optional): the fastest way to high accuracy.

F. Biscani, D. Izzo, Revisiting high-order Taylor methods for astrodynamics and celestial mechanics, 2021. Compiling
takes seconds for large models and is done once for a model and a tolerance; parameters stay free.
"""

from __future__ import annotations

import copy
import importlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any, Literal

from substructures.analysis.motion.conditions import Conditions
from substructures.analysis.motion.right_hand_side import ACCELERATION, POWER, forward_dynamics
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.program import Operation, Program
from substructures.tree.model import Model

BINARY = {"add": "__add__", "sub": "__sub__", "mul": "__mul__", "div": "__truediv__"}
FUNCTIONS = ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt")


@cache
def _heyoka() -> Any:
    """The package heyoka, None where it is not installed.

    The first motion that needs it imports it: with SymPy, which it loads, it would take a quarter of the start of a
    server and 86 MB of every process.
    """
    try:
        return importlib.import_module("heyoka")
    except ImportError:
        return None


def require_taylor(tables: Sequence[str], max_step: float | None) -> None:
    """Raises InvalidArgument where heyoka is missing, an input is a table, or steps are limited."""
    if _heyoka() is None:
        message = "the method 'Taylor' needs the package 'heyoka': install it, or leave 'method' out"
        raise InvalidArgument.at("/method", "not-installed", message)
    if max_step is not None:
        message = "the method 'Taylor' chooses its steps: leave 'max_step' out, or take another method"
        raise InvalidArgument.at("/max_step", "not-supported", message)
    if tables:
        message = f"the method 'Taylor' takes no tables ('{tables[0]}'): use an expression in t, or another method"
        raise InvalidArgument.at("/method", "not-supported", message)


@dataclass(frozen=True)
class _System:
    """What a compiled integrator depends on."""

    digests: tuple[str, str]
    zero: frozenset[str]
    inputs: tuple[str, ...]
    tolerance: float
    has_power: bool
    model: Model = field(compare=False)
    source: Program = field(compare=False)


def taylor_stepper(conditions: Conditions, tolerance: float, has_power: bool) -> _Factory:
    """Makes steppers with the interface of SciPy's for these conditions."""
    model, source = conditions.model, conditions.expressions
    key = (model.program.digest, source.digest)
    system = _System(key, conditions.zero, conditions.formulas, max(tolerance, 1e-15), has_power, model, source)
    integrator, names = _compiled(system)
    return _Factory(integrator, [conditions.values[name] for name in names])


@lru_cache(maxsize=16)
def _compiled(system: _System) -> tuple[Any, tuple[str, ...]]:
    """The integrator, and the names of its parameters in order."""
    heyoka, model = _heyoka(), system.model
    dynamics = forward_dynamics(model, system.zero)
    states = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    *variables, work = heyoka.make_vars(*(f"x{i}" for i in range(len(states) + 1)))
    x = dict(zip(states, variables, strict=True))
    used = dict.fromkeys(s.name for program in (dynamics, system.source) for s in program.symbols)
    names = tuple(n for n in used if n not in x and n != "t" and n not in system.inputs)
    known = x | {"t": heyoka.time} | {name: heyoka.par[i] for i, name in enumerate(names)}
    nodes = _expressions(system.source, known, ["inputs"])
    given = system.source.outputs["inputs"]
    known |= {name: heyoka.expression(0.0) for name in system.inputs}
    known |= {system.inputs[i]: nodes[e] for (i,), e in zip(given.index, given.entries, strict=True)}
    nodes = _expressions(dynamics, known, [ACCELERATION, POWER])
    rows: list[Any] = [heyoka.expression(0.0)] * model.dof
    found = dynamics.outputs[ACCELERATION]
    for (a,), entry in zip(found.index, found.entries, strict=True):
        rows[a] = nodes[entry]
    # (q)' = q', (q')' = q''(q, q', t), W' = power
    equations = [(x[c], x[f"{c}'"]) for c in model.coordinates]
    equations += [(x[f"{c}'"], row) for c, row in zip(model.coordinates, rows, strict=True)]
    if system.has_power:
        equations.append((work, nodes[dynamics.outputs[POWER].entries[0]]))
    start = [0.0] * len(equations)
    pars = [0.0] * len(names)
    return heyoka.taylor_adaptive(equations, start, pars=pars, tol=system.tolerance, compact_mode=True), names


def _expressions(program: Program, known: Mapping[str, Any], names: Sequence[str]) -> dict[int, Any]:
    """The program's operations that the outputs need, as expressions of heyoka."""
    heyoka = _heyoka()
    # operations refer to earlier ones only, so that one pass in their order makes them all
    nodes: dict[int, Any] = {}
    for i in program.reachable(names):
        op, *rest = program.operations[i]
        if op == "sym":
            nodes[i] = known[program.symbols[rest[0]].name]
        elif op in ("int", "rat"):
            nodes[i] = heyoka.expression(float(Fraction(*map(int, rest))))
        elif op == "powi":
            nodes[i] = nodes[rest[0]] ** float(rest[1])
        elif op == "sqrt" and _is_square(program.operations[rest[0]]):
            # |x|, as in the force of an end stop: the series on one side of x = 0 goes on as if there were no other
            nodes[i] = _operation("abs", [])
        else:
            nodes[i] = _operation(op, [nodes[k] for k in rest])
    return nodes


def _is_square(operation: Operation) -> bool:
    """Whether an operation is x * x or x^2."""
    return (operation[0] == "mul" and operation[1] == operation[2]) or (operation[0] == "powi" and operation[2] == 2)


def _operation(op: str, args: Sequence[Any]) -> Any:
    if op in BINARY:
        return getattr(args[0], BINARY[op])(args[1])
    if op == "neg":
        return -args[0]
    if op == "atan2":
        return _heyoka().atan2(*args)
    if op in FUNCTIONS:
        return getattr(_heyoka(), op)(args[0])
    message = f"the method 'Taylor' cannot take '{op}', which has no Taylor series everywhere: choose another method"
    raise InvalidArgument.at("/method", "not-smooth", message)


class _Factory:
    """Makes a stepper of an integrator for values of its parameters."""

    def __init__(self, integrator: Any, parameters: Sequence[float]) -> None:
        self.integrator, self.parameters = integrator, list(parameters)

    def __call__(self, _f: Any, start: float, x: Array, end: float) -> TaylorStepper:
        # what was compiled is shared; time, state and parameters are this motion's
        integrator = copy.copy(self.integrator)
        integrator.time = start
        integrator.state[:] = x
        if self.parameters:
            integrator.pars[:] = self.parameters
        return TaylorStepper(integrator, end)


class TaylorStepper:
    """One step after the other; the attributes are those of scipy.integrate.OdeSolver."""

    def __init__(self, integrator: Any, end: float) -> None:
        self.integrator, self.end, self.nfev = integrator, end, 0
        self.t: float = integrator.time
        self.t_old: float = self.t
        self.y: Array = integrator.state.copy()
        self.status: Literal["running", "finished", "failed"] = "running"

    def step(self) -> str | None:
        """Advance by one step, at most to the end; a message when that failed."""
        outcomes = _heyoka().taylor_outcome
        self.t_old = self.t
        outcome, _ = self.integrator.step(max_delta_t=self.end - self.t, write_tc=True)
        self.nfev += 1
        if outcome not in (outcomes.success, outcomes.time_limit):
            self.status = "failed"
            return "the series does not converge"
        self.t, self.y = self.integrator.time, self.integrator.state.copy()
        # t + (end - t) may miss the end by rounding
        if outcome == outcomes.time_limit:
            self.t, self.status = self.end, "finished"
        return None

    def dense_output(self) -> Any:
        """The polynomial of the last step."""
        return self.integrator.update_d_output
