"""The coupled model of a tree: one program with g, Gamma, Q and kinematics, and its certificate.

=====================  ===========  ==========================================================================
output                 shape        meaning
=====================  ===========  ==========================================================================
metric                 n n          g_ab [kg m^2, kg m, kg]
christoffel            n n n        Gamma_abc, first kind, first index = equation
gravity                n            generalised gravity forces
bias                   n            Gamma_abc q'^b q'^c, by recursion (fewer operations than from christoffel)
forces                 n            Q_a: gravity, loads, joint springs and dampers, actuators
inverse_dynamics       n            g_ab q''^b + Gamma_abc q'^b q'^c - Q_a, by recursion
potential_energy                    of gravity (zero at the world's origin) and of all forces that have one [J]
linear_momentum        n 3          momentum of unit velocity q'^a, world axes
angular_momentum       n 3          moment of momentum of unit velocity q'^a about the world's origin, world axes
position               frames 3     origin of every body frame and port in the world [m]
rotation               frames 3 3   from the axes of the frame to those of the world
U, Omega               frames n 3   partial velocities of the origin, partial angular velocities; axes of the frame
closure.*              m ...        of a tree with closures: see :mod:`substructures.tree.closures`
limits                 n 2          lowest and highest value of the coordinates that have limits
=====================  ===========  ==========================================================================

A tree with more than :data:`substructures.part.topology.MOST_CHRISTOFFEL` Christoffel symbols has no christoffel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Any

from substructures.errors import Fault, InvalidDocument, TooLarge, VerificationFailed, listed
from substructures.expr.garbage import without_collections
from substructures.expr.graph import Expr
from substructures.expr.program import Formulas, Program, array, program
from substructures.expr.syntax import RESERVED
from substructures.mechanics.linear3 import Scalar, add, apply, cross, transpose
from substructures.part.certificate import told_agreement
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_NODES, Part, recheck, told_operations
from substructures.part.topology import MOST_CHRISTOFFEL, entries_of, expected_operations
from substructures.tree.assembly import Assembly, assemble, division_by_zero, joint_parents
from substructures.tree.certificate import certify_tree
from substructures.tree.closures import ClosureRows, closure_formulas
from substructures.tree.coupling import Coupled, couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.inverse_dynamics import bias_forces, inverse_dynamics
from substructures.tree.load_potentials import found_potential
from substructures.tree.mounted_part import PlacedPart
from substructures.tree.plausibility import Plausibility
from substructures.tree.units import check_tree_units, tree_warnings

KINEMATICS = ("position", "rotation", "U", "Omega")
EFFORTS = {"R": "N m", "P": "N"}
MOMENTUM = ("linear_momentum", "angular_momentum")


@dataclass(frozen=True)
class Model:
    """A coupled tree. ``frames``: names of bodies and ports in the order of the kinematic outputs; ``closures``: what
    the rows of the closure outputs are; ``parameters``, ``inputs`` (of loads): all that are declared and not bound,
    whether or not a formula depends on them; ``limited``: the coordinates that have limits; ``plausibility``: of
    values, unknown of a model out of a store."""

    program: Program
    coordinates: tuple[str, ...]
    joints: str
    frames: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    certificate: Mapping[str, Any] = field(hash=False)
    closures: tuple[ClosureRows, ...] = ()
    inputs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict, hash=False)
    limited: tuple[str, ...] = ()
    plausibility: Plausibility | None = field(default=None, compare=False, repr=False)

    def __repr__(self) -> str:
        """Two lines: what it is, and what its formulas take and how well they agree with the direct form."""
        loops = f"; closures {listed(rows.name for rows in self.closures)}" if self.closures else ""
        what = f"{self.dof} coordinates ({self.joints or 'none'}): {listed(self.coordinates) or 'none'}{loops}"
        return f"Model, {what}\n{told_operations(self.operations)}; {told_agreement(self.certificate)}"

    @cached_property
    def operations(self) -> dict[str, int]:
        """Arithmetic operations of every output alone; ``total``: of metric, christoffel and forces together."""
        together = [name for name in ("metric", "christoffel", "forces") if name in self.program.outputs]
        return self.program.totals() | {"total": self.program.count(together)["total"]}

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    @cached_property
    def units(self) -> dict[str, str]:
        """The SI units of parameters and inputs by name; empty where none was given."""
        efforts = {f"tau.{name}": EFFORTS[kind] for name, kind in zip(self.coordinates, self.joints, strict=True)}
        declared = {**self.parameters, **self.inputs}
        return {name: str(given.get("unit", "")) for name, given in declared.items()} | efforts

    @cached_property
    def state_units(self) -> dict[str, dict[str, str]]:
        """The SI units of coordinates, velocities and accelerations, by the fields q, qd, qdd and coordinate."""
        rates = {"q": ("rad", "m"), "qd": ("rad/s", "m/s"), "qdd": ("rad/s^2", "m/s^2")}
        pairs = [(name, kind == "P") for name, kind in zip(self.coordinates, self.joints, strict=True)]
        return {field: {name: units[is_slide] for name, is_slide in pairs} for field, units in rates.items()}

    @cached_property
    def effective(self) -> frozenset[str]:
        """The symbols that the formulas depend on."""
        return frozenset(s.name for s in self.program.symbols)

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """All inputs: those in the formulas in the order of the program's symbols, then those without effect."""
        named = [s.name for s in self.program.symbols if s.kind == "input"]
        return tuple(dict.fromkeys([*named, *self.inputs, *(f"tau.{name}" for name in self.coordinates)]))

    def described(self) -> dict[str, Any]:
        """What the axes of the outputs are, as plain data."""
        closures = {"closures": [rows.plain() for rows in self.closures]} if self.closures else {}
        return closures | {
            "coordinates": list(self.coordinates),
            "joints": self.joints,
            "frames": list(self.frames),
            "limited": list(self.limited),
        }

    def summary(self) -> dict[str, Any]:
        """Plain data that is stored beside the program."""
        return self.described() | {
            "parameters": {name: dict(p) for name, p in self.parameters.items()},
            "inputs": {name: dict(given) for name, given in self.inputs.items()},
            "certificate": dict(self.certificate),
            "operations": self.operations,
        }

    @classmethod
    def load(cls, summary: Mapping[str, Any], program_bytes: bytes) -> Model:
        """A stored model. Raises InvalidProgram when the bytes are damaged."""
        names = (tuple(summary["coordinates"]), str(summary["joints"]), tuple(summary["frames"]))
        described = (summary["parameters"], summary["certificate"])
        closures = tuple(ClosureRows.read(plain) for plain in summary.get("closures", ()))
        inputs, limited = summary.get("inputs", {}), tuple(summary.get("limited", ()))
        return cls(Program.from_bytes(program_bytes), *names, *described, closures, inputs, limited)


