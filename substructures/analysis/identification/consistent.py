"""Inertial parameters of every body that explain a measured motion and belong to a distribution of mass.

Motion determines the base parameters beta = G pi alone, and noise can make them those of no body. Every body has the
pseudo-inertia, of its integrals of dm, x dm and x x^T dm about the origin of its frame,

    P = [J s; s^T m]  >= 0        if and only if there is a distribution of mass >= 0 with m, s and J

(P. M. Wensing, S. Kim and J.-J. E. Slotine, Linear matrix inequalities for physically consistent inertial parameter
identification, IEEE Robotics and Automation Letters 3(1), 2018). What is measured and what was known before give

    minimise  |R (G pi - beta)|^2 + sum over bodies |X - X_0|^2 / d^2      subject to  X >= 0,    R^T R = cov(beta)^-1

with X = S^-1/2 P S^-1/2, S the body's own pseudo-inertia X_0 of before with a hundredth of its radius of gyration in
all directions, and d the relative deviation of what was known. It is solved with the barrier -mu log det X by Newton's
method in a trust region (SciPy) for falling mu, and judged as the convex problem that it is: with the gradient Z in X,
Z >= 0 and tr(Z X) = 0.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy

from substructures.analysis.arguments import positive
from substructures.analysis.identification.base_parameters import BaseParameters
from substructures.analysis.identification.findings import PLACES, ConsistentInertia, Identification, pseudo_inertia
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.regressor_model import RegressorModel

#: by what the squares (1 is one standard deviation) may still fall, and part of a base parameter that counts as known
OPTIMAL, EXACT = 1e-2, 1e-5
#: part of the squared radius of gyration that S has in all directions
ROUND = 0.01


def consistent_inertia(
    base: BaseParameters,
    Y: RegressorModel,
    found: Identification,
    *,
    parameters: Mapping[str, Any] | None = None,
    prior_deviation: float = 1.0,
) -> ConsistentInertia:
    """Consistent inertial parameters of all links nearest to what was identified (see above).

    ``prior_deviation``: relative deviation d of the parameters that the tree has; ``parameters`` as for identify.
    Raises InvalidArgument where the identification failed (``/q``) or values are missing. Source: see above.
    """
    d = positive(prior_deviation, "prior_deviation")
    if found.status != "identified":
        raise InvalidArgument.at("/q", "not-excited", f"nothing consistent follows: {found.message}")
    values = {**default_numbers(Y.parameters), **default_numbers(base.parameters), **(parameters or {})}
    G = np.asarray(interpret(base.program, values, ["grouping"])["grouping"], dtype=np.float64)
    if found.combinations is not None:
        # on closures: their own combinations of these
        place = {name: k for k, name in enumerate(base.names)}
        rows = ([(place[name], c) for name, c in some.items()] for some in found.combinations.values())
        G = np.array([sum((c * G[k] for k, c in row), np.zeros(G.shape[1])) for row in rows])
    pi = np.asarray(interpret(Y.program, values, ["inertial_parameters"])["inertial_parameters"], dtype=np.float64)
    problem = _Problem(Y, G, pi.reshape(-1, 10), found, d)
    return problem.result(problem.solved())


class _Problem:
    """F(X, v) = |R (G pi - beta)|^2 + |X - X_0|^2/d^2; v: parameters of drives."""

    def __init__(self, Y: RegressorModel, G: Array, before: Array, found: Identification, d: float) -> None:
        self.Y, self.before, self.d = Y, before, d
        self.links = tuple(name.removesuffix(".m") for name in Y.names[::10])
        P = pseudo_inertia(before)
        self.free = [k for k, name in enumerate(self.links) if before[k].any() and not name.endswith(".base")]
        self.roots, self.X_0 = list[Array](), list[Array]()
        for k, least in zip(self.free, _least_sizes(P[self.free]), strict=True):
            # what was known may be inconsistent: its positive part is
            sizes, V = np.linalg.eigh(P[k])
            sizes, V = np.linalg.eigh((V * np.maximum(sizes, 0)) @ V.T + ROUND * np.diag(least))
            root = (V * np.sqrt(sizes)) @ V.T
            self.roots.append(root)
            inverse = np.linalg.inv(root)
            self.X_0.append(inverse @ P[k] @ inverse)
        # R = L^-1 D^-1 of the correlations C = L L^T
        deviations = np.maximum(found.deviations, EXACT * (np.abs(found.values) + np.abs(found.values).max(initial=0)))
        known = np.where(found.deviations > 0, found.deviations, 1.0)
        correlation = found.covariance / np.outer(known, known)
        np.fill_diagonal(correlation, 1.0)
        self.R = np.linalg.solve(np.linalg.cholesky(correlation), np.diag(1 / deviations))
        count = len(Y.names)
        fixed = before.copy()
        fixed[self.free] = 0
        self.offset = self.R @ (G[:, :count] @ fixed.ravel() - found.values)
        # R G by the entries of X: pi_k = (S^1/2 X S^1/2)_ij
        blocks = []
        for k, root in zip(self.free, self.roots, strict=True):
            by = np.array([[root[i] @ B @ root[j] for B in BASIS] for i, j in PLACES])
            blocks.append(self.R @ G[:, 10 * k : 10 * k + 10] @ by)
        drives = self.R @ G[:, count:]
        self.A = np.concatenate([*blocks, drives], axis=1) if blocks else drives
        self.drives = drives.shape[1]
        self.x_0 = np.concatenate([np.zeros(0), *(_entries(X) for X in self.X_0)])

    def value(self, x: Array, mu: float) -> float:
        """F - mu log det X, infinite where an X is not positive definite."""
        X, _ = self._matrices(x)
        signs, logarithms = np.linalg.slogdet(X) if len(X) else (np.ones(0), np.zeros(0))
        if (signs <= 0).any() or any(np.linalg.eigvalsh(each)[0] <= 0 for each in X):
            return np.inf
        return float(np.sum((self.A @ x + self.offset) ** 2) + self._prior(x) - mu * logarithms.sum())

    def slope(self, x: Array, mu: float) -> Array:
        """Its derivatives."""
        result = 2 * (self.A.T @ (self.A @ x + self.offset))
        for b, X in enumerate(self._matrices(x)[0]):
            part = slice(10 * b, 10 * b + 10)
            result[part] += 2 * (x[part] - self.x_0[part]) / self.d**2 - mu * _entries(_inverse(X))
        return np.asarray(result, dtype=np.float64)

    def curvature(self, x: Array, mu: float) -> Array:
        """Its second derivatives: of -log det X along B_i and B_j tr(X^-1 B_i X^-1 B_j)."""
        result = 2 * self.A.T @ self.A
        for b, X in enumerate(self._matrices(x)[0]):
            part, inverse = slice(10 * b, 10 * b + 10), _inverse(X)
            own = np.einsum("iab,jba->ij", inverse @ BASIS, inverse @ BASIS)
            result[part, part] += 2 / self.d**2 * np.eye(10) + mu * own
        return np.asarray(result, dtype=np.float64)

    def solved(self) -> Array:
        """X of the free links, and v: minima of F - mu log det X, at most 4 mu above that of F for each link."""
        start = []
        for own in self.X_0:
            # what was known, made round
            sizes, V = np.linalg.eigh(own)
            start.append(_entries((V * np.maximum(sizes, ROUND)) @ V.T))
        x, mu, last = np.concatenate([*start, np.zeros(self.drives)]), 1.0, OPTIMAL / (8 * max(len(self.free), 1))
        while len(x) and mu > last / 10:
            mu = max(mu, last)
            how: dict[str, Any] = {"method": "trust-exact", "jac": self.slope, "hess": self.curvature}
            x = scipy.optimize.minimize(self.value, x, (mu,), options={"gtol": 1e-5, "maxiter": 200}, **how).x
            mu /= 10
        return x

    def result(self, x: Array) -> ConsistentInertia:
        """The parameters with their checks."""
        values = self.before.copy()
        least = np.full(len(self.links), np.nan)
        X, v = self._matrices(x)
        misfit = self.A @ x + self.offset
        gradient, left = self.slope(x, 0.0), 0.0
        for b, (k, each) in enumerate(zip(self.free, X, strict=True)):
            P = self.roots[b] @ each @ self.roots[b]
            values[k] = [P[i, j] for i, j in PLACES]
            least[k] = np.linalg.eigvalsh(each)[0]
            Z = np.tensordot(gradient[10 * b : 10 * b + 10], BASIS, 1)
            # F - F* <= tr(Z X) less the least eigenvalue of Z times tr X*
            left += abs(float(np.sum(Z * each))) + max(-float(np.linalg.eigvalsh(Z)[0]), 0.0) * float(np.trace(each))
        left += float(np.abs(gradient[10 * len(self.free) :] * v).sum())
        inverse = [np.linalg.eigvalsh(pseudo_inertia(values[k]))[0] for k in self.free]
        total = float(misfit @ misfit) + self._prior(x)
        held = tuple(name for k, name in enumerate(self.links) if k not in self.free)
        below = max(-float(min(inverse, default=0.0)), 0.0)
        positive_all = "least eigenvalue of the pseudo-inertia of every body"
        gap = "bound of what the squares could still fall by (Z >= 0, tr(Z X) = 0), over one and their sum"
        checks = (
            Check.at(("consistent", "zero", positive_all, "kg, kg m^2"), below, 0.0),
            Check.at(("optimum", "zero", gap, "1"), left, 0.0, 1 + total, OPTIMAL),
        )
        count = max(len(misfit), 1)
        return ConsistentInertia(
            self.Y.names, self.Y.units, self.links, values.ravel(), self.before.ravel(), least, held,
            float(misfit @ misfit) / count, checks,
        )  # fmt: skip

    def _matrices(self, x: Array) -> tuple[Array, Array]:
        """X (links, 4, 4) and v."""
        entries = x[: 10 * len(self.free)].reshape(-1, 10)
        return np.tensordot(entries, BASIS, 1), x[10 * len(self.free) :]

    def _prior(self, x: Array) -> float:
        return float(np.sum((x[: len(self.x_0)] - self.x_0) ** 2)) / self.d**2


def _basis() -> Array:
    """An orthonormal basis of the symmetric matrices."""
    result = np.zeros((10, 4, 4))
    for k, (i, j) in enumerate(PLACES):
        result[k, i, j] = result[k, j, i] = 1.0 if i == j else np.sqrt(0.5)
    return result


BASIS = _basis()


def _inverse(X: Array) -> Array:
    """X^-1; zero outside of what is allowed, where the search looks before it turns back."""
    result = np.linalg.inv(X) if np.linalg.eigvalsh(X)[0] > 0 else np.zeros_like(X)
    return np.asarray(result, dtype=np.float64)


def _entries(X: Array) -> Array:
    """Coordinates in this basis, (10,)."""
    return np.asarray(np.einsum("kij,ij->k", BASIS, X), dtype=np.float64)


def _least_sizes(P: Array) -> Array:
    """Diagonals (L, 4) of second moments and mass that bodies have in all directions: mass times the squared radius of
    gyration r; without extent r of the largest, without mass what this has with r.
    """
    moments, masses = np.abs(np.trace(P[:, :3, :3], axis1=1, axis2=2)), np.abs(P[:, 3, 3])
    squares = np.divide(moments, masses, out=np.zeros_like(moments), where=masses > 0)
    squares = np.where(squares > 0, squares, squares.max(initial=0) or 1.0)
    masses = np.where(masses > 0, masses, moments / squares)
    return np.stack([*[masses * squares] * 3, masses], axis=1)
