"""What can be said of g_ab, Gamma_abc and Q_a in words: by which coordinates an element is changed, what repeats.

Whether an element depends on a coordinate is read from its program, in which equal formulas are one operation and what
cancels is gone (notation.md, section 8). Elements are told as g[1,2], counted from 1, Christoffel
symbols as Gamma[1,1,2]; ``entries`` count from 0.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.errors import InvalidInput, TooLarge, VerificationFailed, listed
from substructures.expr.operations import Output, operands
from substructures.expr.program import Program
from substructures.printers.symmetry import symmetry_rule
from substructures.tree.model import Model

#: operations of a model up to which symmetries are looked for
SEARCHED = 20_000
Index = tuple[int, ...]
#: around what is mathematics
MARK = "$"
#: what a name of the tree is called for people
Names = Mapping[str, str]


@dataclass(frozen=True)
class Figure:
    """A number that carries a statement, in its unit."""

    name: str
    value: float
    unit: str


@dataclass(frozen=True)
class Statement:
    """``about``: a key of SECTIONS of :mod:`.report`; ``code``: which statement it is; ``marked``: in words, with names
    and elements between dollar signs; ``figures``: the numbers that carry it; ``request``: method and path that tell
    more.
    """

    about: str
    code: str
    marked: str
    entries: tuple[Index, ...] = field(default=())
    coordinates: tuple[str, ...] = ()
    figures: tuple[Figure, ...] = ()
    request: str = ""

    @property
    def text(self) -> str:
        """In words."""
        return self.marked.replace(MARK, "")

    def plain(self) -> dict[str, Any]:
        """Plain data."""
        return {"text" if key == "marked" else key: x for key, x in (asdict(self) | {"marked": self.text}).items()}


class Dependence:
    """Which symbols every operation of a program depends on."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self._number = {s.name: n for n, s in enumerate(program.symbols)}
        masks: list[int] = []
        for operation in program.operations:
            mask = 1 << operation[1] if operation[0] == "sym" else 0
            for x in operands(operation):
                mask |= masks[x]
            masks.append(mask)
        self._masks = masks

    def of(self, entry: int, names: Iterable[str]) -> tuple[str, ...]:
        """Those of the names that an operation depends on."""
        mask = self._masks[entry]
        return tuple(name for name in names if name in self._number and mask >> self._number[name] & 1)

    def kinds(self, entry: int, kind: str) -> tuple[str, ...]:
        """The symbols of a kind that an operation depends on."""
        return self.of(entry, (s.name for s in self.program.symbols if s.kind == kind))


def metric_statements(model: Model, names: Names) -> Iterator[Statement]:
    """Constant, zero and equal elements of g_ab; where every coordinate occurs; what inertia does not couple."""
    output, n = model.program.outputs["metric"], model.dof
    found, depends = Dependence(model.program), {}
    for index, entry in zip(output.index, output.entries, strict=True):
        depends[index] = found.of(entry, model.coordinates)
    given = {tuple(sorted(index)) for index in output.index}
    zero = tuple((a, b) for a in range(n) for b in range(a, n) if (a, b) not in given)
    constant = tuple(index for index, some in depends.items() if not some)
    every = n * (n + 1) // 2
    if constant:
        yield Statement("metric", "constant", f"{_elements('g', constant)} {_do(constant)} not change.", constant)
    if zero:
        text = f"{_elements('g', zero)} {'is' if len(zero) == 1 else 'are'} zero ({len(zero)} of {every} elements)."
        yield Statement("metric", "zero", text, zero)
    for name in model.coordinates:
        where = tuple(index for index, some in depends.items() if name in some)
        what = _elements("g", where) if where else f"no element of {MARK}g{MARK}"
        text = f"{names[name]} changes {what}."
        yield Statement("metric", "coordinate", text, where, (name,))
    yield from _equal(output, "g", "metric")
    yield from _blocks(model, given, names)


def _equal(output: Output, letter: str, about: str) -> Iterator[Statement]:
    """Elements that are the same formula."""
    same: dict[int, list[Index]] = {}
    for index, entry in zip(output.index, output.entries, strict=True):
        same.setdefault(entry, []).append(index)
    for group in same.values():
        if len(group) > 1:
            yield Statement(about, "equal", f"{_elements(letter, group)} are equal.", tuple(group))


def _blocks(model: Model, given: Iterable[Index], names: Names) -> Iterator[Statement]:
    """Groups of coordinates that the metric does not couple with others."""
    group = list(range(model.dof))
    for a, b in given:
        if group[a] != group[b]:
            old, new = sorted((group[a], group[b]), reverse=True)
            group = [new if x == old else x for x in group]
    blocks = [[c for c, g in zip(model.coordinates, group, strict=True) if g == k] for k in sorted(set(group))]
    if len(blocks) > 1:
        told = "; ".join(listed(names[c] for c in block) for block in blocks[:12])
        text = f"Inertia couples only coordinates within each of these groups: {told}."
        yield Statement("metric", "blocks", text, coordinates=tuple(c for block in blocks for c in block))


