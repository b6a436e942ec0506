"""The rows of a sweep by number: which option stands in the place of each instance, and which sample it is.

Row ``k`` is the sample ``k mod S`` of the combination ``k div S``; of the combinations the option of the last instance
varies fastest.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import prod
from typing import Any

from substructures.ensembles.samples import MOST_ROWS, Sampler
from substructures.errors import InvalidDocument, InvalidInput, among
from substructures.part.definition import Parameter
from substructures.sweeps.columns import Columns, read_columns
from substructures.sweeps.document import MOST_KEPT, Choice, SweepDocument
from substructures.tree.document import TreeSpec
from substructures.tree.given.ties import require_untied

#: fields of an instance that a choice replaces as they are; parameters are put to those of the template
_REPLACED = ("substructure", "at", "placement")


@dataclass(frozen=True)
class Plan:
    """A sweep whose options are known. ``options``: by instance, fields of the instance in the tree document."""

    document: SweepDocument
    options: tuple[tuple[Mapping[str, Any], ...], ...]

    @cached_property
    def sampler(self) -> Sampler:
        """What makes the samples."""
        return Sampler(self.document.samples)

    @cached_property
    def columns(self) -> Columns:
        """The columns."""
        return read_columns(self.document)

    @cached_property
    def instances(self) -> tuple[str, ...]:
        """The names of the instances."""
        return tuple(each[0]["name"] for each in self.options)

    @cached_property
    def own_units(self) -> dict[str, str]:
        """The SI units of the parameters of the tree itself, as far as they are declared."""
        declared = self.document.template.get("parameters") or {}
        return {name: Parameter.model_validate(each).unit for name, each in declared.items()}

    @property
    def combinations(self) -> int:
        """How many combinations of options there are."""
        return prod(len(each) for each in self.options)

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return self.combinations * self.sampler.size

    @property
    def rows_of_shape(self) -> int:
        """How many rows a shape has if options of one part are of one shape, and those of others are of others."""
        return self.rows // prod(len({str(one.get("substructure")) for one in each}) for each in self.options)

    def chosen(self, combination: int) -> tuple[int, ...]:
        """The index of the option of each instance."""
        found = []
        for each in reversed(self.options):
            combination, index = divmod(combination, len(each))
            found.append(index)
        return tuple(reversed(found))

    def tree(self, row: int) -> dict[str, Any]:
        """The tree document of a row, with its numbers bound."""
        combination, sample = divmod(row, self.sampler.size)
        numbers = {name: float(x[0]) for name, x in self.sampler.rows(sample, sample + 1).items()}
        tree = copy.deepcopy(self.document.template)
        pairs = zip(self.options, self.chosen(combination), strict=True)
        tree["instances"] = [copy.deepcopy(dict(each[k])) for each, k in pairs]
        for instance in tree["instances"]:
            own = {n.partition(".")[2]: x for n, x in numbers.items() if n.partition(".")[0] == instance["name"]}
            if own:
                instance["parameters"] = {**instance.get("parameters", {}), **own}
        for name, number in numbers.items():
            if name in self.own_units:
                tree["parameters"][name] |= {"value": number, "unit": self.own_units[name]}
        return {**tree, "name": f"{tree['name']}-{row}"[-64:].lstrip("-")}

    def shown(self, row: int) -> dict[str, str]:
        """What stands in the places for which there is a choice."""
        found = self.chosen(row // self.sampler.size)
        pairs = zip(self.instances, self.options, found, strict=True)
        return {name: str(each[k]["substructure"]).partition("@")[0] for name, each, k in pairs if len(each) > 1}


def given_options(document: SweepDocument) -> list[list[tuple[str, Mapping[str, Any]]]]:
    """By instance of the template its options, each with the pointer to what says so: fields of an instance, of which
    ``query`` has to be replaced by what it finds. Raises InvalidDocument.
    """
    instances = document.template.get("instances")
    if not isinstance(instances, list) or not instances or not all(isinstance(each, dict) for each in instances):
        raise InvalidDocument.at("/template/instances", "missing", "a tree with instances is needed")
    names = [str(each.get("name")) for each in instances]
    for name in document.choices:
        if name not in names:
            more = "; numbers of parameters are 'samples'" if "." in name else ""
            message = f"the template has no instance '{name[:80]}'{among(name, names)}{more}"
            raise InvalidDocument.at(f"/choices/{name}", "unknown-choice", message)
    found = []
    for k, (name, instance) in enumerate(zip(names, instances, strict=True)):
        given = document.choices.get(name)
        if given is None:
            found.append([(f"/template/instances/{k}", instance)])
            continue
        one = isinstance(given, Choice)
        listed = [given] if isinstance(given, Choice) else given
        if not listed:
            raise InvalidDocument.at(f"/choices/{name}", "empty", f"no choice is given for '{name}'")
        places = [f"/choices/{name}" + ("" if one else f"/{i}") for i in range(len(listed))]
        found.append([(place, _merged(instance, each)) for place, each in zip(places, listed, strict=True)])
    return found


def _merged(instance: Mapping[str, Any], choice: str | Choice) -> dict[str, Any]:
    """The instance with what a choice says."""
    given = Choice(substructure=choice) if isinstance(choice, str) else choice
    fields = {name: x for name in _REPLACED if (x := getattr(given, name)) is not None}
    merged = {**instance, **fields}
    if given.query is not None:
        merged["query"] = given.query
    if given.parameters is not None:
        merged["parameters"] = {**instance.get("parameters", {}), **given.parameters}
    if given.substructure is not None:
        merged.pop("definition", None)
    return merged


def check_size(document: SweepDocument, sizes: Sequence[int]) -> None:
    """Raise InvalidDocument for more rows than a sweep has; ``sizes``: options by instance."""
    samples = Sampler(document.samples).size
    rows = prod(sizes) * samples
    told = " x ".join(f"{n:,}" for n in [*(n for n in sizes if n > 1), samples])
    if rows > MOST_ROWS:
        message = f"{rows:,} rows ({told}); a sweep has {MOST_ROWS:,} at most: choose fewer values, or draw samples"
        raise InvalidDocument.at("/samples" if document.samples else "/choices", "too-many-rows", message)
    if rows > MOST_KEPT and document.keep is None:
        message = f"{rows:,} rows ({told}) are more than a table holds, {MOST_KEPT:,}: say with 'keep' how many"
        raise InvalidDocument.at("/keep", "missing", message)


def check_template(document: SweepDocument, options: Sequence[Sequence[Mapping[str, Any]]]) -> None:
    """Raise InvalidDocument for a template that is no tree with the first options."""
    try:
        spec = TreeSpec.read({**document.template, "instances": [dict(each[0]) for each in options]})
        require_untied(spec, "sweep")
    except InvalidInput as error:
        raise error.below("/template") from None
