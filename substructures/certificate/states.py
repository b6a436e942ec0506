"""The states at which stored formulas are compared with their documents: exact rational numbers by name.

Two analytic functions that differ anywhere differ at almost all states (of polynomials in what is drawn and its sines
and cosines: at all but a share of about degree / 2^30; Schwartz 1980, Zippel 1979). So one random state decides where
neither the stored operations nor the documents have anything else. A root, an absolute value or an end stop is another
function on each of its sides; then formulas are compared at two states, in which signs are opposite.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from flint import ctx, fmpq

from substructures.certificate.numbers import Plain
from substructures.expr.direct import BALL_FUNCTIONS
from substructures.expr.operations import Operation
from substructures.expr.steps import MEASURES

State = dict[str, Any]
#: what is positive in the first state; everything else has both signs
POSITIVE = frozenset(("parameter", "inertia"))
#: bits of balls of defaults
EXACT = 1100
#: sets of states that do not depend on defaults
WITHOUT_DEFAULTS = 2
#: operations and functions of expressions that are analytic, and one function on all sides of where they have no value
ANALYTIC = frozenset(
    ("int", "rat", "sym", "add", "sub", "mul", "neg", "div", "powi", "sin", "cos", "tan", "atan", "exp")
)
_BRANCHING = ("sqrt", *(f"{name}(" for name in (*BALL_FUNCTIONS, *MEASURES) if name not in ANALYTIC))
#: what may be given of a joint, and types of loads, in which no more happens (axes are constant)
_ROW = ("type", "coordinate", "psi", "theta", "d", "sigma", "phi", "tau", "placement", "axis")
_JOINT = {*_ROW, "stiffness", "rest", "damping", "armature", "limits"}
_LOADS = {"force", "torque", "joint", "potential", "bushing"}
#: what is in no formula: words, and defaults, which are numbers
_ASIDE = {"name", "title", "description", "tags", "license", "source", "poses", "left_out", "parameters", "inputs"}


def states_needed(operations: Sequence[Operation], documents: Iterable[Plain]) -> int:
    """At how many states a program has to be compared with its documents: 1, or 2 where one of them has branches."""
    others = [operation for operation in operations if operation[0] not in ANALYTIC]
    # roots and arcs of numbers are numbers
    branches = any(operations[k][0] not in ("int", "rat") for operation in others for k in operation[1:])
    return 2 if branches or any(map(_has_branches, documents)) else 1


def states_between(*programs: Sequence[Operation]) -> int:
    """At how many states programs have to be compared with each other."""
    return max(states_needed(operations, ()) for operations in programs)


def _has_branches(document: Plain) -> bool:
    """Whether a definition or tree has anything that is not analytic, or is not known to be."""
    return (
        any(not body["joint"].keys() <= _JOINT for body in document.get("bodies", ()))
        or any(load["type"] not in _LOADS for load in document.get("loads", ()))
        or any(name in text for text in _texts(_in_formulas(document)) for name in _BRANCHING)
    )


def _in_formulas(document: Plain) -> Plain:
    """What formulas may depend on; definitions that instances bring along are documents of their own."""
    found = {name: x for name, x in document.items() if name not in _ASIDE}
    if "instances" in document:
        rows = [{name: x for name, x in each.items() if name != "definition"} for each in document["instances"]]
        found["instances"] = rows
    return found


def _texts(document: Plain) -> Iterator[str]:
    stack: list[Any] = [document]
    while stack:
        given = stack.pop()
        if isinstance(given, str):
            yield given
        elif isinstance(given, Mapping):
            stack += given.values()
        elif isinstance(given, (list, tuple)):
            stack += given


def draws(kinds: Mapping[str, str], defaults: Mapping[str, Any], count: int) -> Iterator[list[State]]:
    """Sets of states, one after the other while elements are left that are not finite; ``kinds``: of all symbols.

    Everything is of the order of one, every other state with some negative parameters; then all of these are positive;
    then :data:`WITHOUT_DEFAULTS` sets are over, and parameters have their ``defaults`` (balls), or are positive; then
    coordinates, velocities and inputs are small, too; coordinates that have a default are about it then. ``count``: of
    a set (:func:`states_needed`).
    """
    source = random.Random(0)  # noqa: S311 -- the same states for everybody
    yield _signed(source, kinds, {}, 1, count, True)
    yield _signed(random.Random(1), kinds, {}, 1, count)  # noqa: S311 -- likewise
    yield _signed(source, kinds, defaults, 1, count)
    yield _signed(source, kinds, defaults, 16, count)


def _signed(
    source: random.Random,
    kinds: Mapping[str, str],
    defaults: Mapping[str, Any],
    smaller: int,
    count: int,
    negative: bool = False,
) -> list[State]:
    states: list[State] = [{} for _ in range(count)]
    # a default is as exact in a state as it is
    with ctx.workprec(EXACT):
        for name in sorted(kinds):
            sign = source.choice((-1, 1))
            for k, state in enumerate(states):
                size = fmpq(2**29 + source.getrandbits(30), 2**30)
                if kinds[name] in POSITIVE:
                    # a length may be negative: in every other state some are
                    is_negative = negative and k % 2 and kinds[name] == "parameter" and sign < 0
                    state[name] = defaults.get(name, -size if is_negative else size)
                else:
                    # every sign in one of two states
                    state[name] = sign * (-1) ** k * size / smaller + defaults.get(name, 0)
    return states
