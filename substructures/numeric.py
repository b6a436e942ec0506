"""Numbers of a tree straight from its parts: coupling of evaluated formulas instead of evaluation of coupled ones.

The same coupling code runs over floats (one state) or arrays (a batch), so a tree that was put together a moment ago
answers without a symbolic model and without compiling anything. The evaluated square commutes with the symbolic one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.bias import bias_forces
from substructures.coupling import Coupled, Mounted, Run, couple_parts
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Output, Program, array, program
from substructures.mechanics.linear3 import S
from substructures.mounting import assemble
from substructures.part import Part
from substructures.stored import Stored
from substructures.tree import TreeSpec

Array = NDArray[np.float64]
Engine = Callable[[Program, Mapping[str, Any], Sequence[str]], dict[str, Array]]
EQUATIONS = ("metric", "christoffel", "gravity", "forces", "bias", "potential_energy")


class NumericTree:
    """A tree of parts, ready for numbers. ``engine`` evaluates stored programs (default: the reference interpreter).

    Raises InvalidDocument when the tree cannot be put together.
    """

    def __init__(self, spec: TreeSpec, parts: Mapping[str, Part], engine: Engine = interpret) -> None:
        self.assembly, self.engine = assemble(spec, parts), engine
        pairs = zip(self.assembly.instances, self.assembly.mounted, strict=True)
        self.coordinates = tuple(f"{instance.name}.{name}" for instance, m in pairs for name in m.part.coordinates)
        self._constants = self._constant_program()

    def _constant_program(self) -> Program:
        """Placements, gravity and bindings of the tree as one small program."""
        outputs = {"gravity": array((3,), lambda i: self.assembly.gravity[i])}
        for k, m in enumerate(self.assembly.mounted):
            outputs[f"E.{k}"] = array((3, 3), lambda i, j, m=m: m.E[i][j])
            outputs[f"position.{k}"] = array((3,), lambda i, m=m: m.position[i])
            outputs |= {f"{k}:{name}": array((), lambda x=x: x) for name, x in m.bindings.items()}
        return program(self.assembly.scope.graph, outputs, self.assembly.scope.symbols)

    def evaluate(self, values: Mapping[str, Any], quantities: Sequence[str] = EQUATIONS) -> dict[str, Array]:
        """Equations for values of all symbols (coordinates, velocities, parameters, inputs; floats, or arrays of one
        length N): metric (N, n, n), christoffel (N, n, n, n), gravity, forces, bias (N, n), potential_energy (N,);
        without the axis N for floats. Raises MissingValue.
        """
        batch = np.broadcast_shapes(*(np.shape(x) for x in values.values())) if values else ()
        inputs = {name: 0.0 for name, s in self.assembly.scope.symbols.items() if s.kind == "input"}
        rates = {f"{name}'": 0.0 for name in self.coordinates}
        constants = interpret(self._constants, {**inputs, **rates, "t": 0.0, **values})
        mounted = [_numeric(m, k, constants) for k, m in enumerate(self.assembly.mounted)]
        gravity = tuple(_scalars(constants["gravity"], 1))
        wanted = "christoffel" in quantities
        coupled = couple_parts(self._run(), mounted, (gravity[0], gravity[1], gravity[2]), wanted)
        result = _dense(coupled, batch, [q for q in quantities if q != "bias"])
        if "bias" in quantities:
            given = {**rates, **values}
            found = bias_forces(mounted, coupled.states, [given[f"{name}'"] for name in self.coordinates])
            result["bias"] = _stacked(found, batch)
        return result

    def _run(self) -> Run:
        def run(part: Part, bindings: Mapping[str, S], names: Sequence[str]) -> Stored:
            dense = self.engine(part.program, bindings, names)
            return Stored({name: _sparse(part.program.outputs[name], dense[name]) for name in names})

        return run


def _scalars(x: Array, axes: int) -> list[Any]:
    """The elements along the last axis: floats, or arrays of shape (N,)."""
    flat = x.reshape(*x.shape[: x.ndim - axes], -1)
    return flat.tolist() if flat.ndim == 1 else list(np.moveaxis(flat, -1, 0))


def _sparse(output: Output, dense: Array) -> Formulas:
    """The independent entries of an output as floats or arrays of shape (N,)."""
    axes = len(output.shape)
    if not output.index:
        return Formulas(output.shape, {}, output.symmetry)
    flat = dense.reshape(*dense.shape[: dense.ndim - axes], -1)
    where = np.ravel_multi_index(np.array(output.index).T, output.shape) if axes else np.zeros(1, dtype=np.int64)
    picked: Any = flat[..., where]
    values = picked.tolist() if picked.ndim == 1 else list(np.moveaxis(picked, -1, 0))
    return Formulas(output.shape, dict(zip(output.index, values, strict=True)), output.symmetry)


def _numeric(m: Mounted, k: int, constants: Mapping[str, Array]) -> Mounted:
    """A mounted part with numbers in place of the expressions of the tree; exact integers stay what they are."""
    E = [_kept(x, number) for x, number in zip(sum(m.E, ()), _scalars(constants[f"E.{k}"], 2), strict=True)]
    x, y, z = (_kept(*pair) for pair in zip(m.position, _scalars(constants[f"position.{k}"], 1), strict=True))
    bindings = {name: _scalars(constants[f"{k}:{name}"], 0)[0] for name in m.bindings}
    return Mounted(
        m.part, m.host, m.frame, ((E[0], E[1], E[2]), (E[3], E[4], E[5]), (E[6], E[7], E[8])), (x, y, z), bindings
    )


def _kept(x: Any, number: Any) -> Any:
    value = getattr(x, "value", x)
    return value if isinstance(value, int) else number


def _stacked(values: Sequence[Any], batch: tuple[int, ...]) -> Array:
    result = np.zeros((*batch, len(values)))
    for a, value in enumerate(values):
        result[..., a] = value
    return result


def _dense(coupled: Coupled, batch: tuple[int, ...], quantities: Sequence[str]) -> dict[str, Array]:
    n = len(coupled.gravity)
    sparse = {
        "metric": ((n, n), coupled.metric, "symmetric"),
        "christoffel": ((n, n, n), coupled.christoffel, "christoffel"),
    }
    result: dict[str, Array] = {}
    for name in quantities:
        if name in sparse:
            shape, entries, symmetry = sparse[name]
            index = tuple(entries)
            output = Output(shape, index, tuple(range(len(index))), symmetry)
            values = [entries[i] for i in index]
            dense: Any = np.zeros((*batch, *shape))
            for i, k, sign in output.expanded():
                dense[(..., *i)] = values[k] if sign > 0 else -values[k]
            result[name] = dense
        elif name == "potential_energy":
            result[name] = np.broadcast_to(np.asarray(coupled.potential, dtype=np.float64), batch).copy()
        else:
            result[name] = _stacked(coupled.gravity if name == "gravity" else coupled.forces, batch)
    return result
