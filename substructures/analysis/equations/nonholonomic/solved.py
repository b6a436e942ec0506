"""Equations in quasi-velocities solved for the accelerations, x' = f(t, x) of x = (q, v), and varied, as formulas.

    q' = T v + r        v' = g*^-1 (forces - bias)        q'' = d/dt (T v + r)

The variation is the derivative of (q', v') along the symbols ``d.<name>`` of coordinates, quasi-velocities and
parameters: S' = f_x S + f_p for S = dx/dp (E. Hairer, S. P. Norsett, G. Wanner, Solving ordinary differential equations
I, section I.14).

====================  =====  ============================================================================
output                shape  meaning (n coordinates, p quasi-velocities)
====================  =====  ============================================================================
rates                 n      q' = T v + r [rad/s, m/s]
acceleration          p      v'
second                n      q'' [rad/s^2, m/s^2]
power                        of forces without potential, and of constraints that move (b is not 0) [W]
rates_variation       n      of ``rates``
variation             p      of ``acceleration``
====================  =====  ============================================================================
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache

from substructures.analysis.arguments import NumberOrExpression, exact
from substructures.analysis.equations.elimination import MetricElimination
from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.equations.formulas import inputs_of
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.analysis.equations.perturbation import require_smooth
from substructures.analysis.given import require_known
from substructures.certificate.derived import quasi_motion
from substructures.certificate.derived.model_formulas import Expectation
from substructures.expr.differentiate import directional, gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.known import Known
from substructures.expr.program import Formulas, Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.quantities.certificate import certified

RATES, ACCELERATION, SECOND, POWER = "rates", "acceleration", "second", "power"
RATES_VARIATION, VARIATION = "rates_variation", "variation"
_EQUATIONS = ("metric", "bias", "forces", "rates", "lost_power")


def solved(equations: QuasiVelocities, zero: Iterable[str] = ()) -> Program:
    """``rates``, ``acceleration``, ``second`` and ``power`` of the table above; ``zero``: symbols that are 0.

    Raises InvalidDocument (``singular-metric``) for quasi-velocities that move nothing that has inertia.
    """
    return _solved(Known(equations.program.digest, equations), frozenset(zero))


def varied(equations: QuasiVelocities, parameters: Sequence[str]) -> Program:
    """``rates`` and ``acceleration``, and their variations along ``d.<name>`` of coordinates, quasi-velocities and
    these parameters. Raises as :func:`solved`.
    """
    return _varied(Known(equations.program.digest, equations), tuple(parameters))


def state_space(
    equations: QuasiVelocities, outputs: Sequence[NumberOrExpression] = (), inputs: Sequence[str] | None = None
) -> Program:
    """A (n+p, n+p), B (n+p, m), C (k, n+p), D (k, m) of x = (q, v), with ``derivative`` (n+p,) = x' and ``output`` (k,)
    = y, at any state: what :func:`..perturbation.state_space` is without constraints, with the same arguments.

    Raises InvalidInput as that.
    """
    model = equations.model
    require_smooth(model)
    chosen = inputs_of(model) if inputs is None else tuple(inputs)
    require_known("inputs", "input", chosen, inputs_of(model))
    return _state_space(Known(equations.program.digest, equations), tuple(outputs), chosen)


def dynamics(equations: QuasiVelocities) -> Program:
    """``rates``, ``acceleration``, ``second`` and ``power`` as functions of q, v, t, inputs and parameters, to be
    exported: velocities of coordinates, ``arm.q1'``, are symbols of their own there, ``v.arm.q1``.
    """
    source, graph = solved(equations), Graph()
    names = {name: f"v.{name[:-1]}" for name in equations.velocities if name.endswith("'")}
    symbols = [replace(s, name=names.get(s.name, s.name)) for s in source.symbols]
    bound = {name: graph.symbol(called) for name, called in names.items()}
    return program(graph, replay(source, graph, bound), {s.name: s for s in symbols}).marked(source.not_judged)


@lru_cache(maxsize=32)
def _solved(known: Known, zero: frozenset[str]) -> Program:
    f = _Motion(known.source, zero)
    power = f.power
    outputs = {
        RATES: f.vector(f.rates),
        ACCELERATION: f.vector(f.acceleration),
        SECOND: f.vector(f.second),
        POWER: array((), lambda: power),
    }
    expectation = quasi_motion.solved(f.equations.program, f.equations.velocities)
    return f.certified(outputs, expectation, "equations of motion with velocity constraints")


@lru_cache(maxsize=32)
def _varied(known: Known, parameters: tuple[str, ...]) -> Program:
    f = _Motion(known.source)
    names = [*f.equations.model.coordinates, *f.equations.velocities, *parameters]
    seeds = {name: f.graph.symbol(f"d.{name}") for name in names}
    outputs = {
        RATES: f.vector(f.rates),
        ACCELERATION: f.vector(f.acceleration),
        RATES_VARIATION: f.vector(directional(f.rates, seeds)),
        VARIATION: f.vector(directional(f.acceleration, seeds)),
    }
    f.symbols |= {f"d.{name}": replace(f.symbols[name], name=f"d.{name}") for name in names}
    expectation = quasi_motion.varied(f.equations.program, f.equations.velocities, parameters)
    return f.certified(outputs, expectation, "variation of the motion with velocity constraints")


@lru_cache(maxsize=32)
def _state_space(known: Known, given: tuple[NumberOrExpression, ...], inputs: tuple[str, ...]) -> Program:
    f = _Motion(known.source)
    equations, model = f.equations, f.equations.model
    exacts = [(exact(y, f"/outputs/{i}"), f"/outputs/{i}") for i, y in enumerate(given)]
    read = read_expressions(model, {"output": exacts}, inputs=True)
    f.symbols |= {s.name: s for s in read.symbols if s.name not in f.symbols and not s.name.endswith("'")}
    moving = {f"{name}'": rate for name, rate in zip(model.coordinates, f.rates, strict=True)}
    entries = replay(read, f.graph, moving)["output"].entries
    y = [f.graph.lift(entries.get((i,), 0)) for i in range(len(given))]
    x, states = [*f.rates, *f.acceleration], [*model.coordinates, *equations.velocities]
    outputs = {"derivative": f.vector(x), "output": f.vector(y)}
    for name, rows, by in (("A", x, states), ("B", x, inputs), ("C", y, states), ("D", y, inputs)):
        m = gradient(rows, by)
        outputs[name] = array((len(rows), len(by)), lambda i, j, m=m: m[i][j])
    texts = [text for text, _ in exacts]
    expectation = quasi_motion.first_order(equations.program, equations.velocities, texts, inputs)
    return f.certified(outputs, expectation, "state space with velocity constraints")


class _Motion:
    """The equations in a graph of their own."""

    def __init__(self, equations: QuasiVelocities, zero: frozenset[str] = frozenset()) -> None:
        self.equations, self.graph, self.zero = equations, Graph(), zero
        self.bound = dict.fromkeys(zero, self.graph.zero)
        self.symbols = {symbol.name: symbol for symbol in equations.program.symbols}
        model = equations.model
        for name, unit in model.state_units["q"].items():
            self.symbols.setdefault(name, Symbol(name, "coordinate", unit))
        for name in model.parameters:
            self.symbols.setdefault(name, Symbol(name, "parameter", model.units[name]))
        for name in equations.velocities:
            self.symbols.setdefault(name, Symbol(name, "velocity", model.state_units["qd"].get(name[:-1], "")))
        self.found = replay(equations.program, self.graph, self.bound, list(_EQUATIONS))

    def vector(self, values: Sequence[Expr]) -> Formulas:
        """An output of one axis."""
        return array((len(values),), lambda i: values[i])

    def row(self, name: str) -> list[Expr]:
        """An output of one axis, zeros included."""
        entries, (size,) = self.found[name].entries, self.found[name].shape
        return [self.graph.lift(entries.get((i,), 0)) for i in range(size)]

    @cached_property
    def rates(self) -> list[Expr]:
        """q'."""
        return self.row("rates")

    @cached_property
    def acceleration(self) -> list[Expr]:
        """v' from g* v' = forces - bias."""
        metric = {index: self.graph.lift(x) for index, x in self.found["metric"].expanded().items()}
        factors = MetricElimination(metric, self.equations.velocities)
        return factors.solve([f - b for f, b in zip(self.row("forces"), self.row("bias"), strict=True)])

    @cached_property
    def second(self) -> list[Expr]:
        """q''."""
        moving = zip(self.equations.model.coordinates, self.rates, strict=True)
        turning = zip(self.equations.velocities, self.acceleration, strict=True)
        return directional(self.rates, {"t": self.graph.one, **dict(moving), **dict(turning)})

    @property
    def power(self) -> Expr:
        """The power that is lost, and that of constraints, which depends on v'."""
        result = self.graph.lift(self.found["lost_power"].entries.get((), 0))
        if "constraint_power" not in self.equations.program.outputs:
            return result
        names = (f"{name}'" for name in self.equations.velocities)
        bound = self.bound | dict(zip(names, self.acceleration, strict=True))
        found = replay(self.equations.program, self.graph, bound, ["constraint_power"])
        return result + found["constraint_power"].entries.get((), 0)

    def certified(self, outputs: dict[str, Formulas], expectation: Expectation, what: str) -> Program:
        """The program of the outputs, compared with the equations."""
        made = program(self.graph, outputs, self.symbols)
        kinds = {name: symbol.kind for name, symbol in self.symbols.items()}
        return certified(made, self.equations.model, expectation, what, needs=("metric",), zero=self.zero, more=kinds)
