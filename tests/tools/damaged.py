"""Stored programs with one fault each, as a wrong derivation or a damaged store would leave them (digests made anew);
what certificates say of them.

Hundreds of programs are compared with the same documents at the same states: what these say is computed once.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from flint import ctx

from substructures import Model, Part, TreeSpec
from substructures.certificate.agreement import require_no_less
from substructures.certificate.outputs import Outputs
from substructures.certificate.part_outputs import part_outputs
from substructures.certificate.tree_outputs import tree_outputs
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.expr.known import Known
from substructures.expr.program import Operation, Program
from substructures.part.derive import recheck
from substructures.part.mechanism import Mechanism, mechanism
from substructures.tree.certificate import certify_tree

NUDGE = Fraction(1_000_001, 1_000_000)
KINDS = ("sign", "factor", "exchanged", "nudged", "left out")


def damages(
    program: Program, rng: np.random.Generator, elements: int = 1, kinds: int = len(KINDS)
) -> Iterator[tuple[str, str, Program]]:
    """(kind, place, program): every output damaged in all (or some) ways, at ``elements`` of its elements each."""
    for name, output in program.outputs.items():
        for kind in rng.choice(KINDS, kinds, replace=False) if output.entries else ():
            for k in rng.choice(len(output.entries), min(elements, len(output.entries)), replace=False):
                wrong = _damaged(program, name, int(k), kind, rng)
                if wrong is not None:
                    yield kind, f"{name}{list(output.index[int(k)])}", wrong


def nudged_numbers(program: Program) -> Iterator[tuple[str, str, Program]]:
    """Every number in the program, one after the other, off by 1e-6 of itself."""
    for i, operation in enumerate(program.operations):
        if operation[0] in ("int", "rat") and operation[1] != "0":
            value = Fraction(int(operation[1]), int(operation[2]) if operation[0] == "rat" else 1) * NUDGE
            number = ("rat", str(value.numerator), str(value.denominator))
            yield "number", f"operation {i}", _with(program, {i: number})


def _with(program: Program, changed: dict[int, Operation]) -> Program:
    operations = tuple(changed.get(i, operation) for i, operation in enumerate(program.operations))
    return _read(replace(program, operations=operations))


def _read(program: Program) -> Program:
    """As a store gives it back (test_certificate.py), with a digest of its own; what no output needs is left out."""
    return program.select(list(program.outputs))


def _damaged(program: Program, name: str, k: int, kind: str, rng: np.random.Generator) -> Program | None:
    output, n = program.outputs[name], len(program.operations)
    entry = output.entries[k]
    more: list[Operation] = []
    entries = list(output.entries)
    index = output.index
    if kind == "sign":
        more, entries[k] = [("neg", entry)], n
    elif kind == "factor":
        more, entries[k] = [("add", entry, entry)], n
    elif kind == "nudged":
        more = [("rat", str(NUDGE.numerator), str(NUDGE.denominator)), ("mul", entry, n)]
        entries[k] = n + 1
    elif kind == "left out":
        if name in ("E.turn", "E.tilt") and program.operations[entry] == ("int", "1"):
            return None  # a factor of E that is left out is the identity, as it was
        entries, index = [*entries[:k], *entries[k + 1 :]], (*index[:k], *index[k + 1 :])
    else:
        others = [i for i, other in enumerate(entries) if other != entry]
        if not others:
            return None
        other = others[int(rng.integers(len(others)))]
        entries[k], entries[other] = entries[other], entries[k]
    changed = replace(output, entries=tuple(entries), index=index)
    return _read(replace(program, operations=(*program.operations, *more), outputs={**program.outputs, name: changed}))


def errors_of(certificate: Any) -> dict[str, float | None]:
    found: dict[str, float | None] = certificate["direct_form"]["max_relative_error"]
    return found


class Once:
    """``part_outputs`` or ``tree_outputs``, computed once for the same arguments; kept for one document at a time.

    Of the outputs of a program, which are the last argument, they may know all but the places in the program.
    """

    def __init__(self, outputs: Callable[..., Outputs]) -> None:
        self._outputs, self._of, self._known = outputs, "", dict[Any, Outputs]()

    def __call__(self, *given: Any) -> Outputs:
        *documents, values, stored = given
        if (text := repr(documents)) != self._of:
            self._of, self._known = text, {}
        state = ((name, *x.mid().man_exp(), *x.rad().man_exp()) for name, x in values.items())
        shapes = ((name, x.shape, x.symmetry, x.index) for name, x in stored.items())
        key = ctx.prec, tuple(state), tuple(shapes)
        if key not in self._known:
            self._known[key] = self._outputs(*given)
        return self._known[key]


PART_OUTPUTS, TREE_OUTPUTS = Once(part_outputs), Once(tree_outputs)


@lru_cache(maxsize=1)
def _mechanism(known: Known) -> Mechanism:
    return mechanism(known.source)


def found_in_part(part: Part, wrong: Program) -> str | None:
    """What the certificate of the part says of a program; None when it lets it pass."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("substructures.part.derive.mechanism", lambda of: _mechanism(Known(of.digest, of)))
        patch.setattr("substructures.part.certificate.part_outputs", PART_OUTPUTS)
        return refusal(lambda: recheck(replace(part, program=wrong)))


def found_in_tree(spec: TreeSpec, parts: dict[str, Part], model: Model, wrong: Program) -> str | None:
    definitions, summary = {name: part.definition for name, part in parts.items()}, model.summary()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("substructures.tree.certificate.tree_outputs", TREE_OUTPUTS)
        return refusal(lambda: require_no_less(model.certificate, certify_tree(spec, definitions, summary, wrong)))


def refusal(certify: Callable[[], object]) -> str | None:
    """What is said where nothing is certified."""
    try:
        certify()
    except VerificationFailed as error:
        return str(error)
    return None


def require_all_found(part: Part, spec: TreeSpec, model: Model, least: int = 30) -> None:
    """Damages that have an effect are found: of a part, more than ``least``, and of its tree, in which it is ``x``."""
    rng, tried = np.random.default_rng(0), 0
    for kind, place, wrong in damages(part.program, rng, kinds=2):
        if has_effect(part.program, wrong):
            assert found_in_part(part, wrong), (kind, place)
            tried += 1
    assert tried > least
    for kind, place, wrong in damages(model.program, rng, kinds=1):
        if has_effect(model.program, wrong):
            assert found_in_tree(spec, {"x": part}, model, wrong), (kind, place)


def has_effect(program: Program, wrong: Program, names: Iterable[str] | None = None) -> bool:
    """Whether any output (of these names) changes at all: a number may stand beside a factor that is zero."""
    rng = np.random.default_rng(9)
    values = {s.name: rng.uniform(-2, 2, 3) for s in program.symbols}
    chosen = list(program.outputs if names is None else names)
    before, after = interpret(program, values), interpret(wrong, values)
    return any(not np.array_equal(before[name], after[name], equal_nan=True) for name in chosen)


def verified(part: Part) -> list[str]:
    """The outputs that the certificate of a part vouches for: not those that it calls null."""
    return [name for name, error in errors_of(part.certificate).items() if error is not None]


def as_json(data: Any) -> bytes:
    return json.dumps(data).encode()
