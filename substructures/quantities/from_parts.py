"""Numbers of a tree straight from its parts: coupling of evaluated formulas instead of evaluation of coupled ones.

The same coupling code runs over floats (one state) or arrays (a batch), so a tree that was put together a moment ago
answers without a symbolic model and without compiling anything: what is compiled are the stored programs of its parts,
once for all trees. The evaluated square commutes with the symbolic one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import MissingValue
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret_entries
from substructures.expr.program import Formulas, Output, Program, array, program
from substructures.mechanics.balls import accelerations
from substructures.mechanics.linear3 import Scalar
from substructures.part.outputs import PartOutputs, Run, over_formulas
from substructures.part.part import Part
from substructures.quantities.numbers.array_scalars import Lanes, Supports, is_array, lanes, plain
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.part_kernels import PartEvaluator, Scalars
from substructures.tree.assembly import assemble
from substructures.tree.coupling import couple_parts
from substructures.tree.document import TreeSpec, require_full, require_ungiven
from substructures.tree.forces.load_potentials import found_potential, has_steady_loads, placed_parts
from substructures.tree.forces.loads import load_formulas
from substructures.tree.model_outputs import model_outputs, rate_symbols
from substructures.tree.mounted_part import MountedPart, balls_in

EQUATIONS = ("metric", "christoffel", "gravity", "forces", "bias", "inverse_dynamics", "potential_energy")
#: the potential of loads that is found by integration, a formula of the tree
FOUND = "found_potential"
#: what the loads of the tree do, formulas of the tree as well
LOADS, LOAD_POTENTIAL = "loads", "load_potential"
#: outputs of the program of placements and bindings that only a quantity needs
ASKED_FOR = {
    "limits": ("limits",),
    "friction": ("friction",),
    "friction_load": ("friction_load",),
    FOUND: ("potential_energy",),
    LOADS: ("forces", "inverse_dynamics"),
    LOAD_POTENTIAL: ("potential_energy",),
}
#: states that are coupled at a time: their numbers stay in the second-level cache
BLOCK = 2048
#: elements of dense Christoffel symbols at a time
DENSE = 20_000_000


def gives(names: Iterable[str]) -> bool:
    """Whether a tree of parts gives these outputs: all but rows of closures, which only the formulas of a tree have."""
    return not any(name.startswith("closure.") for name in names)


class NumericTree:
    """A tree of parts, ready for numbers. ``engine`` evaluates stored programs (default: the reference interpreter).

    Raises InvalidDocument when the tree cannot be put together.
    """

    def __init__(self, spec: TreeSpec, parts: Mapping[str, Part], engine: PartEvaluator = interpret_entries) -> None:
        require_ungiven(spec, "ask for formulas, or for numbers of what the tree has formulas of")
        self.assembly, self.engine = assemble(spec, parts), engine
        require_full(self.assembly.reduced, "ask again")
        pairs = zip(self.assembly.instances, self.assembly.mounted, strict=True)
        self.coordinates = tuple(f"{instance.name}.{name}" for instance, m in pairs for name in m.part.coordinates)
        self._constants = self._constant_program()
        # where nothing is given: parameters have their defaults, inputs, velocities and accelerations are zero
        # tau = 0, t = 0, q' = q'' = 0
        self._rest = {name: 0.0 for name, s in self.assembly.scope.symbols.items() if s.kind == "input"} | {"t": 0.0}
        defaults = {name: p["value"] for name, p in self.assembly.parameters.items() if p["value"] is not None}
        self._rest |= {name: default_number(value) for name, value in defaults.items()}
        self._rest |= {f"{name}{primes}": 0.0 for name in self.coordinates for primes in ("'", "''")}
        self._layouts: dict[str, _Layout] = {}
        self._supports: dict[str, Supports] = {}

    def weight(self) -> int:
        """Operations of the programs that are kept with it."""
        return len(self._constants) + sum(len(m.part.program) for m in self.assembly.mounted)

    def _constant_program(self) -> Program:
        """Placements, gravity and bindings of the tree as one small program of its parameters."""
        outputs = {"gravity": array((3,), lambda i: self.assembly.gravity[i])}
        outputs |= self._of_places()
        limits = list(self.assembly.limits.values())
        outputs["limits"] = array((len(limits), 2), lambda k, i: limits[k][i])
        laws = list(self.assembly.friction.values())
        outputs["friction"] = array((len(laws), 4), lambda k, i: laws[k][i])
        loads = list(self.assembly.friction_load.values())
        outputs["friction_load"] = array((len(loads), 2), lambda k, i: loads[k][i])
        for k, m in enumerate(self.assembly.mounted):
            outputs[f"E.{k}"] = array((3, 3), lambda i, j, m=m: m.E[i][j])
            outputs[f"position.{k}"] = array((3,), lambda i, m=m: m.position[i])
            bound = {name: x for name, x in m.bindings.items() if not (isinstance(x, Expr) and x.op == "sym")}
            outputs |= {f"{k}:{name}": array((), lambda x=x: x) for name, x in bound.items()}
        return program(self.assembly.scope.graph, outputs, self.assembly.scope.symbols)

    def _of_places(self) -> dict[str, Formulas]:
        """Potentials and loads that need the places of bodies, as formulas."""
        loads = self.assembly.reading.spec.loads
        if not (loads or has_steady_loads(self.assembly.mounted)):
            return {}
        graph = self.assembly.scope.graph
        placed = placed_parts(over_formulas(graph), self.assembly.mounted)
        found = found_potential(graph, placed, self.coordinates)
        outputs = {FOUND: array((), lambda: found)}
        if loads:
            acting = load_formulas(self.assembly, placed, rate_symbols(self.assembly)[0])
            n, zero = sum(m.part.joint_count for m in self.assembly.mounted), graph.zero
            outputs[LOADS] = array((n,), lambda a: acting.forces.get(a, zero))
            outputs[LOAD_POTENTIAL] = array((), lambda: acting.potential)
        return outputs

    def evaluate(self, values: Mapping[str, Any], quantities: Sequence[str] = EQUATIONS) -> dict[str, Array]:
        """Outputs of the model (see :mod:`substructures.tree.model`) for values of all symbols: floats, or
        arrays of one length N, in blocks of states. Arrays with the axis N first, without it for floats.
        Raises MissingValue.
        """
        batch = np.broadcast_shapes(*(np.shape(x) for x in values.values())) if values else ()
        result: dict[str, Array] = {}
        if not batch:
            self._block(values, batch, slice(None), quantities, result)
            return result
        arrays = {name: np.asarray(x) for name, x in values.items()}
        size = max(1, min(BLOCK, DENSE // max(1, len(self.coordinates)) ** 3)) if "christoffel" in quantities else BLOCK
        for start in range(0, max(1, batch[0]), size):
            part = slice(start, start + size)
            some = {name: x[part] if x.shape == batch else x for name, x in arrays.items()}
            self._block(some, batch, part, quantities, result)
        return result

    def answer(self, values: Mapping[str, Any], names: Sequence[str], states: int) -> dict[str, Array]:
        """:meth:`evaluate` with the axis of states always first; values are numbers or arrays (states,)."""
        if states == 1:
            values = {name: float(np.asarray(x).reshape(())) for name, x in values.items()}
        found = self.evaluate(values, names)
        return {name: x[None] for name, x in found.items()} if states == 1 else found

    def _block(
        self,
        values: Mapping[str, Any],
        batch: tuple[int, ...],
        part: slice,
        quantities: Sequence[str],
        result: dict[str, Array],
    ) -> None:
        """Fills a part of the batch in the results, which are made by the first one."""
        given = {**self._rest, **values}
        asked = [
            x for x in self._constants.outputs if x not in ASKED_FOR or any(name in quantities for name in ASKED_FOR[x])
        ]
        found = interpret_entries(self._constants, given, asked)
        numbers = {name: _filled(self._constants.outputs[name], x) for name, x in found.items()}
        mounted = tuple(_numeric(m, k, numbers, given) for k, m in enumerate(self.assembly.mounted))
        pairs = numbers.get("limits", [])
        limits = dict(zip(self.assembly.limits, zip(pairs[::2], pairs[1::2], strict=True), strict=False))
        rows = numbers.get("friction", [])
        laws = zip(rows[::4], rows[1::4], rows[2::4], rows[3::4], strict=True)
        friction = dict(zip(self.assembly.friction, laws, strict=False))
        pairs = numbers.get("friction_load", [])
        loads = dict(zip(self.assembly.friction_load, zip(pairs[::2], pairs[1::2], strict=True), strict=False))
        constants: dict[str, Any] = {"limits": limits, "friction": friction, "friction_load": loads}
        assembly = replace(self.assembly, mounted=mounted, gravity=tuple(numbers["gravity"]), **constants)
        # the coupling of formulas (notation.md, section 6), over the numbers that the formulas of the parts have
        coupled = couple_parts(self._run(), mounted, assembly.gravity, "christoffel" in quantities, False)
        potential = numbers.get(FOUND, [0])[0] + numbers.get(LOAD_POTENTIAL, [0])[0]
        coupled = coupled.with_loads(dict(enumerate(numbers.get(LOADS, ()))), potential)
        qd, qdd = ([lanes(given[f"{name}{primes}"]) for name in self.coordinates] for primes in ("'", "''"))
        rates, second = map(coupled.ratios.rates, (qd, qdd))
        second = accelerations(balls_in(coupled.placed), rates, second)
        outputs = model_outputs(assembly, coupled, rates, second, frozenset(quantities))
        for name in quantities:
            if name not in result:
                result[name] = np.zeros((*batch, *outputs[name].shape))
            out = result[name][part] if batch else result[name]
            self._layout(name, outputs[name]).fill(list(outputs[name].entries.values()), out)

    def _run(self) -> Run:
        def run(part: Part, bindings: Mapping[str, Scalar], names: Sequence[str]) -> PartOutputs:
            """Stored outputs of a part in numbers."""
            values = {name: plain(x) for name, x in bindings.items()}
            found, outputs = self.engine(part.program, values, names), part.program.outputs
            if any(map(is_array, values.values())):
                found = self._in_lanes(part.program, values, found)
            return PartOutputs({n: _formulas(outputs[n], found[n]) for n in names})

        return run

    def _in_lanes(
        self, program: Program, values: Mapping[str, Any], found: Mapping[str, Scalars]
    ) -> dict[str, Scalars]:
        """Elements that are the same for all states as numbers, the others as lanes."""
        supports = self._supports.get(program.digest)
        if supports is None:
            supports = self._supports[program.digest] = Supports(program)
        varying = supports.varying(values)
        return {
            name: [
                Lanes(x) if varies else lanes(x.item(0) if is_array(x) and x.size else x)
                for x, varies in zip(some, varying(name), strict=True)
            ]
            for name, some in found.items()
        }

    def _layout(self, name: str, formulas: Formulas) -> _Layout:
        """Where the elements of an output come from; remembered."""
        layout, index = self._layouts.get(name), tuple(formulas.entries)
        if layout is None or layout.index != index:
            layout = self._layouts[name] = _Layout(index, formulas)
        return layout


class _Layout:
    """Where the elements of a dense output come from."""

    def __init__(self, index: tuple[tuple[int, ...], ...], formulas: Formulas) -> None:
        self.index, self.shape = index, formulas.shape
        output = Output(formulas.shape, index, tuple(range(len(index))), formulas.symmetry)
        rows = list(output.expanded())
        places = np.array([i for i, _, _ in rows], dtype=np.int64).reshape(len(rows), len(self.shape))
        self.place = np.ravel_multi_index(places.T, self.shape) if self.shape else np.zeros(len(rows), dtype=np.int64)
        self.source = np.array([k for _, k, _ in rows], dtype=np.int64)
        self.sign = np.array([sign for _, _, sign in rows], dtype=np.float64)

    def fill(self, values: Scalars, out: Array) -> None:
        """Writes the non-zero elements of an array batch + shape."""
        batch = out.shape[: out.ndim - len(self.shape)]
        elements = np.empty((*batch, len(values)))
        for k, value in enumerate(values):
            elements[..., k] = plain(value)
        if out.size:
            # a view: the array is contiguous
            out.reshape((*batch, -1))[..., self.place] = elements[..., self.source] * self.sign


def _formulas(output: Output, values: Scalars) -> Formulas:
    return Formulas(output.shape, dict(zip(output.index, values, strict=True)), output.symmetry)


def _filled(output: Output, values: Scalars) -> Scalars:
    """All elements of a vector, matrix or scalar in a row, zeros included."""
    if not output.shape:
        return [lanes(x) for x in values] or [0]
    known = {index: lanes(x) for index, x in zip(output.index, values, strict=True)}
    return [known.get(index, 0) for index in product(*map(range, output.shape))]


def _numeric(m: MountedPart, k: int, numbers: Mapping[str, Scalars], given: Mapping[str, Any]) -> MountedPart:
    """A mounted part with numbers in place of the expressions of the tree; exact integers stay what they are."""
    E = [_kept(x, number) for x, number in zip(sum(m.E, ()), numbers[f"E.{k}"], strict=True)]
    x, y, z = (_kept(*pair) for pair in zip(m.position, numbers[f"position.{k}"], strict=True))
    try:
        bindings = {
            name: lanes(given[x.value]) if isinstance(x, Expr) and x.op == "sym" else numbers[f"{k}:{name}"][0]
            for name, x in m.bindings.items()
        }
    except KeyError as error:
        raise MissingValue(str(error.args[0])) from None
    rotation = ((E[0], E[1], E[2]), (E[3], E[4], E[5]), (E[6], E[7], E[8]))
    return replace(m, E=rotation, position=(x, y, z), bindings=bindings)


def _kept(x: Any, number: Any) -> Any:
    value = getattr(x, "value", x)
    return value if isinstance(value, int) else number
