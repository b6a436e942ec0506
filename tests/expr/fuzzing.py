"""Random expressions as text, and what the package makes of them beside ball arithmetic straight from the text.

What is compared shares nothing: values come from :mod:`substructures.expr.direct`, which knows no graph. Texts are made
to collide: new ones are old ones rewritten by identities that change domains and rounding errors (multiplied and
divided by the same, a difference of equal terms added, products multiplied out), and several live in one graph.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

import flint

from substructures.errors import TooLarge
from substructures.expr.direct import ball, value
from substructures.expr.graph import Graph
from substructures.expr.parse import parse
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.expr.steps import ExpressionError

NAMES = ("a", "b", "k", "q0", "q1", "w")
#: what stands in a formula; the last ones are rare
NUMBERS = ("0", "1", "2", "3", "4", "9", "14", "1/2", "0.1", "2.5", "1e9", "1e-9", "11", "7", "pi", "pi/2", "pi/3")
#: values at which things cancel, vanish, or grow
SPECIAL = (0.0, 1.0, -1.0, 2.0, 0.5, -3.0, 4.0, 1e9, -1e-9, 1e5)
#: bits of the yardstick
PRECISION = 700
#: how many times the rounding of the text a result may be off
TOLERANCE = 256.0


#: equal functions, of which the second one has the larger domain or the smaller rounding errors
PAIRS = (
    ("(X^2-Y^2)/(X-Y)", "X+Y"),
    ("sin(2*X)/sin(X)", "2*cos(X)"),
    ("((X+4)*(X+9)-(X+2)*(X+11))*Y", "14*Y"),
    ("(X+1e9)*Y-1e9*Y", "X*Y"),
    ("(X+Y)^2-(X-Y)^2", "4*X*Y"),
    ("sqrt(X)*sqrt(X)*(Y+1)", "X*Y+X"),
    ("(X^3+Y^3)/(X+Y)", "X^2-X*Y+Y^2"),
    ("(X/Y)*(2*Y+Y^2)", "2*X+X*Y"),
    ("X*(Y+Z)-X*Z", "X*Y"),
    ("(X+Z)*(Y-Z)+Z^2-Z*(Y-X)", "X*Y"),
    ("(1-cos(X)^2)*Y/sin(X)", "sin(X)*Y"),
    ("((X+Y)/(1+Z^2)+Z*(Z*X+Z*Y)/(1+Z^2))*2", "2*X+2*Y"),
    ("(X*Z+Y*Z)/Z", "X+Y"),
    ("sqrt(X)*(sqrt(X)*Y)+Z*X", "X*Y+X*Z"),
)


@dataclass
class Texts:
    """A source of texts that remembers what it gave."""

    rng: random.Random
    known: list[str] = field(default_factory=list)

    def new(self, depth: int = 4) -> str:
        """A new text, or an equal one to an old one."""
        if self.known and self.rng.random() < 0.45:
            text = self.rewritten(self.rng.choice(self.known))
        else:
            text = self.made(depth)
        if len(text) < 600:
            self.known.append(text)
        return text

    def group(self, count: int) -> list[str]:
        """Texts in any order, two pairs of equal ones among them: the worse of the two may come first."""
        texts = [self.new() for _ in range(count - 4)]
        for pair in self.rng.sample(PAIRS, 2):
            x, y, z = (self.made(self.rng.choice((0, 0, 1))) for _ in range(3))
            texts += [text.replace("X", f"({x})").replace("Y", f"({y})").replace("Z", f"({z})") for text in pair]
        self.rng.shuffle(texts)
        return texts

    def made(self, depth: int) -> str:
        """A random text."""
        r = self.rng
        if depth == 0 or r.random() < 0.12:
            return r.choice(NAMES) if r.random() < 0.65 else f"({r.choice(NUMBERS)})"
        if self.known and r.random() < 0.1:
            return f"({r.choice(self.known)})"
        kind = r.choice("++--**/fffnp")
        a = self.made(depth - 1)
        if kind in "+-*/":
            return f"({a}{kind}{self.made(depth - 1)})"
        if kind == "f":
            return f"{r.choice(('sin', 'cos', 'tan', 'sqrt', 'sqrt'))}({a})"
        return f"(-{a})" if kind == "n" else f"({a})^{self.power()}"

    def power(self) -> int:
        """An exponent, small ones more often."""
        return self.rng.choice((2, 2, 2, 3, 4, -1, -2, 7))

    def rewritten(self, a: str) -> str:
        """An equal text, but for its domain and its rounding errors."""
        b = self.made(1)
        forms: tuple[Callable[[], str], ...] = (
            lambda: f"(({a})*({b}))/({b})",
            lambda: f"(({a})+({b}))-({b})",
            lambda: f"({a})*(sin({b})^2+cos({b})^2)",
            lambda: f"(({a}+{b})^2-({a}-{b})^2)/(4*{b})",
            lambda: f"(({a})^2-({b})^2)/(({a})-({b}))-({b})",
            lambda: f"-(-({a}))",
            lambda: f"sqrt(({a})^2)*1",
            lambda: f"sqrt({a})*sqrt({a})",
            lambda: f"(-sqrt({a}))^2",
            lambda: f"2*sin({a})*cos({a})",
            lambda: f"sin(2*({a}))",
            lambda: f"sin(({a})+2*pi)",
            lambda: f"cos(({a})-({b}))*cos({b})-sin(({a})-({b}))*sin({b})",
            lambda: f"14*({a})",
            lambda: f"(({a}+4)*({a}+9)-({a}+2)*({a}+11))*({a})",
            lambda: f"(({a})*({b})+({a}))/(({b})+1)",
        )
        return self.rng.choice(forms)()

    def point(self) -> dict[str, float]:
        """Values for all names: ordinary ones, special ones, equal ones, of all magnitudes."""
        r = self.rng
        kind = r.random()
        if kind < 0.35:
            return {n: r.uniform(-3, 3) for n in NAMES}
        if kind < 0.6:
            return {n: r.choice(SPECIAL) for n in NAMES}
        if kind < 0.75:
            return dict.fromkeys(NAMES, r.choice((r.uniform(-3, 3), r.choice(SPECIAL))))
        return {n: r.choice((-1, 1)) * 10 ** r.uniform(-6, 6) for n in NAMES}


@dataclass(frozen=True)
class Yardstick:
    """What the text says at a point: a ball with the exact value, and what rounding may do to it; None: nothing."""

    exact: Any
    error: float | None

    def accepts(self, x: float) -> bool:
        """Whether a float is the value, as far as rounding lets one say."""
        if not math.isfinite(x):
            return False
        if self.error is None:
            return True
        with flint.ctx.workprec(PRECISION):
            return bool(abs(flint.arb(x) - self.exact) <= flint.arb(self.error))


def measure(text: str, point: Mapping[str, float]) -> Yardstick | None:
    """The yardstick of a text; None where it has no value, or only thanks to rounding."""
    try:
        exact = ball(text, point, PRECISION)
    except ZeroDivisionError:
        return None
    if not exact.is_finite() or not math.isfinite(float(value(text, point))):
        return None
    if not abs(float(exact)) < 1e290:
        return None
    moved = {n: flint.arb(x, abs(x) * 2.0**-52) for n, x in point.items()}
    rough = ball(text, moved, 53)
    if rough.is_finite():
        # rounding of the text and of its inputs; what lies below the smallest doubles is lost everywhere
        error = TOLERANCE * float(rough.rad()) + TOLERANCE * 2.0**-1000
        return Yardstick(exact, error if math.isfinite(error) else None)
    # at the edge of its domain: a value counts where the text has one by exact arithmetic
    return Yardstick(exact, None) if exact.is_exact() else None


def built(texts: list[str]) -> tuple[list[str], Program] | None:
    """The texts read one after the other into one graph, as one program with the outputs f0, f1, ...

    Texts that are refused (division by zero, roots of negative numbers, numbers out of bounds) are left out.
    """
    graph, kept, exprs = Graph(), [], []
    for text in texts:
        try:
            exprs.append(parse(graph, text, graph.symbol))
            kept.append(text)
        except ExpressionError:
            continue
    symbols = {n: Symbol(n, "coordinate", "") for n in NAMES}
    outputs = {f"f{i}": Formulas((), {(): e}) for i, e in enumerate(exprs)}
    return (kept, program(graph, outputs, symbols)) if kept else None


_BALLS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
}


def balls(p: Program, point: Mapping[str, float], precision: int = PRECISION) -> dict[str, Any]:
    """The scalar outputs of a program in ball arithmetic."""
    with flint.ctx.workprec(precision):
        done: list[Any] = []
        for op, *args in p.operations:
            if op in ("int", "rat"):
                number = Fraction(*map(int, args))
                done.append(flint.arb(flint.fmpq(number.numerator, number.denominator)))
            elif op == "sym":
                done.append(flint.arb(point[p.symbols[args[0]].name]))
            elif op in _BALLS:
                done.append(_BALLS[op](*(done[i] for i in args)))
            else:
                done.append(getattr(done[args[0]], op)())
        return {n: done[o.entries[0]] if o.entries else flint.arb(0) for n, o in p.outputs.items()}


def agrees(found: Any, yardstick: Yardstick) -> bool:
    """Whether a ball of a program can hold the exact value; wide balls say nothing but must be there."""
    with flint.ctx.workprec(PRECISION):
        return bool(found.is_finite() and found.overlaps(yardstick.exact))


__all__ = ["NAMES", "Texts", "TooLarge", "Yardstick", "agrees", "balls", "built", "measure"]
