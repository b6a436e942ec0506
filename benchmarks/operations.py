"""Operations per state of the formulas of published chains and of some trees, beside published figures.

python -m benchmarks.operations [--times] [--json FILE]

Additions, subtractions, multiplications and divisions, each shared one once; ``_all``: those of
parameters alone, too. M + bias and the like: of both outputs together. ``_abbreviated``: of the Puma 560 with its
published numbers, every force of a joint wrong by at most 1, 3, 10 % of its own largest value, proven, where joints
turn anywhere with at most 1 rad/s and 1 rad/s^2 (``_fast``: 3 rad/s, 10 rad/s^2). At the end published figures, and
lower estimates with base parameters. ``--times``: instead of all that, what fewer operations save in time.
"""

from __future__ import annotations

from collections.abc import Iterator
from statistics import median
from unittest.mock import patch

import numpy as np

from benchmarks.report import keep, options
from benchmarks.serial_chains import CHAINS, LOWER_ESTIMATES, PUBLISHED, definition, gravity
from benchmarks.timing import Work, alternating, ratio
from substructures import Definition, Model, Program, TreeSpec, abbreviate, catalogue, couple, derive
from substructures.compile import compile_program
from substructures.expr.graph import Graph
from substructures.expr.hoist import hoisted
from substructures.expr.operations import CONSTANT
from substructures.expr.program import Formulas, program
from substructures.expr.trigonometry import cos, sin
from substructures.quantities.formulas import derived
from substructures.tree.forces import velocity_forces

#: chains whose kernels are timed, at how many states, how often
TIMED, STATES, ROUNDS = ("rx90", "iiwa", "6r14"), 20_000, 201
#: outputs of a model that are counted together
QUANTITIES = {
    "metric": ("metric",),
    "gravity": ("gravity",),
    "christoffel": ("christoffel",),
    "metric_christoffel": ("metric", "christoffel"),
    "bias": ("bias",),
    "metric_bias": ("metric", "bias"),
    "inverse_dynamics": ("inverse_dynamics",),
}
#: entries and trees of the catalogue with their own numbers or parameters
TREES = {
    "double_pendulum": "double-pendulum",
    "acrobot": "acrobot",
    "cart_pole": "cart-pendulum",
    "scara": "scara",
}


def chain(name: str, group: bool = False) -> Model:
    """A chain on the ground; ``group``: with base parameters."""
    instance = {"name": "c", "substructure": name, "at": "world"}
    tree = {"name": name, "gravity": gravity(name), "parameters": {"g": {}}, "instances": [instance]}
    return couple(TreeSpec.read(tree), {"c": derive(definition(name))}, group=group)


def entry(name: str) -> Model:
    """An entry of the catalogue on the ground; all of these move in the x-z plane, or turn about z."""
    instance = {"name": "c", "substructure": name, "at": "world"}
    tree = {"name": "tree", "gravity": [0, 0, "-g"], "parameters": {"g": {}}, "instances": [instance]}
    return couple(TreeSpec.read(tree), {"c": derive(Definition.read(catalogue.load(name)))})


def humanoid() -> Model:
    """The tree of 34 coordinates."""
    spec = TreeSpec.read(catalogue.load_tree("humanoid"))
    parts = {str(i.substructure): derive(Definition.read(catalogue.load(str(i.substructure)))) for i in spec.instances}
    return couple(spec, {i.name: parts[str(i.substructure)] for i in spec.instances})


def counted(name: str, model: Model, suffix: str = "") -> dict[str, float]:
    """Figures by quantity, per state and (``_all``) in all; with base parameters (``_base``)."""
    figures: dict[str, float] = {}

    def add(quantity: str, program: Program, outputs: tuple[str, ...]) -> None:
        if set(outputs) <= program.outputs.keys():
            alone = hoisted(program.select(outputs))  # as it is exported
            figures[f"{name}_{quantity}{suffix}"] = alone.count(per_state=True)["total"]
            figures[f"{name}_{quantity}{suffix}_all"] = alone.count()["total"]

    for quantity, outputs in QUANTITIES.items():
        add(quantity, model.program, outputs)
    add("forward_dynamics", derived(model, "forward_dynamics"), ("forward_dynamics",))
    return figures


