"""Operations per state of the formulas of published chains and of some trees, beside published figures.

python -m benchmarks.operations [--json FILE]

Additions, subtractions, multiplications and divisions, each shared one once; ``_all``: those of
parameters alone, too. M + bias and the like: of both outputs together. ``_abbreviated``: of the Puma 560 with its
published numbers, every force of a joint wrong by at most 1, 3, 10 % of its own largest value, proven, where joints
turn anywhere with at most 1 rad/s and 1 rad/s^2 (``_fast``: 3 rad/s, 10 rad/s^2).
"""

from __future__ import annotations

from benchmarks.report import keep, options
from benchmarks.serial_chains import CHAINS, PUBLISHED, definition, gravity
from substructures import Definition, Model, Program, TreeSpec, abbreviate, catalogue, couple, derive
from substructures.expr.hoist import hoisted
from substructures.quantities.formulas import derived

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
    """An entry of the catalogue on the ground."""
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


def main() -> None:
    """The table, then what others have."""
    arguments = options(__doc__).parse_args()
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
        ours = figures.get(f"{each.chain}_{each.quantity}")
        print(f"{each.chain} {each.quantity}: {ours} per state; published {each.operations} ({each.source})")
    keep(figures, arguments.json)


if __name__ == "__main__":
    main()
