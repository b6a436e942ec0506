"""Examples in languages that need no build."""

from __future__ import annotations

import json

from substructures.export.interface import Vector
from substructures.export.kits.example import VALUE, Example
from substructures.export.languages.julia import Julia
from substructures.export.languages.matlab import fields as of_matlab
from substructures.export.languages.python import fields as of_python


def _arguments(e: Example, zeros: str, before: tuple[str, ...] = ("q", "p")) -> str:
    """Arguments: those of ``before`` by their names, all else zero."""
    return ", ".join(
        "0.0" if s == "t" else s if s in before else zeros.format(len(e.function.vector(s)))
        for s in e.function.arguments
    )


def python(e: Example, suffix: str = "") -> str:
    """In Python."""
    n, variable = e.name + suffix, next(iter(e.outputs))
    lines = [f"import {n} as model", ""]
    if "q" in e.lengths:
        first = [each.name for each in of_python(e.function.vector("q"))[:1]]
        lines.append(f"q = model.Coordinates({''.join(f'{name}={VALUE}' for name in first)})  # {e.coordinate}")
    lines += ["p = model.Parameters()"] if "p" in e.lengths else []
    lines.append(f"result = model.{e.called}({_arguments(e, '[0.0] * {}')})")
    names = list(e.function.program.outputs)
    value = f"result[{names[0]!a}]" if len(names) > 1 else "result"
    index = ", ".join("0" for _ in e.outputs[variable])
    return "\n".join([*lines, *e.shown(f"print({value}{f'[{index}]' if index else ''})"), ""])


def jax(e: Example) -> str:
    """In JAX, with doubles."""
    return 'import jax\n\njax.config.update("jax_enable_x64", True)\n' + python(e, "_jax")


def javascript(e: Example) -> str:
    """For Node."""
    lines = [f'import {{ load }} from "./{e.name}.mjs";', "", "const model = await load();"]
    if "q" in e.lengths:
        vector: Vector = e.function.vector("q")
        values = {name: VALUE if k == 0 else 0.0 for k, name in enumerate(vector.names)}
        lines.append(f"const q = {json.dumps(values)};")
    given = _arguments(e, "new Float64Array({})", ("q",))
    given = given.rpartition(", ")[0] if e.function.arguments[-1] == "p" and len(e.function.arguments) > 1 else given
    names = list(e.function.program.outputs)
    lines.append(f"const result = model.{e.called}({given}); // the parameters at their defaults")
    value = f"result[{json.dumps(names[0])}]" if len(names) > 1 else "result"
    return "\n".join([*lines, *e.shown(f"console.log({value}[0]);"), ""])


def package(e: Example) -> dict[str, str]:
    """The package of JavaScript."""
    n = e.name
    told = {
        "name": n.lower(),
        "version": "0.1.0",
        "type": "module",
        "main": f"{n}.mjs",
        "types": f"{n}.d.mts",
        "scripts": {"test": f"node {n}_selftest.mjs", "example": f"node {n}_example.mjs"},
    }
    return {"package.json": json.dumps(told, indent=2) + "\n"}


def matlab(e: Example) -> str:
    """In MATLAB and Octave."""
    n, lines = e.name, list[str]()
    if "q" in e.lengths:
        lines.append(f"q = {n}_coordinates();")
        if e.coordinate:
            lines.append(f"q.{of_matlab(e.function.vector('q'))[0].name} = {VALUE}; % {e.coordinate}")
    lines += [f"p = {n}_parameters();"] if "p" in e.lengths else []
    given = _arguments(e, "zeros({}, 1)")
    for s, called in (("q", "coordinates"), ("p", "parameters")):
        given = ", ".join(f"{n}_{called}({s})" if each == s else each for each in given.split(", "))
    lines.append(f"result = {e.called}({given});")
    return "\n".join([*lines, *e.shown("fprintf('%.9g\\n', result(1));"), ""])


def simulink(e: Example) -> str:
    """A model with the block, in MATLAB."""
    n = e.name
    return f"""\
{n}_build
p = {n}_parameters();
new_system('{n}_example');
add_block('simulink/User-Defined Functions/S-Function', '{n}_example/mechanism', ...
    'FunctionName', '{n}_sfun', 'Parameters', '{n}_parameters(p), []');
open_system('{n}_example');
"""


def julia(e: Example) -> str:
    """In Julia."""
    n = e.name
    lines = [f'include("{n}.jl")', ""]
    lines += [f"q = zeros({e.lengths['q']})"] if "q" in e.lengths else []
    if e.coordinate:
        lines.append(f"q[{e.place(f'{n}_Q_{{}}', Julia.alike, 1)}] = {VALUE} # {e.coordinate}")
    given = _arguments(e, "zeros({})", ("q",))
    given = given.rpartition(", ")[0] if e.function.arguments[-1] == "p" and len(e.function.arguments) > 1 else given
    return "\n".join([*lines, f"println({e.called}({given}))", ""])
