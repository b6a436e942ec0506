"""``model.h`` and ``model.c``: sizes, start values and calls of the C functions for the simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod

from substructures.export.contacts import CONTACTS
from substructures.export.exported import Exported, Function
from substructures.export.fmu.tangents import directions
from substructures.export.fmu.variables import TOLERANCE, Layout

_OF_ALL = "double t, const double *q, const double *qd, const double *qdd, const double *u, const double *p"
_OF_STATE = "double t, const double *q, const double *v, const double *u, const double *p"
_TANGENT = "double t, const double *q, const double *v, const double *qdd, const double *u, const double *p"
_DECLARATIONS = (
    "extern const unsigned FMU_SIZES[]; /* numbers of the variable that begins here, or 0 */",
    "extern const unsigned FMU_QUATERNIONS[]; /* where in q each one begins */",
    "void fmu_start(double *q, double *v, double *u, double *p);",
    "/* der(q), der(v) and, where FMU_NA is not 0, the accelerations of all coordinates */",
    f"void fmu_dynamics({_OF_STATE}, double *dq, double *dv, double *qdd);",
    f"void fmu_outputs({_OF_ALL}, double *y);",
    "/* d: the direction, as the values of an instance stand; dx: that of der(q), der(v) and of the accelerations */",
    f"void fmu_dynamics_tangent({_TANGENT}, const double *d, double *dx);",
    f"void fmu_outputs_tangent({_OF_ALL}, const double *d, double *y);",
)
_SEEN = "double *gap, double *rows, double *rate, double *bias, double *acts, double *metric"
_DECLARATIONS_OF_CONTACTS = (
    "extern const int FMU_TANGENTS[];",
    "extern const double FMU_RESTITUTION[], FMU_FRICTION[], FMU_REST_VELOCITY[];",
    "/* (k), (k, 3, n), (k, 3), (k, 3), (k), (n, n): along the normal and two tangents */",
    f"void fmu_contacts({_OF_STATE}, {_SEEN});",
)


def header(layout: Layout, token: str) -> str:
    """``model.h``."""
    vectors = layout.interface.vectors
    sizes = {"NQ": len(vectors["q"]), "NV": len(layout.velocities), "NA": 0 if layout.is_tree else len(vectors["q"])}
    sizes |= {"NU": len(vectors["u"]), "NP": len(vectors["p"])}
    sizes["V"] = layout.begins["v"]
    sizes["NY"] = layout.size - layout.begins["y"]
    lines = ["#ifndef SUBSTRUCTURES_MODEL_H", "#define SUBSTRUCTURES_MODEL_H", "", f'#define FMU_TOKEN "{token}"']
    lines += [f"#define FMU_TOLERANCE {TOLERANCE!r}", f"#define FMU_CONTACTS {len(layout.exported.contacts)}"]
    lines += [f"#define FMU_BALLS {len(layout.quaternions)}", "enum {"]
    lines += [f"    FMU_{name} = {size}," for name, size in sizes.items()]
    more = _DECLARATIONS_OF_CONTACTS if layout.exported.contacts else ()
    return "\n".join([*lines, "};", "", *_DECLARATIONS, *more, "", "#endif", ""])


def source(layout: Layout, core: Exported, tangents: tuple[Function, Function]) -> str:
    """``model.c``; ``core``: all functions in C; ``tangents``: those of the accelerations and of the outputs."""
    sizes = [0] * layout.size
    for each in layout.variables:
        sizes[each.at] = each.size
    lines = ['#include "model.h"', "", f'#include "{core.name}.h"', "", "#include <string.h>", ""]
    lines += ["const unsigned FMU_SIZES[] = {", *_wrapped(map(str, sizes)), "};", ""]
    if layout.quaternions:
        lines += [f"const unsigned FMU_QUATERNIONS[] = {{{', '.join(map(str, layout.quaternions))}}};", ""]
    lines += _start(layout, core)
    lines += _dynamics(layout, core)
    lines += _function(
        f"fmu_outputs({_OF_ALL}, double *y)", "t q qd qdd u p y", _calls(core, list(layout.outputs), "y")
    )
    of_motion, of_outputs = tangents
    # the velocities of a tree are der(q)
    is_plain = layout.is_tree and layout.changes is None
    body = ["memcpy(dx, d + FMU_V, FMU_NQ * sizeof *dx);"] if is_plain else []
    body += _tangent(layout, core, of_motion, "dx + FMU_NQ" if is_plain else "dx")
    head = f"fmu_dynamics_tangent({_TANGENT}, const double *d, double *dx)"
    lines += _function(head, "t q v qdd u p d dx", body)
    head = f"fmu_outputs_tangent({_OF_ALL}, const double *d, double *y)"
    lines += _function(head, "t q qd qdd u p d y", _tangent(layout, core, of_outputs, "y"))
    return "\n".join([*lines, *_contacts(layout, core)])


def _start(layout: Layout, core: Exported) -> list[str]:
    """Zeros, quaternions that turn nothing, and defaults."""
    lines = ["void fmu_start(double *q, double *v, double *u, double *p)", "{"]
    lines += ["    memset(q, 0, FMU_NQ * sizeof *q);", "    if (FMU_NV > 0) memset(v, 0, FMU_NV * sizeof *v);"]
    lines += ["    if (FMU_NU > 0) memset(u, 0, FMU_NU * sizeof *u);"]
    lines += [f"    q[{i}] = 1.0;" for i in layout.quaternions]
    lines += [f"    u[{i}] = {x!r};" for i, x in enumerate(layout.interface.vectors["u"].defaults) if x]
    return [*lines, f"    {core.name}_defaults(p);", "}", ""]


def _contacts(layout: Layout, core: Exported) -> list[str]:
    """Numbers of contacts, and what is seen of them."""
    laws = layout.exported.contacts
    if not laws:
        return []
    seen = next(each for each in layout.exported.functions if each.quantity == CONTACTS)
    numbers: dict[str, list[float | int]] = {
        "int FMU_TANGENTS": [law.tangents for law in laws],
        "double FMU_RESTITUTION": [law.restitution for law in laws],
        "double FMU_FRICTION": [law.friction for law in laws],
        "double FMU_REST_VELOCITY": [law.rest_velocity for law in laws],
    }
    lines = [f"const {name}[] = {{{', '.join(map(repr, values))}}};" for name, values in numbers.items()]
    results = [{"when": "acts", "mass": "metric"}.get(name, name) for name in seen.program.outputs]
    called = f"{core.called(seen)}({', '.join([*_arguments(seen, {'qd': 'v', 'qdd': 'v'}), *results])});"
    head = f"fmu_contacts({_OF_STATE}, {_SEEN})"
    return [*lines, "", *_function(head, "t q v u p", [called])]


def _dynamics(layout: Layout, core: Exported) -> list[str]:
    head = f"fmu_dynamics({_OF_STATE}, double *dq, double *dv, double *qdd)"
    motion, names = layout.motion, "t q v u p dq dv qdd"
    if layout.is_tree:
        moved = "memcpy(dq, v, FMU_NQ * sizeof *dq);"
        if layout.changes is not None:
            (moved,) = _calls(core, [layout.changes], "dq", {"qd": "v"})
        return _function(head, names, [moved, *_calls(core, [motion], "dv", {"qd": "v"})])
    found = {"rates": "dq", "acceleration": "dv", "second": "qdd"}
    results = [found.get(name, "&power") for name in motion.program.outputs]
    own = layout.velocities.place
    x = ", ".join(f"v[{own[name]}]" for name in motion.further.names)
    called = f"{core.called(motion)}({', '.join([*motion.arguments, *results])});"
    return _function(
        head, names, [*([f"const double x[] = {{{x}}};"] if x else []), "double power;", called, "(void)power;"]
    )


def _arguments(function: Function, renamed: Mapping[str, str]) -> list[str]:
    return [renamed.get(symbol, symbol) for symbol in function.arguments]


def _tangent(layout: Layout, core: Exported, function: Function, target: str) -> list[str]:
    """A call with the directions, and quasi-velocities, where the function has them."""
    seeds, own = directions(function, layout.places), layout.velocities.place
    renamed = {} if target == "y" else {"qd": "v"}
    body = [f"double x[{len(seeds)}];"] if seeds else []
    values = [f"v[{own[name]}]" if at is None else f"d[{at}]" for name, at in seeds.items()]
    body += [f"x[{i}] = {value};" for i, value in enumerate(values)]
    return body + _calls(core, [function], target, renamed)


def _function(head: str, names: str, body: Sequence[str]) -> list[str]:
    unused = ", ".join(f"(void){name}" for name in names.split())
    return [f"void {head}", "{", *(f"    {line}" for line in body), f"    {unused};", "}", ""]


def _calls(
    core: Exported, functions: Sequence[Function], target: str, renamed: Mapping[str, str] | None = None
) -> list[str]:
    """Calls that put all outputs one behind the other."""
    lines, at = [], 0
    for function in functions:
        outputs = []
        for array in function.program.outputs.values():
            outputs.append(f"{target} + {at}")
            at += prod(array.shape)
        lines.append(f"{core.called(function)}({', '.join([*_arguments(function, renamed or {}), *outputs])});")
    return lines


def _wrapped(items: Sequence[str] | map[str], width: int = 110) -> list[str]:
    lines, line = [], "   "
    for item in items:
        if len(line) + len(item) > width:
            lines.append(line)
            line = "   "
        line += f" {item},"
    return [*lines, line]
