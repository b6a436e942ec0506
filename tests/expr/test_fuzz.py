"""Random expressions through everything that is done with formulas, beside ball arithmetic straight from the text.

The README's tests take a few hundred texts, the deep ones as many as FUZZ_TEXTS says.
"""

from __future__ import annotations

import math
import os
import random
import re
from collections import Counter
from collections.abc import Callable, Mapping
from decimal import Decimal
from typing import Any

import flint
import numpy as np
import pytest

from substructures.compile import compile_program
from substructures.errors import InvalidDocument, TooLarge
from substructures.expr.bind import bind
from substructures.expr.differentiate import gradient
from substructures.expr.direct import ball
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.expr.replay import replay
from substructures.expr.rings.expand import Expander
from substructures.expr.steps import ExpressionError
from substructures.printers import entries

from .fuzzing import NAMES, PRECISION, Texts, agrees, balls, built, measure

SYMBOLS = {n: Symbol(n, "coordinate", "") for n in NAMES}
DEEP = int(os.environ.get("FUZZ_TEXTS", "16000"))

Check = Callable[[list[str], Program, Texts], int]


def evaluated(texts: list[str], p: Program, source: Texts) -> int:
    """Values in floating point, of the program and of what is read back from its bytes."""
    again = Program.from_bytes(p.to_bytes())
    assert again == p
    found = 0
    for _ in range(3):
        point = source.point()
        values = interpret(again, point)
        for i, text in enumerate(texts):
            yardstick = measure(text, point)
            if yardstick is not None:
                found += 1
                assert yardstick.accepts(float(values[f"f{i}"])), (text, point, values[f"f{i}"], texts)
    return found


def replayed(_: list[str], p: Program, __: Texts) -> int:
    """Replaying a program without bindings gives the same bytes."""
    graph = Graph()
    assert program(graph, replay(p, graph, {}), SYMBOLS).to_bytes() == p.to_bytes()
    return 1


def compiled(texts: list[str], p: Program, source: Texts) -> int:
    """Kernels give what the interpreter gives, but for rounding; also where there is no value."""
    points = [source.point() for _ in range(8)]
    columns = {s.name: np.array([point[s.name] for point in points]) for s in p.symbols}
    if not columns:
        return 0
    names = list(p.outputs)
    values = compile_program(p, names).evaluate(columns)
    for j, point in enumerate(points):
        for i, text in enumerate(texts):
            yardstick = measure(text, point)
            if yardstick is not None:
                assert yardstick.accepts(float(values[f"f{i}"][j])), (text, point, values[f"f{i}"][j])
    return len(points) * len(texts)


def bound(texts: list[str], p: Program, source: Texts) -> int:
    """Some symbols replaced by numbers, some by expressions."""
    point = {n: float(source.rng.choice((1, 2, -3, 0.5, 4))) for n in NAMES}
    given: dict[str, Any] = {s.name: "q1+1/2" if s.name == "w" else int(point[s.name] * 2) for s in p.symbols}
    given = {n: (v if isinstance(v, str) else f"{v}/2") for n, v in given.items() if n != "q1"}
    point["w"] = point["q1"] + 0.5
    try:
        values = interpret(bind(p, given), point)
    except (InvalidDocument, TooLarge):  # a divisor became zero, a root's argument negative
        return 0
    found = 0
    for i, text in enumerate(texts):
        yardstick = measure(text, point)
        if yardstick is not None and yardstick.error is not None:
            found += 1
            assert yardstick.accepts(float(values[f"f{i}"])), (text, given, values[f"f{i}"])
    return found


def expanded(texts: list[str], p: Program, source: Texts) -> int:
    """The canonical form is the same function, with a value wherever the text has one."""
    graph, outputs = Graph(), {}
    exprs = replay(p, Graph(), {})
    for i in range(len(texts)):
        expr = exprs[f"f{i}"].entries.get(())
        try:
            if expr is not None:
                outputs[f"f{i}"] = Formulas((), {(): Expander([expr], 300).expand(expr).to_expr(graph)})
        except (TooLarge, ZeroDivisionError):
            continue
    return _same(texts, program(graph, outputs, SYMBOLS), source)


def is_readable(number: str) -> bool:
    """Whether the grammar reads so many digits and places; exact numbers may have three times as many."""
    _, digits, exponent = Decimal(number).as_tuple()
    return len(digits) + abs(int(exponent)) <= 400


