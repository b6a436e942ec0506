"""Geodesics of the metric: motions on which no force acts, q''^a + Gamma^a_bc q'^b q'^c = 0.

They are the lines of stationary length, of ds^2 = g_ab dq^a dq^b = 2 T dt^2 (H. Hertz's straightest paths); T is
constant along them.
"""

from __future__ import annotations

from dataclasses import replace

from substructures.expr.graph import Graph
from substructures.expr.program import Formulas, program
from substructures.expr.replay import replay
from substructures.tree.model import Model

#: outputs that are zero without forces, and that of which only the velocity forces are left
ZERO, EFFECTS, BIAS = ("forces", "gravity", "potential_energy"), "nonlinear_effects", "bias"


def without_forces(model: Model) -> Model:
    """The same mechanism without gravity, loads, friction, stops and inputs; outputs that contain them are left out."""
    source = model.program
    kept = [name for name in source.outputs if name not in (*ZERO, EFFECTS, "inverse_dynamics")]
    outputs = replay(source, graph := Graph(), {}, kept)
    outputs |= {name: Formulas(source.outputs[name].shape, {}) for name in ZERO if name in source.outputs}
    if EFFECTS in source.outputs:
        outputs[EFFECTS] = outputs[BIAS]
    return replace(model, program=program(graph, outputs, {s.name: s for s in source.symbols}))
