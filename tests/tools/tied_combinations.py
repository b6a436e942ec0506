"""What goes together: every analysis and formula of analyses is tried on a small tree with each kind of tie."""

from __future__ import annotations

from functools import cache
from textwrap import wrap
from typing import Any

import numpy as np

from service.cli.tree_files import coupled_source
from service.models.formulas import QUANTITIES, made
from service.models.numbers import ANALYSES, analysis_of
from service.models.source import Source
from substructures import TreeSpec, derive
from substructures.errors import InvalidInput

Plain = dict[str, Any]


def body(name: str, parent: str, joint: Plain) -> Plain:
    return {
        "name": name,
        "parent": parent,
        "mass": "m",
        "com": [0, 0, "l"],
        "inertia": dict.fromkeys(("xx", "yy", "zz"), 1),
        "joint": {"placement": {"position": [0, 0, 0]}, **joint},
    }


def turning(coordinate: str) -> Plain:
    return {"type": "revolute", "coordinate": coordinate, "axis": [0, -1, 0]}


#: a cart with two pendulums side by side, the tips of which a rod may hold together
CART: Plain = {
    "name": "cart",
    "parameters": {"m": {"value": 1, "unit": "kg"}, "l": {"value": 0.5, "unit": "m"}},
    "bodies": [
        body("deck", "base", {"type": "prismatic", "coordinate": "a", "axis": [1, 0, 0]}),
        body("rod", "deck", turning("b")),
        body("arm", "rod", {**turning("c"), "placement": {"position": [0, 0, 1]}}),
    ],
    "ports": [
        {"name": "tip", "body": "arm", "position": [0, 0, 1]},
        {"name": "seat", "body": "deck", "position": [1, 0, 0]},
    ],
}
FREE: Plain = {
    "name": "free",
    "bodies": [
        body("hull", "base", {"placement": {}, "type": "free", "coordinate": ["e1", "e2", "e3", "x", "y", "z"]})
    ],
    "parameters": CART["parameters"],
    "ports": [{"name": "deck", "body": "hull"}],
}
INSTANCE: Plain = {"name": "x", "definition": CART}
BAR: Plain = {"name": "bar", "type": "rod", "from": "x.tip", "to": "x.seat", "length": 1}
LINKAGE: Plain = {
    **CART,
    "closures": [{**BAR, "from": "tip", "to": "seat"}],
    "independent": ["a", "b"],
    "start": {"c": 1},
}
TREES: dict[str, Plain] = {
    "open": {"instances": [INSTANCE]},
    "relations": {
        "instances": [
            {**INSTANCE, "definition": {**CART, "relations": [{"coordinate": "c", "of": "b", "multiplier": -2}]}}
        ]
    },
    "floating base": {
        "gravity": [0, 0, 0],
        "instances": [{"name": "hull", "definition": FREE}, {**INSTANCE, "at": "hull.deck"}],
    },
    "closures": {"instances": [INSTANCE], "closures": [BAR]},
    "reduced level": {"instances": [{**INSTANCE, "definition": LINKAGE}]},
    "driven": {"instances": [INSTANCE], "driven": {"x.a": "t/2"}},
    "ignored": {"instances": [INSTANCE], "ignored": {"x.a": "1/2"}},
    "velocity constraints": {
        "instances": [INSTANCE],
        "velocity_constraints": [{"type": "linear", "name": "belt", "expression": "x.a' - 0.5*x.b'"}],
    },
    "contacts": {"instances": [INSTANCE], "contacts": [{"name": "foot", "point": "x.tip"}]},
    "balls": {
        "gravity": [0, 0, 0],
        "instances": [
            {"name": "hull", "definition": {**FREE, "bodies": [body("hull", "base", {"type": "floating"})]}},
            {**INSTANCE, "at": "hull.deck"},
        ],
    },
}


TEXT = """
Each analysis and each formula of analyses was tried on a small tree of each kind: a cart with two pendulums, one
coordinate that moves with another (`relations`), a free body below, a rod that closes a loop (`closures`), the same
in the part, with `independent` coordinates (reduced level), a cart whose motion is given (`driven`) or whose momentum
is (`ignored`), a linear velocity constraint, a point above the floor (`contacts`), a floating body below (`balls`).
**no**: the request is refused with the code `has-closures`, `has-driven`, `has-ignored`, `has-velocity-constraints`,
`has-contacts` or `has-balls`, and told what to take in its place. Formulas of the tree itself (`metric`,
`christoffel`, `forces`, ...), evaluations of them and exports in languages take all kinds, and are those without
velocity constraints and contacts; FMUs have both. In a tree of several kinds the `no` of one is the `no` of all;
balls go with the reduced level and contacts, and with no other tie. Identification is of motions that are measured in
all coordinates: where some are `driven` or `ignored` it is that of the tree without, whose forces of the drives are
measured, too. On closures and with velocity constraints motions tell fewer base parameters than formulas have:
`excitations` and `identifications` find in numbers which. At the reduced level loops in closed form have base
parameters; those that are met by steps (delta robots, suspensions) have them at the full level.
"""


