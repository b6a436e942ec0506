"""Conclusions about what may be left out: parameters of inertia that may be zero, and how wrong T and Q_a are then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from substructures.analysis.report.sizes import ALLOWED, FEW_STATES, MOST_WORK, SEED, sampled, shares
from substructures.analysis.report.statements import Figure, Names, Statement, in_short, reason_of
from substructures.array import Array
from substructures.errors import InvalidInput, MissingValue, listed
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.numbers.defaults import default_numbers, input_defaults
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

QUANTITIES = ("metric", "forces")


@dataclass(frozen=True)
class _Sampled:
    """Metric (S, n, n) and forces (S, n) of a model over the same states for each of several sets of values."""

    model: Model
    names: tuple[str, ...]

    def errors(self, sets: Sequence[Sequence[str]]) -> Array:
        """(len(sets), 2): how wrong kinetic energy and forces are where the parameters of a set are zero.

        |T' - T| <= e T for all rates, e the largest |eigenvalue| of g^-1 (g' - g); forces beside the largest |Q_a| of
        the same coordinate. Raises LinAlgError where the metric is not positive definite.
        """
        count, n = len(sets) + 1, self.model.dof
        q = sampled(self.model)[0][:FEW_STATES]
        qd = np.random.default_rng(SEED).uniform(-1, 1, q.shape)
        states = read_states(self.model, {"q": np.tile(q, (count, 1)), "qd": np.tile(qd, (count, 1))}, None)
        given = {"t": 0.0, "parameters": {}, "inputs": input_defaults(self.model.inputs)}
        values = symbol_values(self.model, given, states, QUANTITIES)
        for name in self.names:
            column = np.array([1.0, *(name not in some for some in sets)])
            values[name] = np.repeat(column, FEW_STATES) * values[name]
        with np.errstate(all="ignore"):
            found = interpret_in_blocks(self.model.program, values, QUANTITIES, count * FEW_STATES)
        g, Q = found["metric"].reshape(count, FEW_STATES, n, n), found["forces"].reshape(count, FEW_STATES, n)
        return shares(g[0], g[1:], Q[0], Q[1:])


def omission_statements(model: Model, names: Names, address: str) -> Iterator[Statement]:
    """Which parameters of the metric may all be zero together at ALLOWED, those first that change least; and which one
    comes next. ``address``: of the tree, for requests that tell more.
    """
    used = {s.name for s in model.program.select(["metric"]).symbols}
    given = tuple(name for name, x in default_numbers(model.parameters).items() if name in used and x)
    size = len(given) * len(model.program)
    if not model.dof:
        return
    if not given or size > MOST_WORK:
        large = f"{len(given)} parameters of {len(model.program):,} operations; the limit of their product is"
        why = f"{large} {MOST_WORK:,}" if given else "the mass matrix has no parameter with a value"
        text = f"Which parameters may be left out was not looked for: {why}."
        yield Statement("omissions", "not-looked-for", text)
        return
    over = _Sampled(model, given)
    try:
        alone = over.errors([[name] for name in given]).max(axis=1)
        order = [given[int(k)] for k in np.argsort(alone, kind="stable")]
        together = over.errors([order[: k + 1] for k in range(len(order))])
    except (InvalidInput, MissingValue) as error:
        text = f"What may be left out was not looked for: {in_short(reason_of(error), model, names)}."
        yield Statement("omissions", "not-looked-for", text)
        return
    except np.linalg.LinAlgError:
        text = "What may be left out was not looked for: the mass matrix is singular at the default values."
        yield Statement("omissions", "not-looked-for", text)
        return
    yield _told(names, order, together, address)


def _told(names: Names, order: Sequence[str], together: Array, address: str) -> Statement:
    """The longest beginning of the order that may be left out, with its errors."""
    wrong = together.max(axis=1) > ALLOWED
    count = int(wrong.argmax()) if wrong.any() else len(order)
    over = f"over {FEW_STATES} random states in the limits of the joints, at rates up to 1"
    figures = []
    told = f"No parameter of the mass matrix may be zero at {100 * ALLOWED:g} %"
    if count:
        energy, force = (float(x) for x in together[count - 1])
        figures = [Figure("energy_error", energy, "1"), Figure("force_error", force, "1")]
        every = listed((names.get(name, name) for name in order[:count]), len(order))
        told = (
            f"{every} may{' all' if count > 1 else ''} be zero at {100 * ALLOWED:g} %, because no kinetic energy "
            f"changes by more than {100 * energy:.3g} % and no force by more than {100 * force:.3g} % of the largest "
            "one of its coordinate"
        )
    after = ""
    if count < len(order) and np.isfinite(together[count]).all():
        energy, force = (float(x) for x in together[count])
        figures += [Figure("next_energy_error", energy, "1"), Figure("next_force_error", force, "1")]
        name = names.get(order[count], order[count])
        after = f"; with {name} it would be {100 * energy:.3g} % and {100 * force:.3g} %"
    request = f"POST {address}/abbreviations" if address else ""
    code = "may-be-zero" if count else "none"
    return Statement("omissions", code, f"{told}{after}, {over}.", (), (), tuple(figures), request)
