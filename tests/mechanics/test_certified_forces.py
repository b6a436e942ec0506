"""That no wrong force, potential or limit gets a certificate, and no right one is refused (certificate.md)."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest
from damaged import KINDS, as_json, damages, errors_of, found_in_part, found_in_tree, has_effect, nudged_numbers
from in_depth import deep, seeds
from random_trees import Plain
from scipy.interpolate import CubicSpline, PchipInterpolator

from substructures import Definition, Model, Part, Program, TreeSpec, couple, derive
from substructures.certificate.compare import TOLERANCE
from substructures.documents import read_json
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.tree.certificate import certify_tree

#: what they change
FORCES = frozenset(("applied", "potential", "forces", "potential_energy", "limits"))
#: parts with forces beside those above: end stops, laws that depend on the state, potentials given and found
LAWS: dict[str, Plain] = {
    "stops": {
        "joint": {"limits": [-0.1, "l/3"], "limits_act": {"stiffness": "k", "damping": 3}, "stiffness": 2, "rest": 0.3},
    },
    "potential": {"loads": [{"type": "potential", "potential": "k*x^2*cos(y - l)*(1 + u*t) + sqrt(1 + y^2)/(2 + x)"}]},
    "laws that depend on the state": {
        "joint": {"stiffness": "k*(1 + x^2)", "rest": "l - y/7", "damping": "2 + x'^2*sin(t)"},
    },
    "force with a potential": {
        "loads": [
            {"type": "joint", "coordinate": "x", "force": "-k*x*y^2 - 4*x^3 - x' + u*y + cos(2*x)"},
            {"type": "joint", "coordinate": "y", "force": "-k*x^2*y + sin(y)*y - 0.2*y'*x"},
        ],
    },
    "force with its own part": {
        "joint": {"stiffness": 3},
        "loads": [
            {"type": "joint", "coordinate": "x", "force": "k*y - 4*x^3 - x'^3 + x*sin(y)^2"},
            {"type": "joint", "coordinate": "y", "force": "-k*x - sin(y + l)"},
        ],
    },
    "force beside one in the time": {
        "loads": [{"type": "joint", "coordinate": "x", "force": "sin(t)*y - k*x^3"}],
    },
    "spring that depends on the state": {
        "loads": [
            {"type": "spring", "from": {"body": "base", "at": [0, 0, 1]}, "to": {"body": "a"},
             "stiffness": "k*(1 + x^2)", "damping": "1 + y^2"},
            {"type": "spring", "from": {"body": "base", "at": [1, 0, 1]}, "to": {"body": "b", "at": [0, "l", 0]},
             "stiffness": "k*(1 + t)", "damping": "1 + y^2", "length": "0.3 + u"},
        ],
    },
    "between frames": {
        "loads": [
            {"type": "bushing", "from": "a", "to": "b", "stiffness": ["k", 2, 3], "damping": [0.1, "l", 0.2],
             "angular_stiffness": [1, "k", 2], "angular_damping": ["l", 0.2, 0.3]},
            {"type": "bushing", "to": "b", "stiffness": ["1 + x^2", 2, "k"], "angular_stiffness": [1, "l", 3]},
            {"type": "force", "from": "base", "to": "b", "at": [0.2, "l", 0.1], "vector": ["u", 1, "x'"]},
            {"type": "torque", "from": "a", "to": "b", "vector": ["u", 1, "distance(base, a)"], "axes": "from"},
        ],
    },
    "measures and friction": {
        "loads": [
            {"type": "joint", "coordinate": "x", "force": "-k*distance'(base, b) - x^3"},
            {"type": "joint", "coordinate": "y", "force": "-k*sin(y)"},
            {"type": "potential", "potential": "k*(distance(base, a) - l)^2*cos(y) + u*x^2"},
            {"type": "spring", "from": {"body": "base", "at": [0, 0, 1]}, "to": {"body": "b", "at": [0, "l", 0]},
             "stiffness": "1 + distance(base, b)", "damping": "0.1*distance(base, b)", "length": 0.4},
            {"type": "friction", "coordinate": "y", "coulomb": "k", "static": 2, "stribeck": "l", "velocity": 0.4},
        ],
    },
    "dead force": {
        "loads": [
            {"type": "force", "body": "b", "at": [0.2, "l", 0.1], "vector": ["k", -2, "3*l"], "frame": "world"},
            {"type": "force", "body": "base", "at": [0.2, 0, 0.1], "vector": [1, 0, 0], "frame": "world"},
            {"type": "force", "body": "a", "at": [0.2, 0, 0.1], "vector": [1, "y", 0], "frame": "world"},
        ],
    },
}  # fmt: skip


def part_with(more: Plain) -> Part:
    """A slide x along an inclined axis and a turning joint y, with a law."""
    mass = {"mass": 2, "com": [0.1, 0.2, 0], "inertia": {"xx": 1, "yy": 1, "zz": 1}}
    x = {"type": "prismatic", "coordinate": "x", "theta": 0.4} | more.get("joint", {})
    y = {"type": "revolute", "coordinate": "y", "theta": 1.1, "limits": [-1, "k"]}
    bodies = [{"name": "a", "parent": "base", "joint": x} | mass, {"name": "b", "parent": "a", "joint": y} | mass]
    loads = more.get("loads", ())
    parameters = {"k": {"value": 1.7}, "l": {"value": 0.6}}
    plain = {"name": "a", "parameters": parameters, "inputs": {"u": {}}, "bodies": bodies, "loads": loads}
    return derive(Definition.read(read_json(as_json(plain))))


def two_of(part: Part) -> tuple[TreeSpec, dict[str, Part], Model]:
    """On each other, with gravity."""
    mounts = [{"name": "x", "substructure": "a"}, {"name": "y", "substructure": "a", "at": "x.b"}]
    mounts[1] |= {"parameters": {"k": "2*x.k"}, "placement": {"rpy": [0.3, 0.2, 0.1]}}
    spec, parts = TreeSpec.read({"name": "t", "gravity": [1, 2, -9], "instances": mounts}), {"x": part, "y": part}
    return spec, parts, couple(spec, parts)


@pytest.mark.parametrize(("elements", "kinds", "every"), [(1, 3, 3), *deep((2, len(KINDS), 1))])
@pytest.mark.parametrize("law", LAWS)
def test_damage_of_forces_and_potentials_is_found(law: str, elements: int, kinds: int, every: int) -> None:
    """In some or all ways, in the part and in a tree; and every third number, or all, of the program of the part."""
    part = part_with(LAWS[law])
    spec, parts, model = two_of(part)
    for certificate, program in ((part.certificate, part.program), (model.certificate, model.program)):
        errors = errors_of(certificate)
        assert errors.keys() == program.outputs.keys()
        assert all(error is not None and error <= TOLERANCE for error in errors.values())
    rng = np.random.default_rng(5)
    for kind, place, wrong in damages(part.program, rng, elements, kinds):
        name = place.partition("[")[0]
        if name in FORCES:
            assert found_in_part(part, wrong) is not None, (kind, place)
    for kind, place, wrong in damages(model.program, rng, elements, kinds):
        if place.partition("[")[0] in FORCES:
            assert found_in_tree(spec, parts, model, wrong) is not None, (kind, place)
    used = set(part.program.reachable(["applied", "potential"]))
    for kind, place, wrong in islice(nudged_numbers(part.program), 0, None, every):
        if int(place.removeprefix("operation ")) in used and has_effect(part.program, wrong):
            assert found_in_part(part, wrong) is not None, (kind, place)


def test_damage_of_forces_in_the_axes_of_the_world_is_found() -> None:
    """They are stored as what acts on either body, at a place that depends on the coordinates."""
    pair = {"from": "a", "to": "b", "axes": "world"}
    loads = [
        {"type": "force", "at": [0.2, "l", 0.1], "vector": ["k", 1, "2*x"], **pair},
        {"type": "torque", "vector": ["k", 1, "2*x"], **pair},
    ]
    part = part_with({"loads": loads})
    assert all(error is not None and error <= TOLERANCE for error in errors_of(part.certificate).values())
    for kind, place, wrong in damages(part.program, np.random.default_rng(5), elements=3):
        if place.startswith("load."):
            assert found_in_part(part, wrong) is not None, (kind, place)


def test_what_is_told_of_a_wrong_potential() -> None:
    """What was found by integration is compared by its gradient; a term in the time alone is none of it."""
    part = part_with(LAWS["force with its own part"])
    program, (entry,) = part.program, part.program.outputs["potential"].entries
    wrong = _with_potential(program, [("mul", entry, entry)])
    assert "the change of potential with x is" in str(found_in_part(part, wrong))
    time = next(i for i, s in enumerate(program.symbols) if s.name == "x'")
    n = len(program.operations)
    wrong = _with_potential(program, [("sym", time), ("add", entry, n)])
    assert "potential where all coordinates are zero is" in str(found_in_part(part, wrong))


def _with_potential(program: Program, more: list[Any]) -> Program:
    """The potential is the last of some operations that are added."""
    operations = (*program.operations, *more)
    potential = replace(program.outputs["potential"], entries=(len(operations) - 1,))
    return replace(program, operations=operations, outputs={**program.outputs, "potential": potential})


def test_no_gradient_is_taken_for_more_than_it_is() -> None:
    """Circulatory forces y, -x: a stored V = -x y has the gradient of one of them, and is none of both."""
    loads = [{"type": "joint", "coordinate": c, "force": f} for c, f in (("x", "y"), ("y", "-x"))]
    part = part_with({"loads": loads})
    index = {s.name: i for i, s in enumerate(part.program.symbols)}
    n = len(part.program.operations)
    more = [("sym", index["x"]), ("sym", index["y"]), ("mul", n, n + 1), ("neg", n + 2)]
    operations = (*part.program.operations, *more)
    potential = replace(part.program.outputs["potential"], entries=(n + 3,), index=((),))
    outputs = {**part.program.outputs, "potential": potential}
    wrong = replace(part.program, operations=operations, outputs=outputs)
    assert "the change of potential with x is" in str(found_in_part(part, wrong))


def test_limits_are_of_the_document() -> None:
    spec, parts, model = two_of(part_with(LAWS["stops"]))
    definitions = {name: part.definition for name, part in parts.items()}
    assert model.limited == ("x.x", "x.y", "y.x", "y.y")
    with pytest.raises(VerificationFailed, match="limited"):
        certify_tree(spec, definitions, {**model.summary(), "limited": ["x.y"]}, model.program)
    outputs = {name: x for name, x in model.program.outputs.items() if name != "limits"}
    without = replace(model.program, outputs=outputs)
    assert "limits is missing" in str(found_in_tree(spec, parts, model, without))
    # a model of a version that knew nothing of limits
    older = {name: x for name, x in model.summary().items() if name != "limited"}
    assert "limits" not in errors_of(certify_tree(spec, definitions, older, without))


#: joint loads as people write them, and worse: nothing in them may be refused
ODD = (
    ("0*x + k*y", "x*k"), ("x - x", "y/y"), ("2*x + 2*sin(t)", "1/y'"), ("u/x' - x", "x*t - x*t"),
    ("sqrt(1 + x^2)", "x*y/(1 + y^2)"), ("tan(x)", "cos(x*y)"), ("(x + t)^2*y", "cos(t)*y - k*y^3"),
    ("x^-2", "sin(y)/cos(y)"), ("cos(k*x)", "sin(x + 1/k)*k"), ("cos(x + k*l)^3*y", "sqrt(l)*y^9/(k + l)"),
    ("(1 + x + y)^9", "sqrt(x^2)"), ("-(x - (t - y))*3", "-(u - x)*y"),
)  # fmt: skip


@pytest.mark.parametrize("forces", ODD)
def test_no_law_is_refused_by_mistake(forces: tuple[str, str]) -> None:
    """As forces, as stiffnesses of joints and of springs; in a part and in a tree."""
    loads = [{"type": "joint", "coordinate": c, "force": f} for c, f in zip("xy", forces, strict=True)]
    ends = {"from": {"body": "base", "at": [0, 0, 1]}, "to": {"body": "b"}}
    springs = [{"type": "spring", "stiffness": f, **ends} for f in forces]
    springs[1]["length"] = "l"
    joint = {"stiffness": forces[0], "rest": "l"}
    for more in ({"loads": loads}, {"joint": joint, "loads": loads[1:]}, {"loads": springs}):
        two_of(part_with(more))


#: factors of laws; ``@`` stands for a coordinate
FACTORS = (
    *("@", "@", "@^2", "k", "2", "0.3", "sqrt(l)", "1/(1 + k)", "tan(k)", "cos(@)", "sin(2*@ - l)", "cos(@ + @)"),
    *("u", "t", "x'", "(1 + @)", "(@ - t)", "sqrt(1 + @^2)", "1/(2 + @)", "sin(k*@)", "cos(@ + 1/k)", "cos(@*@)"),
)


def random_law(rng: np.random.Generator) -> str:
    """A sum of products."""
    terms = ["*".join(rng.choice(FACTORS, rng.integers(1, 4))) for _ in range(rng.integers(1, 5))]
    text = "".join(f" {rng.choice(('+', '-'))} {term}" for term in terms)
    while "@" in text:
        text = text.replace("@", str(rng.choice(("x", "y"))), 1)
    return text.strip()


@pytest.mark.parametrize("seed", seeds(10, 400))
def test_no_random_law_is_refused(seed: int) -> None:
    rng = np.random.default_rng(seed)
    loads: list[Plain] = [{"type": "joint", "coordinate": c, "force": random_law(rng)} for c in "xyx"]
    loads.append({"type": "potential", "potential": random_law(rng).replace("x'", "x")})
    part_with({"joint": {"stiffness": random_law(rng), "rest": "l"}, "loads": loads[int(rng.integers(3)) :]})


#: factors of polynomials and trigonometric polynomials, some in disguise
EXACT = (
    *("@", "@^2", "k", "2", "cos(@)", "sin(2*@ - l)", "(1 + @)", "(@ - @)", "(0*@ + 1)", "sin(@)^2", "(1 - cos(@)^2)"),
    *("u", "t", "q1'", "(@ - t)", "(sin(t)^2 + cos(t)^2)", "(t + @ - t)", "cos(@/2 + pi/7)", "1/(1 + k)", "(@ + k)^4"),
)


def exact_forces(rng: np.random.Generator) -> dict[str, str]:
    """Of four coordinates, some of which are gradients, and some of which belong together."""
    forces: dict[str, str] = {}
    for _ in range(rng.integers(0, 3)):
        a, b = (f"q{i}" for i in rng.choice([1, 2, 3, 4], 2, replace=False))
        # V = k a^2 cos(b)
        for q, force in ((a, f" - 2*k*{a}*cos({b})"), (b, f" + k*{a}^2*sin({b})")):
            forces[q] = forces.get(q, "0") + force
    for _ in range(rng.integers(1, 3)):
        term = "*".join(rng.choice(EXACT, rng.integers(1, 4)))
        while "@" in term:
            term = term.replace("@", f"q{rng.integers(1, 5)}", 1)
        q = f"q{rng.integers(1, 5)}"
        forces[q] = f"{forces.get(q, '0')} {rng.choice(('+', '-'))} {term}"
    return forces


@pytest.mark.parametrize("seed", seeds(10, 400))
def test_potentials_of_trigonometric_polynomials_are_decided(seed: int) -> None:
    """Right ones are certified, whatever is a gradient of them; one that is zero or off by a constant is not."""
    rng = np.random.default_rng(seed)
    loads = [{"type": "joint", "coordinate": q, "force": force} for q, force in exact_forces(rng).items()]
    bodies = [
        {"name": f"b{i}", "parent": f"b{i - 1}" if i > 1 else "base", "mass": 1,
         "joint": {"type": "prismatic" if i % 2 else "revolute", "coordinate": f"q{i}", "theta": f"0.{i}"}}
        for i in range(1, 5)
    ]  # fmt: skip
    parameters = {"k": {"value": 1.7}, "l": {"value": 0.6}}
    plain = {"name": "a", "parameters": parameters, "inputs": {"u": {}}, "bodies": bodies, "loads": loads}
    part = derive(Definition.read(read_json(as_json(plain))))
    assert errors_of(part.certificate)["potential"] is not None
    assert "potential_left_out" not in part.certificate["direct_form"]
    output = part.program.outputs["potential"]
    if not output.entries:
        return
    n = len(part.program.operations)
    shifted = _with_potential(part.program, [("rat", "1", "1000000"), ("add", output.entries[0], n)])
    assert "where all coordinates are zero" in str(found_in_part(part, shifted))
    nothing = {**part.program.outputs, "potential": replace(output, entries=(), index=())}
    assert "the change of potential with" in str(found_in_part(part, replace(part.program, outputs=nothing)))


@pytest.mark.parametrize(
    "loads",
    [
        [{"type": "joint", "coordinate": "x", "force": "x/sqrt(1 + x^2)"}],
        [{"type": "spring", "stiffness": "1 + x^2", "length": "l", "from": {"body": "base", "at": [0, 0, 1]},
          "to": {"body": "a"}}],
    ],
)  # fmt: skip
def test_what_is_left_out_is_told(loads: list[Plain]) -> None:
    """A gradient beyond what is integrated; and one that was found, beside it, is not left out unseen."""
    part = part_with({"loads": loads})
    assert part.certificate["direct_form"]["potential_left_out"] == ["x"]
    assert part.certificate["warnings"][-1]["code"] == "no-potential"
    springs = part_with(LAWS["spring that depends on the state"])
    assert "potential_left_out" not in springs.certificate["direct_form"]
    *_, model = two_of(part)
    assert model.certificate["direct_form"]["potential_left_out"] == ["x.x", "y.x"]


@pytest.mark.parametrize(
    "law", ["sign(x)", "max(x, 0.1)", "step(x, 0.1, l)", "table(x; 0.4: 0, 0.5: 1, 0.6: 0)", "abs(x)/x", "tanh(1000*x)"]
)
def test_springs_whose_laws_are_flat_somewhere_depend_on_the_state(law: str) -> None:
    part_with({"joint": {"stiffness": law, "rest": 0.2}})
    ends = {"from": {"body": "base", "at": [0, 0, 1]}, "to": {"body": "b"}}
    part_with({"loads": [{"type": "spring", "stiffness": 2, "length": f"1 + ({law})^2", **ends}]})
    steady = part_with({"joint": {"stiffness": f"k + 0*({law})"}}).certificate
    assert "no-potential" not in {each["code"] for each in steady["warnings"]}


@pytest.mark.parametrize(
    "load",
    [
        {"type": "potential", "potential": "k*max(x - l, 0)^2.5"},
        {"type": "potential", "potential": "max(x, 0)^(k + 1)"},
        {"type": "joint", "coordinate": "x", "force": "-k*max(x, 0)^1.3"},
        {"type": "potential", "potential": "table(x; 2: 0, 3: 1)*sqrt(x - 2)*y"},
    ],
)
def test_laws_of_contact_are_certified_on_both_sides_of_where_it_begins(load: Plain) -> None:
    """Hertz's among them, also beside a spring whose potential is known by its slopes."""
    part_with({"loads": [load]})
    part_with({"loads": [load], "joint": {"stiffness": "1 + x^2"}})