def abbreviated() -> dict[str, float]:
    """Inverse dynamics of the Puma 560 with its published numbers and what is negligible left out."""
    document = catalogue.load("puma560")
    numbers = {name: each["value"] for name, each in document["parameters"].items()}
    instance = {"name": "c", "substructure": "puma560", "parameters": numbers}
    tree = {"name": "tree", "gravity": [0, 0, -9.81], "instances": [instance]}
    model = couple(TreeSpec.read(tree), {"c": derive(Definition.read(document))}, group=True)
    figures: dict[str, float] = {}
    for percent, v, a, suffix in ((1, 1, 1, ""), (3, 1, 1, ""), (10, 1, 1, ""), (1, 3, 10, "_fast")):
        ranges = {"velocities": (-v, v), "accelerations": (-a, a)}
        found = abbreviate(model, "inverse_dynamics", percent / 100, ranges)
        figures[f"puma560_inverse_dynamics_abbreviated_{percent}pct{suffix}"] = found.operations
        print(f"puma560 {percent} % {v} rad/s {a} rad/s^2:", found)
    return figures


def counts() -> dict[str, float]:
    """The table, then what others have."""
    figures: dict[str, float] = {}
    models = {name: lambda name=name: chain(name) for name in CHAINS}
    models |= {name: lambda name=name: entry(name) for name in TREES.values()}
    for name, make in (models | {"humanoid": humanoid}).items():
        short = {value: key for key, value in TREES.items()}.get(name, name)
        found = counted(short, make())
        if name in CHAINS:
            found |= counted(short, chain(name, True), "_base")
        figures |= found
        row = {key.removeprefix(f"{short}_"): int(x) for key, x in found.items() if not key.endswith("_all")}
        print(f"{short:16}", "  ".join(f"{key} {x}" for key, x in row.items()), flush=True)
    figures |= abbreviated()
    for each in PUBLISHED:
        key = f"{each.chain}_{each.quantity}"
        in_all = f", {figures[f'{key}_all']} in all" if f"{key}_all" in figures else ""
        print(f"{key}: {figures[key]} per state{in_all}; published {each.operations} ({each.source})")
    for (name, quantity), estimate in LOWER_ESTIMATES.items():
        print(f"{name}_{quantity}_base: {figures[f'{name}_{quantity}_base']} per state; lower estimate {estimate}")
    return figures


def pairs() -> Iterator[tuple[str, Program, Program]]:
    """Formulas that need more and fewer operations for the same numbers."""
    for name in TIMED:
        more, less = (chain(name, group).program for group in (False, True))
        yield f"{name}, inverse dynamics, base parameters", *(x.select(["inverse_dynamics"]) for x in (more, less))
    less = humanoid().program
    with patch.multiple(velocity_forces, recursive=velocity_forces.composite, multiplied=velocity_forces.composite):
        more = humanoid().program
    yield "humanoid, velocity forces, recursion", *(x.select(["bias"]) for x in (more, less))


def reading(source: Program) -> Program:
    """The sum of the variables of a program and of the sines and cosines of its coordinates."""
    graph = Graph()
    varied = [s for s in source.symbols if s.kind not in CONSTANT]
    x = graph.sum(graph.symbol(s.name) for s in varied)
    for s in varied:
        if s.kind == "coordinate":
            x = x + sin(graph.symbol(s.name)) + cos(graph.symbol(s.name))
    return program(graph, {"sum": Formulas((1,), {(0,): x})}, {s.name: s for s in varied})


def evaluation(source: Program, rng: np.random.Generator) -> Work:
    """A compiled program at random states, from arrays and into arrays that are used again."""
    kernel = compile_program(source, list(source.outputs))
    values = {
        s.name: float(rng.uniform(0.5, 1.5)) if s.kind in CONSTANT else rng.uniform(-1, 1, STATES)
        for s in source.symbols
    }
    return kernel.bind({name: np.zeros((STATES, *kernel.shape(name))) for name in kernel.names}, values), STATES


def savings() -> dict[str, float]:
    """What fewer operations save of the time of compiled kernels; of both stays what :func:`reading` takes."""
    figures, rng = dict[str, float](), np.random.default_rng(0)
    for name, *both in pairs():
        more, less = map(hoisted, both)
        before, after = (x.count(per_state=True)["total"] for x in (more, less))
        works = {"before": more, "after": less, "reading and sines alone": reading(more)}
        times = alternating({key: evaluation(x, rng) for key, x in works.items()}, ROUNDS)
        saved = ratio(times["after"], times["before"])
        nanoseconds = ", ".join(f"{key} {median(some) * 1e9:.0f}" for key, some in times.items())
        print(f"{name}: operations {before} -> {after}, {after / before:.2f};", end=" ")
        print(f"times {saved:.2f} (ns a state: {nanoseconds})", flush=True)
        figures |= {f"{name}: operations": after / before, f"{name}: times": saved}
    return figures


def main() -> None:
    """The table, then what others have; or times."""
    parser = options(__doc__)
    parser.add_argument("--times", action="store_true", help="times of compiled kernels beside operations")
    arguments = parser.parse_args()
    keep(savings() if arguments.times else counts(), arguments.json)


if __name__ == "__main__":
    main()
