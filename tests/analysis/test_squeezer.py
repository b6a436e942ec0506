"""Andrews' squeezer against published values, from one catalogue entry and from coupled parts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import SQUEEZER, at, closed_entry, tree_model
from random_trees import Plain
from simulated import simulated

from substructures import Model, catalogue
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import ClosedMotion, Integrator, simulate

from .closed_motions import METHODS, right

#: F. Mazzia, F. Iavernaro, C. Magherini, Test Set for IVP Solvers; IFToMM benchmark A03: start, and values at 0.03 s
START = [-0.0617138900142764496, 0, 0.455279819163070380, 0.222668390165885885, 0.487364979543842550]
START += [-0.222668390165885885, 1.23054744454982119]
END = [15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948, 0.5244099658805304]
END += [0.5347301163226948, 1.048080741042263]


def squeezer_in_one_piece() -> tuple[Model, Plain, np.ndarray, np.ndarray]:
    """The catalogue entry with its loops closed; request, start and end in its coordinates."""
    pins = [{"name": f"pin{k}", "type": "pin", "from": "x.end2", "to": f"x.end{k}"} for k in (3, 4, 6)]
    model = closed_entry("andrews-squeezer", pins)
    start, end = (at(model, **dict(zip(SQUEEZER, x, strict=True))) for x in (START, END))
    return model, {}, start, end


def squeezer_from_parts() -> tuple[Model, Plain, np.ndarray, np.ndarray]:
    """Three catalogue arms of two links (K1 K2, K5 K4, K7 K6) and the lever K3 with its spring, coupled and closed.

    Arms of the catalogue have everything on the first axis: the angles of K4, K6 and K7 differ by a right angle.
    """
    whole = catalogue.load("andrews-squeezer")
    lever = next(body for body in whole["bodies"] if body["name"] == "K3")
    lever = lever | {"joint": {"type": "revolute", "coordinate": "gamma"}}
    spring = whole["loads"][1] | {"to": {"body": "base", "at": ["xc - xb", "yc - yb", 0]}}
    names = ("m3", "I3", "xb", "yb", "xc", "yc", "c0", "l0", "ss", "sa", "sb", "sc", "sd")
    parameters = {name: whole["parameters"][name] for name in names}
    end3 = {"name": "end", "body": "K3", "position": [0, "-ss", 0]}
    k3 = {"name": "lever", "parameters": parameters, "bodies": [lever], "ports": [end3], "loads": [spring]}
    arms: Plain = {
        "k12": {"l1": "rr", "c1": "ra", "l2": "-d", "c2": "-da", "m1": "m1", "m2": "m2", "I1": "I1", "I2": "I2"},
        "k54": {"l1": "zt", "c1": "sqrt(ta^2 + tb^2)", "l2": "e", "c2": "e - ea"}
        | {"m1": "m5", "m2": "m4", "I1": "I5", "I2": "I4"},
        "k76": {"l1": "u", "c1": "sqrt(ua^2 + ub^2)", "l2": "zf", "c2": "zf - fa"}
        | {"m1": "m7", "m2": "m6", "I1": "I7", "I2": "I6"},
    }
    shared = {n: p for n, p in whole["parameters"].items() if n not in ("mom", "c0", "l0")}
    places = {"k12": [0, 0, 0], "k54": ["xa", "ya", 0], "k76": ["xa", "ya", 0]}
    instances = [
        {"name": k, "substructure": "planar-2r", "placement": {"position": places[k]}, "parameters": arms[k]}
        for k in arms
    ]
    instances.append({"name": "k3", "substructure": "lever", "placement": {"position": ["xb", "yb", 0]}})
    ends = {"k3": "k3.end", "k54": "k54.flange", "k76": "k76.flange"}
    pins = [{"name": k, "type": "pin", "from": "k12.flange", "to": end} for k, end in ends.items()]
    document = {"parameters": shared, "instances": instances, "closures": pins}
    model = tree_model(document, {"planar-2r": catalogue.load("planar-2r"), "lever": k3})

    def arranged(x: list[float]) -> np.ndarray:
        be, th, ga, phi, de, om, ep = x
        right = np.pi / 2
        return np.array([be, th, de, phi - right, ep - right, om + right, ga])

    return model, {"inputs": {"tau.k12.q1": 0.033}}, arranged(START), arranged(END)


@pytest.mark.parametrize("build", [squeezer_in_one_piece, squeezer_from_parts])
def test_andrews_squeezer(build: Any) -> None:
    model, request, start, end = build()
    first = loop_state(model, **request, q=start)
    assert first.mobility.degrees_of_freedom == 1
    expected = np.zeros(7)
    expected[:2] = 14222.4439199541138, -10666.8329399655854
    np.testing.assert_allclose(first.qdd, expected, rtol=1e-9, atol=1e-6)
    motion = simulated(model, **request, q=start, span=(0, 0.03), count=4)
    right(motion)
    np.testing.assert_allclose(motion.q[-1], end, rtol=1e-7)


def test_both_methods_agree() -> None:
    model, _, start, _ = squeezer_in_one_piece()
    ends = [simulate(model, start, (0, 0.01), kind=ClosedMotion(reduction=method)).q[-1] for method in METHODS]
    np.testing.assert_allclose(*ends, rtol=1e-8, atol=1e-10)


@pytest.mark.parametrize("method", ["Radau", "BDF"])
def test_implicit_methods_agree(method: str) -> None:
    model, _, start, _ = squeezer_in_one_piece()
    motions = [simulate(model, start, (0, 0.01), integrator=Integrator(name)) for name in (method, "DOP853")]
    assert motions[0].is_right, motions[0].checks
    np.testing.assert_allclose(motions[0].q[-1], motions[1].q[-1], atol=1e-8)