def test_what_stands_still_has_an_energy_beside_forces_that_do_nothing() -> None:
    body = {"name": "b", "parent": "base", "joint": {"type": "fixed", "sigma": 1}, "mass": 2, "com": [0, 0, 1]}
    mast = {"name": "mast", "bodies": [body], "loads": [{"type": "force", "body": "b", "vector": [1, 0, 0]}]}
    tree = {"name": "t", "gravity": [0, 0, -9], "instances": [{"name": "m", "substructure": "mast"}]}
    assert errors_of(couple(tree, {"m": derive(mast)}).certificate)["potential_energy"] is not None


def test_a_force_that_waits_for_its_time_is_no_potential_left_out() -> None:
    part = part_with({"loads": [{"type": "joint", "coordinate": "x", "force": "k*step(t, 0, 0.1)"}]})
    assert "potential_left_out" not in part.certificate["direct_form"]


def tabulated(points: int, kind: str, number: int) -> tuple[list[float], list[float], str]:
    """Random places and values in decimals, and their table."""
    rng = np.random.default_rng([points, number])
    x = np.round(np.cumsum(rng.uniform(0.05, 2, points)) - points / 2, 3)
    y = np.round(rng.uniform(-5, 5, points), 2)
    points_ = ", ".join(f"{a}: {b}" for a, b in zip(x, y, strict=True))
    return x.tolist(), y.tolist(), f"table(x; {points_}{'' if kind == 'linear' else f'; {kind}'})"


