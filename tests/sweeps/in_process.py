"""Sweeps in process, of parts of the catalogue and others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from catalogue_entries import shipped_part

from substructures import derive
from substructures.documents import read_model
from substructures.part.part import Part
from substructures.sweeps.block import Block, Refusals, compute, rounding, shape_maker, slow_columns
from substructures.sweeps.document import SweepDocument
from substructures.sweeps.plan import Plan, given_options
from substructures.sweeps.shapes import Option, Shape, option_of


class Sweep:
    """A sweep of parts of the catalogue, and of ``own`` ones by name, in process."""

    def __init__(self, base: Mapping[str, Any], own: Mapping[str, Any] | None = None, **changes: Any) -> None:
        document = read_model(SweepDocument, {**base, **changes})
        self.own: dict[str, Part] = {name: derive(each) for name, each in (own or {}).items()}
        given = [[fields for _, fields in each] for each in given_options(document)]
        self.plan = Plan(document, tuple(tuple(each) for each in given))
        self.made: dict[tuple[str, ...], Shape] = {}
        self.refusals = Refusals()

    def option(self, i: int, k: int) -> Option:
        fields = self.plan.options[i][k]
        name = fields["substructure"]
        return option_of(self.own.get(name) or shipped_part(name), fields)

    def rows(self, start: int = 0, stop: int | None = None) -> Block:
        shape_of = shape_maker(self.plan, self.made)
        return compute(self.plan, start, stop or self.plan.rows, self.option, shape_of, self.refusals, [])

    def moved(self, row: int) -> dict[str, float]:
        chosen = self.plan.chosen(row // self.plan.sampler.size)
        options = [self.option(i, k) for i, k in enumerate(chosen)]
        return rounding(self.plan, row, options, shape_maker(self.plan, self.made))

    def slow(self, row: int) -> tuple[dict[str, float], float]:
        chosen = self.plan.chosen(row // self.plan.sampler.size)
        return slow_columns(self.plan, row, [self.option(i, k).part for i, k in enumerate(chosen)])
