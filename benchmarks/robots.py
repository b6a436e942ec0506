"""The robots of the benchmark: ours, and the same in Pinocchio."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.chains import chain, general_rows, row_of
from benchmarks.derive import humanoid
from benchmarks.peers import Peer
from substructures import Definition, TreeSpec, couple, derive
from substructures.compile import Kernel, compile_program
from substructures.quantities.numbers.defaults import default_number
from substructures.tree.model import Model

Array = Any
METRIC_FORCES = ("metric", "forces")
EVERYTHING = (*METRIC_FORCES, "christoffel")
#: states of a batch; the results of a batch should stay in the third-level cache
BATCHES = {"6r": 4096, "34": 1024}
#: states that Pinocchio is called for in a round
CALLS = 1024


@dataclass
class Robot:
    """A model with numbers for its parameters, random states, and the same robot in Pinocchio."""

    name: str
    model: Model
    peer: Peer
    numbers: dict[str, float]
    q: Array
    qd: Array

    @classmethod
    def of(
        cls, name: str, spec: TreeSpec, library: Mapping[str, Definition], values: dict[str, float], batch: int
    ) -> Robot:
        """Couples the tree; parameters without a value have their defaults."""
        model = couple(spec, {i.name: derive(library[str(i.substructure)]) for i in spec.instances})
        numbers = {
            n: default_number(p["value"]) for n, p in model.parameters.items() if p["value"] is not None
        } | values
        # actuators rest; velocities and times that no force depends on do not matter
        numbers |= {s.name: 0.0 for s in model.program.symbols if s.kind not in ("parameter", "inertia", "coordinate")}
        q, qd = np.random.default_rng(0).uniform(-3, 3, (2, batch, model.dof))
        return cls(name, model, Peer.of(spec, library, numbers), numbers, q, qd)

    def kernel(self, names: tuple[str, ...]) -> Kernel:
        """Compiled anew."""
        return compile_program(self.model.program, names)

    def ours(self, kernel: Kernel, packed: tuple[str, ...] = ("christoffel",)) -> Callable[[], Any]:
        """One batch into arrays that are used again."""
        columns = [(self.model.coordinates, self.q)]
        out = {n: np.zeros((len(self.q), *kernel.shape(n, n in packed))) for n in kernel.names}
        return lambda: kernel.evaluate_into(out, self.numbers, columns=columns, packed=packed, clean=True)

    def in_blocks(self, kernel: Kernel) -> Callable[[], Any]:
        """One batch in the form that the vector unit gives."""
        columns = [(self.model.coordinates, self.q)]
        out = kernel.blocks(self.numbers, columns=columns).array
        return lambda: kernel.blocks(self.numbers, columns=columns, out=out)

    def theirs(self, functions: tuple[str, ...]) -> Callable[[], None]:
        """The same states one by one, each function in a loop of its own."""
        order = np.argsort(self.peer.order)
        q, qd = list(self.q[:CALLS, order]), list(self.qd[:CALLS, order])
        model, data = self.peer.model, self.peer.model.createData()

        def work() -> None:
            for name in functions:
                function = getattr(pin, name)
                if name == "computeCoriolisMatrix":
                    for x, v in zip(q, qd, strict=True):
                        function(model, data, x, v)
                else:
                    for x in q:
                        function(model, data, x)

        return work

    def check(self) -> float:
        """Largest relative deviation of metric, gravity and Coriolis matrix from Pinocchio's."""
        names = ("metric", "gravity", "christoffel")
        found = self.kernel(names).evaluate(self.numbers, columns=[(self.model.coordinates, self.q[:20])])
        order, worst = self.peer.order, 0.0
        place, data = np.argsort(order), self.peer.model.createData()
        for i in range(20):
            x, v = self.q[i][place], self.qd[i][place]
            upper = np.triu(pin.crba(self.peer.model, data, x))
            metric = (upper + np.triu(upper, 1).T)[np.ix_(order, order)]
            forces = -pin.computeGeneralizedGravity(self.peer.model, data, x)[order]
            coriolis = pin.computeCoriolisMatrix(self.peer.model, data, x, v)[np.ix_(order, order)]
            pairs = (
                (found["metric"][i], metric),
                (found["gravity"][i], forces),
                (found["christoffel"][i] @ self.qd[i], coriolis),
            )
            worst = max(worst, *(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs))
        return worst


def robots() -> tuple[Robot, Robot]:
    """The general 6R chain with random constants, and the humanoid of the catalogue."""
    definition = chain("general-6r", general_rows(6))
    rng = np.random.default_rng(7)
    values = {f"p0.{p}": float(rng.uniform(0.1, 1)) for p in definition.parameters}
    # inertia tensors of real bodies: definite, and none of their moments larger than the sum of the others
    values |= {n: (1 if n[4] == n[5] else 0) + v / 10 for n, v in values.items() if n.startswith("p0.I")}
    small = Robot.of(
        "general 6R", row_of([definition]), {definition.name: definition}, values | {"g": 9.81}, BATCHES["6r"]
    )
    spec, library = humanoid()
    return small, Robot.of("humanoid, 34 dof", spec, library, {}, BATCHES["34"])
