"""Names of intermediate quantities by what they are in mechanics (:mod:`substructures.tree.glossary`).

An operation of a program is called what the glossary calls the same function of the symbols, whatever operations it is
made of there: equal values in the field of :mod:`substructures.expr.fingerprint`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Output
from substructures.expr.program import Formulas, Program
from substructures.expr.replay import replay

ALL = "all"
#: what the letters mean; of several names for one function the first is taken
LETTERS = {
    "c": "cosine of the angle at a joint, of several of their sum",
    "s": "sine of the angle at a joint, of several of their sum; with x, y, z: first moments of what a joint carries",
    "m": "mass of what a joint carries",
    "J": "Binet tensor, the integral of x x^T dm, of what a joint carries, about the joint in its frame",
    "Theta": "moment of inertia of what a joint carries about its axis",
    "U": "base function of the velocity: of the second joint in the frame of the first",
    "Omega": "base function of the angular velocity: of the second joint in the frame of the first",
    "p": "momentum of what a joint carries for its unit velocity, in its frame or that of the second joint",
    "H": "angular momentum of what a joint carries for its unit velocity, in its frame or that of the second joint",
}


class Label(NamedTuple):
    """A letter with numbers of joints, from 1, and a component."""

    letter: str
    joints: tuple[int, ...]
    component: str

    @property
    def text(self) -> str:
        """c2, c23, m_3, U_31x; numbers of two digits stand apart."""
        between = "_" if max(self.joints) > 9 else ""
        numbers = between.join(map(str, self.joints))
        if self.letter in "cs" and not self.component:
            return f"{self.letter}{between}{numbers}"
        return f"{self.letter}_{numbers}{between}{self.component}"

    @property
    def latex(self) -> str:
        """U_{31,x}."""
        numbers = ("," if max(self.joints) > 9 else "").join(map(str, self.joints))
        letter = "\\" + self.letter if len(self.letter) > 1 else self.letter
        return f"{letter}_{{{numbers},{self.component}}}" if self.component else f"{letter}_{{{numbers}}}"


def meanings(program: Program, glossary: Program) -> Mapping[int, Label]:
    """By operation of the program what it is called; of several operations that are one function the first."""
    labels: dict[int, Label] = {}
    found = {_label(name): formulas.entries[()] for name, formulas in replay(glossary, Graph(), {}).items()}
    for label in sorted(found, key=lambda label: (list(LETTERS).index(label.letter), bool(label.component), label)):
        value = found[label]
        if _is_made(value):
            labels.setdefault(value.fp, label)
    needed = program.reachable()
    places = tuple((k,) for k in range(len(needed)))
    whole = replace(program, outputs={ALL: Output((len(needed),), places, tuple(needed))})
    values: Formulas = replay(whole, Graph(), {})[ALL]
    result: dict[int, Label] = {}
    for (k,), value in values.entries.items():
        if _is_made(value) and value.fp in labels:
            result[needed[k]] = labels.pop(value.fp)
    return result


def _label(name: str) -> Label:
    """Of an output of the glossary."""
    letter, joints, *component = name.split(" ")
    return Label(letter, tuple(map(int, joints.split("."))), "".join(component))


def _is_made(value: object) -> bool:
    """Whether it is neither a number nor a symbol."""
    return isinstance(value, Expr) and not value.is_number and value.op != "sym"