def require_stored(program: Program, names: Iterable[str]) -> None:
    """Raises InvalidDocument (``not-stored``) for outputs that a model of many coordinates does not have."""
    missing = [name for name in names if name not in program.outputs]
    if missing:
        message = (
            f"of more than {MOST_CHRISTOFFEL:,} Christoffel symbols no formulas are stored, so there is no "
            f"{listed(missing)}, but in numbers by an evaluation of a stored tree; velocity forces are found without "
            "them (bias, inverse_dynamics, forward_dynamics)"
        )
        raise InvalidDocument.at("", "not-stored", message)


def require_open(closures: Sequence[ClosureRows], instead: str) -> None:
    """Raises InvalidDocument (``has-closures``) where closed loops would be ignored; ``instead``: what takes them."""
    if closures:
        names = ", ".join(f"'{rows.name}'" for rows in closures)
        message = (
            f"the closures {names} make the coordinates depend on each other, which is not taken into account here: "
            f"{instead}, or leave the closures out"
        )
        raise InvalidDocument.at("", "has-closures", message)


@without_collections
def couple(
    spec: TreeSpec,
    parts: Mapping[str, Part],
    max_nodes: int = MAX_NODES,
    admit: Callable[[int], None] | None = None,
) -> Model:
    """Couple stored parts (by instance name) to a model and verify it.

    ``admit`` is told how many operations to expect before the work begins, and may raise instead.
    Raises InvalidDocument with pointers into the tree document, TooLarge for more than ``max_nodes`` operations, and
    VerificationFailed, which names the part whose stored formulas are wrong.
    """
    start = perf_counter()
    _require_free_names(spec)
    assembly = assemble(spec, parts)
    units = check_tree_units(spec, {name: part.parameters for name, part in parts.items()})
    units.require()
    joints_of = joint_parents(assembly.mounted)
    entries = entries_of(joints_of)
    entries.require("the tree")
    if admit is not None:
        admit(expected_operations(joints_of))
    names = [
        f"{i.name}.{c}" for i, m in zip(assembly.instances, assembly.mounted, strict=True) for c in m.part.coordinates
    ]
    run = over_formulas(assembly.scope.graph)
    try:
        coupled = couple_parts(run, assembly.mounted, assembly.gravity, not entries.is_large)
        found = found_potential(assembly.scope.graph, coupled.placed, names)
        coupled = replace(coupled, potential=coupled.potential + found)
        outputs = model_outputs(assembly, coupled, *rate_symbols(assembly))
    except ZeroDivisionError:
        raise division_by_zero(spec, assembly) from None
    result = program(assembly.scope.graph, outputs, assembly.scope.symbols)
    if len(result) > max_nodes:
        raise TooLarge("the program of the tree (in operations)", len(result), max_nodes)
    seconds = perf_counter() - start
    joints = "".join(m.part.joints for m in assembly.mounted)
    plausibility = Plausibility(spec, {name: part.definition for name, part in parts.items()})
    warnings = [*units.warnings, *tree_warnings(spec, parts, result, bool(names)), *plausibility.at_defaults]
    rows = tuple(cut.rows for cut in assembly.cuts)
    names_of = (tuple(names), joints, _frame_names(assembly))
    limited = tuple(names[a] for a in sorted(assembly.limits))
    model = Model(result, *names_of, assembly.parameters, {}, rows, assembly.inputs, limited, plausibility)
    definitions = {name: part.definition for name, part in parts.items()}
    try:
        certificate = certify_tree(spec, definitions, model.described(), result, seconds)
    except VerificationFailed as error:
        raise _blamed(parts, error) from None
    return replace(model, certificate={**certificate, "warnings": warnings, "converted": units.converted})


