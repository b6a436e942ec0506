"""How large the terms of a formula are: shares of an element of the metric over states within the limits of joints.

The share of a term t_k at a state is |t_k| / sum_j |t_j| over all terms of the element's textbook form; the largest one
over the sampled states is told. What stays below SMALL everywhere may be left out of an estimate.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Program, program
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.numbers.limits import joint_limits
from substructures.textbook import Reading, Sum, Term
from substructures.textbook.forms import to_expr
from substructures.tree.model import Model

#: a share that is called small, states that are sampled, and the range of slides without limits [m]
SMALL, STATES, SLIDE = 0.02, 400, 1.0
SEED = 1
#: states that one result is the largest over, and values of parameters times operations up to which it is looked for
FEW_STATES, MOST_WORK = 32, 400_000
#: errors of the kinetic energy and of forces that are allowed, and a force beside the largest of all that is rounding
ALLOWED, ROUNDING = 0.01, 1e-12


@dataclass(frozen=True)
class TermSize:
    """A term with its largest share over the states."""

    term: Term
    share: float

    @property
    def is_small(self) -> bool:
        """Whether it is below SMALL in all states."""
        return self.share < SMALL


@dataclass(frozen=True)
class ElementSizes:
    """The terms of one element, the largest first."""

    index: tuple[int, ...]
    terms: tuple[TermSize, ...]


def sampled(model: Model) -> tuple[Array, dict[str, list[float]]]:
    """Positions (STATES, n), uniform in the limits of the joints, and the range of every coordinate [rad, m]."""
    limits, ranges = joint_limits(model), {}
    for a, (name, kind) in enumerate(zip(model.coordinates, model.joints, strict=True)):
        low, high = float(limits.low[a]), float(limits.high[a])
        far = np.pi if kind == "R" else SLIDE
        low = low if np.isfinite(low) else (min(-far, high - far) if np.isfinite(high) else -far)
        high = high if np.isfinite(high) else max(far, low + far)
        ranges[name] = [low, high]
    bounds = np.array(list(ranges.values())).reshape(-1, 2)
    q = np.random.default_rng(SEED).uniform(bounds[:, 0], bounds[:, 1], (STATES, model.dof))
    return q, ranges


def missing_values(model: Model, used: Program) -> list[str]:
    """Parameters without a default that a program depends on."""
    known = default_numbers(model.parameters)
    return [s.name for s in used.symbols if s.kind == "parameter" and s.name not in known]


def element_sizes(model: Model, shown: Program, called: Sequence[str], reading: Reading) -> list[ElementSizes]:
    """Of every element of the metric with several terms. ``shown``: its program, of which the ``reading`` is, whose
    symbols are called otherwise; ``called``: their names in the model, in the order of its symbols.
    """
    output, forms = shown.outputs["metric"], reading.outputs["metric"]
    several = [(i, f) for i, f in zip(output.index, forms, strict=True) if len(f.terms) > 1]
    values = _values(model, shown, called, reading, [f for _, f in several])
    found = []
    for k, (index, form) in enumerate(several):
        x = np.abs(np.broadcast_to(values[f"e{k}"], (STATES, len(form.terms))))
        whole = x.sum(axis=1, keepdims=True)
        shares = np.divide(x, whole, out=np.zeros_like(x), where=whole > 0).max(axis=0)
        terms = [TermSize(term, float(share)) for term, share in zip(form.terms, shares, strict=True)]
        found.append(ElementSizes(index, tuple(sorted(terms, key=lambda each: -each.share))))
    return found


def _values(
    model: Model, shown: Program, called: Sequence[str], reading: Reading, forms: Sequence[Sum]
) -> dict[str, Any]:
    """Every term of every form at the sampled states."""
    graph = Graph()
    moved = reading.atoms_in(graph)
    outputs = {
        f"e{k}": Formulas(
            (len(form.terms),), {(i,): to_expr(Sum((term,)), graph, moved) for i, term in enumerate(form.terms)}
        )
        for k, form in enumerate(forms)
    }
    terms = program(graph, outputs, {s.name: s for s in shown.symbols})
    q, _ = sampled(model)
    known: dict[str, Any] = dict(default_numbers(model.parameters))
    known |= {name: q[:, a] for a, name in enumerate(model.coordinates)}
    names = {s.name: name for s, name in zip(shown.symbols, called, strict=True)}
    with np.errstate(all="ignore"):
        return interpret(terms, {s.name: known[names[s.name]] for s in terms.symbols})


def shares(g: Array, others: Array, Q: Array, forces: Array) -> Array:
    """(K, 2): how wrong kinetic energy and forces are with metrics ``others`` (K, S, n, n) for g (S, n, n) and
    ``forces`` (K, S, n) for Q (S, n), the larger ones over all states S: |T' - T| <= e T with e the largest
    |eigenvalue| of g^-1 (g' - g), forces beside the largest |Q_a| of the same coordinate.
    Raises LinAlgError where g is not positive definite.
    """
    # the eigenvalues of g^-1 dg are those of L^-1 dg L^-T, g = L L^T
    inverse = np.linalg.inv(np.linalg.cholesky(g))
    changes = inverse @ (others - g) @ inverse.transpose(0, 2, 1)
    there = np.asarray(np.isfinite(changes).all(axis=(1, 2, 3)) & np.isfinite(forces).all(axis=(1, 2)))
    energy = np.abs(np.linalg.eigvalsh(np.where(np.isfinite(changes), changes, 0))).max(axis=(1, 2))
    largest, wrong = np.abs(Q).max(axis=0), np.abs(forces - Q).max(axis=1)
    # a force that is none but for rounding of its terms is none
    wrong = np.where(wrong <= ROUNDING * largest.max(initial=0), 0.0, wrong)
    parts = np.divide(wrong, largest, out=np.where(wrong > 0, np.inf, 0.0), where=largest > 0)
    return np.where(there[:, None], np.stack([energy, parts.max(axis=1)], axis=1), np.inf)
