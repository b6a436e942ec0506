"""Text for people is read back as the same formulas, and sizes are known before printing."""

from __future__ import annotations

import pytest
from random_expressions import collected, sample

from substructures.errors import TooLarge
from substructures.export import render
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import Formulas, Output, Program
from substructures.expr.trigonometry import cos
from substructures.printers import entries


def test_text_is_read_back_as_the_same_formulas() -> None:
    for seed in range(40):
        s = sample(6000 + seed, size=30)
        program = collected(s.graph, f=Formulas((len(s.exprs),), {(i,): e for i, e in enumerate(s.exprs)}))
        expected = interpret(program, s.point)["f"]
        for form in ("compact", "expanded", "textbook"):
            found = entries(program, "f", form=form)
            exprs = {f"e{e['index'][0]}": parse(s.graph, e["formula"], s.graph.symbol) for e in found}
            values = interpret(collected(s.graph, **exprs), s.point)
            for name, value in values.items():
                assert value == pytest.approx(expected[int(name[1:])], rel=1e-7, abs=1e-6)


def test_readable_text() -> None:
    g = Graph()
    x, t1 = g.symbol("x"), g.symbol("t1")
    shared = (x + t1) * cos(x)
    text = render(collected(g, f=shared * (shared + x), g=-shared - g.one / 4 * x * x), "text")
    assert "tt1 = (x + t1)*cos(x)\n" in text or "tt1 = (t1 + x)*cos(x)\n" in text
    assert "f = tt1*(tt1 + x)\n" in text
    assert "g = -(tt1 + 1/4*x^2)\n" in text


def test_a_small_program_may_be_a_large_formula() -> None:
    g = Graph()
    e = g.symbol("x")
    for i in range(60):
        e = g.function("exp", e) + g.function("atan2", e, g.number(i))
    program = collected(g, f=e)
    assert len(render(program, "text")) < 10_000
    for form in ("compact", "expanded", "textbook"):
        with pytest.raises(TooLarge):
            entries(program, "f", form=form)
    with pytest.raises(TooLarge):
        render(program, "text", "expanded")


def test_large_arrays_are_refused() -> None:
    huge = Program((), (), {"f": Output((10**5, 10**5), (), ())})
    with pytest.raises(TooLarge):
        render(huge, "text")
