"""Formulas as exact SymPy expressions: straight from the program, no generated code is run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Any

import sympy
from sympy.physics.vector import dynamicsymbols

from substructures.errors import InvalidArgument, meant
from substructures.expr.program import Program, Symbol
from substructures.part.part import Part
from substructures.quantities.quantity import TABLE, outputs_of
from substructures.quantities.sources import Sources
from substructures.tree.model import Model

Expression = Any  #: SymPy has no types

_FUNCTIONS: dict[str, Callable[..., Expression]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "abs": sympy.Abs,
    **{
        name: getattr(sympy, name)
        for name in ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp", "log", "sqrt", "sign")
    },
}


def to_sympy(
    source: Model | Part | Program,
    name: str = "",
    *,
    dynamic: bool = False,
    symbols: Mapping[str, Expression] | None = None,
) -> Expression:
    """A quantity of a model, or an output of a part or a program, as SymPy has it.

    A scalar is an expression, a vector a column, a matrix an ImmutableMatrix, all else an ImmutableDenseNDimArray; of
    a quantity with several outputs, and without a ``name``, a dictionary by output. Numbers are exact.

    ``dynamic``: coordinates as :func:`dynamic_symbols`; else all are real symbols with the names that they have here
    (velocities ``q'``, accelerations ``q''``). ``symbols``: what stands for a name in place of that.

    Raises InvalidArgument for what is not there, TooLarge for what a model does not have as formulas.

    >>> from substructures import couple, derive, to_sympy
    >>> tree = {"name": "clock", "instances": [{"name": "p", "substructure": "simple-pendulum"}]}
    >>> to_sympy(couple(tree, {"p": derive("simple-pendulum")}), "metric")
    Matrix([[p.l**2*p.m]])
    """
    program, names = _outputs(source, name)
    given = _symbols(program, dynamic) | dict(symbols or {})
    values = _values(program, names, given)
    found = {each: _array(program, each, values) for each in names}
    return found[names[0]] if name and len(names) == 1 else found


def dynamic_symbols(coordinates: tuple[str, ...] | list[str]) -> dict[str, Expression]:
    """By name, coordinates as functions of time with their derivatives, as sympy.physics.mechanics writes them.

    >>> from substructures.interchange.symbolic.expressions import dynamic_symbols
    >>> dynamic_symbols(["q"])["q'"]
    Derivative(q(t), t)
    """
    t = dynamicsymbols._t
    found: dict[str, Expression] = {}
    for name in coordinates:
        q = sympy.Function(name)(t)
        found |= {name: q, f"{name}'": q.diff(t), f"{name}''": q.diff(t, 2)}
    return found


def _outputs(source: Model | Part | Program, name: str) -> tuple[Program, list[str]]:
    if isinstance(source, Model) and name and name not in source.program.outputs:
        if name not in TABLE:
            raise InvalidArgument.at(
                "/quantity", "unknown-quantity", f"there is no quantity '{name}'{meant(name, TABLE)}"
            )
        program = Sources(source).formulas(name)
        return program, [each for each in program.outputs if each in outputs_of(name)] or list(program.outputs)
    program = source if isinstance(source, Program) else source.program
    if name and name not in program.outputs:
        message = f"there is no output '{name}'{meant(name, program.outputs)}"
        raise InvalidArgument.at("/quantity", "unknown-output", message)
    return program, [name] if name else list(program.outputs)


def _symbols(program: Program, dynamic: bool) -> dict[str, Expression]:
    plain = {symbol.name: _real(symbol) for symbol in program.symbols}
    if not dynamic:
        return plain
    moving = {symbol.name.rstrip("'") for symbol in program.symbols if symbol.kind in _MOVING}
    t = dynamicsymbols._t
    told = {symbol.name: sympy.Function(symbol.name)(t) for symbol in program.symbols if symbol.kind == "input"}
    times = {symbol.name: t for symbol in program.symbols if symbol.kind == "time"}
    return plain | dynamic_symbols(sorted(moving)) | told | times


_MOVING = ("coordinate", "velocity", "acceleration")


def _real(symbol: Symbol) -> Expression:
    return sympy.Symbol(symbol.name, real=True)


def _values(program: Program, names: list[str], symbols: Mapping[str, Expression]) -> dict[int, Expression]:
    """Every operation that the outputs need."""
    values: dict[int, Expression] = {}
    for i in program.reachable(names):
        op, *operands = program.operations[i]
        if op == "sym":
            values[i] = symbols[program.symbols[operands[0]].name]
        elif op in ("int", "rat"):
            number = Fraction(*map(int, operands))
            values[i] = sympy.Rational(number.numerator, number.denominator)
        elif op == "powi":
            values[i] = values[operands[0]] ** operands[1]
        else:
            values[i] = _FUNCTIONS[op](*(values[k] for k in operands))
    return values


def _array(program: Program, name: str, values: Mapping[int, Expression]) -> Expression:
    output = program.outputs[name]
    elements = {index: sign * values[entry] for index, entry, sign in output.expanded()}
    if not output.shape:
        return elements.get((), sympy.Integer(0))
    if len(output.shape) <= 2:
        rows, columns = (*output.shape, 1)[:2]
        is_column = len(output.shape) == 1
        return sympy.ImmutableMatrix(
            rows, columns, lambda a, b: elements.get((int(a),) if is_column else (int(a), int(b)), 0)
        )
    array = sympy.MutableDenseNDimArray.zeros(*output.shape)
    for index, x in elements.items():
        array[index] = x
    return sympy.ImmutableDenseNDimArray(array)
