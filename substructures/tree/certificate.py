"""What was checked when a tree was coupled: every output against the text of the tree and of its parts' definitions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from time import perf_counter
from typing import Any

from substructures.certificate.agreement import HOW, told
from substructures.certificate.compare import Compared, compare
from substructures.certificate.described import described, free_coordinates
from substructures.certificate.given.driven import of_free
from substructures.certificate.given.reduced import reduced_outputs
from substructures.certificate.given.sides import Make, on_a_side, require_start, starts_of
from substructures.certificate.numbers import Plain
from substructures.certificate.outputs import Outputs
from substructures.certificate.states import states_needed
from substructures.certificate.tree_outputs import level_at, tree_outputs, tree_symbols, with_given
from substructures.certificate.written import defaults_of, plain
from substructures.errors import VerificationFailed
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.derive import recheck
from substructures.part.part import Part
from substructures.tree.document import TreeSpec

#: outputs out of the documents of a tree and of its parts, names of rows, and values of symbols
RowsExpected = Callable[[Plain, Mapping[str, Plain], Sequence[str], Mapping[str, Any]], Outputs]


def certify_tree(
    spec: TreeSpec,
    definitions: Mapping[str, Definition],
    summary: Mapping[str, Any],
    result: Program,
    seconds: float = 0.0,
) -> dict[str, Any]:
    """Compare every output of a coupled tree with the documents (certificate.md); ``definitions``: by instance.

    ``summary``: what the axes of the outputs are called, as :meth:`substructures.tree.model.Model.summary` says it.
    Raises VerificationFailed for a wrong formula, also where a part's stored program was wrong.
    """
    start = perf_counter()
    certificate, _ = certified(spec, definitions, summary, result)
    return certificate | {"seconds": seconds_of(seconds, perf_counter() - start)}


def _require_levels(tree: Plain, parts: Mapping[str, Plain]) -> None:
    """Raises VerificationFailed for a reduced instance whose document says something else."""
    levels = {i["name"]: i.get("level") for i in tree.get("instances", ())}
    for name in tree["reduced"]:
        if levels.get(name, "full") == "full" or not parts[name].get("independent"):
            raise VerificationFailed(f"the documents do not say that '{name[:80]}' is reduced")


def seconds_of(couple: float, verify: float) -> dict[str, float]:
    """What a certificate says of the time that coupling and comparing took."""
    return {"couple": round(couple, 6), "verify": round(verify, 6)}


def certified(
    spec: TreeSpec, definitions: Mapping[str, Definition], summary: Mapping[str, Any], result: Program
) -> tuple[dict[str, Any], bool]:
    """What the certificate says of the formulas, and whether that holds for all values of the parameters' defaults:
    they were not needed. Raises as :func:`certify_tree`.
    """
    tree, parts = plain(spec), {name: plain(definition) for name, definition in definitions.items()}
    # what a level is of is read from the documents; of models of older versions none is reduced
    tree = {**tree, "reduced": [str(each["instance"]) for each in summary.get("reduced", ())]}
    _require_levels(tree, parts)
    # models of older versions know nothing of limits
    older = "limited" not in summary
    for name, said in described(tree, parts).items():
        if older and name == "limited":
            continue
        if summary.get(name, []) != said:
            raise VerificationFailed(f"the {name} of the model are not those of the documents: {said}")

    def expected(tree: Plain, values: Mapping[str, Any]) -> Outputs:
        """All that a model of its version has."""
        outputs = tree_outputs(tree, parts, values, result.outputs)
        return Outputs({name: x for name, x in outputs.items() if name != "limits" or not older})

    require_start(tree, parts, result, expected, tree_symbols(tree, parts))
    states, compared = _compared(tree, parts, result, expected)
    return {**HOW, "states": states, "direct_form": told(compared)}, not compared.at_defaults


def certify_rows(
    what: str,
    spec: TreeSpec,
    definitions: Mapping[str, Definition],
    result: Program,
    rows: Sequence[str],
    outputs: RowsExpected,
    more: Mapping[str, str] | None = None,
    reduced: Sequence[str] = (),
) -> Program:
    """Compare formulas with named rows, which are derived beside those of a model, with what ``outputs`` makes of the
    documents of the tree and of its parts at a state.

    ``more``: kinds of symbols beside those of the tree; ``reduced``: instances of the reduced level. Returns the
    program, in which what cannot be judged is marked. Raises VerificationFailed, which says ``what`` is wrong.
    """
    tree, parts = plain(spec), {name: plain(definition) for name, definition in definitions.items()}
    tree = {**tree, "reduced": list(reduced)}
    every = list(free_coordinates(tree, parts))

    def expected(tree: Plain, values: Mapping[str, Any]) -> Outputs:
        """Of free coordinates, at motions or momenta of the others as they are given."""
        level = level_at(tree, parts, with_given(tree, parts, values))
        found = reduced_outputs(tree, parts, level, outputs(tree, parts, rows, level.values))
        return of_free(found, every, tree.get("driven", ()))

    try:
        _, found = _compared(tree, parts, result, expected, more)
    except VerificationFailed as error:
        raise VerificationFailed(f"{what}: {error}") from None
    return result.marked(found.not_judged)


def _compared(
    tree: Plain,
    parts: Mapping[str, Plain],
    result: Program,
    expected: Make,
    more: Mapping[str, str] | None = None,
) -> tuple[int, Compared]:
    """At how many states, and what was found."""
    defaults = defaults_of(tree)
    for name, part in parts.items():
        defaults |= defaults_of(part, f"{name}.")
    defaults |= starts_of(tree, parts)
    states = states_needed(result.operations, [tree, *parts.values()])
    kinds = tree_symbols(tree, parts) | dict(more or {})
    return states, compare(result, kinds, on_a_side(tree, parts, result, expected), defaults, states)


def blamed(parts: Mapping[str, Part], error: VerificationFailed) -> VerificationFailed:
    """The failure of a part whose stored formulas are wrong, by name; that of the tree where all parts are right."""
    for instance, part in parts.items():
        try:
            recheck(part)
        except VerificationFailed as fault:
            what = f"the stored formulas of '{part.name}' ({part.program.digest}, instance '{instance}') are wrong"
            return VerificationFailed(f"{what}: {fault}")
    return error
