"""The entries of a quantity as a grid of links: what vanishes by structure is hatched, numbers are put in by a script,
or by the server where the pose was sent as a form."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from service.pages.html import Html, html, table, tag
from service.pages.model.shown import INTEGRALS, LETTERS, TITLES, Shown
from substructures.array import Array

#: from this many coordinates on cells are too small for numbers
SMALL = 12
#: up to this many columns their names have room
FEW = 4
#: where the pose goes in addresses of entries; no text holds it, since it would be taken out
POSE = "\0"
ZERO = "zero in every pose; choose it to read why"


def tabs(shown: Shown, chosen: str) -> Html:
    """The quantities, as links."""
    links = [
        tag(
            "a",
            TITLES[name],
            href=f"{shown.path}?tab={name}",
            data_tab=name,
            aria_current="page" if name == chosen else None,
        )
        for name in shown.tabs
    ]
    return tag("nav", links, class_="tabs", aria_label="Quantities")


def grid(shown: Shown, quantity: str, slice_: int, numbers: Array | None) -> Html:
    """One quantity; of the Christoffel symbols and rotations those of one first index, ``slice_``."""
    output = shown.outputs[quantity]
    labels = shown.labels(quantity)
    lead: tuple[int, ...] = ()
    chooser = None
    if len(output.shape) == 3:
        slice_ = min(max(slice_, 0), output.shape[0] - 1)
        lead, chooser = (slice_,), _chooser(shown, quantity, labels[0], slice_)
    there = {index for index, _, _ in output.expanded() if index[: len(lead)] == lead}
    is_matrix = len(output.shape) - len(lead) > 1
    rows, columns = labels[len(lead)], labels[-1] if is_matrix else ("",)
    is_small = len(columns) > SMALL
    head = tag(
        "tr", tag("td"), [tag("th", _short(name, is_small, k), scope="col", title=name) for k, name in _n(columns)]
    )
    width = len(columns)
    write = _cells(shown, quantity)
    body = []
    for i, row in _n(rows):
        cells = []
        for j, _ in _n(columns):
            index = (*lead, i, j) if is_matrix else (*lead, i)
            at = ((lead[0] if lead else 0) * len(rows) + i) * width + j
            value = None if numbers is None else float(numbers[index])
            cells.append(write(index, index in there, at, value))
        body.append(tag("tr", tag("th", _short(row, is_small, i), scope="row", title=row), Html("".join(cells))))
    kind = "grid small" if is_small else "grid few" if len(columns) <= FEW else "grid"
    drawn = tag("table", tag("thead", head), tag("tbody", body), class_=kind, data_quantity=quantity)
    return tag(
        "div", chooser, tag("div", drawn, class_="scroll", tabindex="0", role="group", aria_label=quantity), id="grid"
    )


def posed(drawn: str, pose: Sequence[float]) -> Html:
    """What was drawn for any pose, with links to entries in one that was sent as a form; scripts keep their own."""
    return Html(drawn.replace(POSE, html("".join(f"&q={x!r}" for x in pose))))


def integrals_table(shown: Shown, told: Sequence[Mapping[str, Any]]) -> Html:
    """First integrals by name, with why they are constant; one that is chosen is shown as an entry."""
    rows = []
    for k, each in enumerate(told):
        where = Html(f"{html(shown.path)}?entry={INTEGRALS},{k}{POSE}")
        rows.append((tag("a", each["name"], href=where, data_entry=f"{INTEGRALS},{k}"), each["unit"], _reason(each)))
    columns = ("first integral", "unit", "because")
    return tag("div", table(columns, rows) if rows else tag("p", "None was found."), id="grid", class_="integrals")


def _reason(integral: Mapping[str, Any]) -> str:
    return integral["reason"] if integral["rule"] == "constant" else f"{integral['rule']}: {integral['reason']}"


def _n(names: Sequence[str]) -> list[tuple[int, str]]:
    return list(enumerate(names))


def _short(name: str, is_small: bool, k: int) -> str:
    return str(k + 1) if is_small else name


def _chooser(shown: Shown, quantity: str, names: Sequence[str], chosen: int) -> Html:
    links = [
        tag(
            "a",
            name,
            href=f"{shown.path}?tab={quantity}&slice={k}",
            data_slice=k,
            aria_current="page" if k == chosen else None,
        )
        for k, name in _n(names)
    ]
    letter = f"{LETTERS[quantity]} of "
    return tag("p", tag("span", letter, class_="quiet"), links, class_="chooser")


def _cells(shown: Shown, quantity: str) -> Callable[[tuple[int, ...], bool, int, float | None], str]:
    """What writes a cell: of index, whether it is there, place in the array and value. There may be thousands, and but
    for what is escaped here all of them is numbers.
    """
    before = html(f"{shown.path}?entry={quantity},")
    entry, letter = html(f"{quantity},"), html(LETTERS[quantity])

    def write(index: tuple[int, ...], is_there: bool, at: int, value: float | None) -> str:
        """The cell."""
        name, places = ",".join(map(str, index)), " ".join([str(i + 1) for i in index])
        text = "" if value is None or not is_there else f"{value:.3g}"
        start = "<td><a" if is_there else f'<td class="zero"><a title="{ZERO}"'
        data = f'data-at="{at}" data-entry="{entry}{name}" aria-label="{letter} {places}"'
        return f'{start} href="{before}{name}{POSE}" {data}>{text}</a></td>'

    return write