def christoffel_statements(model: Model, names: Names) -> Iterator[Statement]:
    """How many are independent and not zero, by which rule all others follow, and which equations have none."""
    n = model.dof
    if "christoffel" not in model.program.outputs:
        text = (
            "Of so many coordinates no formulas of Christoffel symbols are stored; velocity forces are found without."
        )
        yield Statement("christoffel", "not-stored", text)
        return
    output = model.program.outputs["christoffel"]
    every = n * n * (n + 1) // 2 if output.symmetry == "connection" else n * (n * n - 1) // 3
    index = tuple(output.index)
    text = f"{len(index)} of {every} independent Christoffel symbols are not zero; {_rule(output.symmetry)}."
    yield Statement("christoffel", "independent", text, index)
    acting: dict[int, set[Index]] = {a: set() for a in range(n)}
    for (a, b, c), _, _ in output.expanded():
        acting[a].add((b, c))
    free = tuple(model.coordinates[a] for a, some in acting.items() if not some)
    if free:
        but = f" but those of the given {'motions' if model.driven else 'momenta'}" if model.given else ""
        text = f"The equations of {listed(names[c] for c in free)} have no velocity forces{but}."
        yield Statement("christoffel", "no-velocity-forces", text, coordinates=free)
    centrifugal = {b for some in acting.values() for b, c in some if b == c}
    silent = tuple(name for a, name in enumerate(model.coordinates) if a not in centrifugal)
    if silent and len(silent) < n:
        text = f"No centrifugal forces (of one rate squared) come from {listed(names[c] for c in silent)}."
        yield Statement("christoffel", "no-centrifugal-forces", text, coordinates=silent)
    yield from _equal(output, "Gamma", "christoffel")


def force_statements(model: Model, names: Names) -> Iterator[Statement]:
    """What acts on every coordinate: gravity, what depends on rates and time, inputs."""
    program, found = model.program, Dependence(model.program)
    gravity = {a for (a,) in program.outputs["gravity"].index}
    forces = dict(zip(program.outputs["forces"].index, program.outputs["forces"].entries, strict=True))
    for a, name in enumerate(model.coordinates):
        entry = forces.get((a,))
        acting = ["gravity"] if a in gravity else []
        if entry is not None:
            inputs = [names.get(x, x) for x in found.kinds(entry, "input")]
            rates = [names.get(x, x) for x in found.kinds(entry, "velocity")]
            acting += [f"the input{'s' if len(inputs) > 1 else ''} {listed(inputs)}"] if inputs else []
            acting += [f"forces that depend on {listed(rates)}"] if rates else []
            acting += ["forces that depend on time"] if found.kinds(entry, "time") else []
            moved = found.of(entry, model.coordinates)
            acting += [] if a in gravity or not moved else [f"forces that depend on {listed(names[c] for c in moved)}"]
        text = f"On {names[name]} {_act(acting)}."
        yield Statement("forces", "acting", text, ((a,),), (name,))


def _act(acting: Sequence[str]) -> str:
    if not acting:
        return "nothing acts"
    *others, last = acting
    return f"{', '.join(others)} and {last} act" if others else f"{last} act{'' if 'forces' in last else 's'}"


def symmetry_statements(model: Model, names: Names) -> Iterator[Statement]:
    """Cyclic coordinates and first integrals with their reasons, with inputs zero."""
    if len(model.program) > SEARCHED:
        text = f"Symmetries were not looked for: {len(model.program):,} operations; the limit is {SEARCHED:,}."
        yield Statement("symmetries", "not-searched", text)
        return
    try:
        found = first_integrals(model)
    except (InvalidInput, TooLarge, VerificationFailed) as error:
        yield Statement("symmetries", "not-searched", f"Symmetries were not looked for: {error}.")
        return
    if found.cyclic:
        told = listed(names[c] for c in found.cyclic)
        text = (
            f"Cyclic: {told}; neither the metric nor the forces depend on {'it' if len(found.cyclic) == 1 else 'them'}."
        )
        yield Statement("symmetries", "cyclic", text, coordinates=found.cyclic)
    has_inputs = any(s.kind == "input" for s in model.program.select(["forces"]).symbols)
    for each in found.integrals:
        words = {"constant": "is constant", "falling": "falls", "balance": "changes by the power fed in"}[each.rule]
        condition = " while all inputs are zero" if has_inputs else ""
        text = f"{_called(each.name, names)} {words}{condition}: {in_short(each.reason, model, names)}."
        yield Statement("symmetries", each.kind, text, coordinates=tuple(each.direction))
    if not found.cyclic and not found.integrals:
        yield Statement("symmetries", "none", "No coordinate is cyclic, and no first integral follows from a symmetry.")


def _called(name: str, names: Names) -> str:
    """The name of an integral as a sentence begins."""
    kind, dot, rest = name.partition(".")
    said = kind.replace("_", " ").capitalize()
    return f"{said} {names.get(rest, rest)}" if dot else said


def reason_of(error: Exception) -> str:
    """Why something cannot be told, without places in documents."""
    return "; ".join(fault.message for fault in error.faults) if isinstance(error, InvalidInput) else str(error)


def in_short(reason: str, model: Model, names: Names) -> str:
    """A reason with the names of coordinates that the other statements have."""
    for name in model.coordinates:
        reason = reason.replace(f"'{name}'", names[name])
    return reason


def _elements(letter: str, index: Iterable[Index]) -> str:
    return listed((f"{MARK}{letter}[{','.join(str(i + 1) for i in one)}]{MARK}" for one in index), 16)


def _rule(symmetry: str) -> str:
    """That of Christoffel symbols."""
    return re.sub(r"Gamma\[[^\]]*\]", lambda m: MARK + m.group() + MARK, symmetry_rule(symmetry, "Gamma"))


def _do(index: Sequence[Index]) -> str:
    return "does" if len(index) == 1 else "do"
