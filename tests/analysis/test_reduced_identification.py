"""Base parameters of linkages of the reduced level: by hand, by the rank on closures, out of motions."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model, tree_parts
from mechanics.reduced_parts import PARTS

from substructures import catalogue, evaluate
from substructures.analysis.closed.reduced import reduced_equations
from substructures.analysis.equations import dependencies
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.fit import excitation, identify
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel

NAMES = {each["name"]: each for each in PARTS if "ranges" not in each}
GRAVITY = [0, "-9.81", 0]


def tree(name: str, level: str | None = None, gravity: Any = GRAVITY) -> Any:
    definition = NAMES.get(name) or catalogue.load(name)
    instance = {"name": "x", "substructure": name} | ({"level": level} if level else {})
    return {"gravity": gravity, "instances": [instance]}, {name: definition}


def made(name: str) -> tuple[RegressorModel, BaseParameters]:
    Y = regressor(*tree_parts(*tree(name)))
    return Y, base_parameters(Y)


def test_a_four_bar_by_hand() -> None:
    """Three of the crank, three of the rocker, four of the coupler (m, s, J in the plane); a mass at either pin may be
    counted with either link: eight are left.
    """
    _, base = made("crank-rocker")
    assert base.count == 8
    found = base.combinations()
    J = ("x.rocker.Jxx", "x.rocker.Jyy")
    assert found["x.crank.sx"] == {"x.crank.sx": "1", "x.coupler.m": "x.l1", **dict.fromkeys(J, "x.l1/x.l3^2")}
    assert found["x.coupler.sx"] == {"x.coupler.sx": "1", **dict.fromkeys(J, "x.l2/x.l3^2")}
    assert found["x.rocker.sx"] == {"x.rocker.sx": "1", **dict.fromkeys(J, "-1/x.l3")}


@pytest.mark.parametrize("name", NAMES)
def test_as_many_as_motions_on_closures_tell(name: str) -> None:
    """The rank of N^T Y of the tree with closures, in numbers; Y_B beta is Y pi."""
    Y, base = made(name)
    model, full = tree_model(*tree(name)), tree_model(*tree(name, "full"))
    whole = regressor(*tree_parts(*tree(name, "full")))
    rng, start = np.random.default_rng(1), {f"x.{q}": float(x) for q, x in NAMES[name]["start"].items()}
    rows, names = [], model.coordinates
    for _ in range(40):
        q = {c: start[c] + rng.uniform(-0.25, 0.25) for c in names}
        qd, qdd = ({c: rng.uniform(-2, 2) for c in names} for _ in range(2))
        closed = reduced_equations(full, q, qd=qd, independent=names, start=start)
        speeds = np.array(list(qd.values()))
        bent = np.einsum("bjk,j,k", closed.tangent_derivative, speeds, speeds)
        second = closed.tangent @ list(qdd.values()) + bent
        rows.append(closed.tangent.T @ whole.evaluate(closed.q, closed.qd, second)["regressor"])
        found = Y.evaluate(q, qd, qdd)["regressor"]
        np.testing.assert_allclose(found, rows[-1], rtol=0, atol=1e-10)
    sizes = np.linalg.svd(np.concatenate(rows), compute_uv=False)
    assert base.count == int((sizes > 1e-9 * sizes[0]).sum())


def test_they_are_found_in_a_motion() -> None:
    """Of the crank, measured with its torque; the spring, the damper and the rotor of the rocker are known."""
    _, base = made("crank-rocker")
    model, t = tree_model(*tree("crank-rocker")), np.linspace(0, 6, 300)
    q = {"x.phi": 1 + 2 * t + np.sin(3 * t)}
    qd, qdd = {"x.phi": 2 + 3 * np.cos(3 * t)}, {"x.phi": -9 * np.sin(3 * t)}
    tau = {"x.phi": evaluate(model, "inverse_dynamics", q, qd, qdd)["inverse_dynamics"][:, 0]}
    assert excitation(base, q, qd, qdd).is_good
    found = identify(base, q, qd, qdd, tau, model=model)
    defaults = {name: float(p["value"]) for name, p in base.parameters.items()}
    values = {s.name: defaults.get(s.name, 0.3) for s in base.program.symbols}
    np.testing.assert_allclose(found.values, interpret(base.program, values)["base_parameters"], rtol=1e-7, atol=1e-9)


def test_faults_in_combinations_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = dependencies._solved

    def wrong(*given: Any) -> Any:
        """A coefficient that is twice as large."""
        found = right(*given)
        j = next(j for j, row in found.items() if row)
        return {**found, j: {b: x * 2 for b, x in found[j].items()}}

    monkeypatch.setattr(dependencies, "_solved", wrong)
    with pytest.raises(VerificationFailed, match="base_parameters"):
        made("rod")