@pytest.mark.parametrize("kind", ["linear", "monotone", "smooth"])
@pytest.mark.parametrize("points", [2, 3, 4, 5, 9, 30])
def test_tables_are_certified_and_are_those_of_scipy(points: int, kind: str) -> None:
    x, y, text = tabulated(points, kind, 0)
    expected = {
        "linear": lambda at: np.interp(at, x, y),
        "monotone": lambda at: PchipInterpolator(x, y)(at),
        "smooth": lambda at: CubicSpline(x, y, bc_type="clamped")(at),
    }
    joint = {"type": "prismatic", "coordinate": "x"}
    body = {"name": "b", "parent": "base", "mass": 1, "joint": joint}
    load = {"type": "joint", "coordinate": "x", "force": text}
    part = derive(Definition.read({"name": "p", "bodies": [body], "loads": [load]}))
    at = np.linspace(x[0] - 1, x[-1] + 1, 57)
    symbols = {symbol.name: at if symbol.name == "x" else 0.0 for symbol in part.program.symbols}
    found = interpret(part.program, symbols, ["applied"])["applied"][..., 0]
    assert np.allclose(found, expected[kind](np.clip(at, x[0], x[-1])), rtol=0, atol=1e-11)


@pytest.mark.parametrize("number", range(4))
def test_smooth_tables_are_certified_in_trees(number: int) -> None:
    """The points of public reports, and others, as laws of parts and between parts."""
    tables = [tabulated(4 + number, "smooth", number)[2], "table(x; -1: 0, 1: 1, 2: 4, 5: 2; smooth)"]
    tables.append("table(x; 0: 0, 1: 1, 2: 4, 3: 9, 4: 16; smooth)")
    load = {"type": "joint", "coordinate": "x", "force": f"{tables[0]} - {tables[1]}*x'"}
    body = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"}}
    part = derive(Definition.read({"name": "p", "bodies": [body], "loads": [load]}))
    instances = [{"name": name, "substructure": "p"} for name in ("one", "two")]
    law = {"type": "potential", "name": "between", "potential": tables[2].replace("(x;", "(one.x - two.x;")}
    tree = TreeSpec.read({"name": "t", "instances": instances, "loads": [law]})
    assert couple(tree, {"one": part, "two": part}).dof == 2
