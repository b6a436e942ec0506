"""Simulink: a C MEX S-function of level 2 on the functions in C, and the MATLAB command that builds it.

Continuous states are the coordinates and velocities; the input port takes the inputs of the tree, output ports give the
state, then every other quantity with its elements in MATLAB's order, so that ``reshape(y, size)`` is the array. Two
parameters of the block: those of the mechanism, ``NAME_parameters(s)`` of a structure, and the initial state, each
``[]`` for its defaults. (MathWorks,
Developing S-Functions: ``simstruc.h``.)
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import prod

from substructures.errors import InvalidArgument
from substructures.export.c_files import c_core
from substructures.export.exported import Exported, Function
from substructures.export.languages.c import head_of
from substructures.export.languages.matlab import structures
from substructures.export.software import SOFTWARE
from substructures.expr.operations import flat
from substructures.tree.given.ties import require_chains

_DYNAMICS = "forward_dynamics"
_STAND_IN = "// Not executed in Simulink: the tests of the generator have a stand-in for its header alone."


def simulink(exported: Exported, limit: int) -> dict[str, bytes]:
    """The files. Raises InvalidArgument without the accelerations of a tree, TooLarge."""
    name = exported.name
    text = "\n".join([*head_of(exported, SOFTWARE), _STAND_IN, "", *_source(exported), ""])
    named = {file: text.encode() for file, text in structures(exported).items() if file.endswith("_parameters.m")}
    build = f"% builds the S-function {name}_sfun\nmex {name}_sfun.c {name}_simulink.c\n"
    return c_core(exported, limit, f"{name}_simulink") | {
        f"{name}_sfun.c": text.encode(),
        f"{name}_build.m": build.encode(),
        **named,
    }


def _source(exported: Exported) -> list[str]:
    name = exported.name
    dynamics = next((each for each in exported.functions if each.quantity == _DYNAMICS), None)
    if dynamics is None or not exported.interface.vectors["q"].names:
        message = "an S-function needs the accelerations of a tree that moves: make a tree of the part"
        raise InvalidArgument.at("/target", "not-a-tree", message)
    require_chains(exported.interface.vectors["q"].defaults, "take an FMU")
    further = next((each for each in exported.functions if each.further.names), None)
    if further is not None:
        message = f"'{further.quantity}' depends on more than states, inputs and parameters: no output can be that"
        raise InvalidArgument.at("/quantities", "signature", message)
    others = [each for each in exported.functions if each is not dynamics]
    widths = [prod(o.shape) for each in others for o in each.program.outputs.values()]
    n, inputs, p = (len(exported.interface.vectors[symbol]) for symbol in ("q", "u", "p"))
    lines = [f"#define S_FUNCTION_NAME {name}_sfun", "#define S_FUNCTION_LEVEL 2", ""]
    lines += ['#include "simstruc.h"', f'#include "{name}_simulink.h"', "", "#include <string.h>", ""]
    lines += [f"enum {{ NQ = {n}, NU = {inputs}, NP = {p}, PORTS = {1 + len(widths)} }};", ""]
    lines += [line.replace("DEFAULTS", f"{name}_defaults") for line in _SIZES]
    for k, width in enumerate([2 * n, *widths]):
        lines.append(f"    ssSetOutputPortWidth(S, {k}, {width});")
    lines += [*_MIDDLE, "#define MDL_DERIVATIVES", "static void mdlDerivatives(SimStruct *S)", "{", *_STATE]
    lines += ["    real_T *rates = ssGetdX(S);", "    memcpy(rates, qd, NQ * sizeof *rates);"]
    lines += [f"    {_call(exported, dynamics, ['rates + NQ'])}", f"    {_unused('t q qd u p')}", "}", ""]
    lines += ["static void mdlOutputs(SimStruct *S, int_T tid)", "{", *_STATE]
    lines += ["    memcpy(ssGetOutputPortRealSignal(S, 0), q, 2 * NQ * sizeof *q);"]
    if any("qdd" in each.arguments for each in others):
        lines += ["    double qdd[NQ];", f"    {_call(exported, dynamics, ['qdd'])}"]
    port = 1
    for each in others:
        body, port = _outputs(exported, each, port)
        lines += ["    {", *body, "    }"]
    lines += [f"    {_unused('t q qd u p tid')}", "}", ""]
    return [*lines, *_END]


def _call(exported: Exported, function: Function, outputs: Sequence[str]) -> str:
    return f"{exported.called(function)}({', '.join([*function.arguments, *outputs])});"


def _outputs(exported: Exported, function: Function, port: int) -> tuple[list[str], int]:
    """A call, and its arrays, whose last index runs first, with the first one first."""
    lines, names, after = [], [], list[str]()
    for array in function.program.outputs.values():
        size, signal = prod(array.shape), f"ssGetOutputPortRealSignal(S, {port})"
        if len(array.shape) < 2:
            names.append(signal)
        else:
            order = [flat(tuple(reversed(i)), array.shape) for i in product(*map(range, reversed(array.shape)))]
            lines += [f"        static double y{port}[{size}];"]
            lines += [f"        static const unsigned order{port}[] = {{{', '.join(map(str, order))}}};"]
            after += [f"        for (int i = 0; i < {size}; ++i) {signal}[i] = y{port}[order{port}[i]];"]
            names.append(f"y{port}")
        port += 1
    return [*lines, f"        {_call(exported, function, names)}", *after], port


def _unused(names: str) -> str:
    return " ".join(f"(void){name};" for name in names.split())


_SIZES = (
    "#define MDL_CHECK_PARAMETERS",
    "static void mdlCheckParameters(SimStruct *S)",
    "{",
    "    size_t p = mxGetNumberOfElements(ssGetSFcnParam(S, 0)), x = mxGetNumberOfElements(ssGetSFcnParam(S, 1));",
    '    if (p != 0 && p != NP) ssSetErrorStatus(S, "the parameters have the wrong length");',
    '    else if (x != 0 && x != 2 * NQ) ssSetErrorStatus(S, "the initial state has the wrong length");',
    "}",
    "",
    "static const double *parameters(SimStruct *S, double *p)",
    "{",
    "    if (mxGetNumberOfElements(ssGetSFcnParam(S, 0)) == NP && NP > 0) return mxGetPr(ssGetSFcnParam(S, 0));",
    "    DEFAULTS(p);",
    "    return p;",
    "}",
    "",
    "static void mdlInitializeSizes(SimStruct *S)",
    "{",
    "    ssSetNumSFcnParams(S, 2);",
    "    if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) return;",
    "    mdlCheckParameters(S);",
    "    if (ssGetErrorStatus(S) != NULL) return;",
    "    ssSetNumContStates(S, 2 * NQ);",
    "    ssSetNumDiscStates(S, 0);",
    "    if (!ssSetNumInputPorts(S, NU > 0)) return;",
    "    if (NU > 0) {",
    "        ssSetInputPortWidth(S, 0, NU);",
    "        ssSetInputPortRequiredContiguous(S, 0, 1);",
    "        ssSetInputPortDirectFeedThrough(S, 0, 1);",
    "    }",
    "    if (!ssSetNumOutputPorts(S, PORTS)) return;",
)
_MIDDLE = (
    "    ssSetNumSampleTimes(S, 1);",
    "    ssSetOptions(S, SS_OPTION_EXCEPTION_FREE_CODE);",
    "}",
    "",
    "static void mdlInitializeSampleTimes(SimStruct *S)",
    "{",
    "    ssSetSampleTime(S, 0, CONTINUOUS_SAMPLE_TIME);",
    "    ssSetOffsetTime(S, 0, 0.0);",
    "}",
    "",
    "#define MDL_INITIALIZE_CONDITIONS",
    "static void mdlInitializeConditions(SimStruct *S)",
    "{",
    "    const mxArray *given = ssGetSFcnParam(S, 1);",
    "    real_T *x = ssGetContStates(S);",
    "    memset(x, 0, 2 * NQ * sizeof *x);",
    "    if (mxGetNumberOfElements(given) == 2 * NQ) memcpy(x, mxGetPr(given), 2 * NQ * sizeof *x);",
    "}",
    "",
)
_STATE = (
    "    double defaults[NP + 1];",
    "    const double *p = parameters(S, defaults), *q = ssGetContStates(S), *qd = q + NQ;",
    "    const double *u = NU > 0 ? ssGetInputPortRealSignal(S, 0) : defaults;",
    "    double t = ssGetT(S);",
)
_END = (
    "static void mdlTerminate(SimStruct *S)",
    "{",
    "    (void)S;",
    "}",
    "",
    "#ifdef MATLAB_MEX_FILE",
    '#include "simulink.c"',
    "#else",
    '#include "cg_sfun.h"',
    "#endif",
)
