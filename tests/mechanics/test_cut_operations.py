"""A coupled tree needs no more operations than the same mechanism in one piece, wherever it is cut."""

from __future__ import annotations

import numpy as np
import pytest
from catalogue_entries import CHAINS, all_entries
from random_cuts import all_cuts
from random_trees import Plain

from substructures import Definition, Program, catalogue
from substructures.expr.hoist import hoisted
from substructures.part.one_piece import derive_in_one_piece

from .catalogue_cuts import bare, in_pieces

#: outputs that are counted, and counted together
COUNTED = (
    *(("metric",), ("christoffel",), ("metric", "christoffel"), ("gravity",)),
    *(("bias",), ("nonlinear_effects",), ("inverse_dynamics",)),
)
Counts = dict[str, tuple[int, int]]


def counted(program: Program) -> Counts:
    """Operations in all, and per state."""
    found: Counts = {}
    for names in COUNTED:
        if program.outputs.keys() >= set(names):
            per_state = hoisted(program.select(names)).count(per_state=True)["total"]
            found[" + ".join(names)] = program.count(names)["total"], per_state
    return found


def in_one_piece(definition: Plain) -> Counts:
    """Of metric and Christoffel symbols derived without coupling, and of a tree of one part: the lower ones. Without
    coupling there are no Christoffel symbols in rates.
    """
    is_chain = definition["name"] in CHAINS
    whole = counted(derive_in_one_piece(Definition.read(definition)).select(("metric", *["christoffel"] * is_chain)))
    alone = counted(in_pieces(definition, ()).program)
    none = (10**9, 10**9)
    lower = {n: tuple(map(min, alone.get(n, none), whole.get(n, none))) for n in alone | whole}
    return {name: (in_all, per_state) for name, (in_all, per_state) in lower.items()}


def dearer(definition: Plain, most: int) -> list[str]:
    """Cuts that cost more than one piece; at most so many are tried, with no cut and all of them among these."""
    cuts, whole = list(all_cuts(definition)), in_one_piece(definition)
    if len(cuts) > most:
        drawn = np.random.default_rng(4).choice(np.arange(1, len(cuts) - 1), most - 2, replace=False)
        cuts = [cuts[0], cuts[-1], *(cuts[i] for i in drawn)]
    found = []
    for cut in cuts:
        for name, counts in counted(in_pieces(definition, cut).program).items():
            if any(x > y for x, y in zip(counts, whole[name], strict=True)):
                found.append(f"{name} cut at {', '.join(cut)}: {counts}, in one piece {whole[name]}")
    return found


@pytest.mark.parametrize("name", all_entries())
def test_no_cut_costs_more_than_one_piece(name: str) -> None:
    assert not dearer(bare(name), 6)


@pytest.mark.deep
@pytest.mark.parametrize("name", catalogue.names())
def test_none_of_all_cuts_costs_more_than_one_piece(name: str) -> None:
    """Of the 2,048 of the gripper with eleven bodies as many as the largest arm has."""
    assert not dearer(bare(name), 256)
