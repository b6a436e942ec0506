"""Random models beside their plain mechanics: the same definition, state, inputs, and closures, computed twice."""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from independent import value as read
from random_trees import GRAVITY, Kind, Plain, model_of, random_definition
from scipy.integrate import solve_ivp

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.part.topology import topology

from .jets import gradient, slopes, space, values
from .plain_mechanics import Dynamics, Mechanism, angular, turn

Array = Any
HINGES = ("revolute", "revolute", "prismatic")


@dataclass
class Case:
    """A model of one part x and its mechanism; ``names``: numbers of inputs and parameters without instance, and t.

    ``make``: the model, which is made when it is asked for: many cases are drawn to find one.
    """

    make: Callable[[], Model]
    plain: Mechanism
    q: Array
    qd: Array
    names: Plain
    closures: list[Plain] = field(default_factory=list)

    @cached_property
    def model(self) -> Model:
        model = self.make()
        assert list(model.coordinates) == self.coordinates
        return model

    @property
    def coordinates(self) -> list[str]:
        """As the model names them."""
        return [f"x.{c}" for c in self.plain.coordinates]

    @property
    def n(self) -> int:
        return len(self.plain.coordinates)

    @property
    def inputs(self) -> Plain:
        """By the names of the model."""
        known = {s.name for s in self.model.program.symbols if s.kind == "input"}
        full = {f"tau.x.{k[4:]}" if k.startswith("tau.") else f"x.{k}": v for k, v in self.names.items()}
        return {k: v for k, v in full.items() if k in known}

    def values(self, **more: Any) -> Plain:
        """Of the symbols of a program."""
        found = {name: float(p["value"]) for name, p in self.model.parameters.items() if p["value"] is not None}
        found |= {s.name: 0.0 for s in self.model.program.symbols if s.kind == "input"} | self.inputs
        found |= {"t": self.names["t"]} | dict(zip(self.model.coordinates, self.q, strict=True))
        return found | {f"{c}'": x for c, x in zip(self.model.coordinates, self.qd, strict=True)} | more

    def dynamics(self, degree: int = 2, q: Any = None, qd: Any = None, **names: Any) -> Dynamics:
        """Everything with polynomials in q of this degree."""
        x, v = self.q if q is None else q, self.qd if qd is None else qd
        return self.plain.dynamics(space(self.n, degree).variables(x), v, self.names | names)


def random_case(seed: int, kind: Kind, closures: Any = None, gravity: Any = GRAVITY, change: Any = None) -> Case:
    """``closures``: of the generator and the names of bodies the closures of the tree; ``change``: of a definition."""
    rng = np.random.default_rng(77_000 + seed)
    definition: Plain = {"bodies": []}
    while sum(np.size(b["joint"].get("coordinate", [])) for b in definition["bodies"]) < 2:
        definition = random_definition(rng, kind)
    if change is not None:
        definition = change(definition)
    given = closures(rng, [b["name"] for b in definition["bodies"]]) if closures else []
    one = {"name": "x", "definition": definition}
    document = {"name": "t", "gravity": list(gravity), "instances": [one], "closures": given}

    def made() -> Model:
        if not given:
            return model_of(definition, gravity)
        return couple(TreeSpec.read(document), {"x": derive(Definition.read(definition))})

    plain = Mechanism(definition, topology(Definition.read(definition)).coordinates, gravity)
    names = {k: round(float(rng.uniform(-1, 1)), 3) for k in ("u1", "u2", *(f"tau.{c}" for c in plain.coordinates))}
    names |= {k: read(p["value"]) for k, p in definition.get("parameters", {}).items()} | {"t": 0.3}
    q, qd = rng.uniform(-0.9, 0.9, (2, len(plain.coordinates)))
    return Case(made, plain, q, qd, names, list(given))


# --- frames and closures by the words of the contract


def frame(case: Case, poses: Plain, name: str) -> tuple[Array, Array]:
    """Rotation to the world and origin of `world`, x.body or x.port."""
    if name == "world":
        return poses["base"]
    short = name.removeprefix("x.")
    for port in case.plain.definition.get("ports", []):
        if port["name"] == short:
            return placed(poses[port["body"]], port.get("position"), port.get("rotation", {}).get("rpy"))
    return poses[short]


