"""Formulas that follow from those of a model: Coriolis matrix, energy, momentum, dynamics and its derivatives."""

from __future__ import annotations

from substructures.certificate.derived.model_formulas import SERVED
from substructures.errors import TooLarge
from substructures.expr.garbage import without_collections
from substructures.expr.hoist import hoisted
from substructures.expr.program import Entries, Formulas, Program
from substructures.mechanics.accelerations import CLOSED
from substructures.part.part import MAX_NODES
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.memo import ProgramCache
from substructures.quantities.numbers.workspace import ID, Workspace, momentum, vector
from substructures.quantities.quantity import DERIVED, PROGRAMS
from substructures.quantities.stored_outputs import require_stored
from substructures.tree.model import Model

#: outputs of a model from which accelerations are computed by numbers: g q'' = Q - Gamma q' q'
DYNAMICS = ("metric", "bias", "forces")


def coriolis(model: Model, max_nodes: int) -> Program:
    """C_ab = Gamma_abc q'^c."""
    require_stored(model.program, ["christoffel"])
    products = sum(1 for _ in model.program.outputs["christoffel"].expanded())
    if products > max_nodes:
        raise TooLarge("the Coriolis matrix (in operations)", products, max_nodes)
    r, entries = Workspace(model), Entries()
    for (a, b, c), gamma in r.elements("christoffel").items():
        # C_ab = sum over c of Gamma_abc q'^c  (notation.md, section 7)
        entries[a, b] = entries.get((a, b), r.graph.zero) + gamma * r.velocity_symbol(c)
    return r.program({"coriolis": Formulas((r.n, r.n), entries)})


def inverse_dynamics(model: Model, _: int) -> Program:
    """g_ab q''^b + Gamma_abc q'^b q'^c - Q_a."""
    r = Workspace(model)
    return r.program({ID: vector(r.inverse_dynamics())})


def kinetic_energy(model: Model, _: int) -> Program:
    """1/2 g_ab q'^a q'^b, and what given motions add."""
    r = Workspace(model)
    return r.program({"kinetic_energy": Formulas((), {(): r.kinetic_energy})})


def generalised_momenta(model: Model, _: int) -> Program:
    """p_a = dL/dq'^a."""
    r = Workspace(model)
    return r.program({"generalised_momenta": vector(r.momenta)})


def lagrangian(model: Model, _: int) -> Program:
    """L = T - V; with ignored coordinates Routh's R."""
    r = Workspace(model)
    return r.program({"lagrangian": Formulas((), {(): r.lagrangian})})


def power(model: Model, _: int) -> Program:
    """Q_a q'^a, not summed."""
    r = Workspace(model)
    return r.program({"power": vector([Q * r.velocity_symbol(a) for a, Q in enumerate(r.vector("forces"))])})


def total_momentum(model: Model, _: int) -> Program:
    """p_a q'^a for the momenta p_a of unit velocities, and the momentum of given motions."""
    r, outputs = Workspace(model), dict[str, Formulas]()
    for kind in ("linear", "angular"):
        entries = Entries(r.elements(f"{kind}_momentum_0") if model.given else {})
        for (a, i), p in r.elements(f"{kind}_momentum").items():
            # p_i = p_ai q'^a: momenta are linear in the velocities
            entries[(i,)] = entries.get((i,), r.graph.zero) + p * r.velocity_symbol(a)
        outputs[kind] = Formulas((3,), entries)
    return r.program(outputs)


CLOSED_DYNAMICS = "closed_dynamics"


@without_collections
def derived(model: Model, quantity: str, max_nodes: int = MAX_NODES) -> Program:
    """A quantity of DERIVED as a program with an output of that name (notation.md, section 7), or CLOSED_DYNAMICS.

    coriolis (n, n): C_ab = Gamma_abc q'^c, g' - 2 C is skew; kinetic_energy (): [J];
    lagrangian (): T - V [J], of the forces that have a potential, with ignored coordinates Routh's function;
    generalised_momenta (n,): p_a = g_ab q'^b = dL/dq'^a, with g_a0 of given motions and momenta;
    inverse_dynamics (n,): g_ab q''^b + Gamma_abc q'^b q'^c - Q_a [N m, N], by recursion;
    forward_dynamics (n,): q'' [rad/s^2, m/s^2] and ``pivots``, see :mod:`.derivatives`;
    power (n,): Q_a q'^a of every coordinate [W], whose sum is dT/dt;
    inverse_metric, christoffel_second_kind, hamiltonian, canonical_equations: :mod:`.canonical`;
    total_momentum: outputs ``linear`` (3,) [kg m/s] and ``angular`` (3,) [kg m^2/s] about the world's origin;
    inverse_dynamics_derivative, forward_dynamics_derivative (n,) beside the quantity itself: along the symbols ``d.*``,
    see :mod:`substructures.quantities.derivatives`;
    closed_dynamics: the outputs DYNAMICS and CLOSED of the model, the part that accelerations on closures need.
    Velocities are the symbols q', accelerations q''. Raises KeyError for another name, TooLarge for more than
    ``max_nodes`` operations, SingularMetric for a metric that is singular in every state, VerificationFailed for a
    program that is not what it has to be (certificate.md, section 4).
    """
    if quantity == CLOSED_DYNAMICS:  # no larger than the model
        return model.program.select([*DYNAMICS, *CLOSED])
    if quantity not in DERIVED:
        raise KeyError(quantity)
    made = PROGRAMS[quantity]
    result = hoisted(made.function(model, max_nodes))
    if len(result) > max_nodes:
        raise TooLarge(f"the program of '{quantity}' (in operations)", len(result), max_nodes)
    more = dict.fromkeys(map(momentum, model.coordinates), "parameter")
    return certified(result, model, SERVED[quantity], quantity, needs=made.needs.split(), more=more)


_programs = ProgramCache()


def kept(model: Model, quantity: str) -> Program:
    """:func:`derived`, once for equal models as long as it is used. Raises as :func:`derived`."""
    return _programs.get(model, quantity, lambda: derived(model, quantity))
