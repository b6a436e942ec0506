"""Formulas and numbers from test suites, typed by hand: the Puma 560 and Andrews' squeezer."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from formulas import alone
from random_trees import Plain

from substructures import catalogue
from substructures.expr.graph import Graph
from substructures.expr.parse import parse
from substructures.expr.replay import replay
from substructures.expr.rings.expand import is_zero
from substructures.quantities.numbers.evaluation import evaluate

#: P. Corke, Robotics Toolbox for Python, models/DH/Puma560.py and tests/test_DHRobot.py
PUMA_ROWS = [(0.67183, 0, 90), (0, 0.4318, 0), (0.15005, 0.0203, -90), (0.4318, 0, 90), (0, 0, -90), (0, 0, 0)]
PUMA_MASS = [0, 17.4, 4.8, 0.82, 0.34, 0.09]
PUMA_COM = [(0, 0, 0), (-0.3638, 0.006, 0.2275), (-0.0203, -0.0141, 0.070), (0, 0.019, 0), (0, 0, 0), (0, 0, 0.032)]
PUMA_INERTIA = [
    (0, 0.35, 0),
    (0.13, 0.524, 0.539),
    (0.066, 0.086, 0.0125),
    (1.8e-3, 1.3e-3, 1.8e-3),
    (0.3e-3, 0.4e-3, 0.3e-3),
    (0.15e-3, 0.15e-3, 0.04e-3),
]
PUMA_ARMATURE = [
    200e-6 * 62.6111**2,
    200e-6 * 107.815**2,
    200e-6 * 53.7063**2,
    33e-6 * 76.0364**2,
    33e-6 * 71.923**2,
    33e-6 * 76.686**2,
]
PUMA_M = [
    [3.6594, -0.4044, 0.1006, -0.0025, 0, 0],
    [-0.4044, 4.4137, 0.3509, 0, 0.0024, 0],
    [0.1006, 0.3509, 0.9378, 0, 0.0015, 0],
    [-0.0025, 0, 0, 0.1925, 0, 0],
    [0, 0.0024, 0.0015, 0, 0.1713, 0],
    [0, 0, 0, 0, 0, 0.1941],
]
PUMA_C = [
    [-0.1735, -2.0494, -0.1178, -0.0002, -0.0045, 0.0001],
    [0.6274, 1.1572, 1.9287, -0.0015, -0.0003, 0],
    [-0.3608, -0.7734, -0.0018, -0.0009, -0.0064, 0],
    [0.0011, 0.0005, -0.0001, 0.0002, 0.0002, -0.0001],
    [-0.0002, 0.0028, 0.0046, -0.0002, 0, 0],
    [0.0001, 0, 0, 0, 0, 0],
]


def puma_from_standard_rows() -> Plain:
    """Every standard row Rz(q) Tz(d) Tx(a) Rx(alpha) as a joint, then a fixed body that carries the link.

    The published inertias of links 1 and 3 are those of no rigid body; as values of parameters they are allowed.
    """
    bodies: list[Plain] = []
    parameters: Plain = {}
    for i, (d, a, alpha) in enumerate(PUMA_ROWS):
        parameters |= {f"I{e}{i}": {"value": x} for e, x in zip(("xx", "yy", "zz"), PUMA_INERTIA[i], strict=True)}
        joint = {"type": "revolute", "coordinate": f"q{i + 1}", "tau": d, "armature": PUMA_ARMATURE[i]}
        angle = {90: "pi/2", -90: "-pi/2", 0: 0}[alpha]
        bodies += [
            {"name": f"axis{i}", "parent": f"link{i - 1}" if i else "base", "joint": joint},
            {
                "name": f"link{i}",
                "parent": f"axis{i}",
                "joint": {"type": "fixed", "placement": {"position": [a, 0, 0], "rpy": [angle, 0, 0]}},
                "mass": PUMA_MASS[i],
                "com": list(PUMA_COM[i]),
                "inertia": {e: f"I{e}{i}" for e in ("xx", "yy", "zz")},
            },
        ]
    return {"name": "one", "parameters": parameters, "bodies": bodies}


@pytest.mark.parametrize("source", ["standard rows", "catalogue"])
def test_puma_560(source: str) -> None:
    """M, C, gravity and torques with armature, published to four decimals."""
    definition = puma_from_standard_rows() if source == "standard rows" else catalogue.load("puma560")
    model = alone(definition, [0, 0, -9.81])
    q, qd = [0, math.pi / 4, math.pi, 0, math.pi / 4, 0], [1, 2, 3, 1, 2, 3]
    quantities = ["metric", "coriolis", "gravity", "inverse_dynamics"]
    answer = evaluate(model, quantities, q=q, qd=qd, qdd=qd)
    close = {"rtol": 0, "atol": 5.1e-5}
    np.testing.assert_allclose(answer["metric"], PUMA_M, **close)
    np.testing.assert_allclose(answer["coriolis"], PUMA_C, **close)
    np.testing.assert_allclose(-answer["gravity"], [0, 31.6399, 6.0351, 0, 0.0283, 0], **close)
    tau = [3.1500, 9.4805, 3.6189, 0.1901, 0.3519, 0.5823]
    np.testing.assert_allclose(np.asarray(answer["metric"]) @ qd, tau, **close)
    total = np.asarray(PUMA_C) @ qd + tau + [0, 31.6399, 6.0351, 0, 0.0283, 0]
    np.testing.assert_allclose(answer["inverse_dynamics"], total, rtol=0, atol=1e-3)


SQUEEZER_MASS = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
SQUEEZER_INERTIA = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
SQUEEZER = {
    **{f"m{i}": x for i, x in enumerate(SQUEEZER_MASS, 1)},
    **{f"I{i}": x for i, x in enumerate(SQUEEZER_INERTIA, 1)},
    "rr": 0.007, "ra": 0.00092, "da": 0.0115, "e": 0.02, "ea": 0.01421, "sa": 0.01874, "sb": 0.01043, "ta": 0.02308,
    "tb": 0.00916, "zt": 0.04, "zf": 0.02, "fa": 0.01421, "u": 0.04, "ua": 0.01228, "ub": 0.00449,
}  # fmt: skip


def squeezer_branches() -> Plain:
    """Andrews' squeezer cut open: three branches of two bodies and K3, planar, each in the angles of the literature.

    Mass centres along and across the rods as the published metric has them; only distances matter for it.
    """

    def link(name: str, parent: str, q: str, d: Any, body: int, com: list[Any]) -> Plain:
        joint = {"type": "revolute", "coordinate": q, "d": d}
        return {
            "name": name,
            "parent": parent,
            "joint": joint,
            "mass": f"m{body}",
            "com": com,
            "inertia": {"zz": f"I{body}"},
        }

    # K4 hangs on K5 (angle delta) at the distance zt, turned by phi; cos(phi - pi/2) = sin(phi) in the published g45
    fourth = link("k4", "k5", "phi", "zt", 4, ["e - ea", 0, 0])
    sixth = link("k6", "k7", "om", "u", 6, ["zf - fa", 0, 0])
    fourth["joint"]["phi"] = "-pi/2"
    sixth["joint"]["phi"] = "pi/2"
    bodies = [
        link("k1", "base", "be", 0, 1, ["ra", 0, 0]),
        link("k2", "k1", "th", "rr", 2, ["-da", 0, 0]),
        link("k3", "base", "ga", 0, 3, ["sa", "sb", 0]),
        link("k5", "base", "de", 0, 5, ["ta", "tb", 0]),
        fourth,
        link("k7", "base", "ep", 0, 7, ["ua", "ub", 0]),
        sixth,
    ]
    return {"name": "one", "parameters": {name: {"value": x} for name, x in SQUEEZER.items()}, "bodies": bodies}


def test_andrews_squeezer_metric() -> None:
    """IVP test set, IFToMM A03: all entries of the metric as formulas (the start accelerations: see the catalogue)."""
    definition = squeezer_branches()
    model = alone(definition, [0, 0, 0], definition["parameters"])
    names = [c.removeprefix("x.") for c in model.coordinates]
    expected = {
        ("be", "be"): "m1*ra^2 + m2*(rr^2 - 2*da*rr*cos(th) + da^2) + I1 + I2",
        ("be", "th"): "m2*(da^2 - da*rr*cos(th)) + I2",
        ("th", "th"): "m2*da^2 + I2",
        ("ga", "ga"): "m3*(sa^2 + sb^2) + I3",
        ("phi", "phi"): "m4*(e-ea)^2 + I4",
        ("phi", "de"): "m4*((e-ea)^2 + zt*(e-ea)*sin(phi)) + I4",
        ("de", "de"): "m4*(zt^2 + 2*zt*(e-ea)*sin(phi) + (e-ea)^2) + m5*(ta^2 + tb^2) + I4 + I5",
        ("om", "om"): "m6*(zf-fa)^2 + I6",
        ("om", "ep"): "m6*((zf-fa)^2 - u*(zf-fa)*sin(om)) + I6",
        ("ep", "ep"): "m6*((zf-fa)^2 - 2*u*(zf-fa)*sin(om) + u^2) + m7*(ua^2 + ub^2) + I6 + I7",
    }
    graph = Graph()
    found = replay(model.program, graph, {}, ["metric"])["metric"].entries
    angles = {"be", "th", "ga", "phi", "de", "om", "ep"}
    seen = set()
    for (row, column), text in expected.items():
        i, j = sorted((names.index(row), names.index(column)))
        reference = parse(graph, text, lambda n: graph.symbol(f"x.{n}" if n in angles else n))
        assert is_zero(graph.zero + found[i, j] - reference), (row, column)
        seen.add((i, j))
    assert set(found) == seen
