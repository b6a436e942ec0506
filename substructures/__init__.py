"""Multibody dynamics from stored formulas that couple (P. Maisser's algebraised Lagrange formalism).

>>> from substructures import Definition, TreeSpec, catalogue, couple, derive
>>> part = derive(Definition.read(catalogue.load("simple-pendulum")))
>>> tree = TreeSpec.read({"name": "clock", "instances": [{"name": "p", "substructure": "simple-pendulum"}]})
>>> couple(tree, {"p": part}).coordinates
('p.q1',)
"""

from substructures import catalogue
from substructures.errors import (
    Fault,
    InvalidArgument,
    InvalidDocument,
    InvalidInput,
    InvalidProgram,
    MissingValue,
    SubstructuresError,
    TooLarge,
)
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.part import Formula, Part, derive
from substructures.tree.document import Instance, TreeSpec, read_instance
from substructures.tree.model import Model, couple

__all__ = [
    "Definition",
    "Fault",
    "Formula",
    "Instance",
    "InvalidArgument",
    "InvalidDocument",
    "InvalidInput",
    "InvalidProgram",
    "MissingValue",
    "Model",
    "Part",
    "Program",
    "SubstructuresError",
    "TooLarge",
    "TreeSpec",
    "catalogue",
    "couple",
    "derive",
    "read_instance",
]
