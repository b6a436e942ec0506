"""Programs over a prime field: exact linear algebra with formulas at a random point.

Unlike fingerprints, which must be quick and only lose simplifications, this evaluation is a homomorphism for everything
that occurs in mechanisms: square roots of all numbers (of those in formulas that are known beforehand; else another
prime may have to be drawn), rational multiples of angles, and multiples of pi/12 beside them. Other functions are
independent values.
"""

from __future__ import annotations

import secrets
from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import lcm

from flint import fmpz

from substructures.expr.construction.fingerprint import Point, added, multiplied, point_of
from substructures.expr.operations import BINARY, Operation
from substructures.expr.program import Program

#: an angle as multiples of what its sine and cosine are built from, and of pi
AngleForm = tuple[dict[int, Fraction], Fraction]
BITS = 100
#: bits of a prime that is chosen so that numbers have square roots
MOST_BITS = 4000
#: multiples with denominators that divide this one are multiples of one point on the circle
PARTS = 63 * 10**6


class NoSquareRoot(ArithmeticError):
    """A square root that the field does not hold: draw another one."""


class Field:
    """The integers modulo a random prime, 23 mod 24: 2 and 3 have square roots, -1 has none.

    So have all positive numbers under roots in ``programs``, up to MOST_BITS bits together.
    """

    def __init__(self, programs: Iterable[Program] = ()) -> None:
        self.prime = _prime(number for program in programs for number in _radicands(program))
        self.points: dict[object, Point] = {}
        root2, root6, quarter = self.root(2), self.root(6), pow(4, -1, self.prime)
        self.points["pi/12"] = (root6 + root2) * quarter % self.prime, (root6 - root2) * quarter % self.prime

    def draw(self) -> int:
        """A random element."""
        return secrets.randbelow(self.prime)

    def root(self, x: int) -> int:
        """The square root that is a square itself. Raises NoSquareRoot."""
        y = pow(x, (self.prime + 1) // 4, self.prime)
        if y * y % self.prime != x % self.prime:
            raise NoSquareRoot("no square root in this field")
        return y

    def inverse(self, x: int) -> int:
        """1/x. Raises ZeroDivisionError."""
        if not x:
            raise ZeroDivisionError("division by zero in the field")
        return pow(x, -1, self.prime)

    def circle(self, angle: AngleForm) -> Point:
        """(cos, sin) of an angle."""
        terms, turns = angle
        twelfths = turns * 12
        base = self.points["pi/12"] if twelfths.denominator == 1 else self._point(("pi", turns.denominator))
        result = multiplied(base, twelfths.numerator if twelfths.denominator == 1 else turns.numerator, self.prime)
        for atom, factor in terms.items():
            common = PARTS if PARTS % factor.denominator == 0 else factor.denominator
            n = factor.numerator * (common // factor.denominator)
            result = added(result, self._multiple(n, (atom, common)), self.prime)
        return result

    def _multiple(self, n: int, key: object) -> Point:
        """Of an angle so many times."""
        if (n, key) not in self.points:
            self.points[n, key] = multiplied(self._point(key), n, self.prime)
        return self.points[n, key]

    def _point(self, key: object) -> Point:
        if key not in self.points:
            self.points[key] = point_of(self.draw(), self.prime)
        return self.points[key]

    def evaluate(self, program: Program, values: Mapping[str, int], name: str) -> dict[tuple[int, ...], int]:
        """The independent elements of an output. Raises NoSquareRoot, ZeroDivisionError, KeyError for a symbol."""
        return FieldValues(self, program, values, [name]).output(name)


class FieldValues:
    """Values of the operations that some outputs need, and of angles as linear forms; atoms are known by their values.
    Raises NoSquareRoot, ZeroDivisionError, KeyError for a symbol.

    ``is_exact``: whether all is made of symbols, numbers and their roots by sums, products, quotients, and sines and
    cosines of sums of rational multiples of symbols and of pi/12: another value is another function then.
    """

    def __init__(self, field: Field, program: Program, symbols: Mapping[str, int], names: Iterable[str]) -> None:
        self.field, self.program, self.symbols = field, program, symbols
        self.needed = program.reachable(names)
        self.values = [0] * len(program)
        self.linear: dict[int, AngleForm] = {}
        self.points: dict[int, Point] = {}
        self.is_exact = True
        known, operations, p = self.values, program.operations, field.prime
        for i in self.needed:
            operation = operations[i]
            op = operation[0]
            if op == "mul":
                known[i] = known[operation[1]] * known[operation[2]] % p
            elif op == "add":
                known[i] = (known[operation[1]] + known[operation[2]]) % p
            elif op == "sub":
                known[i] = (known[operation[1]] - known[operation[2]]) % p
            else:
                self._step(i, operation)

    def output(self, name: str) -> dict[tuple[int, ...], int]:
        """The independent elements of one of the outputs."""
        output = self.program.outputs[name]
        return {index: self.values[e] for index, e in zip(output.index, output.entries, strict=True)}

    def elements(self, name: str) -> Iterator[tuple[tuple[int, ...], int]]:
        """All of them by index, those that follow from a symmetry included."""
        for index, entry, sign in self.program.outputs[name].expanded():
            yield index, sign * self.values[entry]

    def changes(self, names: Sequence[str], rates: Mapping[str, int]) -> list[dict[tuple[int, ...], int]]:
        """The derivatives of some of the outputs where symbols change at these rates, where all is exact."""
        p, values, d = self.field.prime, self.values, dict[int, int]()
        for i in self.program.reachable(names):
            operation = self.program.operations[i]
            op = operation[0]
            if op == "sym":
                d[i] = rates.get(self.program.symbols[operation[1]].name, 0)
                continue
            x, y = operation[1], operation[2] if op in BINARY else operation[1]
            u, v = d.get(x, 0), d.get(y, 0)
            if not (u or v):
                continue
            if op == "mul":
                d[i] = (u * values[y] + values[x] * v) % p
            elif op in ("add", "sub"):
                d[i] = u + v if op == "add" else u - v
            else:
                d[i] = self._slope(i, operation, u, v) % p
        outputs = [self.program.outputs[name] for name in names]
        return [{index: d[e] for index, e in zip(o.index, o.entries, strict=True) if d.get(e)} for o in outputs]

    def _slope(self, i: int, operation: Operation, u: int, v: int) -> int:
        """The derivative of all but sums and products, from those of its operands."""
        op, x, inverse = operation[0], operation[1], self.field.inverse
        if op == "neg":
            return -u
        if op == "div":
            # (x/y)' = (x' - (x/y) y') / y
            return (u - self.values[i] * v) * inverse(self.values[operation[2]])
        if op == "powi":
            return u * operation[2] * self.values[i] * inverse(self.values[x])
        c, s = self.points[x]
        return u * inverse(c) ** 2 if op == "tan" else c * u if op == "sin" else -s * u

    def _step(self, i: int, operation: Operation) -> None:
        """The value of one operation."""
        op, p = operation[0], self.field.prime
        if op == "sym":
            self.values[i] = self.symbols[self.program.symbols[operation[1]].name] % p
        elif op in ("int", "rat"):
            number = Fraction(int(operation[1]), int(operation[2]) if op == "rat" else 1)
            self.values[i] = number.numerator * self.field.inverse(number.denominator % p) % p
            self.linear[i] = {1: number} if number else {}, Fraction(0)
        elif op == "powi":
            base, n = self.values[operation[1]], operation[2]
            self.values[i] = pow(base if n >= 0 else self.field.inverse(base), abs(n), p)
        elif op in ("sin", "cos", "tan"):
            c, s = self.points[operation[1]] = self._point(operation[1])
            self.values[i] = {"sin": s, "cos": c}[op] if op != "tan" else s * self.field.inverse(c) % p
        elif op == "sqrt":
            self.values[i] = self.field.root(self.values[operation[1]])
            self.is_exact &= self._number(operation[1]) is not None
        elif op == "neg":
            self.values[i] = -self.values[operation[1]] % p
        elif op == "div":
            self.values[i] = self.values[operation[1]] * self.field.inverse(self.values[operation[2]]) % p
        else:
            self._other(i, operation)

    def _other(self, i: int, operation: Operation) -> None:
        """Independent values, the same for the same arguments; pi is acos(-1)."""
        key = (operation[0], *(self.values[x] for x in operation[1:]))
        if key not in self.field.points:
            self.field.points[key] = (self.field.draw(), 0)
        self.values[i] = self.field.points[key][0]
        if key == ("acos", self.field.prime - 1):
            self.linear[i] = {}, Fraction(1)
        else:
            self.is_exact = False

    def _point(self, i: int) -> Point:
        """(cos, sin) of an operation."""
        return self.points.get(i) or self.field.circle(self._form(i))

    def _form(self, i: int) -> AngleForm:
        """An operation as multiples of atoms and of pi."""
        terms: dict[int, Fraction] = {}
        turns, stack = Fraction(0), [(i, Fraction(1))]
        while stack:
            k, factor = stack.pop()
            op, *args = self.program.operations[k]
            number = next((x for x in args if op in ("mul", "div") and self._number(x) is not None), None)
            if k in self.linear:
                known, more = self.linear[k]
                turns += factor * more
                for atom, x in known.items():
                    terms[atom] = terms.get(atom, Fraction(0)) + factor * x
            elif op in ("add", "sub", "neg"):
                stack.append((args[0], -factor if op == "neg" else factor))
                stack += [(args[1], -factor if op == "sub" else factor)] if op != "neg" else []
            elif number is not None and (op == "mul" or number == args[1]):
                value = self._number(number) or Fraction(0)
                other = args[1] if number == args[0] else args[0]
                stack.append((other, factor * value if op == "mul" else factor / value))
            else:
                atom = self.values[k]
                self.is_exact &= op == "sym"
                terms[atom] = terms.get(atom, Fraction(0)) + factor
        self.is_exact &= (12 * turns).denominator == 1
        return {atom: x for atom, x in terms.items() if x}, turns

    def _number(self, i: int) -> Fraction | None:
        """The value of a constant."""
        op, *args = self.program.operations[i]
        return Fraction(int(args[0]), int(args[1]) if op == "rat" else 1) if op in ("int", "rat") else None


def _radicands(program: Program) -> Iterable[int]:
    """Numerators and denominators of all numbers under square roots."""
    operations = program.operations
    for inner in (operations[operation[1]] for operation in operations if operation[0] == "sqrt"):
        if inner[0] in ("int", "rat"):
            yield from (abs(int(x)) for x in inner[1:] if int(x))


def _prime(roots: Iterable[int]) -> int:
    """A random prime, -1 mod 24 and mod every number that is to have a square root.

    With p = -1 mod 4 the Jacobi symbol of an odd n is (n/p) = (-1)^((n - 1)/2) (p/n), and with p = -1 mod n that is
    (-1)^((n - 1)/2) (-1/n) = 1; (2/p) = 1 with p = -1 mod 8.
    """
    modulus = 24
    for n in roots:
        more = lcm(modulus, n)
        # without a number that is too long a field has its root by chance
        modulus = more if more.bit_length() <= MOST_BITS else modulus
    while True:
        n = (secrets.randbits(BITS - 5) | 1 << (BITS - 6)) * modulus - 1
        if fmpz(n).is_probable_prime():
            return n
