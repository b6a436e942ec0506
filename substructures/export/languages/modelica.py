"""Modelica: a package of functions ``name_metric(q, p)``, and, with ``inverse_dynamics``, a model with flanges."""

from __future__ import annotations

import re
from collections.abc import Iterable
from math import isnan
from typing import ClassVar

from substructures.errors import InvalidArgument
from substructures.export.exported import KEYWORDS, Exported
from substructures.export.languages.code import Code, head, indented
from substructures.export.languages.named import members
from substructures.printers.language import Listing, Piece
from substructures.printers.names import comment

#: names of the model Mechanism
_TAKEN = frozenset(["der", "time", "loads", "q", "qd", "u", "p", "Modelica", "Mechanism"])


class Modelica(Code):
    """Modelica 3.4; needs the standard library for the flanges."""

    media = "text/x-modelica; charset=utf-8"
    mark = "//"
    suffix = ".mo"
    first = 1
    infinity = "Modelica.Constants.inf"
    executed: ClassVar[str] = ""
    has_names = True

    @classmethod
    def constant(cls, name: str, place: int) -> str:
        """A constant of the package."""
        return f"constant Integer {name} = {place};"

    @classmethod
    def opening(cls, exported: Exported) -> str:  # noqa: ARG003 -- of the base
        """Nothing."""
        return ""

    def pi(self) -> Piece:
        """pi as a double."""
        return Piece("3.141592653589793")

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A package. Raises InvalidArgument for a parameter without a default, which a model needs."""
        body = [line for each in functions for line in (*each, "")]
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed)), f"package {exported.name}"]
        return "\n".join(
            [*lines, *indented([*cls.constants(exported), *body, *_model(exported)]), f"end {exported.name};", ""]
        )

    def define(self, listing: Listing) -> list[str]:
        """A function."""
        lines = [f"function {self.called}"]
        lines += [f"    input Real {v.symbol}" + (";" if v.symbol == "t" else f"[{len(v)}];") for v in self.vectors()]
        for output, array in self.program.outputs.items():
            shape = f"[{', '.join(map(str, array.shape))}]" if array.shape else ""
            lines.append(f"    output Real {self.variables[output]}{shape};")
        named = self.named(self.texts(listing))
        lines += ["protected", *(f"    Real {name};" for name, _ in named)]
        lines += [*(f"    Real t{n};" for n, _ in listing.temporaries), "algorithm"]
        body = [f"{name} := {element};" for name, element in named]
        body += [f"t{n} := {text};" for n, text in listing.temporaries]
        for output, array in self.program.outputs.items():
            name = self.variables[output]
            zeros = f"zeros({', '.join(map(str, array.shape))})" if array.shape else "0.0"
            body += [f"{name} := {zeros};", *(f"{element} := {text};" for element, text in self.pairs(output, listing))]
        return [*lines, *indented(body), f"end {self.called};"]


def _unit(unit: str) -> str:
    """A unit as Modelica writes it: points for products; empty where it cannot."""
    plain = unit.replace(" ", ".").replace("*", ".").replace("^", "")
    return plain if re.fullmatch(r"[A-Za-z0-9./-]*", plain, re.ASCII) and plain.count("/") < 2 else ""


def _model(exported: Exported) -> list[str]:
    """Accelerations by inverse dynamics as an equation; a flange for every coordinate."""
    if all(each.quantity != "inverse_dynamics" for each in exported.functions):
        return []
    q, u, p = (exported.interface.vectors[s] for s in ("q", "u", "p"))
    missing = [name for name, x in zip(p.names, p.defaults, strict=True) if isnan(x)]
    if missing:
        message = f"the parameter '{missing[0][:80]}' has no default: bind it to a number"
        raise InvalidArgument.at("/bind", "missing", message)
    named = members(p, lambda name: name in KEYWORDS or name in _TAKEN, 1)
    lines = ["model Mechanism"]
    lines += [
        f'    parameter Real {each.name}(unit="{_unit(unit)}") = {each.value!r} "{comment(name)}";'
        for each, name, unit in zip(named, p.names, p.units, strict=True)
    ]
    values = f"{{{', '.join(each.name for each in named)}}}" if named else "fill(0.0, 0)"
    lines += ["protected", f"    parameter Real p[{len(p)}] = {values};", "public"]
    lines += [f"    Real q[{len(q)}];", f"    Real qd[{len(q)}];", f"    Real u[{len(u)}];"]
    loads = len(u) - len(q)
    if loads:
        lines.append(f"    input Real loads[{loads}];")
    equations = ["der(q) = qd;", f"{exported.name}_inverse_dynamics(time, q, qd, der(qd), u, p) = zeros({len(q)});"]
    equations += [f"u[{i + 1}] = loads[{i + 1}];" for i in range(loads)]
    for i, unit in enumerate(q.units):
        kind, place, force = ("Rotational", "phi", "tau") if unit == "rad" else ("Translational", "s", "f")
        lines.append(f"    Modelica.Mechanics.{kind}.Interfaces.Flange_a flange{i + 1};")
        equations += [f"flange{i + 1}.{place} = q[{i + 1}];", f"flange{i + 1}.{force} = u[{loads + i + 1}];"]
    return [*lines, "equation", *indented(equations), "end Mechanism;"]
