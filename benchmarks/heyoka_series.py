"""Equations of motion as Taylor series of high order, compiled and propagated by heyoka: a peer of our integrators.

F. Biscani, D. Izzo, Revisiting high-order Taylor methods for astrodynamics and celestial mechanics, 2021.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import heyoka

from substructures.analysis.motion.right_hand_side import ACCELERATION, forward_dynamics
from substructures.expr.program import Program
from substructures.tree.model import Model

ARITHMETIC = {"add": "__add__", "sub": "__sub__", "mul": "__mul__", "div": "__truediv__"}


def integrator(model: Model, numbers: Mapping[str, float], tolerance: float) -> Any:
    """heyoka's adaptive integrator of q'' = g^-1 (Q - Gamma q' q'), x = (q, q'); inputs are zero, ``numbers``: of all
    parameters.
    """
    inputs = [s.name for s in model.program.symbols if s.kind == "input"]
    dynamics = forward_dynamics(model, inputs)
    names = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    x = dict(zip(names, heyoka.make_vars(*(f"x{i}" for i in range(len(names)))), strict=True))
    nodes = _expressions(dynamics, x | {name: heyoka.expression(number) for name, number in numbers.items()})
    found = dynamics.outputs[ACCELERATION]
    second = {a: nodes[entry] for (a,), entry in zip(found.index, found.entries, strict=True)}
    rates = [(x[c], x[f"{c}'"]) for c in model.coordinates]
    rates += [(x[f"{c}'"], second.get(a, heyoka.expression(0.0))) for a, c in enumerate(model.coordinates)]
    return heyoka.taylor_adaptive(rates, [0.0] * len(rates), tol=tolerance, compact_mode=True)


def _expressions(program: Program, known: Mapping[str, Any]) -> dict[int, Any]:
    """The operations that the accelerations need, as expressions of heyoka; an operation refers to earlier ones."""
    nodes: dict[int, Any] = {}
    for i in program.reachable([ACCELERATION]):
        op, *rest = program.operations[i]
        if op == "sym":
            nodes[i] = known[program.symbols[rest[0]].name]
        elif op in ("int", "rat"):
            nodes[i] = heyoka.expression(float(Fraction(*map(int, rest))))
        elif op == "powi":
            nodes[i] = nodes[rest[0]] ** float(rest[1])
        elif op == "neg":
            nodes[i] = -nodes[rest[0]]
        elif op in ARITHMETIC:
            nodes[i] = getattr(nodes[rest[0]], ARITHMETIC[op])(nodes[rest[1]])
        else:
            nodes[i] = getattr(heyoka, op)(nodes[rest[0]])
    return nodes
