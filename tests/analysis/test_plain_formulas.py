"""Formulas of analyses at random trees against exact derivatives of poses and energies, which share nothing with them:
curvature, Routh's reduction, adjoint equations, velocity constraints, closures.
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import seeds
from independent import value as read
from random_trees import Kind, Plain, with_parameters

from substructures.analysis.closed.loops import loop_state
from substructures.analysis.control.adjoint import adjoint_equations
from substructures.analysis.control.problem import Cost
from substructures.analysis.equations.curvature import curvature_values
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.routh import routh
from substructures.analysis.simulate import Closed, Linear
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate

from .compared import HINGES, Case, close, constrained, jacobian, random_case, residuals
from .jets import gradient, space, values
from .plain_constraints import constraint_rows, random_closures, random_constraints, random_velocities
from .plain_mechanics import riemann


def same(found: Any, expected: Any, tolerance: float = 1e-9) -> None:
    """Relative to the largest element."""
    expected = np.asarray(expected, dtype=float)
    size = max(float(np.abs(expected).max(initial=0)), 1e-3)
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * size)


@pytest.mark.parametrize("seed", seeds(2, 16))
def test_curvature_of_larger_trees(seed: int) -> None:
    """R_abcd from R^a_bcd = d_c Gamma^a_bd - ..., up to seven coordinates, with chains of massless bodies."""
    case = random_case(seed, Kind(6, massive=True, depth=7, chain=seed % 2 == 0, loads=0, springs=0))
    d = case.dynamics(3)
    found = curvature_values(case.model, case.q)
    same(found.riemann, riemann(d))
    inverse = np.linalg.inv(values(d.g))
    same(found.ricci, np.einsum("ac,abcd->bd", inverse, riemann(d)))
    second = np.einsum("ae,ebc->abc", inverse, values(d.gamma))
    same(found.christoffel_second, second)


def on_a_turntable(slides: bool) -> Any:
    """A definition with a turntable, on a lift too, under all bodies: its coordinates are cyclic without loads."""

    def change(definition: Plain) -> Plain:
        bodies = [b | {"parent": "table"} if b["parent"] == "base" else b for b in definition["bodies"]]
        loads = [load | {"from": load["from"] | {"body": "table"}} for load in definition["loads"]]
        joint = {"type": "revolute", "coordinate": "f"}
        inertia = {"xx": 1, "yy": 1, "zz": 1}
        table: Plain = {"name": "table", "parent": "lift" if slides else "base", "joint": joint, "inertia": inertia}
        table["mass"] = 1
        lift = [{"name": "lift", "parent": "base", "joint": {"type": "prismatic", "coordinate": "h"}}]
        return definition | {"bodies": [*lift[: int(slides)], table, *bodies], "loads": loads, "ports": []}

    return change


@pytest.mark.parametrize("seed", seeds((0, 3), 30))
def test_routh(seed: int) -> None:
    """h, its Christoffel symbols, B as the curl of p_c g_cc^-1 g_cr, V_p, R, and the accelerations of the whole."""
    slides = bool(seed % 2)
    kind = Kind(4, joints=(*HINGES, "universal"), massive=True, depth=5, loads=0, springs=0)
    gravity = (0, 0, 0) if slides else (0, 0, -9.3)
    case = random_case(1000 + seed, kind, gravity=gravity, change=on_a_turntable(slides))
    case.names |= dict.fromkeys(set(case.names) - {"t"}, 0.0)
    reduced = routh(case.model)
    names = list(case.model.coordinates)
    c, r = ([names.index(x) for x in some] for some in (reduced.cyclic, reduced.coordinates))
    assert len(c) >= 1 + slides
    d = case.dynamics(3)
    g, V, qd = values(d.g), float(values(d.V)), case.qd
    p, v = (g @ qd)[c], qd[r]
    out = interpret(reduced.program, case.values(**{f"p.{names[a]}": x for a, x in zip(c, p, strict=True)}))
    inverse, cr = np.linalg.inv(g[np.ix_(c, c)]), g[np.ix_(c, r)]
    same(out["metric"], g[np.ix_(r, r)] - cr.T @ inverse @ cr)
    same(out["amended_potential"], V + p @ inverse @ p / 2)
    same(out["routhian"], qd @ g @ qd / 2 - V - p @ qd[c])
    same(out["cyclic_velocities"], qd[c])
    carried = np.einsum("abc,b,c->a", out["christoffel"], v, v)
    same(np.linalg.solve(out["metric"], out["forces"] - carried - out["gyroscopic"] @ v), d.acceleration()[r])
    # d_x h_ab and d_x (p_c g_cc^-1 g_cb) for the remaining coordinates x
    K, dg = inverse @ cr, gradient(d.g, r)
    dh = (
        dg[np.ix_(r, r)] - np.einsum("abx,bc->acx", dg[np.ix_(r, c)], K) - np.einsum("ba,bcx->acx", K, dg[np.ix_(c, r)])
    )
    dh = dh + np.einsum("ba,bcx,cd->adx", K, dg[np.ix_(c, c)], K)
    same(carried, np.einsum("abc,b,c->a", dh - dh.transpose(2, 0, 1) / 2, v, v))
    slope = np.einsum("c,cbx->bx", p @ inverse, dg[np.ix_(c, r)] - np.einsum("cdx,db->cbx", dg[np.ix_(c, c)], K))
    same(out["gyroscopic"], slope - slope.T)


@pytest.mark.parametrize("seed", seeds(2, 30))
def test_adjoint_formulas(seed: int) -> None:
    """dH/d(q, q', u, p) of H = l + lambda_q q' + lambda_qd q'' with q'' from the equations of motion; the ends."""
    rng = np.random.default_rng(seed)
    kind = Kind(4, chain=seed % 3 == 0, joints=(*HINGES, "universal"), massive=True, depth=4)
    case = random_case(2000 + seed, kind, change=lambda d: with_parameters(np.random.default_rng(seed), d, 0.25))
    model, n = case.model, case.n
    inputs = [s.name for s in model.program.symbols if s.kind == "input" and s.name.startswith("tau.")]
    controls, varied = ([str(x) for x in rng.permutation(some)[:2]] for some in (inputs, list(model.parameters)))
    first, last = model.coordinates[0], model.coordinates[-1]
    running = f"{controls[0]}^2*{first} + sin({last})*{first}' + t*{last}'^2" + "".join(
        f"+{x}*{first}^2" for x in varied
    )
    terminal = f"{first}'^2 + cos({last})" + "".join(f"*{x}" for x in varied)
    equations = adjoint_equations(model, controls, Cost(running, terminal), varied)
    # polynomials in q, q', u, p
    S = space(2 * n + len(controls) + len(varied), 3)
    q, qd = S.variables(case.q), S.variables(case.qd, n)
    plain = [name.replace("x.", "") for name in controls]
    some = dict(zip(plain, S.variables([case.names[x] for x in plain], 2 * n), strict=True))
    some |= dict(zip(varied, S.variables([case.names[x] for x in varied], 2 * n + len(controls)), strict=True))
    d = case.plain.dynamics(q, qd, case.names | some)
    every, qdd = range(S.count), d.acceleration()
    # g dq'' = -d(g q'' + Gamma q' q' - Q) at fixed q''
    slope = -np.linalg.solve(values(d.g), gradient(d.g @ qdd.astype(object) - d.force, every))
    known = case.names | some | dict(zip(case.plain.coordinates, q, strict=True))
    known |= {f"{c}_dot": x for c, x in zip(case.plain.coordinates, qd, strict=True)}
    known = {name.replace("tau.", "tau_"): x for name, x in known.items()}
    cost, end = (read(text.replace("tau.x.", "tau_").replace("x.", ""), known) for text in (running, terminal))
    lq, lqd = rng.uniform(-1, 1, (2, n))
    dH = gradient(cost, every) + lqd @ slope
    dH[n : 2 * n] += lq
    given = [
        ("lambda.", "", lq),
        ("lambda.", "'", lqd),
        ("mu.", "", np.linalg.solve(values(d.g), lqd)),
        ("", "''", qdd),
    ]
    costates = {name: x for a, b, some in given for name, x in zip(equations.names(a, b), some, strict=True)}
    out = interpret(equations.program, case.values(**costates, **{"lambda.0": 1.0}))
    found = [-out["adjoint_q"], -out["adjoint_qd"], out["control_gradient"], out["parameter_gradient"]]
    same(np.concatenate(found), dH)
    same(out["hamiltonian"], cost.value + lq @ case.qd + lqd @ qdd)
    at_end = [out["terminal_q"], out["terminal_qd"], np.zeros(len(controls)), out["terminal_parameters"]]
    same(np.concatenate(at_end), gradient(end, every))


def well_determined(rng: Any, seed: int) -> tuple[Case, list[Any], dict[str, str] | None]:
    """A case, independent constraints, and quasi-velocities (or none) that determine the velocities well."""
    joints = (*HINGES, "free") if seed % 3 == 0 else HINGES
    for attempt in range(100):
        kind = Kind(5, chain=seed % 2 == 0, joints=joints, massive=True, depth=7, loads=2)
        case = random_case(30_000 + 100 * seed + attempt, kind)
        constraints = random_constraints(rng, case, seed % 5)
        d = case.dynamics(3)
        try:
            rows, _ = constraint_rows(case, d, constraints)
        except ValueError:
            continue
        chosen = random_velocities(rng, case, case.n - len(rows)) if seed % 2 else None
        own = [constraint_rows(case, d, [Linear("v", text)])[0] for text in chosen.values()] if chosen else []
        sizes = np.linalg.svd(values(np.concatenate([*own, rows])), compute_uv=False)
        if len(rows) < case.n and sizes[-1] > 0.02 * sizes[0]:
            return case, constraints, chosen
    raise AssertionError("no constraints were independent")


@pytest.mark.parametrize("seed", seeds(5, 60))
def test_velocity_equations(seed: int) -> None:
    """Linear, knife-edge and rolling constraints in quasi-velocities of all kinds: T, g*, forces, both biases by the
    accelerations with multipliers, forces of constraint, structure coefficients, energies, power, gap.
    """
    rng = np.random.default_rng(seed)
    case, constraints, chosen = well_determined(rng, seed)
    d, n = case.dynamics(3), case.n
    rows, gap = constraint_rows(case, d, constraints)
    place = dict(zip(case.model.coordinates, case.q, strict=True))
    equations = quasi_velocity_equations(case.model, constraints, velocities=chosen, near=place)
    texts = chosen.values() if chosen else equations.velocities
    Y, _ = constraint_rows(case, d, [Linear("v", text) for text in texts])
    inverse, p = np.linalg.inv(values(np.concatenate([Y, rows]))), len(Y)
    v, T = rng.uniform(-1, 1, p), inverse[:, :p]
    case.qd = T @ v
    d = case.dynamics(3)
    qdd, multipliers = constrained(d, rows)
    dv = values(Y) @ qdd + np.einsum("kab,a,b->k", gradient(Y, range(n)), case.qd, case.qd)
    more = dict(zip(equations.velocities, v, strict=True))
    more |= {f"{name}'": x for name, x in zip(equations.velocities, dv, strict=True)}
    out = interpret(equations.program, case.values(**more))
    g, Q = values(d.g), values(d.Q)
    for name, expected in (("T", T), ("rates", case.qd), ("metric", T.T @ g @ T), ("forces", T.T @ Q)):
        same(out[name], expected)
    for bias in ("bias", "hamel_bias"):
        same(np.linalg.solve(out["metric"], out["forces"] - out[bias]), dv)
    same(out["constraints"].T @ out["multipliers"], values(rows).T @ multipliers)
    same(out["kinetic_energy"], case.qd @ g @ case.qd / 2)
    same(out["potential_energy"], values(d.V))
    same(out["lost_power"], (Q + gradient(d.V, range(n))) @ case.qd)
    if gap is not None:
        same(out["gaps"][0], values(gap))
    else:
        # c^k_ij = -(d_b Y_ka - d_a Y_kb) X_i^b X_j^a
        turning = np.einsum("kab,bi,aj->kij", gradient(np.concatenate([Y, rows]), range(n)), T, T)
        same(out["structure"], turning.transpose(0, 2, 1) - turning)


def closed_case(seed: int, **more: Any) -> Case:
    """A random chain whose loops can be closed near by."""
    kind = Kind(6, chain=True, joints=(*HINGES, "universal"), massive=True, depth=7)
    for attempt in range(20):
        case = random_case(10_000 + 100 * seed + attempt, kind, random_closures, **more)
        if close(case):
            return case
    raise AssertionError("no loop could be closed")


@pytest.mark.parametrize("seed", seeds(2, 40))
def test_closures_at_a_state_and_as_velocity_constraints(seed: int) -> None:
    """q'' and multipliers of the equations with G^T lambda; the closure as a constraint on the velocities has both."""
    case = closed_case(seed)
    d = case.dynamics(3)
    qdd, multipliers = constrained(d, jacobian(residuals(case, d.poses), case.n))
    state = {"qd": case.qd, "inputs": case.inputs, "t": case.names["t"]}
    found = loop_state(case.model, case.q, **state)
    same(found.consistent.q, case.q, 1e-12)
    same(found.qdd, qdd)
    same(found.multipliers, multipliers)
    same(evaluate(case.model, ["forward_dynamics"], q=case.q, **state)["forward_dynamics"], qdd)
    place, names = dict(zip(case.model.coordinates, case.q, strict=True)), list(case.model.coordinates)
    equations = quasi_velocity_equations(case.model, [Closed(c["name"]) for c in case.closures], near=place)
    index = [names.index(v.removesuffix("'")) for v in equations.velocities]
    more = {f"{names[a]}'": case.qd[a] for a in index} | {f"{names[a]}''": qdd[a] for a in index}
    out = interpret(equations.program, case.values(**more))
    same(out["rates"], case.qd)
    for bias in ("bias", "hamel_bias"):
        same(np.linalg.solve(out["metric"], out["forces"] - out[bias]), qdd[index], 1e-8)
    same(out["multipliers"], multipliers, 1e-8)
