"""Parameters, counts and certificates in words and tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from service.pages.html import Content, Html, html, table, tag

LONGEST = 40
_KINDS = {"R": ("revolute", "rad"), "P": ("prismatic", "m")}
_NAMES = {"metric": "metric", "christoffel": "Christoffel symbols", "gravity": "gravity forces"}


def coordinates(names: Sequence[str], joints: str) -> Html:
    """The coordinates in the order of all arrays."""
    rows = [
        (str(k), tag("code", name), *_KINDS[kind]) for k, (name, kind) in enumerate(zip(names, joints, strict=True))
    ]
    return table(("index", "name", "joint", "unit"), rows) if rows else tag("p", "None.", class_="quiet")


def parameters(given: Mapping[str, Mapping[str, Any]]) -> Html:
    """Names, default values and units."""
    if not given:
        return tag("p", "None.", class_="quiet")
    rows = [
        (
            tag("code", name),
            [_value(each.get("value")), _given(each)],
            each.get("unit", ""),
            each.get("description", ""),
        )
        for name, each in given.items()
    ]
    return table(("name", "default", "unit", "description"), rows)


def _given(each: Mapping[str, Any]) -> Content:
    """What was given in another unit than SI."""
    given = each.get("given", {})
    return tag("span", f" ({given['value']} {given['unit']})", class_="quiet") if "value" in given else ""


def converted(report: Mapping[str, Any]) -> Html:
    """The numbers of a document that were given in other units than SI, both ways; parameters have a table."""
    rows = [
        (tag("code", each["pointer"]), f"{each['value']} {each['unit']}", f"{each['si']} {each['si_unit']}")
        for each in report.get("converted", ())
        if not each["pointer"].startswith("/parameters/")
    ]
    return table(("place", "given", "SI"), rows) if rows else Html()


def _value(value: Any) -> Content:
    if value is None:
        return tag("span", "to be given", class_="quiet")
    text = str(value)
    return text if len(text) <= LONGEST else text[:LONGEST] + "..."


def operations(counts: Mapping[str, int], note: str) -> Html:
    """How many operations each quantity takes; those that take none are left out."""
    shown = [tag("div", tag("dt", tag("code", name)), tag("dd", f"{n:,}")) for name, n in counts.items() if n]
    intro = tag("p", f"Additions, multiplications and divisions of each quantity alone; {note}", class_="quiet")
    return html(intro, tag("dl", shown, class_="counts"))


def certificate(report: Mapping[str, Any]) -> Html:
    """What was checked when the formulas were stored."""
    sentences = [*_agreement(report), *_definiteness(report), *_times(report)]
    warnings = [tag("li", f"Warning: {w['message']}.", class_="warn") for w in report.get("warnings", ())]
    return tag("ul", [tag("li", sentence) for sentence in sentences], warnings, class_="plain")


def _agreement(report: Mapping[str, Any]) -> list[str]:
    errors = report.get("direct_form", {}).get("max_relative_error")
    if not errors:
        return ["There are no coordinates, so there is no metric to be checked."]
    known = {name: error for name, error in errors.items() if error is not None}
    states = "a random state" if report["states"] == 1 else f"{report['states']} random states"
    allowed = f"{float(report['tolerance']):.1e}"
    sentences = [
        f"The {_NAMES.get(name, name)} could not be compared: a formula is singular at the random values."
        for name in errors
        if name not in known
    ]
    if known:
        worst = max(known, key=lambda name: float(known[name]))
        sentences.insert(
            0,
            f"{len(known)} quantities compared with {_yardstick(report)} at {states}; largest deviation"
            f" {float(known[worst]):.1e}, in {_NAMES.get(worst, worst)} (refused beyond {allowed}).",
        )
    return sentences


def _yardstick(report: Mapping[str, Any]) -> str:
    is_new = report.get("compared_with") == "documents"
    return "a computation from the definitions' own text" if is_new else "the direct computation of an older version"


def _definiteness(report: Mapping[str, Any]) -> list[str]:
    if "positive_definite" not in report:
        return []
    where = "at the default values of the parameters and a random state"
    match report["positive_definite"]:
        case True:
            return [f"The metric is positive definite {where}."]
        case False:
            return [
                f"The metric is not positive definite {where}: some motion has no inertia as the part stands alone."
            ]
    return ["Whether the metric is positive definite was not checked: defaults are missing or it is singular."]


def _times(report: Mapping[str, Any]) -> list[str]:
    seconds = {name: float(value) for name, value in report.get("seconds", {}).items()}
    verbs = {"derive": "derived", "couple": "coupled", "verify": "verified"}
    parts = [f"{verbs.get(name, name)} in {1000 * value:.1f} ms" for name, value in seconds.items()]
    return [f"{', '.join(parts).capitalize()}."] if parts else []
