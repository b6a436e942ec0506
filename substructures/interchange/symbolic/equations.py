"""The equations of motion of a model in the classes of sympy.physics.mechanics."""

from __future__ import annotations

from typing import Any

import sympy
from sympy.physics.mechanics import Linearizer
from sympy.physics.mechanics.system import SymbolicSystem
from sympy.physics.vector import dynamicsymbols

from substructures.interchange.symbolic.expressions import dynamic_symbols, to_sympy
from substructures.tree.given.ties import require_chains
from substructures.tree.model import Model


def symbolic_system(model: Model) -> Any:
    """A ``SymbolicSystem`` with g u' = Q - Gamma u u and q' = u, speeds named ``u.`` and the coordinate.

    It has the mass matrix, the right-hand side and the inputs that PyDy and its users take. Raises as ``to_sympy``.
    """
    require_chains(model.balls)
    t = dynamicsymbols._t
    q = [sympy.Function(name)(t) for name in model.coordinates]
    u = [sympy.Function(f"u.{name}")(t) for name in model.coordinates]
    speeds = {f"{name}'": each for name, each in zip(model.coordinates, u, strict=True)}
    metric, bias, forces = (
        to_sympy(model, name, dynamic=True, symbols=speeds) for name in ("metric", "bias", "forces")
    )
    return SymbolicSystem(
        [*q, *u],
        sympy.Matrix(forces - bias),
        speeds=u,
        mass_matrix=sympy.Matrix(metric),
        coordinate_derivatives=sympy.Matrix(u),
    )


def linearizer(model: Model) -> Any:
    """A ``Linearizer`` of the model; ``.linearize(op_point=..., A_and_B=True)`` is SymPy's. Raises as ``to_sympy``.

    Coordinates are q(t), speeds their derivatives, inputs ``.r``, as of a ``LagrangesMethod``.
    """
    require_chains(model.balls)
    named = dynamic_symbols(model.coordinates)
    q, u, a = (sympy.Matrix([named[name + stroke] for name in model.coordinates]) for stroke in ("", "'", "''"))
    metric, bias, forces = (to_sympy(model, name, dynamic=True) for name in ("metric", "bias", "forces"))
    t = dynamicsymbols._t
    inputs = [sympy.Function(name)(t) for name in model.input_names if name in model.effective]
    nothing = sympy.Matrix()
    return Linearizer(
        u, -u, sympy.Matrix(metric * a), sympy.Matrix(bias - forces), sympy.zeros(model.dof, 1), nothing, nothing,
        nothing, q, u, q_i=q, u_i=u, r=inputs,
    )  # fmt: skip
