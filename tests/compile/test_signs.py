"""Values kept as their negatives: any of them give the same results, and few instructions turn signs."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE
from random_expressions import sample
from serial_chains import IIWA, RX90, SIX, SIX14, Plain, revolute

from substructures import Program, TreeSpec, couple, derive
from substructures.compile import compile_program, lowering, target
from substructures.compile.emission import assembly
from substructures.compile.lowering import lower
from substructures.compile.signs import KEPT, negatives
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.operations import Operation
from substructures.expr.program import Formulas

pytestmark = NEEDS_MACHINE_CODE
Collected = Callable[..., Program]
DYNAMICS = ("metric", "christoffel", "forces")


def machine_text(program: Program, names: Sequence[str], fused: bool) -> str:
    """The compiler's listing of the functions of a kernel."""
    llvm = target.library()
    text = assembly(lower(program, names, fused=fused), program.operations, target.host().width)
    text = text if fused else text.replace(" contract ", " ")
    with llvm.create_context() as context, llvm.parse_assembly(text, context) as module:
        module.triple = target.host().triple
        return str(target.machine().emit_assembly(module))


def signs_turned(program: Program, names: Sequence[str], fused: bool = True) -> int:
    """Instructions that turn the sign of a value, on x86 an exclusive or with the bits of the sign."""
    if not target.host().fused or "x86" not in target.host().triple:
        pytest.skip("counts instructions of x86 with fused multiplication and addition")
    return len(re.findall(r"^\s*v?xorp[sd]\s", machine_text(program, names, fused), re.MULTILINE))


def negations(program: Program, names: Sequence[str]) -> int:
    return sum(program.operations[i][0] == "neg" for i in program.reachable(names))


def anything(seed: int) -> Callable[..., set[int]]:
    """Any sums and products that are not used by functions and as results."""
    rng = np.random.default_rng(seed)

    def chosen(ops: Sequence[Operation], needed: Sequence[int], results: set[int], _: bool) -> set[int]:
        fixed = set(results)
        for i in needed:
            if ops[i][0] not in (*KEPT, "neg", "sym", "int", "rat"):
                fixed.update(ops[i][1:])
        return {i for i in needed if ops[i][0] in KEPT and i not in fixed and rng.random() < 0.5}

    return chosen


@pytest.mark.parametrize("contraction", [True, False])
@pytest.mark.parametrize("seed", range(12))
def test_whatever_is_kept_as_its_negative(
    seed: int, contraction: bool, collected: Collected, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = sample(seed, 120)
    some = given.exprs[-40:]
    program = collected(
        given.graph, {"x": "parameter", "y": "velocity"}, x=Formulas((40,), {(k,): x for k, x in enumerate(some)})
    )
    values = {name: np.full(5, x) for name, x in given.point.items()}
    expected = interpret(program, values, ["x"])["x"]
    if not contraction:
        monkeypatch.setattr(lowering, "sharp", lambda _, needed: set(needed))
    kernels = [compile_program(program, ["x"])]
    monkeypatch.setattr(lowering, "negatives", anything(seed))
    kernels += [compile_program(program, ["x"], width=width) for width in (2, target.host().width)]
    # in functions of three operations, between which negatives are stored
    monkeypatch.setattr("substructures.compile.compiled.lower", lambda p, n, fused: lower(p, n, 3, fused))
    kernels.append(compile_program(program, ["x"]))
    for kernel in kernels:
        found = kernel.evaluate(values)["x"]
        if contraction:
            np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)
        else:
            # sums keep their roundings; sines are those of another library
            np.testing.assert_allclose(found, expected, rtol=1e-14, atol=1e-14)


G = Graph()
A, B, C, D = (G.symbol(n) for n in "abcd")
COSTLESS = {
    "difference": [-(A - B)],
    "product": [-(A * B + C)],
    "products": [-(A * B + C * D)],
    "factor": [-(A * (B - C))],
    "sum of sums": [-((A * B + C) + D)],
    "sum and product": [-((A - B) + C * D), (A - B) * C],
    "in a product": [-(A - B), (A - B) * C + D],
    "in sums": [-(A - B), (A - B) + C, D - (A - B)],
    "in products": [-(A * B - C), (A * B - C) * D - A, (A * B - C) * C + D],
}


@pytest.mark.parametrize("entries", COSTLESS.values(), ids=COSTLESS)
def test_signs_that_cost_nothing(entries: list[Expr], collected: Collected) -> None:
    program = collected(G, {}, x=Formulas((len(entries),), {(k,): x for k, x in enumerate(entries)}))
    assert negations(program, ["x"]) > 0
    assert signs_turned(program, ["x"]) == 0
    values = {n: np.linspace(k - 2, 1.5 * k, 7) for k, n in enumerate("abcd")}
    found, expected = compile_program(program, ["x"]).evaluate(values), interpret(program, values, ["x"])
    np.testing.assert_allclose(found["x"], expected["x"], rtol=1e-14, atol=1e-14)


def test_results_and_arguments_keep_their_signs(collected: Collected) -> None:
    """x and -x both as results, and x as the argument of a function: one sign is turned."""
    g = Graph()
    a, b = g.symbol("a"), g.symbol("b")
    x, y = a - b, a + 2 * b
    for entries in ([x, -x], [g.function("exp", y), -y], [-a]):
        program = collected(g, {}, x=Formulas((len(entries),), {(k,): e for k, e in enumerate(entries)}))
        lowered = lower(program, ["x"])
        assert not lowered.minus
        assert signs_turned(program, ["x"]) == 1


def test_what_decides_about_the_last_bit_keeps_its_signs(collected: Collected) -> None:
    g = Graph()
    a, b = g.symbol("a"), g.symbol("b")
    x = a - b
    ops = collected(g, {}, y=-x, z=g.function("sqrt", x * b + a))
    assert not lower(ops, ["y", "z"]).minus
    assert lower(ops, ["y"]).minus


@pytest.mark.parametrize(
    ("rows", "nodes", "left"),
    [(RX90, 23, 7), (IIWA, 35, 11), (SIX14, 14, 2), (SIX, 7, 1)],
    ids=["rx90", "iiwa", "6r with 14 parameters", "6r"],
)
def test_few_instructions_turn_signs(rows: list[Plain], nodes: int, left: int) -> None:
    """Of metric, Christoffel symbols and forces; what is left are products, and values that are needed with both."""
    tree = {"name": "t", "gravity": [0, 0, "-g"], "parameters": {"g": {}}}
    spec = TreeSpec.read(tree | {"instances": [{"name": "x", "substructure": "chain", "at": "world"}]})
    program = couple(spec, {"x": derive(revolute(rows))}).program
    assert negations(program, DYNAMICS) == nodes
    assert signs_turned(program, DYNAMICS) <= left
    assert signs_turned(program, ("inverse_dynamics",)) == 0
    assert signs_turned(program, DYNAMICS, fused=False) <= nodes


def test_values_that_leave_more_signs_stay_as_they_are() -> None:
    """-x beside x - c: neither way saves one."""
    for op in ("add", "sub"):
        ops: list[Operation] = [("sym", 0), ("sym", 1), ("sym", 2), (op, 0, 1), ("neg", 3), ("sub", 3, 2)]
        assert negatives(ops, range(6), {4, 5}) == set()