def _blamed(parts: Mapping[str, Part], error: VerificationFailed) -> VerificationFailed:
    """The failure of a part whose stored formulas are wrong, by name; that of the tree where all parts are right."""
    for instance, part in parts.items():
        try:
            recheck(part)
        except VerificationFailed as fault:
            what = f"the stored formulas of '{part.name}' ({part.program.digest}, instance '{instance}') are wrong"
            return VerificationFailed(f"{what}: {fault}")
    return error


def _require_free_names(spec: TreeSpec) -> None:
    """Raises InvalidDocument for parameters whose name means something else: t is the time, pi a number."""
    faults = [
        Fault(f"/parameters/{name}", "reserved-name", f"'{name}' has a fixed meaning in expressions")
        for name in spec.parameters
        if name in RESERVED
    ]
    if faults:
        raise InvalidDocument(faults)


def model_outputs(
    assembly: Assembly,
    coupled: Coupled,
    rates: Sequence[Scalar],
    accelerations: Sequence[Scalar],
    names: frozenset[str] | None = None,
) -> dict[str, Formulas]:
    """The table above, over the scalars of the assembly; ``names``: those that are wanted, and some more."""
    n, placed = len(coupled.gravity), coupled.placed

    def wanted(*some: str) -> bool:
        """Whether all outputs are wanted, or one of these."""
        return names is None or not names.isdisjoint(some)

    outputs = {"metric": Formulas((n, n), coupled.metric, "symmetric")}
    if coupled.christoffel is not None:
        outputs["christoffel"] = Formulas((n, n, n), coupled.christoffel, "christoffel")
    outputs |= {
        "gravity": array((n,), lambda a: coupled.gravity[a]),
        "forces": array((n,), lambda a: coupled.forces[a]),
        "potential_energy": array((), lambda: coupled.potential),
    }
    # by recursion, so that neither needs the Christoffel symbols
    if wanted("bias"):
        bias = bias_forces(placed, rates)
        outputs["bias"] = array((n,), lambda a: bias[a])
    if wanted("inverse_dynamics"):
        inverse = inverse_dynamics(placed, rates, accelerations)
        outputs["inverse_dynamics"] = array((n,), lambda a: inverse[a])
    if wanted(*MOMENTUM):
        outputs |= _momentum(placed, n)
    if assembly.limits and wanted("limits"):
        rows: dict[tuple[int, ...], Scalar] = {
            (a, i): x for a, pair in assembly.limits.items() for i, x in enumerate(pair)
        }
        outputs["limits"] = Formulas((n, 2), rows)
    if assembly.cuts and names is None:
        outputs |= closure_formulas(placed, assembly.cuts, rates)
    return outputs | (_kinematics(placed, n) if wanted(*KINEMATICS) else {})


