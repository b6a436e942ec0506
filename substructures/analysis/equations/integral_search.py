"""First integrals of degree one and two in the momenta by exact linear algebra (notation.md, section 7).

The derivatives F_j' of an :mod:`ansatz <.ansatz>` depend on each other, sum_j c_j F_j' = 0 with constant c, exactly for
the integrals sum_j c_j F_j. Floats at random states tell which F take part, and which integrals are new; the c,
formulas in the parameters, come from :mod:`.dependencies`; I' is then shown to be the zero formula. What floats
overlook is not found; nothing is claimed that is none.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from substructures.analysis.equations.ansatz import OUTPUTS, Ansatz, Column, in_momenta, in_velocities
from substructures.analysis.equations.energy import depends_on
from substructures.analysis.equations.exact_constants import exact_constants
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.equations.generators import STATES, Generators
from substructures.analysis.equations.integral import Integral, IntegralKind
from substructures.analysis.equations.symmetries import Direction
from substructures.array import Array
from substructures.errors import TooLarge
from substructures.expr.calculus.corners import corners
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret
from substructures.expr.program import array, program
from substructures.expr.walk import transfer
from substructures.printers import entries

#: coordinates and operations of models that are searched, and coordinates where products of harmonics are tried
MOST, LIMIT, WAVES = 6, 3_000, 3
NEEDED = ["metric", "christoffel", "forces", "potential_energy"]
#: symmetries in words
MODES = "inertia and stiffness have principal directions in common: a combination of the energies of single modes"
HIDDEN = "a change of the motion that depends on the velocities leaves the action as it is (a hidden symmetry)"
BOOST = "the same motion seen from one that moves uniformly beside it is a motion, too (Galilei)"
IMPULSE = "the force on this combination of momenta is the rate of a function of coordinates and time"
GAUGE = "moved by the coefficients of the momenta, the Lagrangian changes by the rate of a function alone"
#: terms of an integral whose coefficients are solved for exactly
SUPPORT = 30
#: a column that is a combination of others to so much is one; and what a coefficient that is not zero has at least
FREE, SMALL = 1e-9, 1e-7


def not_searched(f: ModelFormulas) -> str | None:
    """Why a model is not searched."""
    if f.model.balls:
        return "rates of ball and floating joints are no derivatives of coordinates"
    if f.multipliers or f.model.given:
        held = "the model has velocity constraints" if f.model.velocity_constraints else "the model has closures"
        return held if f.multipliers else "motions are given"
    if f.n > MOST:
        return f"{f.n} coordinates; the limit is {MOST}"
    size = len(f.model.program.select(NEEDED))
    if size > LIMIT:
        return f"{size:,} operations; the limit is {LIMIT:,}"
    return "a formula has corners (|x|, sign x)" if corners([f.power, *f.vector("forces")]) else None


class IntegralSearch:
    """``told``: among which functions integrals were looked for. ``known``: those that are, new ones with them."""

    def __init__(self, f: ModelFormulas, known: Generators, vanishes: Callable[[Expr], bool]) -> None:
        self.f, self.known, self.vanishes = f, known, vanishes
        self.told = ""
        self.numbers: Counter[str] = Counter()

    def found(self, degree: int) -> list[tuple[Integral, Expr]]:
        """New integrals up to a degree in the momenta, with their formulas."""
        told = list[str]()
        result = list[tuple[Integral, Expr]]()
        for ansatz in _ansaetze(self.f, degree):
            told.append(f"{len(ansatz.columns)} terms, {ansatz.told}")
            left = 0
            for columns in _candidates(ansatz, self.known):
                more = self._proven(ansatz, columns)
                left += more is None
                result += more or []
            told += [f"not told are {left} that were not proven, or are too large to be written"] if left else []
        self.told = "; ".join(told)
        return result

    def _proven(self, ansatz: Ansatz, columns: Sequence[Column]) -> list[tuple[Integral, Expr]] | None:
        """One of these columns, none where it is known; None where none is proven."""
        direction = exact_constants(ansatz, columns) if len(columns) <= SUPPORT else None
        if direction is None:
            return None
        at = ansatz.at()
        value = direction.of([c.value(at["phi"], at["w"]) for c in columns], self.f.graph)
        if not self.known.is_new(value):
            return []
        # I' along the equations of motion is the zero formula
        if not self.vanishes(direction.of([c.rate(at) for c in columns], self.f.graph)):
            return None
        kind: IntegralKind = "quadratic" if max(len(c.factors) for c in columns) == 2 else "linear"
        try:
            found = _integral(ansatz, columns, direction, kind, self.numbers[kind] + 1)
        except TooLarge:
            return None
        self.known.add(value)
        self.numbers[kind] += 1
        return [(found, value)]


def _ansaetze(f: ModelFormulas, degree: int) -> Iterator[Ansatz]:
    yield in_momenta(f, degree)
    more = in_velocities(f) if degree > 1 and "R" in f.model.joints and f.n <= WAVES else None
    if more is not None:
        yield more


def _candidates(ansatz: Ansatz, known: Generators) -> list[list[Column]]:
    """Columns of the integrals that are new, as floats tell: each with those that it depends on. None are found where
    formulas have no value at some of the states.
    """
    with np.errstate(all="ignore"):
        at = interpret(ansatz.program(), dict(known.values()), list(OUTPUTS))
    rows = {name: list(np.broadcast_to(x, (STATES, x.shape[-1])).T) for name, x in at.items()}
    values = np.stack([column.value(rows["phi"], rows["w"]) for column in ansatz.columns], axis=1)
    rates = np.stack([column.rate(rows) for column in ansatz.columns], axis=1)
    if not (np.isfinite(values).all() and np.isfinite(rates).all()):
        return []
    found, trial = [], known.copy()
    # of functions that depend on each other, as products of harmonics do, the first ones
    some = 2 * len(ansatz.columns) + 50
    own = np.delete(np.arange(len(ansatz.columns)), [support[-1] for support, _ in _dependent(values[:some])])
    for support, c in _dependent(rates[:some, own]):
        value = values[:, own[support]] @ c
        if trial.are_new(value):
            trial.add_values(value)
            found.append([ansatz.columns[j] for j in own[support]])
    return found


def _dependent(D: Array) -> Iterator[tuple[list[int], Array]]:
    """Every column that is a combination of those before it: all that take part, it as the last, and coefficients."""
    sizes = np.linalg.norm(D, axis=0)
    sizes[sizes == 0] = 1
    A = D / sizes
    # A[:, base] = basis R with R upper triangular
    basis, R, base = np.empty(A.shape, order="F"), np.zeros((A.shape[1],) * 2), list[int]()
    for j in range(A.shape[1]):
        some = basis[:, : len(base)]
        along = some.T @ A[:, j]
        left = A[:, j] - some @ along
        more = some.T @ left
        left, along = left - some @ more, along + more
        size = float(np.linalg.norm(left))
        if size > FREE:
            basis[:, len(base)], R[: len(base), len(base)], R[len(base), len(base)] = left / size, along, size
            base.append(j)
            continue
        c = np.linalg.solve(R[: len(base), : len(base)], along)
        used = [k for k, x in enumerate(c) if abs(x) > SMALL * max(1.0, float(np.abs(c).max(initial=0)))]
        support = [*(base[k] for k in used), j]
        yield support, np.array([*(-c[used]), 1.0]) / sizes[support]


def _integral(ansatz: Ansatz, columns: Sequence[Column], found: Direction, kind: IntegralKind, number: int) -> Integral:
    """What is said about it: terms, and the symmetry in words."""
    f = ansatz.f
    c = transfer(list(found.components.values()), f.graph, {})
    used = [columns[j] for j in found.components]
    pairs = [(each, x * ansatz.functions[each.phi]) for each, x in zip(used, c, strict=True)]
    shown = program(f.graph, {"c": array((len(pairs),), lambda k: pairs[k][1])}, f.symbols)
    texts = {entry["index"][0]: str(entry["formula"]) for entry in entries(shown, "c", "text")}
    terms = [(texts.get(k, "0"), tuple(ansatz.names[a] for a in each.factors)) for k, each in enumerate(used)]
    moving = [ansatz.functions[each.phi] for each in used if each.factors]
    plain = all(x is f.graph.one for x in moving)
    if kind == "quadratic":
        reason = MODES if plain else HIDDEN
    else:
        reason = BOOST if depends_on(moving, {"t"}) else IMPULSE if plain else GAUGE
    # of one momentum with a number before it; what else has units of its own
    single = [(each, x) for each, x in pairs if each.factors]
    is_momentum = kind == "linear" and len(single) == 1 and single[0][1].is_number
    joint = f.model.joints[single[0][0].factors[0]] if is_momentum else ""
    unit = {"R": "N m s", "P": "N s", "": ""}[joint]
    return Integral(f"{kind}.{number}", kind, "constant", unit, reason, terms=tuple(terms))
