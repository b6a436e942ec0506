"""Conclusions about parameters: which one moves a result most when it is a tenth less or more than its default."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from substructures.analysis.report.rest import Rest
from substructures.analysis.report.sizes import FEW_STATES, MOST_WORK, sampled
from substructures.analysis.report.statements import MARK, Figure, Names, Statement, in_short, reason_of
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.vibrations import modes
from substructures.array import Array
from substructures.errors import InvalidInput, MissingValue, listed
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.numbers.defaults import default_numbers, input_defaults
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

#: by which part of their default parameters are changed, and changes of a result that count as none
PART, NOTHING = 0.1, 1e-9
#: parameters that are ranked in a sentence
TOLD = 5
#: steps of Newton's method with which a position of rest is followed, and the last one at most [rad, m]
STEPS, CLOSE = 8, 1e-8


@dataclass(frozen=True)
class Varied:
    """Columns (2 p + 1,) of the p parameters: all defaults, then each one less and more by PART of it."""

    names: tuple[str, ...]
    columns: dict[str, Array]

    @classmethod
    def of(cls, model: Model) -> Varied:
        """Of the parameters of metric and forces that have a default that is not zero."""
        used = {s.name for s in model.program.select(["metric", "forces", "potential_energy"]).symbols}
        values = {name: x for name, x in default_numbers(model.parameters).items() if name in used and x}
        columns = {name: np.full(2 * len(values) + 1, x) for name, x in values.items()}
        for k, column in enumerate(columns.values()):
            column[2 * k + 1 : 2 * k + 3] *= (1 - PART, 1 + PART)
        return cls(tuple(values), columns)


@dataclass(frozen=True)
class _Result:
    """A number in words, and its values (2 p + 1,)."""

    code: str
    called: str
    unit: str
    values: Array
    request: str


def influence_statements(model: Model, names: Names, rest: Rest, address: str) -> Iterator[Statement]:
    """By how much parameters move the lowest frequency [Hz] beside the first position of rest, the largest element of
    the metric and the range of the potential energy [J] over states, ranked by the larger change. ``address``: of the
    tree, for requests that tell more.
    """
    varied = Varied.of(model)
    if not model.dof or not varied.names:
        return
    work = len(varied.names) * len(model.program)
    if work > MOST_WORK:
        text = f"Parameters were not ranked: {len(varied.names)} of them times {len(model.program):,} operations"
        yield Statement("parameters", "not-ranked", f"{text}; the limit is {MOST_WORK:,}.")
        return
    try:
        results = [*_frequencies(model, rest, varied), *_over_states(model, varied)]
    except (InvalidInput, MissingValue) as error:
        text = f"Parameters were not ranked: {in_short(reason_of(error), model, names)}."
        yield Statement("parameters", "not-ranked", text)
        return
    for result in results:
        yield from _ranked(result, varied, names, address)


def _ranked(result: _Result, varied: Varied, names: Names, address: str) -> Iterator[Statement]:
    """The parameters by how far they move a result; none where it is zero."""
    base, ends = float(result.values[0]), result.values[1:].reshape(-1, 2)
    if not np.isfinite(base) or not base:
        return
    changes = (ends - base) / base
    lost = [names.get(name, name) for name, x in zip(varied.names, changes, strict=True) if not np.isfinite(x).all()]
    sizes = np.nan_to_num(np.abs(changes)).max(axis=1)
    # equal ones in the order of the parameters
    order = [int(k) for k in np.argsort(-np.round(sizes, 9), kind="stable") if sizes[k] > NOTHING]
    if not order:
        return
    figures, told = [Figure("default", base, result.unit)], []
    for k in order[:TOLD]:
        low, high = (float(x) for x in ends[k])
        figures += [Figure(f"{varied.names[k]} less", low, result.unit)]
        figures += [Figure(f"{varied.names[k]} more", high, result.unit)]
        down, up = (f"{100 * x:+.3g} %" for x in changes[k])
        told.append(f"{names.get(varied.names[k], varied.names[k])} ({down}, {up})")
    others = len(order) - len(told)
    more = f"; {others} more move it less" if others > 0 else ""
    gone = f"; it is not there over the whole range of {listed(lost)}" if lost else ""
    then = f"; then {', '.join(told[1:])}" if told[1:] else ""
    by = f"each parameter alone {100 * PART:g} % less, {100 * PART:g} % more than its default"
    unit = result.unit.replace("*", " ")
    text = f"{result.called}, {base:.4g} {unit}, is moved most by {told[0]}{then}{more}{gone}: {by}."
    request = f"POST {address}/{result.request}" if address else ""
    yield Statement("parameters", result.code, text, figures=tuple(figures), request=request)


def _frequencies(model: Model, rest: Rest, varied: Varied) -> Iterator[_Result]:
    """The lowest frequency beside the first position of rest that is not unstable, which is followed; not of closed
    loops.
    """
    place = next(iter(rest.places), None)
    if place is None or place.verdict in ("unstable", "failed") or model.closures:
        return
    q = np.tile(place.q, (len(next(iter(varied.columns.values()))), 1))
    step = np.full_like(q, np.inf)
    for _ in range(STEPS):
        at = linearise(model, q, qdd=np.zeros_like(q), parameters=varied.columns)
        if at.status == "failed":
            return
        # K dq = -(g q'' + Gamma q' q' - Q) at q' = q'' = 0; least steps along what no force depends on
        step = -(np.linalg.pinv(at.K, rcond=NOTHING) @ at.residual[:, :, None])[:, :, 0]
        q = q + step
        if np.abs(step).max() <= CLOSE:
            break
    lowest = [
        min((mode.hertz for mode in modes(M, D, K) if mode.hertz), default=np.nan)
        for M, D, K in zip(at.M, at.D, at.K, strict=True)
    ]
    values = np.where(np.abs(step).max(axis=1) <= CLOSE, lowest, np.nan)
    yield _Result(
        "lowest-frequency", "The lowest frequency beside the first position of rest", "Hz", values, "root-loci"
    )


def _over_states(model: Model, varied: Varied) -> Iterator[_Result]:
    """The largest diagonal element of the metric, and the range of the potential energy, over the same states."""
    count = len(next(iter(varied.columns.values())))
    states = read_states(model, {"q": np.tile(sampled(model)[0][:FEW_STATES], (count, 1))}, None)
    given = {"t": 0.0, "parameters": {}, "inputs": input_defaults(model.inputs)}
    quantities = ["metric", "potential_energy"]
    values = symbol_values(model, given, states, quantities)
    values |= {name: np.repeat(column, FEW_STATES) for name, column in varied.columns.items()}
    found = interpret_in_blocks(model.program, values, quantities, count * FEW_STATES)
    g = found["metric"].reshape(count, FEW_STATES, model.dof, model.dof)
    diagonal = np.einsum("ksaa->ksa", g).max(axis=1)
    a = int(diagonal[0].argmax())
    unit, over = "kg*m^2" if model.joints[a] == "R" else "kg", f"over {FEW_STATES} random states"
    element = f"The largest value of {MARK}g[{a + 1},{a + 1}]{MARK} {over}"
    yield _Result("largest-element", element, unit, diagonal[:, a], "evaluations")
    V = found["potential_energy"].reshape(count, FEW_STATES)
    yield _Result("potential-range", f"The range of the potential energy {over}", "J", np.ptp(V, axis=1), "evaluations")
