"""Programs that follow from a model are formed once, and given up when there are too many."""

from __future__ import annotations

from dataclasses import replace

from analysis_models import catalogue_model
from exported_models import derived_anew

from substructures import Model
from substructures.expr.program import Program
from substructures.quantities.formulas import derived, kept
from substructures.quantities.numbers.memo import ProgramCache, known_model


def test_equal_models_share_what_follows_from_them() -> None:
    first, second = derived_anew("double-pendulum"), derived_anew("double-pendulum")
    assert first is not second
    assert kept(first, "coriolis") is kept(second, "coriolis")
    assert kept(first, "coriolis") == derived(first, "coriolis")


def test_the_axes_are_part_of_the_key() -> None:
    """The same program with other names of its axes is another model."""
    model = catalogue_model("double-pendulum")
    turned = Model(model.program, model.coordinates[::-1], model.joints, model.frames, model.parameters, {})
    assert kept(model, "kinetic_energy") is not kept(turned, "kinetic_energy")


def test_velocity_constraints_are_part_of_the_key() -> None:
    """They are in no output, but in what follows."""
    model = catalogue_model("double-pendulum")
    first, second = ({"type": "linear", "name": "belt", "expression": f"{k}*x.q1'"} for k in (1, 2))
    keys = {known_model(replace(model, velocity_constraints=some)) for some in ((), (first,), (second,))}
    assert len(keys) == 3


def test_the_cache_is_bounded_by_operations() -> None:
    model, made = catalogue_model("double-pendulum"), list[str]()

    def program(name: str) -> Program:
        made.append(name)
        return derived(model, name)

    sizes = {name: len(derived(model, name)) for name in ("coriolis", "kinetic_energy")}
    cache = ProgramCache(capacity=sum(sizes.values()) - 1)
    for name in ("coriolis", "coriolis", "kinetic_energy", "kinetic_energy", "coriolis"):
        cache.get(model, name, lambda name=name: program(name))
    assert made == ["coriolis", "kinetic_energy", "coriolis"]
