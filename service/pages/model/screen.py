"""What is shown of a part or a tree on its page and by its fragments: made once for each model, but for the pose."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Annotated, Any

import orjson
from fastapi import Query

from service.jobs.worker import Worker
from service.messages.refusals import not_found
from service.operations import modules
from service.pages.html import Html, tag
from service.pages.model.entry import panel
from service.pages.model.grid import grid, integrals_table, posed
from service.pages.model.place import formulas, place, state
from service.pages.model.shown import INTEGRALS, Shown, read_entry
from service.store.store import Store
from substructures.array import Array
from substructures.errors import InvalidInput
from substructures.expr.program import Program, read_program

Text = Annotated[str, Query(max_length=50_000)]
Poses = Annotated[str | None, Query(max_length=50_000)]
Numbers = Annotated[list[str] | None, Query(alias="q", max_length=2_000)]
Slice = Annotated[int, Query(alias="slice", ge=0, le=100_000)]
Subject = Callable[[], modules.Subject]


@dataclass(frozen=True)
class Asked:
    """What of a part or tree is shown: the state, a tab of formulas, one entry; ``qd`` and ``set``, the rates and the
    parameters that differ from their defaults, are read by scripts."""

    pose: Poses = None
    q: Numbers = None
    tab: Text = ""
    slice_: Slice = 0
    entry: Text = ""
    qd: Text = ""
    set: Text = ""


def chosen_tab(shown: Shown, wanted: str) -> str:
    """The quantity of this name, the first one where there is none."""
    return wanted if wanted in shown.tabs else next(iter(shown.tabs), "")


def first_screen(store: Store, shown: Shown, subject: Subject, worker: Worker, asked: Asked) -> Html:
    """View, sliders, formulas, and the entry that is chosen; nothing of what does not move. Raises as
    :func:`entry_of`."""
    if not shown.coordinates:
        return Html()
    quantity = chosen_tab(shown, asked.tab or (read_entry(asked.entry) or ("",))[0])
    has_numbers = bool(asked.q) and quantity != INTEGRALS

    def make() -> Html:
        """With numbers in the pose where no script computes them."""
        numbers = shown.numbers(quantity) if has_numbers else None
        return formulas(shown, quantity, entries_of(shown, subject, worker, quantity, asked.slice_, numbers))

    key = (*shown.digests, shown.path, quantity, asked.slice_)
    right = posed(make() if has_numbers else store.caches.pictures.once(key, make), shown.pose if asked.q else ())
    entry = entry_of(shown, subject, worker, asked.entry) if asked.entry else None
    make_state = partial(state, shown, picture_of(shown))
    left = make_state() if shown.pose else store.caches.pictures.once((*shown.digests, shown.path), make_state)
    return place(shown, left, right, entry)


def entries_of(
    shown: Shown,
    subject: Subject,
    worker: Worker,
    quantity: str,
    slice_: int,
    numbers: Array | None,
) -> Html:
    """The grid of a quantity, or the list of first integrals. Raises TooLarge, TimeoutError."""
    if quantity != INTEGRALS:
        return grid(shown, quantity, slice_, numbers)
    try:
        return integrals_table(shown, orjson.loads(modules.integrals(subject(), worker)))
    except InvalidInput as error:
        return tag("p", str(error), id="grid", class_="warn")


def picture_of(shown: Shown) -> str:
    """The address of the drawing of the server."""
    drawn = f"?q={','.join(map(repr, shown.pose))}" if shown.pose else ""
    return f"/v1/{shown.kind}/{shown.reference}/picture{drawn}"


def entry_of(shown: Shown, subject: Subject, worker: Worker, entry: str) -> Html:
    """The panel of one entry, with its value by its own formula. Raises Refused 404 for what is no entry, TooLarge,
    TimeoutError."""
    found = read_entry(entry)
    if found is None or found[0] not in shown.tabs:
        raise not_found(f"there is no entry '{entry[:80]}'; write for example metric,0,1", "unknown-formula")
    of = subject()
    told, formula = _entry(modules.entry(of, worker, *found))
    here = None if formula is None else shown.evaluated(formula, next(iter(formula.outputs)))
    return panel(shown, told, _read(modules.origins(of, worker)), None if here is None else told["sign"] * float(here))


@lru_cache(maxsize=8)
def _read(told: bytes) -> Mapping[str, Any]:
    """The document, which is large and the same for every entry of a model."""
    found: Mapping[str, Any] = orjson.loads(told)
    return found


@lru_cache(maxsize=64)
def _entry(told: bytes) -> tuple[Mapping[str, Any], Program | None]:
    """One entry, and its formula alone; None where it vanishes."""
    found: Mapping[str, Any] = orjson.loads(told)
    return found, None if found["is_zero"] else read_program(orjson.loads(found["texts"]["json"]))