def placed(pose: tuple[Array, Array], position: Any, rpy: Any) -> tuple[Array, Array]:
    R, r = pose
    X, Y, Z = np.eye(3)
    roll, pitch, yaw = (read(x) for x in rpy or (0, 0, 0))
    at = np.array([read(x) for x in position or (0, 0, 0)], dtype=object)
    return R @ turn(Z, yaw) @ turn(Y, pitch) @ turn(X, roll), r + R @ at


ROWS = {"ball": "xyz", "rod": "L", "planar": "z12", "universal": "xyzc", "slider": "xy123", "pin": "xyz12"}


def residuals(case: Case, poses: Plain) -> Array:
    """phi of all closures (without axis), row by row."""
    found = []
    for closure in case.closures:
        A, a = frame(case, poses, closure["from"])
        place = closure.get("placement", {})
        B, b = placed(frame(case, poses, closure.get("to", "world")), place.get("position"), place.get("rpy"))
        d, M = A.T @ (b - a), A.T @ B
        length = closure.get("length", 1)
        rows = {"x": d[0], "y": d[1], "z": d[2], "L": (d @ d - length**2) / (2 * length)}
        rows |= {"1": -M[1, 2], "2": M[0, 2], "3": M[1, 0], "c": M[2, 1]}
        found += [rows[row] for row in ROWS[closure["type"]]]
    return np.array(found, dtype=object)


def jacobian(phi: Array, n: int) -> Array:
    """d phi / dq (m, n), polynomials of a degree less."""
    return np.stack([slopes(phi, a) for a in range(n)], axis=-1)


def constrained(d: Dynamics, G: Array, *, rate: Any = 0.0) -> tuple[Array, Array]:
    """q'' and lambda of g q'' = f + G^T lambda, G q'' = -G' q' - ``rate``, in numbers."""
    n, m, qd = len(d.g), len(G), values(d.qd)
    B = values(G)
    second = np.einsum("kab,a,b->k", gradient(G, range(n)), qd, qd)
    kkt = np.block([[values(d.g), -B.T], [B, np.zeros((m, m))]])
    x = np.linalg.solve(kkt, np.concatenate((values(d.force), -second - rate)))
    return x[:n], x[n:]


def close(case: Case) -> bool:
    """Move the state onto the closures by Newton's method; whether that worked and the rows are independent."""
    for _ in range(50):
        phi = residuals(case, case.plain.poses(_moving(case)))
        G = values(jacobian(phi, case.n))
        if np.abs(values(phi)).max() < 1e-15:
            break
        step = np.linalg.lstsq(G, -values(phi), rcond=None)[0]
        case.q = case.q + step * min(1.0, 0.5 / max(np.abs(step).max(), 1e-300))
    sizes = np.linalg.svd(G, compute_uv=False)
    case.qd = case.qd - np.linalg.pinv(G) @ (G @ case.qd)
    return bool(np.abs(values(phi)).max() < 1e-14 and sizes[-1] > 0.05 and np.abs(case.q).max() < 3)


def _moving(case: Case, degree: int = 2) -> Plain:
    return dict(zip(case.plain.coordinates, space(case.n, degree).variables(case.q), strict=True)) | case.names


def integrated(case: Case, end: float, inputs: Any = None, rows: Any = None) -> Any:
    """A motion from t to t + end by solve_ivp, with multipliers; ``inputs``: of t, numbers by plain names; ``rows``: of
    the case and its dynamics the rows B of constraints on the velocities, in place of closures.
    """
    n = case.n

    def rates(t: float, x: Array) -> Array:
        case.q, case.qd = x[:n], x[n:]
        d = case.dynamics(2 if rows is None else 3, t=t, **(inputs(t) if inputs else {}))
        if rows is None and not case.closures:
            return np.concatenate((x[n:], d.acceleration()))
        B = jacobian(residuals(case, d.poses), n) if rows is None else rows(case, d)
        return np.concatenate((x[n:], constrained(d, B)[0]))

    kept = case.q, case.qd
    span = case.names["t"], case.names["t"] + end
    found = solve_ivp(rates, span, np.concatenate(kept), "DOP853", rtol=1e-9, atol=1e-10, dense_output=True)
    case.q, case.qd = kept
    return found


def angular_columns(R: Array, n: int) -> list[Array]:
    return [angular(R, a) for a in range(n)]
