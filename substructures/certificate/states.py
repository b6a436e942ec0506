"""The states at which stored formulas are compared with their documents: exact rational numbers by name."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from typing import Any

from flint import fmpq

State = dict[str, Any]
#: that every element is compared at
STATES = 2
#: what is positive in the first state; everything else has both signs
POSITIVE = frozenset(("parameter", "inertia"))


def draws(kinds: Mapping[str, str], defaults: Mapping[str, Any]) -> Iterator[list[State]]:
    """Sets of states, one after the other while elements are left that are not finite; ``kinds``: of all symbols.

    Everything is of the order of one; then parameters have their ``defaults`` (balls); then coordinates, velocities and
    inputs are small, too.
    """
    source = random.Random(0)  # noqa: S311 -- the same states for everybody
    yield _signed(source, kinds, {}, 1)
    yield _signed(source, kinds, defaults, 1)
    yield _signed(source, kinds, defaults, 16)


def _signed(source: random.Random, kinds: Mapping[str, str], defaults: Mapping[str, Any], smaller: int) -> list[State]:
    states: list[State] = [{} for _ in range(STATES)]
    for name in sorted(kinds):
        sign = source.choice((-1, 1))
        for k, state in enumerate(states):
            size = fmpq(2**29 + source.getrandbits(30), 2**30)
            if kinds[name] in POSITIVE:
                # a length may be negative: in every other state some are
                is_negative = k % 2 and kinds[name] == "parameter" and sign < 0
                state[name] = defaults.get(name, -size if is_negative else size)
            else:
                # every sign in one of two states
                state[name] = sign * (-1) ** k * size / smaller
    return states
