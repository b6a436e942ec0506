"""``model.h`` and ``model.c``: sizes, start values and calls of the C functions for the simulation."""

from __future__ import annotations

from collections.abc import Sequence
from math import prod

from substructures.export.exported import Exported, Function
from substructures.export.fmu.tangents import directions
from substructures.export.fmu.variables import TOLERANCE, Layout
from substructures.quantities.quantity import FORWARD

_OF_ALL = "double t, const double *q, const double *qd, const double *qdd, const double *u, const double *p"
_OF_STATE = "double t, const double *q, const double *qd, const double *u, const double *p"
_DECLARATIONS = (
    "extern const unsigned FMU_SIZES[]; /* numbers of the variable that begins here, or 0 */",
    "void fmu_start(double *q, double *qd, double *u, double *p);",
    f"void fmu_dynamics({_OF_STATE}, double *qdd);",
    f"void fmu_outputs({_OF_ALL}, double *y);",
    "/* d: the direction, as the values of an instance stand */",
    f"void fmu_dynamics_tangent({_OF_ALL}, const double *d, double *dqdd);",
    f"void fmu_outputs_tangent({_OF_ALL}, const double *d, double *y);",
)


def header(layout: Layout, token: str) -> str:
    """``model.h``."""
    vectors = layout.interface.vectors
    sizes = {"NQ": len(vectors["q"]), "NU": len(vectors["u"]), "NP": len(vectors["p"])}
    sizes["NY"] = layout.size - layout.begins["y"]
    lines = ["#ifndef SUBSTRUCTURES_MODEL_H", "#define SUBSTRUCTURES_MODEL_H", "", f'#define FMU_TOKEN "{token}"']
    lines += [f"#define FMU_TOLERANCE {TOLERANCE!r}", "enum {"]
    lines += [f"    FMU_{name} = {size}," for name, size in sizes.items()]
    return "\n".join([*lines, "};", "", *_DECLARATIONS, "", "#endif", ""])


def source(layout: Layout, core: Exported, tangents: tuple[Function, Function]) -> str:
    """``model.c``; ``core``: all functions in C; ``tangents``: those of the accelerations and of the outputs."""
    sizes = [0] * layout.size
    for each in layout.variables:
        sizes[each.at] = each.size
    dynamics = next(each for each in layout.exported.functions if each.quantity == FORWARD)
    lines = ['#include "model.h"', "", f'#include "{core.name}.h"', "", "#include <string.h>", ""]
    lines += ["const unsigned FMU_SIZES[] = {", *_wrapped(map(str, sizes)), "};", ""]
    lines += ["void fmu_start(double *q, double *qd, double *u, double *p)", "{"]
    lines += ["    memset(q, 0, FMU_NQ * sizeof *q);", "    memset(qd, 0, FMU_NQ * sizeof *qd);"]
    lines += ["    if (FMU_NU > 0) memset(u, 0, FMU_NU * sizeof *u);"]
    lines += [f"    u[{i}] = {x!r};" for i, x in enumerate(layout.interface.vectors["u"].defaults) if x]
    lines += [f"    {core.name}_defaults(p);", "}", ""]
    lines += _function(f"fmu_dynamics({_OF_STATE}, double *qdd)", "t q qd u p qdd", _calls(core, [dynamics], "qdd"))
    lines += _function(
        f"fmu_outputs({_OF_ALL}, double *y)", "t q qd qdd u p y", _calls(core, list(layout.outputs), "y")
    )
    names = "t q qd qdd u p d"
    for called, tangent, result in zip(("dynamics", "outputs"), tangents, ("qdd", "y"), strict=True):
        target = "dqdd" if result == "qdd" else result
        seeds = directions(tangent, layout.places)
        body = [f"static const unsigned from[] = {{{', '.join(map(str, seeds))}}};"] if seeds else []
        body += (
            [f"double x[{len(seeds)}];", f"for (int i = 0; i < {len(seeds)}; ++i) x[i] = d[from[i]];"] if seeds else []
        )
        body += _calls(core, [tangent], target)
        head = f"fmu_{called}_tangent({_OF_ALL}, const double *d, double *{target})"
        lines += _function(head, f"{names} {target}", body)
    return "\n".join(lines)


def _function(head: str, names: str, body: Sequence[str]) -> list[str]:
    unused = ", ".join(f"(void){name}" for name in names.split())
    return [f"void {head}", "{", *(f"    {line}" for line in body), f"    {unused};", "}", ""]


def _calls(core: Exported, functions: Sequence[Function], target: str) -> list[str]:
    """Calls that put all outputs one behind the other."""
    lines, at = [], 0
    for function in functions:
        outputs = []
        for array in function.program.outputs.values():
            outputs.append(f"{target} + {at}")
            at += prod(array.shape)
        lines.append(f"{core.called(function)}({', '.join([*function.arguments, *outputs])});")
    return lines


def _wrapped(items: Sequence[str] | map[str], width: int = 110) -> list[str]:
    lines, line = [], "   "
    for item in items:
        if len(line) + len(item) > width:
            lines.append(line)
            line = "   "
        line += f" {item},"
    return [*lines, line]
