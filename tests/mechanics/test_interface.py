"""What is stored of a substructure, term by term: coupling evaluated formulas = evaluating coupled ones.

The blocks of notation.md, section 6, from the stored interface functions f, n, K, kappa, F, N in numbers,
against the coupled model of a host and a guest.
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import pytest
from random_trees import GRAVITY, Kind, random_definition, random_states, vector, with_parameters

from substructures import Definition, Model, Part, TreeSpec, couple, derive
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.result import Evaluation

N = 3
Array = Any


@dataclass
class Pair:
    """A guest on a host: the coupled model evaluated, and the guest's stored program evaluated alone."""

    host: Part
    guest: Part
    model: Model
    answer: Evaluation
    stored: dict[str, Array]

    @property
    def n(self) -> int:
        """Coordinates of the host come first."""
        return self.host.dof

    def frame(self, name: str) -> tuple[Array, Array, Array, Array]:
        f, k = (self.answer.frames or ()).index(name), self.answer["kinematics"]
        return k["position"][:, f], k["rotation"][:, f], k["U"][:, f], k["Omega"][:, f]

    @property
    def twist(self) -> tuple[Array, Array]:
        """(U_Ia, Omega_Ia) of the guest's interface for the host's coordinates, in its axes."""
        _, _, U, Omega = self.frame("guest.base")
        return U[:, : self.n], Omega[:, : self.n]