@cache
def source_of(kind: str) -> Source:
    """The tree of a kind, coupled."""
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, -9.81], **TREES[kind]})
    return coupled_source(spec, {each.name: derive(each.definition) for each in spec.instances if each.definition})


def request_of(name: str, source: Source) -> Plain:
    """A small request for an analysis of a tree."""
    model = source.model
    moving = "x.b"
    turned = {name: k == 0 for ball in model.balls for k, name in enumerate(ball["positions"][-4:])}
    q = [float(turned.get(c, 0.5 if c == moving else 0.2)) for c in model.positions]
    still = [float(turned.get(c, 0)) for c in model.positions]
    motion = {
        k: np.random.default_rng(i).uniform(-1, 1, (60, model.dof)).tolist()
        for i, k in enumerate(("q", "qd", "qdd", "tau"))
    }
    if model.balls:
        motion["q"] = [q] * 60
    effort = f"tau.{moving}"
    control = {
        "controls": [effort],
        "cost": {"running": f"{effort}^2"},
        "horizon": 0.1,
        "intervals": 2,
        "steps": 2,
        "q": q,
    }
    swing = {"q": q, "span": [0, 0.1], "count": 3}
    return {
        "abbreviations": {"quantity": "gravity", "simplify": 0.1, "ranges": {"coordinates": [0, 0.1]}},
        "simulations": swing,
        "ensembles": {**swing, "parameters": {"x.l": [0.5, 0.6]}},
        "sensitivities": {**swing, "by": ["x.l"]},
        "periodic-orbits": {"q": q, "period": 0.1},
        "lyapunov-exponents": {"q": q, "duration": 0.2, "intervals": 20},
        "poincare-sections": {"q": q, "quantity": moving, "duration": 0.2},
        "linearisations": {"q": q},
        "frequency-responses": {"q": q, "frequencies": [1], "outputs": {"y": moving}},
        "regulators": {"q": still, "weights": {moving: 1}, "of_inputs": [effort]},
        "equilibria": {"count": 1},
        "steady-motions": {"rates": {}, "count": 1},
        "root-loci": {"parameter": "x.l", "values": [0.5], "q": q},
        "curvatures": {"q": q},
        "cost-gradients": {**control, "values": {effort: 1}},
        "optimal-controls": {**control, "iterations": 1},
        "optimal-parameters": {"vary": {"x.l": [0.4, 0.5]}, "columns": {"m": "mass"}, "minimise": "x.l", "starts": 1},
        "loop-states": {"q": q},
        "reduced-equations": {"independent": ["x.a", moving], "start": dict(zip(model.positions, q, strict=True))},
        "excitations": {name: motion[name] for name in ("q", "qd", "qdd")},
        "identifications": motion,
    }[name]


def refusal(name: str, kind: str) -> str:
    """The code of what says that an analysis, or formula, does not take a kind of tie into account; empty if it does.

    Raises for every other fault.
    """
    if name == "reduced-equations" and kind != "closures":
        return "not-needed"
    source = source_of(kind)
    try:
        if name in ANALYSES:
            analysis_of(name, source.model).compute(source, request_of(name, source), lambda _: None)
        else:
            made(source, name, {})
    except InvalidInput as error:
        codes = {fault.code for fault in error.faults}
        if len(codes) == 1 and next(iter(codes)).startswith("has-"):
            return codes.pop()
        # it was looked at, with its ties
        if not codes <= {"no-equilibrium", "no-cyclic-coordinate"}:
            raise
    return ""


def page() -> str:
    """The page of the documents."""
    lines = [
        "# What goes together",
        "",
        *wrap(" ".join(TEXT.split()), 118, break_on_hyphens=False),
        "",
        f"| | {' | '.join(TREES)} |",
        f"|---|{'---|' * len(TREES)}",
    ]
    for name in (*ANALYSES, *QUANTITIES):
        cells = ({"": "yes", "not-needed": ""}.get(refusal(name, kind), "**no**") for kind in TREES)
        lines.append(f"| `{name}` | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"
