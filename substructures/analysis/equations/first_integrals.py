"""First integrals of a model as formulas, each with the reason why it is constant (notation.md, section 7).

Energy: H' = Q_a q'^a + V' is the zero formula; of given motions Jacobi's (section 12), beside momenta alone.
Cyclic coordinate c: Gamma_abc + Gamma_bac = 0 for all a, b and Q_c = 0, then p_c = g_cb q'^b. The same for constant
directions c^a: c^a p_a (:mod:`.symmetries`). Momenta of the whole: the derivative of p . e or L . e along the motion
is the zero formula, as gravity, loads and the reactions of the world have no resultant along (about) e.
Ball joints: p_c of a rate is in the axes of the body; in place of d_c g_ab stands d_a g_cb + d_b g_ca - 2 Gamma~_cab.
Closed loops: closures do no work and do not depend on time, so the energy is as without them; reactions enter as
G^T lambda with any lambda; no closure depends on a cyclic coordinate c, G_kc = 0. So do velocity constraints
B q' + b = 0 with B for G, but for the energy where b is not 0. Zero: :mod:`substructures.expr.calculus.vanish`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from itertools import chain
from typing import Literal

from substructures.analysis.equations.energy import constraints_in, depends_on, judged_energy
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.equations.free_motion import FreeMotion, kept_axes
from substructures.analysis.equations.generators import Generators
from substructures.analysis.equations.integral import SIZES, FirstIntegrals, Integral, IntegralKind
from substructures.analysis.equations.integral_search import IntegralSearch, not_searched
from substructures.analysis.equations.nonholonomic.constrained_formulas import formulas_of, rows_expected
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of
from substructures.analysis.equations.subsystems import subsystems
from substructures.analysis.equations.symmetries import Direction, directions, varied
from substructures.certificate.derived.integrals import constant
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.calculus.corners import VanishingOnAllSides, corners
from substructures.expr.differentiate import directional
from substructures.expr.garbage import without_collections
from substructures.expr.graph import Expr
from substructures.expr.known import Known
from substructures.expr.program import Formulas, array, program
from substructures.expr.walk import transfer
from substructures.printers import entries
from substructures.quantities.certificate import DYNAMICS, certified
from substructures.quantities.numbers.defaults import input_defaults
from substructures.quantities.numbers.field_state import field_state
from substructures.quantities.numbers.memo import known_model
from substructures.tree.model import KINEMATICS, Model

Names = frozenset[str]
AXES = "xyz"
UNITS: dict[IntegralKind, str] = {"linear_momentum": "N s", "angular_momentum": "N m s"}
MOMENTA = [f"{name}{given}" for name in UNITS for given in ("", "_0")]


def first_integrals(
    model: Model, inputs: Iterable[str] | None = None, zero: Iterable[str] = (), degree: Literal[1, 2] = 2
) -> FirstIntegrals:
    """Everything constant that follows from symmetry, with the energy (also where it is not constant), and what exact
    search finds among integrals of this ``degree`` in the momenta at most, in models that are small enough for it
    (``searched`` tells).

    ``inputs``: inputs that may have any value (default: those whose own default is not 0); all others are 0, as are
    the parameters ``zero``.
    What the reactions of closures and velocity constraints could change, whatever they are, is not constant. Raises
    InvalidInput for a coordinate without inertia, and for unknown names (``/inputs``, ``/parameters``).
    """
    if degree not in (1, 2):
        raise InvalidArgument.at("/degree", "unknown-degree", f"no integrals of degree {str(degree)[:80]}: give 1 or 2")
    known = model.input_names
    inputs, zero = acting_inputs(model) if inputs is None else list(inputs), list(zero)
    faults = [
        Fault(f"/{field}", f"unknown-{field[:-1]}", f"unknown {field[:-1]} '{str(name)[:80]}'{among(name, some)}")
        for field, names, some in (("inputs", inputs, known), ("parameters", zero, model.parameters))
        for name in names
        if name not in some
    ]
    if faults:
        raise InvalidArgument(faults)
    return _found(known_model(model), frozenset(inputs), frozenset(zero), degree)


def acting_inputs(model: Model) -> list[str]:
    """The inputs that act where none is given: those with a default that is not 0."""
    return [name for name, value in input_defaults(model.inputs).items() if value]


@lru_cache(maxsize=32)
@without_collections
def _found(known: Known, given: Names, zero: Names, degree: int) -> FirstIntegrals:
    model: Model = known.source
    unused = {s.name for s in model.program.symbols if s.kind == "input" and s.name not in given}
    f = formulas_of(model, constraints_of(model), unused | zero)
    search = _Search(f)
    search.energy(given)
    freely = search.momenta()
    search.cyclic()
    search.further(given, freely)
    searched = search.beyond(degree)
    outputs = {name: Formulas((), {(): x}) for name, x in [*((i.name, x) for i, x in search.found), ("power", f.power)]}
    outputs |= dict(zip(SIZES, f.formulas([*SIZES.values()]).values(), strict=True))
    along, integrals, rows = f.program(outputs), tuple(i for i, _ in search.found), f.multipliers
    some, held = [vars(each) for each in integrals], rows_expected(f, along)
    expectation = constant(along, some, rows, held, model.balls, SIZES)
    needs = (*DYNAMICS, *MOMENTA, *KINEMATICS)
    kinds = dict.fromkeys(rows, "input")
    along = certified(along, model, expectation, "first_integrals", needs=needs, zero=unused | zero, more=kinds)
    return FirstIntegrals(along, integrals, tuple(search.cyclic_names), *searched)


class _Search:
    """Integrals found so far, and the tests; ``state``: one of a field, where that tells all."""

    def __init__(self, f: ModelFormulas) -> None:
        self.f, self.zero, self.vanishes = f, f.graph.zero, VanishingOnAllSides(f.graph)
        self.state = field_state(f.model, f.zero)
        self.found: list[tuple[Integral, Expr]] = []
        self.cyclic_names: list[str] = []

    @cached_property
    def generators(self) -> Generators:
        """What the momenta found by now make, as others are compared with it."""
        result = Generators(self.f)
        for integral, value in self.found:
            if integral.rule == "constant" and integral.kind != "energy":
                result.add(value)
        return result

    def energy(self, given: frozenset[str]) -> None:
        """H = T + V, unless a varying input is part of V."""
        judged = judged_energy(self.f, self.vanishes, given)
        if judged is not None:
            self.found.append((Integral("energy", "energy", judged[0], "J", judged[1]), self.f.energy))

    def further(self, given: frozenset[str], freely: FreeMotion | None) -> None:
        """Those beside the momenta that are no combinations of them and of their products; none at given motions."""
        if freely is None:
            return
        blocks = subsystems(self.f, self.vanishes, given) if self.f.is_scleronomic else ()
        for integral, value in chain(freely.spin(), blocks):
            self._note_new(integral, value)

    def beyond(self, degree: int) -> tuple[int, str]:
        """Those that are found among terms of a degree; the degree that was searched, and what among."""
        why = not_searched(self.f)
        if why is not None:
            return 1, f"symmetries, momenta and subsystems only: {why}"
        generators = self.generators
        for integral, value in self.found:
            if integral.kind == "energy" and integral.rule == "constant":
                generators.add(value)
        search = IntegralSearch(self.f, generators, self.vanishes)
        self.found += search.found(degree)
        return degree, search.told

    def _note_new(self, integral: Integral, value: Expr) -> None:
        if integral.rule != "constant" or self.generators.is_new(value):
            self.found.append((integral, value))
            self.generators.add(value)

    @cached_property
    def varied(self) -> set[int]:
        """The coordinates on which anything depends."""
        return varied(self.f, self.vanishes) if self.state is None else {c for _, _, c in self.state.slopes}

    @cached_property
    def free(self) -> list[int]:
        """The other ones, where no force acts on them."""
        forces = self.f.vector("forces")
        return [c for c in range(self.f.n) if c not in self.varied and self.vanishes(forces[c])]

    def cyclic(self) -> None:
        """p_c for every coordinate c that neither metric nor forces depend on."""
        f = self.f
        for c in self.free:
            name = f.model.coordinates[c]
            self.cyclic_names.append(name)
            unit = "N m s" if f.model.joints[c] == "R" else "N s"
            where = ", in the axes of its body" * (name not in f.model.positions)
            reason = f"the metric does not depend on '{name}'{where} and no generalised force acts on it"
            reason += f"; {constraints_in(f.model)} do not depend on it" if f.multipliers else ""
            self._note(Integral(f"momentum.{name}", "cyclic", "constant", unit, reason), f.momenta[c])
        for direction in () if f.model.given else directions(f, self.varied, self.free, self.vanishes, self.state):
            self._symmetry(direction)

    def _symmetry(self, found: Direction) -> None:
        """c^a p_a for a constant direction c that is free."""
        f, components = self.f, list(found.components.items())
        graph = components[0][1].graph
        shown = program(graph, {"c": array((len(components),), lambda k: components[k][1])}, f.symbols)
        texts = {entry["index"][0]: str(entry["formula"]) for entry in entries(shown, "c", "text")}
        direction = {f.model.coordinates[a]: texts.get(k, "0") for k, (a, _) in enumerate(components)}
        moved = ", ".join(f"'{name}' by {text}" for name, text in direction.items())
        reason = f"neither the metric nor the power of the forces changes when these move together: {moved}"
        reason += f"; {constraints_in(f.model)} do not change either" if f.multipliers else ""
        unit = "N m s" if f.model.joints[components[-1][0]] == "R" else "N s"
        name = "symmetry." + "-".join(direction)
        self._note(Integral(name, "symmetry", "constant", unit, reason, direction), found.of(f.momenta, f.graph))

    def _note(self, integral: Integral, value: Expr) -> None:
        """Add an integral; of one that is known already only the reason."""
        for k, (known, x) in enumerate(self.found):
            if self.vanishes(x - value) or self.vanishes(x + value):
                self.found[k] = replace(known, reason=f"{known.reason}; {integral.reason}"), x
                return
        self.found.append((integral, value))

    def momenta(self) -> FreeMotion | None:
        """Of the whole along, and about, axes of the world and a constant force; what moves freely, if it may."""
        # p = sum_a p_a q'^a, L = sum_a L_a q'^a and their derivatives along the equations of motion
        linear, angular = self._momentum("linear_momentum"), self._momentum("angular_momentum")
        rates = self._rates([*linear, *angular])
        constant = [None if x is None else self._constant(x) for x in rates[:3]]
        pull = [x or self.zero for x in constant]
        kinds: list[IntegralKind] = [*("linear_momentum",) * 3, *("angular_momentum",) * 3]
        for kind, axis, value, rate in zip(kinds, AXES + AXES, [*linear, *angular], rates, strict=True):
            if rate is not None and self.vanishes(rate):
                self._momentum_found(kind, axis, value)
        self._across(linear, pull)
        self._about(angular, pull)
        if not all(rate is not None and self.vanishes(rate) for rate in rates):
            self._along_axes(linear, angular)
        if self.f.model.given:
            return None
        freely = FreeMotion(self.f, linear, angular, constant, self._constant, self.vanishes)
        for integral, value in freely.with_time():
            self._note(integral, value)
        return freely

    def _rates(self, momenta: Sequence[Expr]) -> list[Expr | None]:
        """Their derivatives along the equations of motion; None for one that is known to vary. Without a formula where
        one is +-p_c of a free c, or known to be zero."""
        kept = {x.fp for c in self.free for x in (self.f.momenta[c], -self.f.momenta[c])}
        told = [None] * 6 if self.state is None else self.state.told_rates
        moving = [x for x, rule in zip(momenta, told, strict=True) if rule is None and x.fp not in kept]
        found = dict(zip(moving, self.f.rate(moving), strict=True)) if moving else {}
        return [None if rule == "varies" else found.get(x, self.zero) for x, rule in zip(momenta, told, strict=True)]

    def _momentum(self, name: str) -> list[Expr]:
        """Components of sum_a n_a q'^a."""
        # momentum_i = n_ai q'^a
        given = self.f.elements(f"{name}_0") if self.f.model.given else {}
        result = [given.get((i,), self.zero) for i in range(3)]
        for (a, i), x in self.f.elements(name).items():
            result[i] = result[i] + x * self.f.rates[a]
        return result

    def _momentum_found(self, kind: IntegralKind, label: str, value: Expr) -> None:
        # what is zero in every state says nothing about a motion
        if self.vanishes(value):
            return
        word = "force along" if kind == "linear_momentum" else "moment about"
        where = "" if kind == "linear_momentum" else " through the origin"
        world = f"{constraints_in(self.f.model)} and the world" if self.f.multipliers else "the world"
        reason = f"gravity, loads and {world} exert no resultant {word} {label}{where}"
        self._note(Integral(f"{kind}.{label}", kind, "constant", UNITS[kind], reason), value)

    def _constant(self, expr: Expr) -> Expr | None:
        """The value of a formula that depends on parameters only, else None."""
        states = frozenset(s.name for s in self.f.symbols.values() if s.kind != "parameter")
        varied = self.vanishes.smooth.varies(expr, states)
        if not varied and not depends_on([expr], states):
            return expr
        # a jump has no derivative that tells of it
        if varied or corners([expr]):
            return None
        # dx = 0 for all changes of the state
        seeds = {name: self.f.graph.symbol(f"d.{name}") for name in states}
        if not self.vanishes(directional([expr], seeds)[0]):
            return None
        try:
            return transfer([expr], self.f.graph, self.f.at_zero(states))[0]
        except ZeroDivisionError:
            return None

    def _along_axes(self, linear: Sequence[Expr], angular: Sequence[Expr]) -> None:
        """Along and about the axes of joints that keep their direction, through the origin."""
        for name, axis in kept_axes(self.f, self._constant, self.vanishes):
            for kind, some in zip(UNITS, (linear, angular), strict=True):
                # p . e, L . e
                value = self.f.graph.sum(x * e for x, e in zip(some, axis, strict=True))
                if self.vanishes(self.f.rate([value])[0]):
                    self._momentum_found(kind, f"axis-of-{name}", value)

    def _across(self, linear: Sequence[Expr], pull: Sequence[Expr]) -> None:
        """Directions in the planes of two axes that are normal to a constant force: p_i - p_j F_i/F_j."""
        acting = [i for i in range(3) if not self.vanishes(pull[i])]
        for i in acting[1:]:
            j = acting[0]
            # p_i' F_j - p_j' F_i = 0 where p' = F is constant
            value = linear[i] - linear[j] * (pull[i] / pull[j])
            self._momentum_found("linear_momentum", f"{AXES[i]}-normal-to-force", value)

    def _about(self, angular: Sequence[Expr], pull: Sequence[Expr]) -> None:
        """The direction of a constant force that is along none of the axes."""
        acting = [i for i in range(3) if not self.vanishes(pull[i])]
        if len(acting) > 1:
            # L . F / F_j
            value = self.f.graph.sum(angular[i] * (pull[i] / pull[acting[0]]) for i in acting)
            if self.vanishes(self.f.rate([value])[0]):
                self._momentum_found("angular_momentum", "force", value)
