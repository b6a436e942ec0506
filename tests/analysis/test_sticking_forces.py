"""Forces of joints that stick where they are not unique: the least largest share, by its vertices."""

from __future__ import annotations

import numpy as np
import pytest

from substructures.analysis.closed import sticking_forces
from substructures.analysis.closed.sticking_forces import holding
from substructures.array import Array


def cases(kind: str) -> list[tuple[Array, Array, Array]]:
    """Levers, accelerations without friction and static friction of some joints."""
    rng, found = np.random.default_rng(3), []
    for k, d in [(2, 1), (5, 1), (4, 2), (6, 3), (7, 2), (8, 7)]:
        levers, most = rng.standard_normal((k, d)), rng.uniform(0.5, 3, k)
        if kind == "alike":
            levers[-1], levers[1] = 2 * levers[0], -levers[0]
        if kind == "equal":
            levers, most = np.sign(levers), np.ones(k)
        if kind == "apart":
            levers[: k // 2, d // 2 :] = levers[k // 2 :, : d // 2] = 0
            levers[~levers.any(axis=1), 0] = 1
        found.append((levers, levers @ rng.integers(-2, 3, d).astype(float), most))
    return found


@pytest.mark.parametrize("kind", ["any", "alike", "equal", "apart"])
def test_few_vertices_tell_what_a_linear_program_does(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Shares are unique: the largest is least, then the next largest, and so on."""
    direct = [holding(*case) for case in cases(kind)]
    monkeypatch.setattr(sticking_forces, "MANY", -1)
    for case, (force, used) in zip(cases(kind), direct, strict=True):
        levers, a, most = case
        right, share = holding(*case)
        np.testing.assert_allclose(force, right, atol=1e-12 * max(1.0, np.abs(right).max()))
        np.testing.assert_allclose(levers @ (levers.T @ force), -a, atol=1e-12 * max(1.0, np.abs(a).max()))
        assert used == pytest.approx(share, rel=1e-12, abs=1e-15)
        assert used == pytest.approx(float(np.abs(force / most).max()), abs=1e-15)


def test_one_degree_of_freedom() -> None:
    """What moves by p is held by the same share p / sum_i |b_i| F_s,i of all joints with levers b_i."""
    levers, most, push = np.array([[2.0], [-1.0], [0.5]]), np.array([1.0, 3.0, 2.0]), 3.0
    force, used = holding(levers, levers[:, 0] * push, most)
    share = push / float(np.abs(levers[:, 0]) @ most)
    assert used == pytest.approx(share, rel=1e-14)
    np.testing.assert_allclose(force, -share * most * np.sign(levers[:, 0]), rtol=1e-14)
