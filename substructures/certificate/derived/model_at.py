"""The certified program of a model at one state, in balls: what follows from it is computed from these values alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from flint import arb, arb_mat

from substructures.certificate.linear import Ball, Matrix
from substructures.certificate.outputs import images_of
from substructures.certificate.slopes import slopes, tangents
from substructures.certificate.stored import Stored, operations_in_balls

Index = tuple[int, ...]


class ModelAt:
    """Outputs of a model at a state; ``values``: of all symbols. What :meth:`along` returns has changes in their place.

    ``q``, ``rates``, ``second``: the values of coordinates, velocities and accelerations.
    """

    def __init__(
        self,
        program: Stored,
        coordinates: Sequence[str],
        values: Mapping[str, Ball],
        found: Sequence[Ball] | None = None,
    ) -> None:
        self.program, self.coordinates, self.values, self.n = program, coordinates, values, len(coordinates)
        self.found = operations_in_balls(program, values) if found is None else found
        self.q, self.rates, self.second = (
            [values.get(f"{name}{primes}", arb(0)) for name in coordinates] for primes in ("", "'", "''")
        )

    def at(self, more: Mapping[str, Ball]) -> ModelAt:
        """With other values of some symbols."""
        return ModelAt(self.program, self.coordinates, {**self.values, **more})

    def along(self, direction: Mapping[str, Ball]) -> ModelAt:
        """The changes of all outputs when symbols change in a direction, by forward differentiation."""
        changes, zero = tangents(self.program, self.found, direction), arb(0)
        found = [changes.get(i, zero) for i in range(len(self.found))]
        return ModelAt(self.program, self.coordinates, direction, found)

    def change(self, name: str, direction: Mapping[str, Ball]) -> Ball:
        """The change of one output without axes, by backward differentiation."""
        found = (slopes(self.program, entry, self.found) for entry in self.program.outputs[name].entries)
        return total(x * direction[symbol] for some in found for symbol, x in some.items() if symbol in direction)

    def by(self, name: str) -> ModelAt:
        """The derivatives by one symbol."""
        return self.along({name: arb(1)})

    def motion(self, second: Sequence[Ball]) -> dict[str, Ball]:
        """The direction of a motion with these accelerations: q', q'' and 1 for the time."""
        pairs = [(self.coordinates, self.rates), ([f"{name}'" for name in self.coordinates], second)]
        return self.time() | {name: x for names, some in pairs for name, x in zip(names, some, strict=True)}

    def elements(self, name: str) -> dict[Index, Ball]:
        """All elements of an output that are not zero by structure."""
        output, result = self.program.outputs[name], dict[Index, Ball]()
        for index, entry in zip(output.index, output.entries, strict=True):
            for image, sign in images_of(index, output.symmetry):
                result[image] = self.found[entry] * sign
        return result

    def scalar(self, name: str) -> Ball:
        """An output without axes."""
        return self.elements(name).get((), arb(0))

    def vector(self, name: str) -> list[Ball]:
        """An output (n,)."""
        found = self.elements(name)
        return [found.get((a,), arb(0)) for a in range(self.n)]

    def matrix(self, name: str) -> Matrix:
        """An output (k, l)."""
        rows, columns = self.program.outputs[name].shape
        result = arb_mat(rows, columns)
        for (i, j), x in self.elements(name).items():
            result[i, j] = x
        return result

    def needed(self, second: Sequence[Ball]) -> list[Ball]:
        """g q'' + Gamma q' q' - Q."""
        pairs = zip(times(self.matrix("metric"), second), self.vector("bias"), self.vector("forces"), strict=True)
        return [inertia + bias - Q for inertia, bias, Q in pairs]

    def accelerations(self, beside: Sequence[Ball] | None = None) -> list[Ball]:
        """q'' with g q'' + Gamma q' q' = Q; ``beside``: forces beside Q."""
        missing = self.needed([arb(0)] * self.n)
        return self.solved([(0 if beside is None else beside[a]) - x for a, x in enumerate(missing)])

    def solved(self, right: Sequence[Ball]) -> list[Ball]:
        """x with g x = right; not finite for a singular metric."""
        return solve(self.matrix("metric"), right)

    def momentum(self, name: str) -> list[Ball]:
        """sum_a p_a q'^a for the linear or angular momenta p_a of unit velocities."""
        found, drives = self.elements(f"{name}_momentum"), f"{name}_momentum_0"
        given = self.elements(drives) if drives in self.program.outputs else {}
        moved = (total(found.get((a, i), arb(0)) * x for a, x in enumerate(self.rates)) for i in range(3))
        return [x + given.get((i,), arb(0)) for i, x in enumerate(moved)]

    def momenta(self) -> list[Ball]:
        """p_a = g_ab q'^b + g_a0, the last of given motions."""
        return [x + y for x, y in zip(times(self.matrix("metric"), self.rates), self.drives(), strict=True)]

    def kinetic_energy(self) -> Ball:
        """g_ab q'^a q'^b / 2 + g_a0 q'^a + g_00 / 2."""
        return (dot(self.momenta(), self.rates) + dot(self.drives(), self.rates) + self.drives_alone()) / 2

    def kinetic_change(self, direction: Mapping[str, Ball]) -> Ball:
        """The change of T in a direction at fixed velocities: T is linear in what it is made of."""
        if direction.keys().isdisjoint(symbol.name for symbol in self.program.symbols):
            return arb(0)
        return ModelAt(self.program, self.coordinates, self.values, self.along(direction).found).kinetic_energy()

    def energy(self) -> Ball:
        """p_a q'^a - T + V."""
        return dot(self.momenta(), self.rates) - self.kinetic_energy() + self.scalar("potential_energy")

    def time(self) -> dict[str, Ball]:
        """The direction in which the time alone changes, and driven coordinates that are inputs: those with a rate."""
        inputs = (symbol.name for symbol in self.program.symbols if symbol.kind == "input")
        return {"t": arb(1)} | {name: self.values[f"{name}'"] for name in inputs if f"{name}'" in self.values}

    def drives(self) -> list[Ball]:
        """g_a0, 0 where no motion is given."""
        return self.vector("g_a0") if "g_a0" in self.program.outputs else [arb(0)] * self.n

    def drives_alone(self) -> Ball:
        """g_00."""
        return self.scalar("g_00") if "g_00" in self.program.outputs else arb(0)

    def changed(self, direction: Mapping[str, Ball], second: Sequence[Ball]) -> list[Ball]:
        """The change of g q'' + Gamma q' q' - Q in a direction, in which q'' changes, too."""
        moved = self.along(direction)
        by_state = moved.needed(second)
        by_rate = times(self.matrix("metric"), [direction.get(f"{name}''", arb(0)) for name in self.coordinates])
        return [x + y for x, y in zip(by_state, by_rate, strict=True)]


def total(terms: Iterable[Ball]) -> Ball:
    """The sum."""
    return sum(terms, arb(0))


def dot(x: Sequence[Ball], y: Sequence[Ball]) -> Ball:
    """x . y."""
    return total(a * b for a, b in zip(x, y, strict=True))


def times(matrix: Matrix, x: Sequence[Ball]) -> list[Ball]:
    """A matrix times a vector."""
    return (matrix * arb_mat(len(x), 1, list(x))).entries() if len(x) else [arb(0)] * matrix.nrows()


def solve(matrix: Matrix, right: Sequence[Ball]) -> list[Ball]:
    """x with matrix x = right; not finite where the matrix may be singular."""
    try:
        return matrix.solve(arb_mat(len(right), 1, list(right))).entries() if len(right) else []
    except ZeroDivisionError:
        return [arb("nan")] * len(right)
