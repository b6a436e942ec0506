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
potential_energy                    of gravity (zero at the world's origin) and of all springs [J]
linear_momentum        n 3          momentum of unit velocity q'^a, world axes
angular_momentum       n 3          moment of momentum of unit velocity q'^a about the world's origin, world axes
position               frames 3     origin of every body frame and port in the world [m]
rotation               frames 3 3   from the axes of the frame to those of the world
U, Omega               frames n 3   partial velocities of the origin, partial angular velocities; axes of the frame
closure.*              m ...        of a tree with closures: see :mod:`substructures.tree.closures`
=====================  ===========  ==========================================================================
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from typing import Any

from substructures.errors import InvalidDocument, TooLarge, VerificationFailed, listed
from substructures.expr.graph import Expr
from substructures.expr.program import Formulas, Program, array, program
from substructures.mechanics.linear3 import Scalar, add, apply, cross, transpose
from substructures.part.certificate import told_agreement
from substructures.part.outputs import over_formulas
from substructures.part.part import MAX_ENTRIES, MAX_NODES, Part, recheck, told_operations
from substructures.part.topology import christoffel_entries
from substructures.tree.assembly import Assembly, assemble, division_by_zero, joint_parents
from substructures.tree.certificate import certify_tree
from substructures.tree.closures import ClosureRows, closure_formulas
from substructures.tree.coupling import Coupled, couple_parts
from substructures.tree.document import TreeSpec
from substructures.tree.inverse_dynamics import bias_forces, inverse_dynamics
from substructures.tree.mounted_part import PlacedPart

KINEMATICS = ("position", "rotation", "U", "Omega")
MOMENTUM = ("linear_momentum", "angular_momentum")


@dataclass(frozen=True)
class Model:
    """A coupled tree. ``frames``: names of bodies and ports in the order of the kinematic outputs; ``closures``: what
    the rows of the closure outputs are."""

    program: Program
    coordinates: tuple[str, ...]
    joints: str
    frames: tuple[str, ...]
    parameters: Mapping[str, Mapping[str, Any]] = field(hash=False)
    certificate: Mapping[str, Any] = field(hash=False)
    closures: tuple[ClosureRows, ...] = ()

    def __repr__(self) -> str:
        """Two lines: what it is, and what its formulas take and how well they agree with the direct form."""
        loops = f"; closures {listed(rows.name for rows in self.closures)}" if self.closures else ""
        what = f"{self.dof} coordinates ({self.joints or 'none'}): {listed(self.coordinates) or 'none'}{loops}"
        return f"Model, {what}\n{told_operations(self.operations)}; {told_agreement(self.certificate)}"

    @cached_property
    def operations(self) -> dict[str, int]:
        """Arithmetic operations of every output alone; ``total``: of metric, christoffel and forces together."""
        return self.program.totals() | {"total": self.program.count(["metric", "christoffel", "forces"])["total"]}

    @property
    def dof(self) -> int:
        """Number of coordinates."""
        return len(self.coordinates)

    def described(self) -> dict[str, Any]:
        """What the axes of the outputs are, as plain data."""
        closures = {"closures": [rows.plain() for rows in self.closures]} if self.closures else {}
        return closures | {
            "coordinates": list(self.coordinates),
            "joints": self.joints,
            "frames": list(self.frames),
        }

    def summary(self) -> dict[str, Any]:
        """Plain data that is stored beside the program."""
        return self.described() | {
            "parameters": {name: dict(p) for name, p in self.parameters.items()},
            "certificate": dict(self.certificate),
            "operations": self.operations,
        }

    @classmethod
    def load(cls, summary: Mapping[str, Any], program_bytes: bytes) -> Model:
        """A stored model. Raises InvalidProgram when the bytes are damaged."""
        names = (tuple(summary["coordinates"]), str(summary["joints"]), tuple(summary["frames"]))
        described = (summary["parameters"], summary["certificate"])
        closures = tuple(ClosureRows.read(plain) for plain in summary.get("closures", ()))
        return cls(Program.from_bytes(program_bytes), *names, *described, closures)


def require_open(closures: Sequence[ClosureRows], instead: str) -> None:
    """Raises InvalidDocument (``has-closures``) where closed loops would be ignored; ``instead``: what takes them."""
    if closures:
        names = ", ".join(f"'{rows.name}'" for rows in closures)
        message = (
            f"the closures {names} make the coordinates depend on each other, which is not taken into account here: "
            f"{instead}, or leave the closures out"
        )
        raise InvalidDocument.at("", "has-closures", message)


def couple(spec: TreeSpec, parts: Mapping[str, Part], max_nodes: int = MAX_NODES) -> Model:
    """Couple stored parts (by instance name) to a model and verify it.

    Raises InvalidDocument with pointers into the tree document, TooLarge for more than ``max_nodes`` operations, and
    VerificationFailed, which names the part whose stored formulas are wrong.
    """
    start = perf_counter()
    assembly = assemble(spec, parts)
    entries = christoffel_entries(joint_parents(assembly.mounted))
    if entries > MAX_ENTRIES:
        raise TooLarge("the tree (in Christoffel symbols)", entries, MAX_ENTRIES)
    try:
        coupled = couple_parts(over_formulas(assembly.scope.graph), assembly.mounted, assembly.gravity)
        outputs = model_outputs(assembly, coupled, *rate_symbols(assembly))
    except ZeroDivisionError:
        raise division_by_zero(spec, assembly) from None
    result = program(assembly.scope.graph, outputs, assembly.scope.symbols)
    if len(result) > max_nodes:
        raise TooLarge("the program of the tree (in operations)", len(result), max_nodes)
    seconds = perf_counter() - start
    names = [
        f"{i.name}.{c}" for i, m in zip(assembly.instances, assembly.mounted, strict=True) for c in m.part.coordinates
    ]
    joints = "".join(m.part.joints for m in assembly.mounted)
    used = {s.name for s in result.symbols}
    parameters = {name: value for name, value in assembly.parameters.items() if name in used}
    rows = tuple(cut.rows for cut in assembly.cuts)
    model = Model(result, tuple(names), joints, _frame_names(assembly), parameters, {}, rows)
    definitions = {name: part.definition for name, part in parts.items()}
    try:
        certificate = certify_tree(spec, definitions, model.described(), result, seconds)
    except VerificationFailed as error:
        raise _blamed(parts, error) from None
    return replace(model, certificate=certificate)


def _blamed(parts: Mapping[str, Part], error: VerificationFailed) -> VerificationFailed:
    """The failure of a part whose stored formulas are wrong, by name; that of the tree where all parts are right."""
    for instance, part in parts.items():
        try:
            recheck(part)
        except VerificationFailed as fault:
            what = f"the stored formulas of '{part.name}' ({part.program.digest}, instance '{instance}') are wrong"
            return VerificationFailed(f"{what}: {fault}")
    return error


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

    outputs = {
        "metric": Formulas((n, n), coupled.metric, "symmetric"),
        "christoffel": Formulas((n, n, n), coupled.christoffel, "christoffel"),
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
