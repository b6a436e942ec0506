"""What first integrals are looked for among: sums of known functions of q and t times products of momenta.

    I = sum over j of c_j F_j,        F = phi,  phi w_a  or  phi w_a w_b        w = p (momenta) or q' (velocities)

with unknown constants c. I' along the equations of motion is linear in them, and F' follows from the derivatives of phi
and w by the rule of products. With p no inverse of g is needed: p_a' = Gamma_bca q'^b q'^c + Q_a.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, product
from typing import Any

from substructures.analysis.equations.formulas import ModelFormulas
from substructures.errors import TooLarge
from substructures.expr.calculus.integrate import symbols_of
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.expr.program import Program, Symbol, array, program
from substructures.expr.rings.expand import Expanded, Term, expand
from substructures.expr.rings.generators import times_power
from substructures.expr.trigonometry import cos, sin

#: columns, and terms of canonical forms that functions are taken from
COLUMNS, TERMS = 250, 40
OUTPUTS = ("phi", "phi_rate", "w", "w_rate")


@dataclass(frozen=True)
class Column:
    """phi_k times w_a for every a of ``factors``."""

    phi: int
    factors: tuple[int, ...] = ()

    def value(self, phi: Sequence[Any], w: Sequence[Any]) -> Any:
        """F, over any scalars."""
        result = phi[self.phi]
        for a in self.factors:
            result = result * w[a]
        return result

    def rate(self, at: Mapping[str, Sequence[Any]]) -> Any:
        """F', over any scalars; ``at``: phi, phi', w, w'."""
        phi, w, rates = at["phi"], at["w"], at["w_rate"]
        result = self.value(at["phi_rate"], w)
        for k, a in enumerate(self.factors):
            part = phi[self.phi] * rates[a]
            for b in (*self.factors[:k], *self.factors[k + 1 :]):
                part = part * w[b]
            result = result + part
        return result


class Ansatz:
    """``functions``: phi; ``w``: p or q'; ``columns``: what stands beside each other, simple ones first."""

    def __init__(self, f: ModelFormulas, names: Sequence[str], w: Sequence[Expr], rates: Sequence[Expr]) -> None:
        self.f, self.names, self.w, self.w_rate = f, names, w, rates
        self.functions: list[Expr] = []
        self.columns: list[Column] = []
        self.told = "products of harmonics of inertia and V times velocities"

    def add(self, functions: Iterable[Expr], degree: int) -> None:
        """Each of the functions times all products of so many w."""
        place = {x: k for k, x in enumerate(self.functions)}
        known = set(self.columns)
        for x in functions:
            k = place.setdefault(x, len(self.functions))
            self.functions += [x] if k == len(self.functions) else []
            for factors in combinations_with_replacement(range(self.f.n), degree):
                if (degree or x is not self.f.graph.one) and Column(k, factors) not in known:
                    self.columns.append(Column(k, factors))

    def program(self) -> Program:
        """phi, w and their derivatives along the motion."""
        outputs = {name: array((len(x),), x.__getitem__) for name, x in self.at().items()}
        return program(self.f.graph, outputs, self.f.symbols)

    def at(self) -> dict[str, list[Expr]]:
        """The same as formulas."""
        rates = self.f.along_motion(self.functions)
        return {"phi": self.functions, "phi_rate": rates, "w": list(self.w), "w_rate": list(self.w_rate)}


def in_momenta(f: ModelFormulas, degree: int) -> Ansatz:
    """w = p; coefficients are polynomials in slides, and t; without momenta also those in angles, and what V is
    made of. Fewer polynomials where there are too many columns.
    """
    gamma, forces = f.elements("christoffel"), f.vector("forces")
    rates = list(forces)
    for (b, c, a), x in gamma.items():
        rates[a] = rates[a] + x * f.rates[b] * f.rates[c]
    ansatz = Ansatz(f, [f"p.{name}" for name in f.model.coordinates], f.momenta, rates)
    f.symbols.setdefault("t", Symbol("t", "time", "s"))
    t, slides = f.graph.symbol("t"), [q for q, joint in zip(f.q, f.model.joints, strict=True) if joint == "P"]
    squares = [x * y for x, y in combinations_with_replacement(slides, 2)]
    potential = _of_potential(f, slides)
    ansatz.add([t, t * t, *f.q, *(x * y for x, y in combinations_with_replacement(f.q, 2))], 0)
    ansatz.add([*potential, *(x * y for x in potential for y in slides)], 0)
    ansatz.add([f.graph.one, t, *slides], 1)
    ansatz.told = "linear in the momenta"
    for power, some in enumerate(([f.graph.one], slides, squares) if degree > 1 else ()):
        size = len(ansatz.columns) + len(some) * f.n * (f.n + 1) // 2
        if size > COLUMNS:
            break
        # phi' cancels q_a q_b p_c d_d V: terms of V with two more slides
        more = [x * y for x in potential for y in some] if some is squares else []
        ansatz.add(more if size + len(more) <= COLUMNS else [], 0)
        ansatz.add(some, 2)
        ansatz.told = f"quadratic in the momenta with coefficients of degree {power} in slides"
    return ansatz


