"""Shapes of trees: what their formulas are made of. Trees of one shape have one program and one certificate of it.

g, Gamma, Q and all other outputs are identities in the symbols and are compared with the documents at random values of
all symbols, so that neither depends on the values of parameters (notation.md, section 6). What does, plausibility and
warnings, is found for every tree. Numbers that parameters of instances are bound to, those of placements, and those of
gravity that is not the usual one, are values, too: symbols of the shape, in whose place they are put exactly. Only 0, 1
and -1 belong to the shape, as they make formulas shorter. Names of instances are names of symbols alone: a program is
that of other names, too.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, Protocol

from substructures.documents import write_json
from substructures.errors import InvalidDocument, TooLarge
from substructures.expr.bind import bind
from substructures.expr.operations import Operation, Output
from substructures.expr.program import Program
from substructures.expr.units.unit_check import Notice
from substructures.part.part import Part
from substructures.part.shape import without_descriptions
from substructures.tree.document import TreeSpec
from substructures.tree.given.loops.reduction import dependent
from substructures.tree.numbers import without_numbers

#: members of a tree whose formulas have names of instances in their symbols alone
NAMELESS = frozenset(("gravity", "parameters", "inputs", "instances"))
#: operations that have a value whatever their operands are
TOTAL = frozenset(("add", "sub", "mul", "neg", "int", "rat", "sym", "sin", "cos"))


@dataclass(frozen=True)
class CertifiedProgram:
    """The program of a shape, what its certificate says of the formulas, and what is to be told of them.

    ``instances``: the names in its symbols, in the order of the document that it was made of. ``axes``:
    ``coordinates``, ``joints``, ``frames`` and ``limited`` of the model where it has nothing else (loops, ties).
    """

    program: Program
    certificate: Mapping[str, Any]
    notices: Sequence[Notice] = ()
    instances: tuple[str, ...] = ()
    axes: Mapping[str, Any] | None = None

    def called(self, instances: tuple[str, ...]) -> CertifiedProgram:
        """That of the tree whose instances have these names: an identity holds whatever its symbols are called."""
        names = dict(zip(self.instances, instances, strict=True))

        def name(text: str) -> str:
            """Of a symbol: arm.q1, tau.arm.q1."""
            effort = "tau." if text.startswith("tau.") else ""
            instance, dot, rest = text.removeprefix(effort).partition(".")
            return f"{effort}{names.get(instance, instance) if dot else instance}{dot}{rest}"

        program = replace(self.program, symbols=tuple(replace(s, name=name(s.name)) for s in self.program.symbols))
        axes = self.axes and {k: x if k == "joints" else tuple(map(name, x)) for k, x in self.axes.items()}
        return replace(self, program=program, instances=instances, axes=axes)

    @cached_property
    def _undefined_somewhere(self) -> Program | None:
        """What operations that have no value of some operands are made of; None where there are none."""
        entries = tuple(i for i, operation in enumerate(self.program.operations) if not _is_total(operation))
        if not entries:
            return None
        output = Output((len(entries),), tuple((k,) for k in range(len(entries))), entries)
        return replace(self.program, outputs={"undefined": output})

    def takes(self, values: Mapping[str, Fraction]) -> bool:
        """Whether these numbers may be put in: no formula divides by zero, or leaves its domain, with them."""
        program = self._undefined_somewhere
        if not values or program is None:
            return True
        try:
            bind(program, {name: values[name] for name in program.needs(program.outputs) if name in values})
        except (InvalidDocument, TooLarge):
            return False
        return True


def _is_total(operation: Operation) -> bool:
    return operation[0] in TOTAL or (operation[0] == "powi" and operation[2] > 0)


Make = Callable[[TreeSpec, Collection[str]], tuple[CertifiedProgram, bool]]


def of_shape(
    spec: TreeSpec,
    parts: Mapping[str, Part],
    group: bool,
    known: KnownShapes | None,
    make: Make,
    require: Callable[[], None],
) -> tuple[CertifiedProgram, dict[str, Fraction]]:
    """What is known of the shape of a tree, or made, and the numbers to be put in.

    ``make``: gives it of a tree that is free of the numbers of such parameters, and whether it holds for all values of
    parameters. Where it does not, and where numbers cannot be put in, the tree with its numbers is a shape of its own.
    ``require``: raises for what is wrong with the tree; called where the names of a known shape's instances are new.
    """
    free, values = without_numbers(spec)
    if values:
        try:
            found, is_shared = _found(free, parts, group, known, make, require, values)
        except (InvalidDocument, TooLarge):  # maybe not with numbers
            is_shared = False
        if is_shared and found.takes(values):
            return found, values
    return _found(spec, parts, group, known, make, require, {})[0], {}


def _found(
    spec: TreeSpec,
    parts: Mapping[str, Part],
    group: bool,
    known: KnownShapes | None,
    make: Make,
    require: Callable[[], None],
    values: Collection[str],
) -> tuple[CertifiedProgram, bool]:
    if known is None:
        return make(spec, values)
    key, names = shape_digest(spec, parts, group, values), tuple(each.name for each in spec.instances)
    found = known.get(key)
    if found is None:
        made, is_shared = make(spec, values)
        found = replace(made, instances=names)
        if is_shared:
            known.put(key, found)
        return found, is_shared
    if found.instances == names:
        return found, True
    key = f"{key} {' '.join(names)}"
    renamed = known.get(key)
    if renamed is None:
        # once for each list of names: the program of the shape keeps those that it was made with
        require()
        renamed = found.called(names)
        known.put(key, renamed)
    return renamed, True


class KnownShapes(Protocol):
    """Programs of shapes that were coupled and certified before, by :func:`shape_digest`."""

    def get(self, key: str, /) -> CertifiedProgram | None:
        """What is known of a shape, or None."""

    def put(self, key: str, value: CertifiedProgram, /) -> None:
        """Remember a shape."""


def shape_digest(
    spec: TreeSpec, parts: Mapping[str, Part], group: bool = False, constants: Collection[str] = ()
) -> str:
    """The digest of the shape of a tree: mounts, placements, bindings, loads and closures, the shapes of its ``parts``
    (by instance) with the digests of their programs; ``group``: see :func:`substructures.tree.couple.couple`;
    ``constants``: the parameters that numbers are put in for.

    Words and values of parameters are not in it; of the tree's own there is whether they have one. Names of instances
    are not in it either where nothing but mounts and expressions has them: their numbers are, and how they sort among
    the other names, as symbols do, and with them the random values that a certificate takes.
    """
    plain = spec.plain()
    if "parameters" in plain:
        plain["parameters"] = {
            name: {**each, "value": each.get("value") is not None} for name, each in plain["parameters"].items()
        }
    instances = [
        {name: x for name, x in each.items() if name not in ("substructure", "definition")}
        | {"part": parts[each["name"]].shape, **_level(each, parts[each["name"]])}
        for each in plain.get("instances", ())
    ]
    left = {name: x for name, x in plain.items() if name != "name"} | {"instances": instances}
    told = [without_descriptions(left), group, sorted(constants)]
    names = [each["name"] for each in instances]
    if names and left.keys() <= NAMELESS:
        named = {*(f"{x}." for x in names), "t", "tau.", *left.get("parameters", ()), *left.get("inputs", ())}
        told = _numbered([*told, sorted(named)], names)
        for each in told[0]["instances"]:
            del each["name"]
    return hashlib.sha256(write_json(told)).hexdigest()


def _level(instance: Mapping[str, Any], part: Part) -> dict[str, Any]:
    """Of an instance that takes the reduced level, with what its formulas take from the definition beside its shape."""
    own = part.definition.independent and instance.get("level") != "full"
    found, plain = (dependent(part), part.definition.plain()) if own else ("", {})
    chosen = {name: plain.get(name) for name in ("independent", "start")}
    return {} if isinstance(found, str) else {"level": "reduced", "branches": found.branches, **chosen}


def _numbered(plain: Any, names: Sequence[str]) -> Any:
    """Plain data with the numbers of instances, ``#0.``, in the places of their ``names`` before dots."""
    numbers = {name: f"#{k}" for k, name in enumerate(names)}
    before_dots = re.compile(rf"(?<![\w.])(?:{'|'.join(sorted(map(re.escape, names)))})(?=\.)")

    def text(given: str) -> str:
        """With the numbers."""
        return before_dots.sub(lambda found: numbers[found.group()], given)

    def value(given: Any) -> Any:
        """Of any kind."""
        if isinstance(given, str):
            return text(given)
        if isinstance(given, dict):
            return {text(name): value(x) for name, x in given.items()}
        return [value(x) for x in given] if isinstance(given, (list, tuple)) else given

    return value(plain)
