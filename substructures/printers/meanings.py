"""Names of intermediate quantities by what they are in mechanics (:mod:`substructures.tree.glossary`).

An operation of a program is called what the glossary calls the same function of the symbols, whatever operations it is
made of there: equal values in the field of :mod:`substructures.expr.construction.fingerprint`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import NamedTuple

from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Output
from substructures.expr.program import Program
from substructures.expr.replay import replay

ALL = "all"
#: what the letters mean; of several names for one function the first is taken
LETTERS = {
    "c": "cosine of the angle at a joint, of several of their sum",
    "s": "sine of the angle at a joint, of several of their sum; with x, y, z: first moments of what a joint carries",
    "m": "mass of what a joint carries",
    "Theta": "inertia tensor of what a joint carries, about the joint in its frame",
    "J": "Binet tensor, the integral of x x^T dm, of what a joint carries, about the joint in its frame",
    "U": "base function of the velocity: of the second joint in the frame of the first",
    "Omega": "base function of the angular velocity: of the second joint in the frame of the first",
    "p": "momentum of what a joint carries for its unit velocity, in its frame or that of the second joint",
    "H": "angular momentum of what a joint carries for its unit velocity, in its frame or that of the second joint",
    "s.e": "first moments of what the first joint carries, about it along the axes of the second",
    "J.e": "Binet tensor of what the first joint carries, about it along the axes of the second",
    "K": "matrix of the Christoffel symbols of what a joint carries, in its frame or that of the second joint",
    "S": "first moments of the body of a joint, about its origin",
    "B": "Binet tensor of the body of a joint, about its origin",
    "omega": "angular velocity of what a joint moves, in its frame or that of the second joint; 0 is what carries the "
    "first joints",
    "gamma": "gravity in the frame of a joint",
    "alpha": "angular acceleration of what a joint moves, in its frame or that of the second joint",
    "alpha.0": "angular acceleration, with all second derivatives zero, of what a joint moves, in its frame or that of "
    "the second joint",
    "a": "acceleration, less gravity, of what a joint moves, in its frame; of two joints: of their common point, in "
    "the frame of the second",
    "a.0": "acceleration, with all second derivatives zero, of what a joint moves, in its frame; of two joints: of "
    "their common point, in the frame of the second",
    "a.g": "acceleration, with all second derivatives zero and less gravity, of what a joint moves, in its frame; of "
    "two joints: of their common point, in the frame of the second",
    "A": "matrix of alpha x r + omega x (omega x r), in the frame of a joint or of the second one",
    "A.0": "matrix of alpha x r + omega x (omega x r), in the frame of a joint or of the second one",
    "F": "force that moves the body of a joint",
    "F.0": "force, by its own velocity, on what a joint carries",
    "N": "moment that moves the body of a joint, about its origin",
    "N.0": "moment, by its own velocity, on what a joint carries",
    "f": "force that a joint transmits, in its frame or that of the second joint",
    "f.0": "velocity force that a joint transmits, in its frame or that of the second joint",
    "n": "moment that a joint transmits, in its frame or that of the second joint, about the origin there",
    "n.0": "moment of velocity forces that a joint transmits, in its frame or that of the second joint",
    "g": "element of the mass matrix",
    "Gamma": "Christoffel symbol of the first kind",
    "Q": "generalised force",
    "h": "velocity forces less gravity, of a coordinate",
    "p.q": "generalised momentum",
    "D": "element of the diagonal matrix in g = L^T D L, g the mass matrix",
    "y": "solution of L^T y = Q - Gamma q' q', Q and L here",
    "L": "element of the triangular matrix in g = L^T D L, g the mass matrix",
}

#: letters of quantities, which are not steps to themselves
OUTPUTS = {"g": "metric", "Gamma": "christoffel", "Q": "forces", "h": "nonlinear_effects", "p.q": "generalised_momenta"}
#: letters of what differs with the state of motion: as it is, with all second derivatives zero, in a world at rest
STATES = frozenset(x for x in LETTERS if f"{x.partition('.')[0]}.0" in LETTERS)


class Label(NamedTuple):
    """A letter with numbers of joints, from 1, and a component; ``key``: one of LETTERS, the letter up to the dot.

    ``is_barred``: a bar over the letter, where a symbol has it already; ``is_negative``: it names the negative.
    """

    key: str
    joints: tuple[int, ...]
    component: str
    is_barred: bool = False
    is_negative: bool = False

    @property
    def letter(self) -> str:
        """As it is written."""
        return self.key.partition(".")[0]

    @property
    def is_of_angle(self) -> bool:
        """Whether it is a cosine or sine."""
        return self.letter in "cs" and not self.component

    @property
    def kind(self) -> tuple[str, bool]:
        """What has or has not a bar in common."""
        return self.key, bool(self.component)

    @property
    def text(self) -> str:
        """c2, c23, m_3, U_31x; numbers of two digits stand apart."""
        between = "_" if max(self.joints) > 9 else ""
        numbers = between.join(map(str, self.joints))
        if self.is_of_angle:
            return f"{self.letter}{between}{numbers}"
        return f"{self.letter}_{numbers}{between}{self.component}"

    @property
    def latex(self) -> str:
        """U_{31,x}."""
        numbers = ("," if max(self.joints) > 9 else "").join(map(str, self.joints))
        letter = "\\" + self.letter if len(self.letter) > 1 else self.letter
        letter = rf"\bar{{{letter}}}" if self.is_barred else letter
        return f"{letter}_{{{numbers},{self.component}}}" if self.component else f"{letter}_{{{numbers}}}"


def meanings(program: Program, glossary: Program) -> Mapping[int, Label]:
    """By operation of the program what it is called, or what is called its negative; of several operations that are
    one function the first.
    """
    made = _values(program)
    labels = _labels(glossary, {x for _, value in made for x in (value.fp, (-value).fp)})
    result: dict[int, Label] = {}
    texts = set[str]()
    # names of the operations themselves come first
    for is_negative in (False, True):
        for i, value in made:
            label = labels.get((-value if is_negative else value).fp)
            if label is not None and i not in result and label.text not in texts:
                result[i] = label._replace(is_negative=is_negative)
                texts.add(label.text)
    return result


def _values(program: Program) -> list[tuple[int, Expr]]:
    """The operations that may have a name: a negative has a sign, no name."""
    needed = program.reachable()
    places = tuple((k,) for k in range(len(needed)))
    whole = replace(program, outputs={ALL: Output((len(needed),), places, tuple(needed))})
    found = replay(whole, Graph(), {})[ALL].entries
    pairs = [(needed[k], value) for (k,), value in found.items() if isinstance(value, Expr)]
    return [(i, value) for i, value in pairs if _is_made(value) and program.operations[i][0] != "neg"]


def _labels(glossary: Program, wanted: Collection[int]) -> dict[int, Label]:
    """By value the first label in the order of LETTERS, of those that are wanted.

    A letter is that of one state of motion, the one that most values are of.
    """
    # with numbers in them some are zero
    outputs = replay(glossary, Graph(), {}).items()
    found = {_label(name): x for name, formulas in outputs for x in formulas.entries.values()}
    some = {label: x.fp for label, x in found.items() if isinstance(x, Expr) and _is_made(x) and x.fp in wanted}
    counts = Counter(label.key for label in some)
    order = {key: n for n, key in enumerate(LETTERS)}
    chosen = {key.partition(".")[0]: key for key in sorted(STATES, key=lambda key: (counts[key], -order[key]))}
    labels: dict[int, Label] = {}
    for label in sorted(some, key=lambda label: (order[label.key], bool(label.component), label)):
        if label.key not in STATES or chosen[label.letter] == label.key:
            labels.setdefault(some[label], label)
    return labels


def _label(name: str) -> Label:
    """Of an output of the glossary."""
    key, joints, *component = name.split(" ")
    return Label(key, tuple(map(int, joints.split("."))), "".join(component))


def _is_made(value: object) -> bool:
    """Whether it is neither a number nor a symbol."""
    return isinstance(value, Expr) and not value.is_number and value.op != "sym"
