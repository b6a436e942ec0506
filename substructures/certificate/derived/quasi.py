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

    def held(self, m: ModelAt) -> list[list[Ball]]:
        """(B, b) at a state."""
        return [[*self._row(label, m), b] for label, b in zip(self.rows, self._rests(m), strict=True)]

    def __call__(self, m: ModelAt) -> Outputs:
        """All outputs at a state."""
        n, p = m.n, len(self.velocities)
        v, dv = ([m.values[f"{name}{prime}"] for name in self.velocities] for prime in ("", "'"))
        B = [self._row(label, m) for label in self.rows]
        # Y q' = (v, -b), Y^-1 = [T S]
        rows = [*(self._linear(text, m) for text in self.velocities.values()), *B]
        Y = arb_mat(n, n, [x for row in rows for x in row])
        T, S = _inverse(Y, p)
        b, result = self._rests(m), Outputs()
        rates = [x - y for x, y in zip(times(T, v), times(S, b), strict=True)]
        here = m.at({f"{q}'": x for q, x in zip(m.coordinates, rates, strict=True)})
        # the stored T and q' are compared with these, so that their changes are those of T and of q' at fixed v
        served = ModelAt(self.program, m.coordinates, m.values)

        def turned(direction: Sequence[Ball]) -> Matrix:
            """dT in a direction of the coordinates."""
            return served.along(dict(zip(m.coordinates, direction, strict=True))).matrix("T")

        g, Q = here.matrix("metric"), here.vector("forces")
        turning = served.along(m.time() | dict(zip(m.coordinates, rates, strict=True))).vector("rates")
        inertial = [x + y for x, y in zip(times(g, turning), here.vector("bias"), strict=True)]
        missing = [x + y - f for x, y, f in zip(times(g, times(T, dv)), inertial, Q, strict=True)]
        columns_of(result, "constraints", n - p, [[row[a] for row in B] for a in range(n)])
        columns_of(result, "T", n, [[T[a, i] for a in range(n)] for i in range(p)])
        vector_of(result, "rates", rates)
        symmetric_of(result, "metric", T.transpose() * g * T)
        bias = times(T.transpose(), inertial)
        # both forms are those of g* v' + bias = forces; with given motions there is one
        for name in {"bias", "hamel_bias"} & {*self.program.outputs}:
            vector_of(result, name, bias)
        vector_of(result, "forces", times(T.transpose(), Q))
        _structure(result, Y, [turned([T[a, i] for a in range(n)]) for i in range(p)])
        multipliers = times(S.transpose(), missing)
        vector_of(result, "multipliers", multipliers)
        _energies(result, here, rates)
        _work_of_constraints(result, self.program, b, multipliers)
        if self.gaps:
            vector_of(result, "gaps", [self._gap(label, m) for label in self.gaps])
        return result

    def _linear(self, text: str, m: ModelAt) -> list[Ball]:
        """The coefficients of the velocities."""
        return [slope(text, m.values, f"{q}'") for q in m.coordinates]

    def _rests(self, m: ModelAt) -> list[Ball]:
        """b of every row: the expression where nothing moves."""
        still = Numbers({**m.values, **{f"{q}'": arb(0) for q in m.coordinates}})
        given = [(label, self._given(label)) for label in self.rows]
        return [still.read(x["expression"]) if "expression" in x else self._moved(label, x, m) for label, x in given]

    def _moved(self, label: str, given: Plain, m: ModelAt) -> Ball:
        """What given motions make of a row where the coordinates rest."""
        outputs = m.program.outputs
        if "frame" not in given:
            rate = m.elements("closure.rate") if "closure.rate" in outputs else {}
            return rate.get((self.closed.index(label),), arb(0))
        if "U_0" not in outputs:
            return arb(0)
        k, zero = self.frames.index(given["frame"]), arb(0)
        found = m.elements("U_0"), m.elements("Omega_0")
        u, w = (vector(*(each.get((k, i), zero) for i in range(3))) for each in found)
        if "radius" not in given:
            return u[1, 0]
        R = self._kinematics(given["frame"], m)[0]
        plane, rho = self._contact(given, R, m)
        return (plane.transpose() * R * (u + cross(w, rho)))[ROLLING[label.rpartition(".")[2]], 0]

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
    """T, of given motions T_2 - T_0, V, and the power that is lost: Q.q' + V' - d_t T."""
    own = total(p * v for p, v in zip(times(here.matrix("metric"), rates), rates, strict=True))
    result.scalar("kinetic_energy", (own - here.drives_alone()) / 2)
    result.scalar("potential_energy", here.scalar("potential_energy"))
    moved = here.along({"t": arb(1)} | dict(zip(here.coordinates, rates, strict=True)))
    power = total(f * x for f, x in zip(here.vector("forces"), rates, strict=True))
    given = here.kinetic_change({"t": arb(1)}) if "g_00" in here.program.outputs else arb(0)
    result.scalar("lost_power", power + moved.scalar("potential_energy") - given)


def _work_of_constraints(result: Outputs, program: Stored, b: Sequence[Ball], multipliers: Sequence[Ball]) -> None:
    """b and -lambda_k b_k, where they are served: a b that is left out shows in q'."""
    if "given" in program.outputs:
        vector_of(result, "given", b)
        result.scalar("constraint_power", -total(x * y for x, y in zip(multipliers, b, strict=True)))


def _columns(matrix: Matrix, some: Sequence[int]) -> Matrix:
    n: Any = matrix.nrows()
    return arb_mat(n, len(some), [matrix[a, i] for a in range(n) for i in some])