def own_values(part: Part, values: dict[str, Any]) -> dict[str, Any]:
    """Coordinates and parameters, with the own values of the inertia symbols added."""
    x = interpret(part.program, values, ["inertia.m", "inertia.s", "inertia.J"])
    result = dict(values)
    for k, symbols in part.inertia_symbols.items():
        J = x["inertia.J"][:, k]
        six = [J[:, i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
        numbers = [x["inertia.m"][:, k], *x["inertia.s"][:, k].T, *six]
        result |= dict(zip(symbols, numbers, strict=True))
    return result


@pytest.fixture(scope="module", params=range(6))
def pair(request: pytest.FixtureRequest) -> Pair:
    rng = np.random.default_rng(300 + request.param)
    parts = {}
    for name in ("host", "guest"):
        definition = random_definition(rng, Kind(4, massive=True, depth=7), name)
        while not any("coordinate" in b["joint"] for b in definition["bodies"]):
            definition = random_definition(rng, Kind(4, massive=True, depth=7), name)
        parts[name] = derive(Definition.read(with_parameters(rng, definition, 0.5)))
    placement = {"position": vector(rng), "rpy": vector(rng, 3)}
    host, guest = parts["host"], parts["guest"]
    at = f"host.{rng.choice([*host.bodies, *host.ports])}"
    mounts = [("host", "world", {}), ("guest", at, placement)]
    instances = [{"name": n, "substructure": n, "at": place, "placement": p} for n, place, p in mounts]
    model = couple(TreeSpec.read({"name": "t", "gravity": list(GRAVITY), "instances": instances}), parts)
    states = random_states(rng, N, model.dof)
    answer = evaluate(model, ["metric", "christoffel", "gravity", "kinematics"], **states)
    values = {name: float(p["value"]) for name, p in guest.parameters.items()} | {"": np.zeros(N)}
    values |= {c: states["q"][:, host.dof + i] for i, c in enumerate(guest.coordinates)}
    names = [n for n in guest.program.outputs if not n.startswith(("applied", "potential", "load"))]
    return Pair(host, guest, model, answer, interpret(guest.program, own_values(guest, values), names))


def close(found: Array, expected: Array) -> None:
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10 * max(1.0, np.abs(expected).max(initial=0)))


def test_own_metric_and_christoffel_symbols(pair: Pair) -> None:
    n = pair.n
    close(pair.answer["metric"][:, n:, n:], pair.stored["metric"])
    close(pair.answer["christoffel"][:, n:, n:, n:], pair.stored["christoffel"])


def test_metric_by_the_momenta_at_the_interface(pair: Pair) -> None:
    """g_ac = U_Ia . f_c + Omega_Ia . n_c."""
    U, Omega = pair.twist
    found = np.einsum("nai,nci->nac", U, pair.stored["f"]) + np.einsum("nai,nci->nac", Omega, pair.stored["n"])
    close(found, pair.answer["metric"][:, : pair.n, pair.n :])


def test_christoffel_symbols_with_two_host_coordinates(pair: Pair) -> None:
    """Gamma_abc = U_Ia . (Omega_Ib x f_c) + Omega_Ia^T K_c Omega_Ib."""
    U, Omega = pair.twist
    f, K = pair.stored["f"], pair.stored["K"]
    force = np.cross(Omega[:, :, None], f[:, None])
    found = np.einsum("nai,nbci->nabc", U, force) + np.einsum("nai,ncij,nbj->nabc", Omega, K, Omega)
    close(found, pair.answer["christoffel"][:, : pair.n, : pair.n, pair.n :])


def test_christoffel_symbols_with_one_host_coordinate(pair: Pair) -> None:
    """kappa_ac . Omega_Ib for all a < c in the guest; U_Ia . F_bc + Omega_Ia . N_bc for b <= c in the guest."""
    U, Omega = pair.twist
    x, n = pair.stored, pair.n
    gamma = pair.answer["christoffel"]
    kappa = np.einsum("naci,nbi->nabc", x["kappa"], Omega)
    for a, c in combinations(range(pair.guest.dof), 2):
        close(kappa[:, a, :, c], gamma[:, n + a, :n, n + c])
    other = np.einsum("nai,nbci->nabc", U, x["F"]) + np.einsum("nai,nbci->nabc", Omega, x["N"])
    for b in range(pair.guest.dof):
        for c in range(b, pair.guest.dof):
            close(other[:, :, b, c], gamma[:, :n, n + b, n + c])


def test_gravity_by_the_force_at_the_interface(pair: Pair) -> None:
    """Q_c = gamma_I . f_c, and the composite acts on the carrier as additional inertia."""
    _, R, _, _ = pair.frame("guest.base")
    gamma = np.einsum("nji,j->ni", R, np.array(GRAVITY))
    close(np.einsum("nci,ni->nc", pair.stored["f"], gamma), pair.answer["gravity"][:, pair.n :])
    alone = couple(
        TreeSpec.read({"name": "t", "gravity": list(GRAVITY), "instances": [{"name": "host", "substructure": "host"}]}),
        {"host": pair.host},
    )
    q = np.zeros((N, pair.n))
    q[:] = np.random.default_rng(0).uniform(-1, 1, pair.n)
    model = evaluate(pair.model, ["metric", "kinematics"], q=np.hstack([q, np.zeros((N, pair.guest.dof))]))
    values = {name: float(p["value"]) for name, p in pair.guest.parameters.items()} | {"": np.zeros(N)}
    values |= dict.fromkeys(pair.guest.coordinates, 0.0)
    x = interpret(pair.guest.program, own_values(pair.guest, values), [f"composite.{y}" for y in "msJ"])
    f = (model.frames or ()).index("guest.base")
    U, Omega = (model["kinematics"][name][:, f, : pair.n] for name in ("U", "Omega"))
    m, s, J = (x[f"composite.{y}"] for y in "msJ")
    theta = np.trace(J, axis1=1, axis2=2)[:, None, None] * np.eye(3) - J
    mixed = np.einsum("nai,nbi->nab", U, np.cross(Omega, s[:, None]))
    payload = m[:, None, None] * np.einsum("nai,nbi->nab", U, U) + mixed + np.swapaxes(mixed, 1, 2)
    payload += np.einsum("nai,nij,nbj->nab", Omega, theta, Omega)
    close(evaluate(alone, ["metric"], q=q)["metric"] + payload, model["metric"][:, : pair.n, : pair.n])


def test_ports_and_joint_frames_with_respect_to_the_interface(pair: Pair) -> None:
    """R, r, U, Omega of ports, and the body frames at O_c + tau e3."""
    r_I, R_I, _, _ = pair.frame("guest.base")
    x, n = pair.stored, pair.n
    for i, port in enumerate(pair.guest.ports):
        r, R, U, Omega = pair.frame(f"guest.{port}")
        close(x["port.R"][:, i], np.swapaxes(R, 1, 2) @ R_I)
        close(x["port.r"][:, i], np.einsum("nji,nj->ni", R_I, r - r_I))
        close(x["port.U"][:, i], U[:, n:])
        close(x["port.Omega"][:, i], Omega[:, n:])
    frames = list(pair.guest.frames)
    for body, c in pair.guest.topology.carrier.items():
        if c >= 0:
            r, R, _, Omega = pair.frame(f"guest.{body}")
            E, z = x["frame.E"][:, frames.index(body)], x["frame.position"][:, frames.index(body)].copy()
            z[:, 2] += x["tau"][:, c]
            close(E @ x["R"][:, c], np.swapaxes(R, 1, 2) @ R_I)
            place = x["r"][:, c] + np.einsum("nji,nj->ni", x["R"][:, c], z)
            close(place, np.einsum("nji,nj->ni", R_I, r - r_I))
            close(np.einsum("nij,naj->nai", E, x["Omega"][:, c]), Omega[:, n:])


def test_links_put_together_give_the_positions(pair: Pair) -> None:
    """R_c = E_c R_p, r_c = r_p + R_p^T Z_c; E is the product of its stored factors."""
    x = pair.stored
    for c, joint in enumerate(pair.guest.topology.joints):
        p = joint.parent
        R_p = x["R"][:, p] if p >= 0 else np.broadcast_to(np.eye(3), (N, 3, 3))
        r_p = x["r"][:, p] if p >= 0 else np.zeros((N, 3))
        close(x["E"][:, c] @ R_p, x["R"][:, c])
        close(r_p + np.einsum("nji,nj->ni", R_p, x["Z"][:, c]), x["r"][:, c])
