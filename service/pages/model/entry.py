"""One entry of a quantity: its formula, its value here, its terms, where it comes from, and how to take it along."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import orjson

from service.pages.html import Content, Html, html, joined, link, tag
from service.pages.model.shown import LETTERS, Shown

LANGUAGES = {"latex": "LaTeX", "python": "Python", "c": "C", "matlab": "MATLAB", "json": "JSON", "text": "text"}


def panel(shown: Shown, told: Mapping[str, Any], origins: Mapping[str, Any], here: float | None) -> Html:
    """``told``: of :func:`service.models.entries.entry`; ``origins``: of :func:`substructures.quantities.origins`;
    ``here``: the value in the pose, None where a parameter has none.
    """
    quantity, index = told["quantity"], tuple(told["index"])
    names = _names(shown, told)
    number = tag("sub", " ".join(str(i + 1) for i in index))
    title = tag("h2", LETTERS[quantity], number, " ", tag("span", joined(names), class_="quiet small"))
    if told["is_zero"]:
        return tag("section", title, tag("p", *_why(index, names, quantity, origins)), id="entry", data_zero="1")
    return tag(
        "section",
        title,
        _value(shown, told, here),
        tag("p", f"Because {told['integral']['reason']}.") if "integral" in told else None,
        _formula(told),
        _terms(told),
        _origin(told, origins, shown),
        _copies(told["texts"]),
        tag("div", id="plots"),
        id="entry",
        data_entry=f"{quantity},{','.join(map(str, index))}",
        data_sign=told["sign"],
        data_module=told["module"],
        data_layout=orjson.dumps(told["layout"]).decode(),
        data_bodies=" ".join(_bodies(told, origins)),
    )


def _names(shown: Shown, told: Mapping[str, Any]) -> list[str]:
    if "integral" in told:
        return [told["integral"]["name"]]
    return [labels[i] for labels, i in zip(shown.labels(told["quantity"]), told["index"], strict=True)]


def _value(shown: Shown, told: Mapping[str, Any], here: float | None) -> Html:
    unit = told["integral"]["unit"] if "integral" in told else shown.unit(told["quantity"], told["index"])
    text = "a parameter has no value" if here is None else repr(here)
    return tag(
        "p",
        tag("output", text, id="value"),
        f" {unit}" if unit else "",
        " in this state" if "integral" in told else " in this pose",
        class_="value",
    )


def _formula(told: Mapping[str, Any]) -> Html:
    of = ", ".join(str(i + 1) for i in told["of"])
    same = told["of"] == told["index"]
    sign = "" if told["sign"] > 0 else "minus "
    return html(
        None if same else tag("p", f"Equal to {sign}the entry {of} by symmetry:", class_="quiet small"),
        tag("p", told["remark"], class_="quiet small") if told["remark"] else None,
        tag("div", Html("".join(told["lines"])), class_="formula", tabindex="0", role="group", aria_label="Formula"),
    )


def _terms(told: Mapping[str, Any]) -> Html:
    if len(told["terms"]) < 2:
        return Html()
    math = '<math xmlns="http://www.w3.org/1998/Math/MathML">{}</math>'
    rows = [
        tag("li", tag("span", class_="bar-of", data_term=k), tag("output", data_term=k), Html(math.format(term)))
        for k, term in enumerate(told["terms"])
    ]
    return tag(
        "details",
        tag("summary", f"{len(rows)} terms"),
        tag("ol", rows, class_="terms", tabindex="0", aria_label="Terms"),
        open="open",
    )


def _bodies(told: Mapping[str, Any], origins: Mapping[str, Any]) -> list[str]:
    return [origins["bodies"][k] for k in _entry(told, origins).get("bodies", ())]


def _entry(told: Mapping[str, Any], origins: Mapping[str, Any]) -> Mapping[str, Any]:
    entries = origins["quantities"].get(told["quantity"], {"entries": ()})["entries"]
    return next((each for each in entries if each["index"] == told["of"]), {})


def _origin(told: Mapping[str, Any], origins: Mapping[str, Any], shown: Shown) -> Html:
    bodies, symbols = _bodies(told, origins), [origins["symbols"][k] for k in _entry(told, origins).get("symbols", ())]
    proof = f"{shown.path}#certificate"
    compared = "certificate: compared with a computation that shares no code with this formula"
    if "integral" in told:
        compared = "certificate of the equations of motion, along which the rate of this formula vanishes identically"
    rows: list[tuple[str, Content]] = [
        ("Bodies", joined([tag("code", name) for name in bodies])),
        ("Symbols", joined([tag("code", name) for name in symbols])),
        ("Operations", f"{told['operations']:,}"),
        ("Proof", link(compared, proof)),
    ]
    shown_rows = [html(tag("dt", name), tag("dd", value)) for name, value in rows if html(value)]
    return tag("dl", shown_rows)


def _why(index: Sequence[int], names: Sequence[str], quantity: str, origins: Mapping[str, Any]) -> list[Content]:
    if quantity in origins["quantities"]:
        moved = [frozenset(origins["moved"][a]) for a in index]
        if not frozenset.intersection(*moved):
            return ["Zero in every pose: no body is moved by ", joined(dict.fromkeys(names), " and by "), "."]
    return ["Zero in every pose: its formula vanishes identically, whatever the parameters are."]


def _copies(texts: Mapping[str, str]) -> Html:
    each = [
        tag("details", tag("summary", LANGUAGES[name]), tag("pre", tag("code", text), tabindex="0"), data_copy=name)
        for name, text in texts.items()
    ]
    return tag("div", each, class_="copies", role="group", aria_label="Copy as")
