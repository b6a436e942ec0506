"""Rates of trees that turn as a whole about an axis of the world, while bodies of ball joints spin and wheels turn.

Where the angular momentum L_a v^a about the axis is constant, g = M^-1 L are the rates of turning about it alone (E.
Noether), and where a rate c is cyclic its body is the same turned in itself. With Omega and sigma_c constant

    v = Omega g + sigma_c e_c        v_c = Omega g_c + sigma_c        v' = -S v,  S = sigma_c e_c x  in the joint of c

as the axis turns the other way in the axes of a body that spins.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from substructures.analysis.equations.integral import FirstIntegrals
from substructures.array import Array
from substructures.errors import Fault, InvalidArgument, listed
from substructures.tree.model import Model

#: a rate about the axis [rad/s], or any with which a place is kept
Precession = float | Literal["any"] | None
#: integrals about axes of the world
TURN = "angular_momentum."
#: what may vary beside parameters and cyclic rates
TURNING = ("precession", *(f"{TURN}{axis}" for axis in "xyz"))


@dataclass(frozen=True)
class Turning:
    """What is given: ``rates`` or ``momenta`` (``field``) of ``cyclic`` ones by their numbers, and of the turning about
    an ``axis`` of the world, if there is one, as the last of the ``wanted`` (k or k + 1,).
    """

    model: Model
    field: Literal["rates", "momenta"]
    cyclic: tuple[int, ...]
    axis: int | None
    wanted: Array

    @cached_property
    def blocks(self) -> dict[int, tuple[int, list[list[int]]]]:
        """Of cyclic rates of ball joints the number of their axis, and the rates of the joint in threes."""
        places = {name: a for a, name in enumerate(self.model.coordinates)}
        found: dict[int, tuple[int, list[list[int]]]] = {}
        for ball in self.model.balls:
            joint = [places[name] for name in ball["velocities"]]
            threes = [joint[k : k + 3] for k in range(0, len(joint), 3)]
            found |= {c: (threes[-1].index(c), threes) for c in self.cyclic if c in threes[-1]}
        return found

    def require_single(self) -> None:
        """Raises InvalidArgument (``/precession``) where a body is the same turned about several axes: no rates are
        constant then in any axes of its own.
        """
        joints = [threes[-1][0] for _, threes in self.blocks.values()]
        if len(joints) > len(set(joints)):
            message = "a body that is the same about several axes of a ball joint has no precession of its own"
            raise InvalidArgument.at("/precession", "not-supported", f"{message}: give 'rates' alone")

    def spin(self, sigma: Array) -> Array:
        """S (n, n) of v' = -S v."""
        S = np.zeros((self.model.dof, self.model.dof))
        for c, (i, threes) in self.blocks.items():
            x, y, z = sigma[self.cyclic.index(c)] * np.eye(3)[i]
            for three in threes:
                S[np.ix_(three, three)] += [[0, -z, y], [z, 0, -x], [-y, x, 0]]
        return S

    def momenta(self, metric: Array, momentum: Array) -> Array:
        """Of rates v, in the order of what is wanted: (k or k + 1, n)."""
        rows = metric[list(self.cyclic)]
        return rows if self.axis is None else np.vstack((rows, momentum[:, self.axis]))

    def motion(self, metric: Array, momentum: Array) -> tuple[Array, Array, Array, float]:
        """v (n,), S (n, n), g (n,) and Omega where g_ab is ``metric`` (n, n) and L_a ``momentum`` (n, 3)."""
        c, n = list(self.cyclic), self.model.dof
        rows = self.momenta(metric, momentum)
        g = np.zeros(n) if self.axis is None else np.linalg.solve(metric, rows[-1])
        # v = rates_c e_c + Omega (g - g_c e_c)
        ways = np.eye(n)[:, c]
        if self.axis is not None:
            ways = np.column_stack((ways, g - ways @ g[c]))
        y = self.wanted
        if self.field == "momenta":
            y = np.asarray(np.linalg.lstsq(rows @ ways, self.wanted)[0], dtype=np.float64)
        turn = 0.0 if self.axis is None else float(y[-1])
        return ways @ y, self.spin(y[: len(c)] - turn * g[c]), g, turn


@dataclass(frozen=True)
class BallRequest:
    """``rates`` or ``momenta`` of cyclic ones by name, 0 of the others, and the ``precession``."""

    rates: Mapping[str, float] | None
    momenta: Mapping[str, float] | None
    precession: Precession
    vary: str | None = None

    @property
    def field(self) -> Literal["rates", "momenta"]:
        """What is given."""
        return "rates" if self.momenta is None else "momenta"

    def beginning(self, vary: str | None, value: float) -> BallRequest:
        """With the first value of what varies: a rate, a momentum or the precession."""
        if vary is None:
            return self
        if vary == "precession":
            return replace(self, precession=value, vary=vary)
        given = {**(self.rates or self.momenta or {}), vary: value}
        one = replace(self, vary=vary)
        return replace(one, rates=given) if self.momenta is None else replace(one, momenta=given)

    def turning(self, model: Model, found: FirstIntegrals) -> Turning:
        """What is given, by numbers. Raises InvalidArgument (``/rates/name``, ``/momenta/name``, ``/precession``)."""
        given, axis = dict(self.rates or self.momenta or {}), _axis(found)
        self._require(found.cyclic, axis, given)
        places = tuple(model.coordinates.index(name) for name in found.cyclic)
        wanted = [given.get(name, 0.0) for name in found.cyclic]
        if self.precession is None and axis not in given:
            return Turning(model, self.field, places, None, np.array(wanted))
        turn = self.precession if isinstance(self.precession, float) else 0.0
        wanted.append(given.get(axis, turn))
        result = Turning(model, self.field, places, "xyz".index(axis[-1]), np.array(wanted))
        result.require_single()
        return result

    def _require(self, cyclic: Sequence[str], axis: str, given: Mapping[str, float]) -> None:
        known = [*cyclic, *([axis] if axis and self.field == "momenta" else [])]
        told = f"is no cyclic rate; there are: {listed(known) or 'none'}"
        places = {x: "/vary" if x == self.vary else f"/{self.field}/{x}" for x in given}
        faults = [Fault(places[x], "not-cyclic", f"'{x[:80]}' {told}") for x in given if x not in known]
        if self.precession is not None and (self.field == "momenta" or not axis):
            why = "the angular momentum is constant about no axis of the world through its origin: hang the tree there"
            message = f"of 'momenta' one is '{axis}': leave it out" if axis else why
            faults.append(Fault("/precession", "not-supported", message))
        if faults:
            raise InvalidArgument(faults)
        if not cyclic and self.precession is None and not given:
            message = "there is no rate that is constant by itself"
            raise InvalidArgument.at(f"/{self.field}", "no-cyclic-coordinate", message)


def _axis(found: FirstIntegrals) -> str:
    """The constant angular momentum about the vertical, else about another axis of the world; empty without any."""
    axes = [i.name for i in found.integrals if i.kind == "angular_momentum" and i.rule == "constant"]
    return f"{TURN}z" if f"{TURN}z" in axes else next(iter(axes), "")