def rate_symbols(assembly: Assembly) -> tuple[list[Expr], list[Expr]]:
    """The symbols of all velocities and accelerations."""
    rates: list[Expr] = []
    accelerations: list[Expr] = []
    for instance, m in zip(assembly.instances, assembly.mounted, strict=True):
        for joint in m.part.topology.joints:
            name, unit = f"{instance.name}.{joint.coordinate}", "m" if joint.s else "rad"
            rates.append(assembly.scope.declare(f"{name}'", "velocity", f"{unit}/s"))
            accelerations.append(assembly.scope.declare(f"{name}''", "acceleration", f"{unit}/s^2"))
    return rates, accelerations


def _momentum(placed: Sequence[PlacedPart], n: int) -> dict[str, Formulas]:
    """Linear momentum, and angular momentum about the world's origin, in world axes."""
    linear: dict[tuple[int, ...], Scalar] = {}
    angular: dict[tuple[int, ...], Scalar] = {}
    for here in placed:
        for c, momentum in enumerate(here.evaluated.momenta):
            # R_c^T p_c   and   R_c^T H_c + r_c x R_c^T p_c
            pose = here.pose(c)
            back = transpose(pose.R)
            p = apply(back, momentum.p)
            L = add(apply(back, momentum.H), cross(pose.r, p))
            linear |= {(here.first + c, i): p[i] for i in range(3)}
            angular |= {(here.first + c, i): L[i] for i in range(3)}
    return {"linear_momentum": Formulas((n, 3), linear), "angular_momentum": Formulas((n, 3), angular)}


def _kinematics(placed: Sequence[PlacedPart], n: int) -> dict[str, Formulas]:
    entries: dict[str, dict[tuple[int, ...], Scalar]] = {name: {} for name in KINEMATICS}
    f = 0
    for here in placed:
        for frame in range(len(here.part.frames)):
            pose, twists = here.frame_kinematics(frame)
            entries["position"] |= {(f, i): pose.r[i] for i in range(3)}
            # from the axes of the frame to those of the world: R^T
            entries["rotation"] |= {(f, j, i): pose.R[i][j] for i in range(3) for j in range(3)}
            # U_fa, Omega_fa in the axes of the frame f
            entries["U"] |= {(f, a, i): t.U[i] for a, t in twists.items() for i in range(3)}
            entries["Omega"] |= {(f, a, i): t.Omega[i] for a, t in twists.items() for i in range(3)}
            f += 1
    shapes = {"position": (f, 3), "rotation": (f, 3, 3), "U": (f, n, 3), "Omega": (f, n, 3)}
    return {name: Formulas(shapes[name], some) for name, some in entries.items()}


def _frame_names(assembly: Assembly) -> tuple[str, ...]:
    pairs = zip(assembly.instances, assembly.mounted, strict=True)
    return tuple(f"{instance.name}.{frame}" for instance, m in pairs for frame in m.part.frames)