def _of_potential(f: ModelFormulas, slides: Sequence[Expr]) -> list[Expr]:
    """The functions that V consists of; of a polynomial also what these become in other axes."""
    V = f.scalar("potential_energy")
    by = slides if len(slides) > 1 and _is_polynomial(f, V) else []
    slopes = zip(by, gradient([V], [str(q.value) for q in by])[0], strict=True)
    # of constant K: d_a U = K_ab d_b V, and k U = q_a d_a U where U is homogeneous of degree k: terms of q_a d_b V
    return _functions(f, [V, *(x * slope for y, slope in slopes for x in slides if x is not y)])


def in_velocities(f: ModelFormulas) -> Ansatz | None:
    """w = q'; coefficients are products of two harmonics of g and V. None where these are too many, or none."""
    ansatz = Ansatz(f, [f"{name}'" for name in f.model.coordinates], f.rates, f.acceleration)
    waves = _waves(f, [*f.elements("metric").values(), f.scalar("potential_energy")])
    if not 1 < len(waves) <= COLUMNS // (1 + f.n * (f.n + 3) // 2):
        return None
    for degree in (0, 1, 2):
        ansatz.add(waves, degree)
    return ansatz


def _forms(exprs: Iterable[Expr]) -> Iterator[Expanded]:
    for x in exprs:
        try:
            form = expand(x, TERMS)
        except (TooLarge, ZeroDivisionError):
            continue
        yield form


def _functions(f: ModelFormulas, exprs: Iterable[Expr]) -> list[Expr]:
    """The functions of the state that the canonical forms are sums of."""
    fixed = {name for name, s in f.symbols.items() if s.kind == "parameter"}
    found = []
    for form in _forms(exprs):
        below = Expanded(form.denominator).to_expr(f.graph) if form.denominator else f.graph.one
        below = f.graph.one if symbols_of([below]) <= fixed else below
        found += [_of_state(term, f, fixed) / below for term in form.terms]
    # of inputs it is not known how they change
    inputs = {name for name, s in f.symbols.items() if s.kind == "input"}
    return list(dict.fromkeys(x for x in found if not symbols_of([x]) <= fixed and not symbols_of([x]) & inputs))


def _is_polynomial(f: ModelFormulas, x: Expr) -> bool:
    """Whether a formula is a polynomial in coordinates, with parameters in its coefficients."""
    fixed = {name for name, s in f.symbols.items() if s.kind == "parameter"}
    for form in _forms([x]):
        atoms = [atom for term in form.denominator for atom in term.atoms()]
        atoms += [a for term in form.terms for a, _ in term.angle]
        powers = [
            (atom, power) for term in form.terms for atom, power in term.powers if not symbols_of([atom]) <= fixed
        ]
        return symbols_of(atoms) <= fixed and all(atom.op == "sym" and power > 0 for atom, power in powers)
    return False


def _of_state(term: Term, f: ModelFormulas, fixed: set[str]) -> Expr:
    """A term without its number and parameters."""
    result = f.graph.one
    for x, power in term.powers:
        if not symbols_of([x]) <= fixed:
            result = times_power(result, x, power)
    is_moving = not symbols_of(a for a, _ in term.angle) <= fixed
    return result * _wave(term.trig, term.angle, f) if is_moving else result


def _wave(trig: str, angle: Iterable[tuple[Expr, Any]], f: ModelFormulas) -> Expr:
    whole = f.graph.sum(x * f.graph.number(c) for x, c in angle)
    return (cos if trig == "cos" else sin)(whole)


def _waves(f: ModelFormulas, exprs: Iterable[Expr]) -> list[Expr]:
    """1, and cosines and sines of all sums and differences of two of the angles that occur."""
    angles: list[dict[Expr, Any]] = [{}]
    for form in _forms(exprs):
        for term in form.terms:
            known = all(f.symbols[name].kind != "input" for name in symbols_of(a for a, _ in term.angle))
            if term.trig and known and dict(term.angle) not in angles:
                angles.append(dict(term.angle))
    waves = [f.graph.one]
    tried: set[frozenset[tuple[Expr, Any]]] = {frozenset()}
    for x, y, sign in product(angles, angles, (1, -1)):
        total = {a: x.get(a, 0) + sign * y.get(a, 0) for a in (*x, *y)}
        angle = [(a, c) for a, c in total.items() if c]
        if frozenset(angle) not in tried:
            tried |= {frozenset(angle), frozenset((a, -c) for a, c in angle)}
            waves += [_wave(trig, angle, f) for trig in ("cos", "sin")]
    # -sin(x) is no other function than sin(x)
    unique: dict[Expr, None] = {}
    for wave in waves:
        unique.setdefault(-wave if wave.negative else wave)
    return list(unique)
