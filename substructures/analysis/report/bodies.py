"""Conclusions about whole bodies that may be left out: how wrong T and gravity are without their inertia.

With Y(q, q', q'')_a i pi_i (:mod:`substructures.quantities.regressor`) the ten parameters of a body give its share of
the metric, g^k_ab = Y_a(q, 0, e_b) pi - Y_a(q, 0, 0) pi without gravity, and of the forces, Q^k_a = -Y_a(q, 0, 0) pi.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from substructures.analysis.report.sizes import ALLOWED, FEW_STATES, MOST_WORK, sampled, shares
from substructures.analysis.report.statements import Figure, Names, Statement, in_short, reason_of
from substructures.array import Array
from substructures.errors import InvalidInput, MissingValue, listed
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.regressor_model import RegressorModel
from substructures.tree.model import Model


@dataclass(frozen=True)
class _Shares:
    """Metric g (S, n, n) and forces Q (S, n) of the tree, and those of every link (L, S, n, n), (L, S, n)."""

    g: Array
    Q: Array
    metrics: Array
    forces: Array

    def errors(self, sets: Sequence[Sequence[int]]) -> Array:
        """(len(sets), 2): how wrong T and Q_a are without the links of a set."""
        dg = np.array([-self.metrics[list(some)].sum(axis=0) for some in sets])
        dQ = np.array([-self.forces[list(some)].sum(axis=0) for some in sets])
        return shares(self.g, self.g + dg, self.Q, self.Q + dQ)


def body_statements(model: Model, names: Names, Y: RegressorModel | None, address: str) -> Iterator[Statement]:
    """Which bodies may all be left out together at ALLOWED, those first that change least; and which one comes next.
    ``Y``: the regressor of the tree, None where nothing is to be said. ``address``: of the tree.
    """
    if Y is None or not model.dof:
        return
    links, size = [name.removesuffix(".m") for name in Y.names[::10]], len(Y.program) * (model.dof + 1)
    why = ""
    if model.given:
        why = "some motions or momenta are given"
    elif size > MOST_WORK:
        why = f"{size:,} operations; the limit is {MOST_WORK:,}"
    try:
        found = None if why else _shares(model, Y)
        order, together = ([], np.zeros((0, 2))) if found is None else _ordered(found)
    except (InvalidInput, MissingValue) as error:
        why = in_short(reason_of(error), model, names)
    except np.linalg.LinAlgError:
        why = "the mass matrix is singular at the default values"
    if why:
        text = f"Whole bodies that may be left out were not looked for: {why}."
        yield Statement("omissions", "bodies-not-looked-for", text)
        return
    yield _told([links[k] for k in order], together, address)


def _shares(model: Model, Y: RegressorModel) -> _Shares:
    """At FEW_STATES random states."""
    q = sampled(model)[0][:FEW_STATES]
    S, n = q.shape
    # one position, at rest and with every acceleration one
    unit = np.concatenate([np.zeros((1, n)), np.eye(n)])
    found = Y.evaluate(np.repeat(q, n + 1, axis=0), np.zeros((S * (n + 1), n)), np.tile(unit, (S, 1)))
    pi = np.broadcast_to(found["inertial_parameters"], (S * (n + 1), len(Y.names)))
    # (L, S, n + 1, n): forces of inertia and weight of each link
    each = (found["regressor"] * pi[:, None]).reshape(S, n + 1, n, -1, 10).sum(axis=-1).transpose(3, 0, 1, 2)
    metrics = (each[:, :, 1:] - each[:, :, :1]).transpose(0, 1, 3, 2)
    own = evaluate(model, ["metric", "forces"], q, np.zeros_like(q))
    g = np.broadcast_to(own["metric"], (S, n, n))
    return _Shares(g, np.broadcast_to(own["forces"], (S, n)), metrics, -each[:, :, 0])


def _ordered(found: _Shares) -> tuple[list[int], Array]:
    """The links, those first that change least, and the errors without the first k + 1 of them."""
    count = len(found.metrics)
    alone = found.errors([[k] for k in range(count)]).max(axis=1)
    order = [int(k) for k in np.argsort(alone, kind="stable")]
    return order, found.errors([order[: k + 1] for k in range(count)])


def _told(order: Sequence[str], together: Array, address: str) -> Statement:
    """The longest beginning of the order that may be left out, and what comes next."""
    wrong = together.max(axis=1, initial=0) > ALLOWED
    count = int(wrong.argmax()) if wrong.any() else len(order)
    figures = []
    told = f"No body may be left out at {100 * ALLOWED:g} %"
    if count:
        energy, force = (float(x) for x in together[count - 1])
        figures = [Figure("energy_error", energy, "1"), Figure("force_error", force, "1")]
        told = (
            f"The inertia of {listed(order[:count])} may{' all' if count > 1 else ''} be left out at "
            f"{100 * ALLOWED:g} %, because no kinetic energy changes by more than {100 * energy:.3g} % and no force at "
            f"rest by more than {100 * force:.3g} % of the largest one of its coordinate"
        )
    after = ""
    if count < len(order) and np.isfinite(together[count]).all():
        energy, force = (float(x) for x in together[count])
        figures += [Figure("next_energy_error", energy, "1"), Figure("next_force_error", force, "1")]
        also = "also without" if count else "without"
        after = f"; {also} {order[count]} it would be {100 * energy:.3g} % and {100 * force:.3g} %"
    text = f"{told}{after}, over {FEW_STATES} random states in the limits of the joints."
    request = f"GET {address}/inertial_parameters" if address else ""
    return Statement("omissions", "bodies" if count else "no-body", text, (), (), tuple(figures), request)
