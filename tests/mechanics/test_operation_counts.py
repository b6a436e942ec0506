"""Operation counts of a fixed set of models, recorded beside this file.

A change that raises one fails the test; one that lowers it asks to write the file anew: run this file as a script.
Counts are additions, subtractions, multiplications and divisions, each shared one once.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from substructures import Definition, Model, Part, TreeSpec, catalogue, couple, derive
from substructures.part.one_piece import derive_in_one_piece

FILE = Path(__file__).with_name("operation_counts.json")
Plain = dict[str, Any]

#: alpha and a of rows 1 to 6, modified Denavit-Hartenberg; d at every joint
FOURTEEN = [("0", "0")] + [(f"alpha{i}", f"a{i}") for i in (2, 3, 4)] + [("pi/2", "a5"), ("pi/2", "a6")]
GENERAL = [(f"alpha{i}", f"a{i}") for i in range(1, 7)]


def revolute_chain(rows: list[tuple[str, str]], name: str, first: int = 1, thetas: bool = False) -> Plain:
    """Rows as part of a chain that starts at joint ``first``; inertias are the symbols of the stored program."""
    numbers = range(first, first + len(rows))
    bodies, used = [], set()
    for k, (alpha, a) in zip(numbers, rows, strict=True):
        joint = {"type": "revolute", "coordinate": f"q{k}", "theta": alpha, "d": a, "tau": f"d{k}"}
        joint |= {"phi": f"theta{k}"} if thetas else {}
        used |= {x for x in joint.values() if x[-1].isdigit() and x[0] != "q"} - {"0", "pi/2"}
        bodies.append({"name": f"b{k}", "parent": f"b{k - 1}" if k > first else "base", "joint": joint})
    ports = [{"name": "tip", "body": f"b{numbers[-1]}"}]
    return {"name": name, "parameters": {x: {} for x in sorted(used)}, "bodies": bodies, "ports": ports}


def inertia_symbols(definition: Plain) -> Plain:
    """The same with mass, first moments and inertia tensor about the body origin as parameters.

    What coupling adds up then are symbols, as in the program of one piece.
    """
    result = json.loads(json.dumps(definition))
    for body in result["bodies"]:
        k = body["name"]
        values = {f"{x}_{k}": {} for x in ("m", "cx", "cy", "cz", "xx", "yy", "zz", "xy", "xz", "yz")}
        result["parameters"] |= values
        body |= {"mass": f"m_{k}", "com": [f"c{x}_{k}/m_{k}" for x in "xyz"]}
        body["inertia"] = {x: f"{x}_{k}" for x in ("xx", "yy", "zz", "xy", "xz", "yz")} | {"about": "origin"}
    return dict(result)


@cache
def stored(text: str) -> Part:
    return derive(Definition.read(json.loads(text)))


def part(definition: Plain) -> Part:
    return stored(json.dumps(definition))


@cache
def entry(name: str) -> Part:
    return derive(Definition.read(catalogue.load(name)))


def mounted(*instances: tuple[str, Part, str]) -> Model:
    """Parts mounted on each other under gravity along -z."""
    tree = {
        "name": "tree",
        "gravity": [0, 0, "-g"],
        "parameters": {"g": {"value": 9.81}},
        "instances": [{"name": name, "substructure": p.name, "at": at} for name, p, at in instances],
    }
    return couple(TreeSpec.read(tree), {name: p for name, p, _ in instances})


def in_pieces(rows: list[tuple[str, str]], sizes: list[int], thetas: bool = False) -> Model:
    """A chain in parts of the given sizes, mounted tip to base."""
    instances, first, at = [], 1, "world"
    for size in sizes:
        definition = inertia_symbols(revolute_chain(rows[first - 1 : first - 1 + size], f"from{first}", first, thetas))
        instances.append((f"p{first}", part(definition), at))
        at, first = f"p{first}.tip", first + size
    return mounted(*instances)


def humanoid() -> Model:
    limbs = [(i["name"], i["substructure"], i["at"]) for i in catalogue.load_tree("humanoid")["instances"]]
    parts = {name: entry(name) for _, name, _ in limbs}
    model = mounted(*((instance, parts[name], at) for instance, name, at in limbs))
    assert model.dof == 34
    return model


def counted(formulas: Part | Model) -> dict[str, int]:
    """Metric, Christoffel symbols, and all quantities of the program."""
    names = ("metric", "christoffel", "gravity", "forces")
    all_of = formulas.program.count([n for n in ("metric", "christoffel", "forces") if n in formulas.program.outputs])
    return {n: formulas.operations[n] for n in names if n in formulas.program.outputs} | {"all": all_of["total"]}


MODELS: dict[str, Callable[[], Part | Model]] = {
    "6R with 14 kinematic parameters": lambda: part(revolute_chain(FOURTEEN, "six")),
    "6R general": lambda: part(revolute_chain(GENERAL, "six-general", thetas=True)),
    "6R with 14 kinematic parameters, tree": lambda: in_pieces(FOURTEEN, [6]),
    "puma560": lambda: mounted(("arm", entry("puma560"), "world")),
    "ur5": lambda: mounted(("arm", entry("ur5"), "world")),
    "kuka-iiwa-14": lambda: mounted(("arm", entry("kuka-iiwa-14"), "world")),
    "puma560 and parallel-gripper": lambda: mounted(
        ("arm", entry("puma560"), "world"), ("hand", entry("parallel-gripper"), "arm.flange")
    ),
    "puma560 and screw-gripper": lambda: mounted(
        ("arm", entry("puma560"), "world"), ("hand", entry("screw-gripper"), "arm.flange")
    ),
    "puma560 and screw-gripper without relations": lambda: mounted(
        ("arm", entry("puma560"), "world"),
        ("hand", derive({**catalogue.load("screw-gripper"), "relations": []}), "arm.flange"),
    ),
    "humanoid of 34": humanoid,
}

SIZES = {"3+3": [3, 3], "2+2+2": [2, 2, 2], "six of 1": [1] * 6}
for _name, _sizes in SIZES.items():
    MODELS[f"6R with 14 kinematic parameters, {_name}"] = lambda sizes=_sizes: in_pieces(FOURTEEN, sizes)
    MODELS[f"6R general, {_name}"] = lambda sizes=_sizes: in_pieces(GENERAL, sizes, thetas=True)


@pytest.mark.parametrize("name", MODELS)
def test_no_count_is_higher_than_recorded(name: str) -> None:
    found, recorded = counted(MODELS[name]()), json.loads(FILE.read_text())[name]
    assert found.keys() == recorded.keys()
    worse = {key: (x, recorded[key]) for key, x in found.items() if x > recorded[key]}
    assert not worse, f"more operations than recorded (now, recorded): {worse}"
    message = f"fewer operations than recorded: 'python tests/mechanics/{Path(__file__).name}' writes the file anew"
    assert found == recorded, message


def test_the_file_has_no_other_models() -> None:
    assert set(json.loads(FILE.read_text())) == set(MODELS)


def test_six_joints_with_14_parameters_need_at_most_the_figures_to_reach() -> None:
    six = part(revolute_chain(FOURTEEN, "six"))
    assert len(six.parameters) == 14
    assert six.operations["metric"] <= 755
    assert six.operations["christoffel"] <= 1271


def test_parallel_axes_need_only_the_sum_of_two_moments() -> None:
    """Planar 3R, metric and Christoffel symbols together; with J_xx and J_yy apart 80 and 67."""
    definition = Definition.read(catalogue.load("planar-3r"))
    assert derive(definition).program.count(["metric", "christoffel"])["total"] <= 58
    assert derive_in_one_piece(definition).count(["metric", "christoffel"])["total"] <= 52


@pytest.mark.parametrize("rows", [FOURTEEN, GENERAL], ids=["14 parameters", "general"])
@pytest.mark.parametrize("sizes", SIZES.values(), ids=SIZES)
def test_coupled_from_parts_no_more_than_from_one(rows: list[tuple[str, str]], sizes: list[int]) -> None:
    thetas = rows is GENERAL
    whole, pieces = (counted(in_pieces(rows, some, thetas)) for some in ([6], sizes))
    assert all(pieces[quantity] <= count for quantity, count in whole.items()), (pieces, whole)


def write() -> None:
    """Write the file anew and show what changed."""
    old = json.loads(FILE.read_text()) if FILE.exists() else {}
    new = {name: counted(make()) for name, make in sorted(MODELS.items())}
    FILE.write_text(json.dumps(new, indent=1, sort_keys=True) + "\n")
    for name, counts in new.items():
        print(name, counts, "" if old.get(name) == counts else f"was {old.get(name)}")


if __name__ == "__main__":
    write()
