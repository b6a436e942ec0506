"""Numbers of a model for one state or many."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from substructures.array import Array
from substructures.certificate.agreement import not_judged_warnings
from substructures.compile.kernel import NO_PLACES, Evaluated, Places, with_elements
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.quantities.accelerations import (
    Evaluator,
    accelerations,
    accelerations_on_closures,
    conditions,
)
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.numbers.asked import Asked, Form, read_arguments
from substructures.quantities.numbers.conditioning import Look, solved_anew
from substructures.quantities.numbers.levels import singular_loops
from substructures.quantities.numbers.reaction_numbers import reaction_numbers
from substructures.quantities.numbers.result import Evaluation, Failure, failures_of, without_axis
from substructures.quantities.numbers.states import (
    ArgumentsByName,
    StateInput,
    States,
    ValueInput,
    require,
)
from substructures.quantities.numbers.warnings import (
    Notice,
    advice,
    doubted,
    result_of,
    state_warnings,
    told_of,
    value_warnings,
)
from substructures.quantities.quantity import (
    CONDITION,
    FORWARD,
    MODEL,
    OUTPUTS,
    REACTIONS,
    TABLE,
)
from substructures.quantities.sources import (
    PARTS,
    Sources,
    steps,
)
from substructures.tree.model import Model


def interpreted(
    program: Program, values: Mapping[str, Any], names: list[str], states: int, places: Places = NO_PLACES, /
) -> dict[str, Array]:
    """The engine that needs nothing: the reference interpreter, in blocks of states."""
    return with_elements(interpret_in_blocks(program, values, names, states), places)


@dataclass(frozen=True)
class EvaluationOptions:
    """What results look like, and what computes them.

    ``along``: the direction of derivatives; ``joints``: rows of ``reactions`` (default: all). ``packed``: of metric and
    Christoffel symbols the independent elements alone (:mod:`substructures.formats.packing`); ``float32``: results in
    single precision. ``limit``: most states; ``evaluator``: what computes outputs of programs; ``first``: the number of
    the first state in warnings, if they are part of more.
    """

    along: Direction | None = None
    joints: Sequence[str] | None = None
    packed: bool = False
    float32: bool = False
    limit: int | None = None
    evaluator: Evaluator = interpreted
    first: int = 0


PLAIN = EvaluationOptions()


def evaluate(
    model: Model | Sources,
    quantities: str | Sequence[str],
    q: StateInput | None,
    qd: StateInput | None = None,
    qdd: StateInput | None = None,
    *,
    inputs: ValueInput | None = None,
    parameters: ValueInput | None = None,
    t: ArrayLike | None = 0.0,
    options: EvaluationOptions = PLAIN,
) -> Evaluation:
    """Numbers of quantities, one name of QUANTITIES or several, for one state or N of a model.

    ``q`` [rad, m], ``qd`` [rad/s, m/s], ``qdd`` [rad/s^2, m/s^2]: (n,), (N, n), or by coordinate name a number or (N,);
    velocities that are not given are zero. ``inputs`` [N m, N], ``parameters`` [SI]: by name a number or (N,); those
    that are not given have their defaults, inputs without one are zero. ``t`` [s]: a number or (N,). The results have
    the axis N first, but for one state with ``q`` (n,). In place of the model its Sources: with its parts, or to keep
    what is derived.

    ``forward_dynamics`` of a model with closures are the accelerations on them, in states that meet them
    (:func:`substructures.mechanics.accelerations.closed_solve`); other quantities are those of the tree without them.

    Raises InvalidArgument (pointers start with the name of the argument or option), MissingValue (a parameter without
    a value), TooLarge, and InvalidDocument for closures where they are not taken.
    States without a finite result are no exceptions but ``failures``; accelerations that rounding changes noticeably,
    as the metric is nearly singular, are ``warnings`` (``condition`` is the number that tells).

    >>> from substructures import couple, derive
    >>> tree = {"name": "clock", "gravity": [0, 0, "-9.81"]}
    >>> tree["instances"] = [{"name": "p", "substructure": "simple-pendulum"}]
    >>> model = couple(tree, {"p": derive("simple-pendulum")})
    >>> evaluate(model, ["metric", "forces"], q=[[0.0], [0.1]])
    Evaluation of 2 state(s) of p.q1
      metric (2, 1, 1), forces (2, 1)
    """
    given: dict[str, Any] = {"q": q, "qd": qd, "qdd": qdd, "inputs": inputs, "parameters": parameters, "t": t}
    given |= {"along": options.along, "joints": options.joints}
    sources = Sources(model) if isinstance(model, Model) else model
    form = Form(options.packed, options.float32)
    asked = read_arguments(sources, quantities, given, form, options.limit, options.evaluator)
    warnings = _told_of_values(asked, asked.states.q, asked.values, options.first)
    return _answered(asked, asked.states, asked.values, warnings)


def evaluate_in_parts(
    sources: Sources,
    quantities: str | Sequence[str],
    given: ArgumentsByName,
    size: int,
    *,
    limit: int | None = None,
    evaluator: Evaluator = interpreted,
    first: int = 0,
    told_first: bool = False,
) -> Iterator[Evaluation]:
    """:func:`evaluate` for so many states after the other, always with the axis N first.

    ``given``: the other arguments by name. All of them are checked, and what is wrong is raised, before the first part
    is asked for. Warnings about the values of a part are told with it, with ``told_first`` those about all states with
    the first one; states in failures, and in warnings about one state, are counted from the beginning of the part.
    """
    form = Form(bool(given.get("packed")), bool(given.get("float32")))
    asked = read_arguments(sources, quantities, given, form, limit, evaluator)
    return _parts(asked, size, first, told_first)


def _parts(asked: Asked, size: int, first: int, told_first: bool) -> Iterator[Evaluation]:
    states, count = asked.states, asked.states.count
    varying = {name for name, x in asked.values.items() if np.shape(x) == (count,)}
    told = _told_of_values(asked, states.q, asked.values, first) if told_first else None
    for start in range(0, max(1, count), size):
        some = slice(start, min(start + size, count))
        values = {name: x[some] if name in varying else x for name, x in asked.values.items()}
        q, qd = (x[some] if len(x) == count else x for x in (states.q, states.qd))
        part = States(q, qd, None, some.stop - start, single=False)
        yield _answered(asked, part, values, _told_of_values(asked, q, values, first + start) if told is None else told)
        told = told and []


def _told_of_values(asked: Asked, q: Array, values: Mapping[str, Any], first: int) -> list[Notice]:
    sources, chosen = asked.sources, {name: values[name] for name in asked.chosen}
    others = {symbol.name for each in sources.derived(asked.names) for symbol in each.program.symbols}
    told = value_warnings(sources, chosen, asked.inputs, q, others, first)
    return [*told, *not_judged_warnings(doubted(sources, asked.names))]


def _answered(
    asked: Asked, states: States, values: Mapping[str, Any], warnings: Iterable[Mapping[str, Any]]
) -> Evaluation:
    """The numbers of some states; ``warnings`` about their values."""
    sources, names, model = asked.sources, asked.names, asked.sources.model
    found = _computed(asked, values, states.count)
    results = {name: result_of(TABLE[name], found[TABLE[name].source]) for name in names}
    told = told_of(names, found, results, _looking(model, values, states.count))
    shown = {name: asked.form.shown(result) for name, result in results.items()}
    failures: tuple[Failure, ...] = ()
    if asked.form.float32 or not _is_finite(names, found):
        failures = failures_of(
            shown,
            lambda name, state: advice(
                name,
                told.get(name, {}).get(state),
                asked.form.is_beyond(results[name], state),
                singular_loops(model),
            ),
        )
    return Evaluation(
        model.coordinates,
        states.count,
        model.program.digest,
        {name: without_axis(value) for name, value in shown.items()} if states.single else shown,
        failures,
        sources.labels(names),
        states.single,
        (*warnings, *state_warnings(results, told, states.single)),
    )


def _is_finite(names: Sequence[str], found: Mapping[str, Mapping[str, Array]]) -> bool:
    """Whether the engine has seen that all results are, and nothing is put in their places for another reason."""
    seen = all(isinstance(outputs, Evaluated) and outputs.finite for outputs in found.values())
    return seen and not any(TABLE[name].pivots for name in names)


def _computed(asked: Asked, values: Mapping[str, Any], count: int) -> dict[str, dict[str, Array]]:
    """Outputs by source."""
    sources, evaluator, model = asked.sources, asked.evaluator, asked.sources.model
    look = _looking(model, values, count)
    found: dict[str, dict[str, Array]] = {}
    for source, program, names in steps(sources, asked.names):
        places = asked.form.places(sources, names) if source in (PARTS, MODEL) else NO_PLACES
        if source == PARTS and sources.numbers is not None:
            found[MODEL] = with_elements(sources.numbers(values, names, count), places)
            continue
        if program is None:
            found[source] = {name: np.full((count, *_shape(name, model.dof)), np.nan) for name in names}
            found[source]["pivots"] = np.zeros((count, model.dof))
            continue
        if source == REACTIONS:
            motion = result_of(TABLE[FORWARD], found[FORWARD]) if FORWARD in found else None
            found[source] = reaction_numbers(model, sources.program, values, motion, evaluator, count)
            continue
        require(program, names, values)
        if source == CONDITION:
            found[source] = {CONDITION: conditions(model, values, evaluator, count)}
        elif source == FORWARD and model.closures:
            found[source] = accelerations_on_closures(model, program, values, evaluator, count)
        elif program is model.program and source == FORWARD:
            found[source] = accelerations(model, values, evaluator, count)
        else:
            # engines that do not know of places are not asked for them
            given = evaluator(program, values, names, count, *((places,) if places else ()))
            found[source] = {**found[source], **given} if source in found else given
            if "inertias" in names:
                found[source] = solved_anew(found[source], source, look)
    return found


def _shape(output: str, n: int) -> tuple[int, ...]:
    """Of an output that has no result in any state, of one axis where it only tells that there is none."""
    return OUTPUTS[output].shape({"coordinates": n}) if output in OUTPUTS else (n,)


def _looking(model: Model, values: Mapping[str, Any], count: int) -> Look:
    """Outputs of the model at some of the states."""

    def look(states: NDArray[np.int64], names: list[str]) -> Mapping[str, Array]:
        """The outputs there."""
        # symbols without a value, which no result depends on, are not numbers
        known = {s.name: np.nan for s in model.program.symbols} | dict(values)
        some = {name: x[states] if np.shape(x) == (count,) else x for name, x in known.items()}
        return interpreted(model.program, some, names, len(states))

    return look
