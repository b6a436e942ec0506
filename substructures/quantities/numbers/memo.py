"""What was formed from a model before: keys that are equal for equal models, and programs by such keys."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from threading import Lock

from substructures.expr.known import Known
from substructures.expr.program import Program
from substructures.tree.model import Model

#: operations of the programs that are kept in a process
CAPACITY = 300_000


def known_model(model: Model) -> Known:
    """A model: its program, the meaning of its axes, the names of the rows of its closures, its velocity constraints,
    which are in no output, and all that is declared, also what has no effect."""
    axes = f"{model.coordinates} {model.joints} {model.closures} {model.velocity_constraints}"
    return Known(f"{model.program.digest} {axes} {sorted(model.units.items())}", model)


class ProgramCache:
    """Programs formed from models, by model and name; those that were not used for longest are given up when all have
    more than ``capacity`` operations. Safe between threads, of which two may form the same program.
    """

    def __init__(self, capacity: int = CAPACITY) -> None:
        self.capacity = capacity
        self._programs: OrderedDict[tuple[str, str], Program] = OrderedDict()
        self._lock = Lock()

    def get(self, model: Model, name: str, make: Callable[[], Program]) -> Program:
        """The program of this name, made when it is not kept. Raises what ``make`` raises."""
        key = known_model(model).digest, name
        with self._lock:
            if key in self._programs:
                self._programs.move_to_end(key)
                return self._programs[key]
        program = make()
        with self._lock:
            self._programs[key] = program
            while len(self._programs) > 1 and sum(map(len, self._programs.values())) > self.capacity:
                self._programs.popitem(last=False)
        return program
