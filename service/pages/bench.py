"""The workbench of a tree: its outline, which is the truth, and a form for every step; each step is a new revision."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import orjson

from service.pages import forms as step_forms
from service.pages.html import Content, Html, html, joined, link, table, tag
from service.pages.layout import document
from service.queries.trees import Tree
from substructures.documents import read_json

MOST = 50  # revisions that are offered for comparison
#: quantities whose operations are compared with those of the revision before
COUNTED = ("metric", "christoffel", "forces")


@dataclass(frozen=True)
class Bench:
    """A revision, the one before it, and the numbers of the newest; ``frames``: of the tree by instance, in order, and
    ``parameters`` that their parts declare."""

    tree: Tree
    before: Tree | None
    newest: Sequence[int]
    frames: Mapping[str, Sequence[str]]
    parameters: Mapping[str, Mapping[str, Any]]

    @property
    def reference(self) -> str:
        """With its revision."""
        return f"{self.tree.name}@{self.tree.revision}"

    def spec(self) -> dict[str, Any]:
        """The stored document."""
        found: dict[str, Any] = read_json(self.tree.spec.encode())
        return found


def bench_page(bench: Bench, view: Html, part: str = "") -> bytes:
    """The bytes of the page; ``view``: where the tree is drawn; ``part``: that somebody wants to couple."""
    spec = bench.spec()
    left = tag("div", view, tag("section", id="ahead"), _steps(bench), _changed(bench), class_="left")
    forms = (
        step_forms.couple(part, "world" if not bench.frames else ""),
        step_forms.change(list(bench.frames)),
        step_forms.parameters(_settable(bench, spec)),
        step_forms.gravity(_gravity(spec)),
        step_forms.load(orjson.loads(bench.tree.summary)["coordinates"]),
        step_forms.loop(),
        step_forms.publish(bench.tree.name),
    )
    right = tag("div", _outline(bench, spec), tag("p", id="told", role="status"), *forms, _requests(), class_="right")
    about = {"reference": bench.reference, "name": bench.tree.name, "kind": "trees", "spec": bench.tree.spec}
    place = tag("div", left, right, _frames(bench), class_="place", id="place", data_bench=orjson.dumps(about).decode())
    title = tag("h1", f"Workbench of {bench.reference}")
    path = [("trees", "/trees"), (bench.reference, f"/trees/{bench.reference}")]
    needs = tag("noscript", tag("p", "Steps are taken by a script; without one the interface takes them, as below."))
    return document(f"Workbench of {bench.reference} - substructures", title, needs, place, crumbs=path)


def _settable(bench: Bench, spec: Mapping[str, Any]) -> step_forms.Settable:
    """Of every instance the parameters that its part declares, and those that it is given."""
    instances = spec.get("instances", ())
    return {each["name"]: (bench.parameters[each["name"]], each.get("parameters", {})) for each in instances}


def _gravity(spec: Mapping[str, Any]) -> Sequence[Any]:
    return spec.get("gravity", (0, 0, 0))


def _frames(bench: Bench) -> Html:
    """The places that fields may name."""
    names = ["world", *(f"{instance}.{frame}" for instance, some in bench.frames.items() for frame in some)]
    return tag("datalist", [tag("option", value=name) for name in names], id="frames")


def _steps(bench: Bench) -> Html:
    """Undo, redo and comparison, over revisions."""
    n, name = bench.tree.revision, bench.tree.name
    parts: list[Content] = []
    if bench.before is not None:
        before = f"{name}@{bench.before.revision}"
        parts += [tag("button", "undo", type="button", id="undo", data_of=before, data_first=bench.newest[-1])]
        parts += [link(f"what changed since @{bench.before.revision}", f"/trees/{before}/difference?to={name}@{n}")]
        parts += [link("revision before", f"/trees/{before}/edit")]
    if n < bench.newest[0]:
        parts += [link("newest revision", f"/trees/{name}@{bench.newest[0]}/edit")]
    redo = tag("button", "redo", type="button", id="redo", hidden="hidden")
    return html(tag("p", redo, " ", joined(parts, " "), class_="bar"), _beside(bench), _comparison(bench))


def _beside(bench: Bench) -> Html | None:
    """That others have changed the tree meanwhile, as in another window: their changes are not in this revision."""
    base, before = bench.tree.based_on, bench.before
    if base is None or before is None or base == before.revision:
        return None
    known = link(
        f"what @{before.revision} has", f"/trees/{bench.reference}/difference?to={before.name}@{before.revision}"
    )
    return tag("p", f"This was made of @{base}, not of @{before.revision}: compare ", known, class_="warn")


def _comparison(bench: Bench) -> Html:
    """This revision beside any other one."""
    others = [n for n in bench.newest if n != bench.tree.revision][:MOST]
    if not others:
        return Html()
    options = [tag("option", f"@{n}", value=f"{bench.tree.name}@{n}") for n in others]
    chosen = tag("label", "compare with ", tag("select", options, name="to"))
    compare = tag("button", "Compare", type="submit")
    return tag("form", chosen, compare, method="get", action=f"/trees/{bench.reference}/difference", class_="bar small")


def _changed(bench: Bench) -> Html:
    """What the last step changed: size, mass, operations; and how it was proved."""
    now, before = orjson.loads(bench.tree.summary), bench.before
    then = None if before is None else orjson.loads(before.summary)
    rows = [
        ("degrees of freedom", then and before and before.dof, bench.tree.dof),
        ("mass in kg", then and before and before.mass, bench.tree.mass),
    ]
    rows += [(f"operations of {x}", then and then["operations"].get(x), now["operations"].get(x)) for x in COUNTED]
    shown = [(name, _number(a), _number(b)) for name, a, b in rows]
    certificate = now["certificate"]
    seconds = ", ".join(f"{name} {1000 * float(x):.0f} ms" for name, x in certificate.get("seconds", {}).items())
    warnings = [tag("li", each["message"], class_="warn") for each in certificate.get("warnings", ())]
    head = ("", "before" if before is None else f"@{before.revision}", f"@{bench.tree.revision}")
    proof = tag("p", "Proved: ", link("certificate", f"/trees/{bench.reference}#certificate"), f" ({seconds})")
    return tag("section", table(head, shown), proof, tag("ul", warnings, class_="plain small"), id="changed")


def _number(given: Any) -> str:
    return "" if given is None else f"{given:,.4g}" if isinstance(given, float) else f"{given:,}"


def _outline(bench: Bench, spec: Mapping[str, Any]) -> Html:
    """What hangs on what, with a button for every place."""
    rows = _instances(bench, spec.get("instances", ()), "world")
    gravity = f" gravity {', '.join(map(step_forms.written, _gravity(spec)))} m/s²"
    world = tag("li", _place("world", "world"), tag("span", gravity, class_="quiet small"), tag("ul", rows))
    lists = [_list(spec.get(kind, ()), kind) for kind in ("loads", "closures")]
    return tag("section", tag("h2", "Outline"), tag("ul", world, class_="outline"), *lists, id="outline")


def _instances(bench: Bench, instances: Sequence[Mapping[str, Any]], host: str) -> list[Html]:
    """The instances on a place of the world, or on places of another instance."""
    found = []
    for each in instances:
        at = each.get("at", "world")
        if (at if host == "world" else at.partition(".")[0]) != host:
            continue
        name = each["name"]
        part = each.get("substructure", "").partition("@")[0] or each.get("definition", {}).get("name", "")
        replace = tag("button", "replace", type="button", data_replace=name, aria_label=f"replace {name}")
        remove = tag("button", "remove", type="button", data_remove=f"couplings/{name}", aria_label=f"remove {name}")
        places = [_place(f"{name}.{frame}", frame) for frame in bench.frames.get(name, ())]
        below = _instances(bench, instances, name)
        given = ", ".join(f"{key} = {step_forms.written(value)}" for key, value in each.get("parameters", {}).items())
        where = tag("span", f" at {at}" + (f" with {given}" if given else ""), class_="quiet small")
        head = html(tag("b", name), " ", link(part, f"/substructures/{part}"), where, " ", replace, " ", remove)
        found.append(tag("li", head, tag("div", places, class_="frames"), tag("ul", below) if below else None))
    return found


def _place(at: str, shown: str) -> Html:
    return tag("button", shown, type="button", data_frame=at, aria_label=f"take {at}", class_="frame")


def _list(given: Sequence[Mapping[str, Any]], kind: str) -> Html | None:
    """Loads or closures, each with a button that removes it."""
    rows = [
        tag(
            "li",
            tag("b", each["name"]),
            f" {each['type']} ",
            tag(
                "button",
                "remove",
                type="button",
                data_remove=f"{kind}/{each['name']}",
                aria_label=f"remove {each['name']}",
            ),
        )
        for each in given
    ]
    return tag("section", tag("h3", kind.capitalize()), tag("ul", rows, class_="plain")) if rows else None


def _requests() -> Html:
    """Filled in by the script with what the form that is being filled in would send."""
    names = ("curl", "Python", "MATLAB")
    texts = [
        tag("details", tag("summary", each), tag("pre", tag("code", data_request=each), tabindex="0")) for each in names
    ]
    return tag("section", tag("h2", "As a request"), tag("div", texts, class_="copies"), id="requests")