def printed(texts: list[str], p: Program, source: Texts) -> int:
    """Text is read back as the same function."""
    graph, outputs = Graph(), {}
    for name in p.outputs:
        for entry in entries(p, name, "text"):
            if all(map(is_readable, re.findall(r"\d[\d.]*(?:e-?\d+)?", entry["formula"]))):
                outputs[name] = Formulas((), {(): parse(graph, entry["formula"], graph.symbol)})
    return _same(texts, program(graph, outputs, SYMBOLS), source)


def _same(texts: list[str], p: Program, source: Texts) -> int:
    found = 0
    point = source.point()
    values = balls(p, point)
    for i, text in enumerate(texts):
        yardstick = measure(text, point)
        if yardstick is not None and yardstick.error is not None and f"f{i}" in values:
            found += 1
            assert agrees(values[f"f{i}"], yardstick), (text, point, values[f"f{i}"], yardstick.exact)
    return found


def differentiated(texts: list[str], p: Program, source: Texts) -> int:
    """Derivatives are the limits of difference quotients of the text, taken with 700 digits."""
    graph = Graph()
    exprs = replay(p, graph, {})
    point = {n: source.rng.uniform(-2, 2) for n in NAMES}
    name, found = source.rng.choice(NAMES), 0
    for i, text in enumerate(texts):
        yardstick = measure(text, point)
        slope = _slope(text, point, name)
        if yardstick is None or yardstick.error is None or slope is None or () not in exprs[f"f{i}"].entries:
            continue
        ((derivative,),) = gradient([exprs[f"f{i}"].entries[()]], [name])
        value = balls(program(graph, {"d": Formulas((), {(): derivative})}, SYMBOLS), point)["d"]
        found += 1
        with flint.ctx.workprec(PRECISION):
            error = abs(value - slope)
            assert error < 1e-60 * (1 + abs(slope)), (text, name, point, value, slope)
    return found


def _slope(text: str, point: Mapping[str, float], name: str) -> Any:
    """(f(x + h) - f(x - h)) / 2h with h = 2^-300, where f is smooth on that scale; else None."""
    with flint.ctx.workprec(4 * PRECISION):
        h = flint.arb(2) ** -300
        sides = [measure_ball(text, {**point, name: flint.arb(point[name]) + s * h}) for s in (1, -1, 2, -2)]
        if not all(x is not None and x.is_finite() for x in sides):
            return None
        near, far = (sides[0] - sides[1]) / (2 * h), (sides[2] - sides[3]) / (4 * h)
        # third derivatives beyond 1e80 are poles or corners
        return near if abs(near - far) < 1e-70 * (1 + abs(near)) else None


def measure_ball(text: str, point: Mapping[str, Any]) -> Any:
    """The text in balls of many digits, None where it divides by zero."""
    try:
        return ball(text, point, 4 * PRECISION)
    except ZeroDivisionError:
        return None


CHECKS: tuple[Check, ...] = (evaluated, replayed, bound, expanded, printed, differentiated, compiled)


def run(seed: int, count: int, checks: tuple[Check, ...]) -> Counter[str]:
    """Texts in groups of eight, each group in one graph; how many comparisons each check made."""
    made: Counter[str] = Counter()
    for group in range(count // 8):
        source = Texts(random.Random(f"{seed} {group}"))  # noqa: S311 -- test data
        try:
            found = built(source.group(8))
        except (ExpressionError, TooLarge):
            continue
        if found is None:
            continue
        for check in checks:
            made[check.__name__] += check(*found, source)
    return made


@pytest.mark.parametrize("seed", range(4))
def test_random_expressions(seed: int) -> None:
    made = run(seed, 160, CHECKS[:-1])
    assert all(made[check.__name__] > 5 for check in CHECKS[:-1]), made


def test_random_expressions_as_kernels() -> None:
    assert run(100, 80, (compiled,))["compiled"] > 100


@pytest.mark.deep
@pytest.mark.parametrize("seed", range(1000, 1004))
def test_many_random_expressions(seed: int) -> None:
    made = run(seed, DEEP // 4, CHECKS[:-1]) + run(seed, DEEP // 80, CHECKS[-1:])
    print(f"seed {seed}: {dict(made)}")
    assert made["evaluated"] > DEEP // 8
    assert math.prod(made.values()) > 0
