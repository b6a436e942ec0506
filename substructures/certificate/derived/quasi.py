"""What equations in quasi-velocities have to be, from a model's certified program and the texts of the constraints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, arb_mat

from substructures.certificate.derived.model_at import ModelAt, times, total
from substructures.certificate.derived.model_formulas import columns_of, symmetric_of, vector_of
from substructures.certificate.linear import Ball, Matrix, cross, dot, unit, vector, with_third_axis
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.stored import Stored
from substructures.certificate.texts import slope

ROLLING = {"slip_1": 0, "slip_2": 1, "contact": 2}


@dataclass(frozen=True)
class Quasi:
    """An expectation of the ``program``; ``velocities``: texts by name; ``rows``: the constraints in force by label,
    ``gaps``: labels of what is constant; ``constraints``: what was given, by name; ``frames``, ``closed``: frames and
    rows of closures of the model, in order.
    """

    program: Stored
    velocities: Mapping[str, str]
    rows: Sequence[str]
    gaps: Sequence[str]
    constraints: Mapping[str, Plain]
    frames: Sequence[str]
    closed: Sequence[str]

    def __call__(self, m: ModelAt) -> Outputs:
        """All outputs at a state."""
        n, names = m.n, list(self.velocities)
        p = len(names)
        v, dv = ([m.values[f"{name}{prime}"] for name in names] for prime in ("", "'"))
        own = [self._linear(text, m) for text in self.velocities.values()]
        B = [self._row(label, m) for label in self.rows]
        # Y q' = (v, 0), Y^-1 = [T S]
        Y = arb_mat(n, n, [x for row in (*own, *B) for x in row])
        T, S = _inverse(Y, p)
        rates, result = times(T, v), Outputs()
        here = m.at({f"{q}'": x for q, x in zip(m.coordinates, rates, strict=True)})
        # the stored T is compared with this one, so that its changes are those of T
        served = ModelAt(self.program, m.coordinates, m.values)

        def turned(direction: Sequence[Ball]) -> Matrix:
            """dT in a direction of the coordinates."""
            return served.along(dict(zip(m.coordinates, direction, strict=True))).matrix("T")

        g, Q = here.matrix("metric"), here.vector("forces")
        turning = times(turned(rates), v)
        inertial = [x + y for x, y in zip(times(g, turning), here.vector("bias"), strict=True)]
        second = times(T, dv)
        missing = [x + y - f for x, y, f in zip(times(g, second), inertial, Q, strict=True)]
        columns_of(result, "constraints", n - p, [[row[a] for row in B] for a in range(n)])
        columns_of(result, "T", n, [[T[a, i] for a in range(n)] for i in range(p)])
        vector_of(result, "rates", rates)
        symmetric_of(result, "metric", T.transpose() * g * T)
        bias = times(T.transpose(), inertial)
        vector_of(result, "bias", bias)
        # both forms are those of g* v' + bias = forces
        vector_of(result, "hamel_bias", bias)
        vector_of(result, "forces", times(T.transpose(), Q))
        _structure(result, Y, [turned([T[a, i] for a in range(n)]) for i in range(p)])
        vector_of(result, "multipliers", times(S.transpose(), missing))
        _energies(result, here, rates)
        if self.gaps:
            vector_of(result, "gaps", [self._gap(label, m) for label in self.gaps])
        return result

    def _linear(self, text: str, m: ModelAt) -> list[Ball]:
        """The coefficients of the velocities."""
        return [slope(text, m.values, f"{q}'") for q in m.coordinates]

    def _row(self, label: str, m: ModelAt) -> list[Ball]:
        """B of one row."""
        given, row = self._given(label), label.rpartition(".")[2]
        if "expression" in given:
            return self._linear(given["expression"], m)
        if "frame" not in given:
            G, zero = m.elements("closure.jacobian"), arb(0)
            return [G.get((self.closed.index(label), a), zero) for a in range(m.n)]
        R, _, U, Omega = self._kinematics(given["frame"], m)
        if "radius" not in given:
            return [u[1, 0] for u in U]
        plane, rho = self._contact(given, R, m)
        # the velocity of the point of contact in the axes of the plane
        return [(plane.transpose() * R * (u + cross(w, rho)))[ROLLING[row], 0] for u, w in zip(U, Omega, strict=True)]

    def _given(self, label: str) -> Plain:
        """The constraint of a row, ``constraint`` or ``constraint.row``; names of closures of parts have a dot."""
        found: Plain = self.constraints[label if label in self.constraints else label.rpartition(".")[0]]
        return found

    def _gap(self, label: str, m: ModelAt) -> Ball:
        """The residual of a closure; the distance of the contact from a plane through the origin."""
        given = self._given(label)
        if "frame" not in given:
            return m.elements("closure.residual").get((self.closed.index(label),), arb(0))
        R, origin, _, _ = self._kinematics(given["frame"], m)
        plane, rho = self._contact(given, R, m)
        return dot(plane * unit(2), origin + R * rho)

    def _kinematics(self, frame: str, m: ModelAt) -> tuple[Matrix, Matrix, list[Matrix], list[Matrix]]:
        """Rotation to the world, origin, and the columns of U and Omega."""
        k, zero = self.frames.index(frame), arb(0)
        found = {name: m.elements(name) for name in ("rotation", "position", "U", "Omega")}
        R = arb_mat(3, 3, [found["rotation"].get((k, i, j), zero) for i in range(3) for j in range(3)])
        origin = vector(*(found["position"].get((k, i), zero) for i in range(3)))
        U, Omega = (
            [vector(*(found[name].get((k, a, i), zero) for i in range(3))) for a in range(m.n)]
            for name in ("U", "Omega")
        )
        return R, origin, U, Omega

    def _contact(self, given: Plain, R: Matrix, m: ModelAt) -> tuple[Matrix, Matrix]:
        """The axes of the plane, and the point of contact in the axes of the frame."""
        read = Numbers(m.values)
        plane, radius = with_third_axis(read.vector(given["normal"])), read.read(given["radius"])
        # away from the plane, for a disc in its own plane
        down = R.transpose() * plane * unit(2)
        if given["shape"] == "disc":
            down = down - unit(2) * down[2, 0]
            down = down / dot(down, down).sqrt()
        return plane, down * -radius


def _inverse(Y: Matrix, p: int) -> tuple[Matrix, Matrix]:
    """The first p columns of Y^-1 and the others, which are nothing where Y is singular."""
    n: Any = Y.nrows()
    try:
        inverse = Y.inv()
    except ZeroDivisionError:
        inverse = arb_mat(n, n, [arb("nan")] * n * n)
    return _columns(inverse, range(p)), _columns(inverse, range(p, n))


def _structure(result: Outputs, Y: Matrix, along: Sequence[Matrix]) -> None:
    """[X_i, X_j] = c^k_ij X_k; ``along``: dT in the direction of every X."""
    n, p = int(Y.nrows()), len(along)
    structure = result.array("structure", (n, p, p))
    for i in range(p):
        for j in range(p):
            bracket = [along[i][a, j] - along[j][a, i] for a in range(n)]
            structure |= {(k, i, j): x for k, x in enumerate(times(Y, bracket))}


def _energies(result: Outputs, here: ModelAt, rates: Sequence[Ball]) -> None:
    """T, V, and the power that is lost: Q.q' + V'."""
    result.scalar("kinetic_energy", here.kinetic_energy())
    result.scalar("potential_energy", here.scalar("potential_energy"))
    moved = here.along({"t": arb(1)} | dict(zip(here.coordinates, rates, strict=True)))
    power = total(f * x for f, x in zip(here.vector("forces"), rates, strict=True))
    result.scalar("lost_power", power + moved.scalar("potential_energy"))


def _columns(matrix: Matrix, some: Sequence[int]) -> Matrix:
    n: Any = matrix.nrows()
    return arb_mat(n, len(some), [matrix[a, i] for a in range(n) for i in some])
