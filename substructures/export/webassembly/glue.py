"""JavaScript around a module: vectors in, arrays out, lengths checked, defaults filled in; and its types."""

from __future__ import annotations

import json
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from substructures.printers.names import comment

_NAMED = {"q": "Coordinates", "qd": "Velocities", "qdd": "Accelerations", "u": "Inputs", "p": "Parameters"}
_TYPES = """/** What was exported: names, order, units, shapes and defaults of everything. */
export declare const description: Record<string, unknown>;
%s
export interface Functions {
%s
}
/** The functions, from the bytes of the module or from a compiled module. */
export declare function create(source: BufferSource | WebAssembly.Module): Functions;
/** The functions, from the file of the module beside this one. */
export declare function load(url?: URL): Promise<Functions>;
"""


def javascript(name: str, description: Mapping[str, Any], heap: int) -> str:
    """The text of ``NAME.mjs`` for a module ``NAME.wasm``; ``description``: the document of the target "interface"."""
    text = files(__package__).joinpath("glue.mjs").read_text(encoding="utf-8")
    # ASCII, and no text of a user can end a script element of a page that the code is put into
    embedded = json.dumps(description).replace("<", "\\u003c")
    return text.replace('"@heap@"', str(heap)).replace("@name@", name).replace('"@description@"', embedded)


def types(description: Mapping[str, Any]) -> str:
    """The declarations of TypeScript, ``NAME.d.mts``."""
    vectors = description["vectors"]
    named = [line for symbol, called in _NAMED.items() for line in _interface(called, vectors[symbol])]
    functions = (_declared(each, vectors) for each in description["functions"])
    return _TYPES % ("\n".join(named), "\n".join(functions))


def _interface(called: str, vector: Mapping[str, Any]) -> list[str]:
    """An object with a number for every element."""
    values = vector.get("defaults") or [None] * vector["length"]
    lines = [f"export interface {called} {{"]
    for name, unit, value in zip(vector["names"], vector["units"], values, strict=True):
        told = f"{comment(name)} [{comment(unit)}]" + ("" if value is None else f", default {value!r}")
        lines += [f"    /** {told} */", f"    {json.dumps(name)}{'' if value is None else '?'}: number;"]
    return [*lines, "}"]


def _type(symbol: str) -> str:
    return "number" if symbol == "t" else " | ".join(["ArrayLike<number>", *filter(None, [_NAMED.get(symbol)])])


def _declared(function: Mapping[str, Any], vectors: Mapping[str, Any]) -> str:
    arguments = ", ".join(
        f"{symbol}{'?' if symbol == 'p' and _complete(vectors['p']) else ''}: {_type(symbol)}"
        for symbol in function["arguments"]
    )
    outputs = function["outputs"]
    shapes = [f"{' x '.join(map(str, output['shape'])) or '1'}" for output in outputs]
    if len(outputs) == 1:
        return f"    /** {shapes[0]}, row-major */\n    {function['name']}({arguments}): Float64Array;"
    told = "; ".join(f"{json.dumps(o['name'])}: Float64Array" for o in outputs)
    return f"    /** {', '.join(shapes)}, row-major */\n    {function['name']}({arguments}): {{ {told} }};"


def _complete(vector: Mapping[str, Any]) -> bool:
    return not vector["length"] or None not in vector.get("defaults", [None])
