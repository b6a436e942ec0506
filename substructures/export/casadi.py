"""CasADi: a C file with external functions and their dense Jacobians, for ``casadi.external``.

The C functions stand in the same file, with outputs as CasADi has them: matrices by columns, an array of more axes as
the matrix of its first axis by all others (J. Andersson et al., CasADi, Math. Prog. Comp. 11, 2019; user guide,
section 5.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod

from substructures.errors import TooLarge
from substructures.export.exported import Exported, Function
from substructures.export.interface import Vector
from substructures.export.languages.c import C
from substructures.export.render import text_of
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import MAX_ELEMENTS, flat, images
from substructures.expr.program import Formulas, Program, program
from substructures.expr.replay import replay

#: name, rows, columns
Matrix = tuple[str, int, int]
#: name, rows, columns, and whether the function needs it
Input = tuple[str, int, int, bool]


@dataclass(frozen=True)
class Changed(Function):
    """A function with other outputs, and the arguments of ``of``."""

    of: Function

    @cached_property
    def arguments(self) -> tuple[str, ...]:
        """As of the other function."""
        return self.of.arguments

    @cached_property
    def further(self) -> Vector:
        """As of the other function."""
        return self.of.further


def casadi(exported: Exported, limit: int) -> str:
    """The file. Raises TooLarge for Jacobians of too many elements, and as printing in C does."""
    changed: list[Function] = []
    lines: list[str] = []
    name = f"{exported.name}_core"
    for function in exported.functions:
        values, jacobians = _programs(function)
        changed.append(
            Changed(
                function.quantity,
                values,
                function.interface,
                function,
                packed=function.packed,
                glossary=function.glossary,
            )
        )
        changed.append(Changed(f"jac_{function.quantity}", jacobians, function.interface, function))
        core = Exported(name, exported.interface, tuple(changed), exported.form)
        of, slope = (core.called(each) for each in changed[-2:])
        lines += _externals(function, exported, of, slope)
    core = Exported(name, exported.interface, tuple(changed), exported.form)
    return "\n".join([*_use(exported), text_of(core, C, limit), *_OPENING, *lines])


def _use(exported: Exported) -> list[str]:
    """How the file is used: a command that compiles it, and Python."""
    name, function = exported.name, exported.functions[0]
    called, given = exported.called(function), ", ".join(function.arguments)
    return [
        "// External functions for CasADi, with their Jacobians. Compile, then load each by its name:",
        f"//   cc -O2 -shared -fPIC -o {name}_casadi.so {name}_casadi.c -lm",
        f'//   {called} = casadi.external("{called}", "./{name}_casadi.so")',
        f"//   {called}({given}) takes numbers or symbols; casadi.jacobian of it has its own formulas.",
        "// Second derivatives are not among them: solvers take approximate ones, IPOPT with the option",
        '// "ipopt.hessian_approximation": "limited-memory".',
        "//",
    ]


def _externals(function: Function, exported: Exported, of: str, slope: str) -> list[str]:
    """An external function and its Jacobian, by calls of two functions in C."""
    name = exported.called(function)
    shapes = [matrix(o.shape) for o in function.program.outputs.values()]
    outputs = [(v, *s) for v, s in zip(C(function, exported).variables.values(), shapes, strict=True)]
    inputs: list[Input] = [(symbol, len(function.vector(symbol)), 1, True) for symbol in function.arguments]
    unused: list[Input] = [(f"out_{v}", rows, columns, False) for v, rows, columns in outputs]
    slopes = [(f"jac_{v}_{s}", rows * columns, size) for v, rows, columns in outputs for s, size, *_ in inputs]
    return [*_external(name, of, inputs, outputs), *_external(f"jac_{name}", slope, [*inputs, *unused], slopes)]


def matrix(shape: Sequence[int]) -> tuple[int, int]:
    """Rows and columns of an array in CasADi."""
    return (shape[0], prod(shape[1:])) if shape else (1, 1)


def _programs(function: Function) -> tuple[Program, Program]:
    """The outputs, and their Jacobians by every argument, each by columns."""
    given, graph = function.program, Graph()
    vectors = [function.vector(symbol) for symbol in function.arguments]
    for output in given.outputs.values():
        size = prod(output.shape) * max(map(len, vectors))
        if size > MAX_ELEMENTS:
            raise TooLarge("a Jacobian (in elements)", size, MAX_ELEMENTS)
    values: dict[str, Formulas] = {}
    slopes: dict[str, Formulas] = {}
    for n, (name, array) in enumerate(replay(given, graph, {}).items()):
        elements = _by_columns(array)
        size = prod(array.shape)
        values[name] = Formulas((size,), {(i,): e for i, e in elements.items()})
        for vector in vectors:
            rows = gradient(elements.values(), vector.names)
            found: dict[tuple[int, ...], Expr] = {
                (j, i): e
                for i, row in zip(elements, rows, strict=True)
                for j, e in enumerate(row)
                if not e.is_zero
            }  # fmt: skip
            slopes[f"jac{n}_{vector.symbol}"] = Formulas((len(vector), size), found)
    symbols = {s.name: s for s in given.symbols}
    # in the order of the function's outputs, not of their names
    return program(graph, values, symbols).select(list(values)), program(graph, slopes, symbols).select(list(slopes))


def _by_columns(array: Formulas) -> dict[int, Expr]:
    """All elements that are not zero, dependent ones included, by their position in the matrix."""
    found = {}
    for index, expr in array.entries.items():
        for image, sign in images(index, array.symmetry):
            place = flat(image[1:], array.shape[1:]) * array.shape[0] + image[0] if image else 0
            found[place] = expr if sign > 0 else -expr
    return dict(sorted(found.items()))


def _external(name: str, called: str, inputs: Sequence[Input], outputs: Sequence[Matrix]) -> list[str]:
    """An external function: its call, names, shapes and workspace."""
    given, work, body = [], 0, []
    for i, (symbol, rows, columns, used) in enumerate(inputs):
        if used:
            body.append(f"    const double *a{i} = arg[{i}] ? arg[{i}] : substructures_zeros(w + {work}, {rows});")
            given.append(f"*a{i}" if symbol == "t" else f"a{i}")
            work += rows * columns
    for i, (_, rows, columns) in enumerate(outputs):
        given.append(f"res[{i}] ? res[{i}] : w + {work}")
        work += rows * columns
    arguments = "const double **arg, double **res, long long int *iw, double *w, int mem"
    lines = [f"CASADI_SYMBOL_EXPORT int {name}({arguments})", "{", *body, "    (void)iw;", "    (void)mem;"]
    lines += [f"    {called}({', '.join(given)});", "    return 0;", "}", ""]
    lines += _side(name, "in", [each[0] for each in inputs], [_pattern(*each[1:]) for each in inputs])
    lines += _side(name, "out", [each[0] for each in outputs], [_pattern(*each[1:]) for each in outputs])
    sizes = "long long int *arg, long long int *res, long long int *iw, long long int *w"
    lines += [f"CASADI_SYMBOL_EXPORT int {name}_work({sizes})"]
    lines += ["{", f"    if (arg) *arg = {len(inputs)};", f"    if (res) *res = {len(outputs)};"]
    return [*lines, "    if (iw) *iw = 0;", f"    if (w) *w = {work};", "    return 0;", "}", ""]


def _pattern(rows: int, columns: int, full: bool = True) -> str:
    """Compressed columns: all elements, or none."""
    return f"{{{rows}, {columns}, {'1' if full else ', '.join(['0'] * (columns + 1))}}}"


def _side(name: str, side: str, names: Sequence[str], patterns: Sequence[str]) -> list[str]:
    """Number, names and patterns of inputs or outputs."""
    lines = [f"CASADI_SYMBOL_EXPORT long long int {name}_n_{side}(void) {{ return {len(names)}; }}"]
    lines += [f"CASADI_SYMBOL_EXPORT const char *{name}_name_{side}(long long int i)", "{", "    switch (i) {"]
    lines += [f'    case {i}: return "{n}";' for i, n in enumerate(names)]
    lines += ["    default: return 0;", "    }", "}"]
    lines += [f"CASADI_SYMBOL_EXPORT const long long int *{name}_sparsity_{side}(long long int i)", "{"]
    lines += [f"    static const long long int s{i}[] = {p};" for i, p in enumerate(patterns)]
    lines += ["    switch (i) {", *(f"    case {i}: return s{i};" for i in range(len(patterns)))]
    return [*lines, "    default: return 0;", "    }", "}"]


_OPENING = (
    "",
    "#ifndef CASADI_SYMBOL_EXPORT",
    "#ifdef _WIN32",
    "#define CASADI_SYMBOL_EXPORT __declspec(dllexport)",
    "#else",
    "#define CASADI_SYMBOL_EXPORT",
    "#endif",
    "#endif",
    "",
    "static const double *substructures_zeros(double *w, size_t count)",
    "{",
    "    for (size_t i = 0; i < count; ++i) w[i] = 0.0;",
    "    return w;",
    "}",
    "",
)
