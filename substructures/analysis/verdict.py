"""Verdicts on what was integrated or optimised: checks of necessary conditions, and what they say together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from substructures.array import Array

Rule = Literal["constant", "falling", "zero", "accurate"]
#: of a check: name, rule, reason, unit
About = tuple[str, Rule, str, str]


@dataclass(frozen=True)
class Check:
    """A necessary condition of a right result.

    ``rule``: the quantity ``name`` is constant (first integral), never rises (energy with dissipation), is zero (a
    residual of closures, a derivative at an optimum) or accurate (a second computation, which ``reason`` describes,
    finds the same). ``worst``: the largest violation at all steps and all results, in ``unit``: of a constant the
    largest difference of two of its values, of what falls the largest rise, of what is accurate the difference of the
    two computations, which is the stated error. Relative to ``scale`` it is judged against ``limit``, and what rounding
    may add (next to singular positions of closures up to a hundred limits). ``time``: when the limit was first exceeded
    [s], None where the condition holds.

    ``made``: False of a check that was left out, whose ``reason`` says why; ``needed``: without it nobody knows.
    """

    name: str
    rule: Rule
    reason: str
    unit: str
    worst: float
    scale: float
    limit: float
    time: float | None = None
    made: bool = True
    needed: bool = True

    @classmethod
    def of(
        cls,
        about: About,
        violation: Array,
        t: Array,
        scale: float,
        limit: float,
        noise: Array | float = 0,
    ) -> Check:
        """``violation`` (K,): allowed up to limit * scale + noise (K,)."""
        # |violation| <= limit * scale + noise; not a number is a violation, too
        size = np.abs(violation)
        bad = np.flatnonzero(~(size <= limit * scale + noise))
        first = float(t[bad[0]]) if len(bad) else None
        return cls(*about, float(np.fmax.reduce(size, initial=0.0)), scale, limit, first)

    @classmethod
    def at(cls, about: About, violation: float, t: float, scale: float = 1.0, limit: float = 0.0) -> Check:
        """A condition on one number that belongs to the time ``t``."""
        return cls.of(about, np.array([violation]), np.array([t]), scale, limit)

    @classmethod
    def left_out(cls, name: str, rule: Rule, reason: str, needed: bool = False) -> Check:
        """A check that was not made, and why."""
        return cls(name, rule, reason, "", np.nan, np.nan, np.nan, None, False, needed)

    @property
    def holds(self) -> bool | None:
        """Whether the condition holds everywhere; None where the check was not made."""
        return self.time is None if self.made else None

    @property
    def relative(self) -> float:
        """The largest violation over its scale."""
        return self.worst / self.scale if self.scale else self.worst

    def summary(self) -> dict[str, Any]:
        """Plain data; ``holds`` is null, and so are all numbers, of a check that was not made."""
        names = ("name", "rule", "reason", "unit", "worst", "scale", "limit", "time", "relative", "holds")
        values = {name: getattr(self, name) for name in names}
        return {name: None if x != x else x for name, x in values.items()}


def verdict(checks: Iterable[Check], finished: bool = True) -> bool | None:
    """False where a check is violated; True where all that are needed were made, at least one, and hold; else None.

    ``finished``: whether the computation came to its end; what did not is neither right nor wrong: None.
    """
    found = [check for check in checks if check.made or check.needed]
    if not finished or not found:
        return None
    if any(check.holds is False for check in found):
        return False
    return True if all(check.made for check in found) else None
