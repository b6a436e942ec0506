"""``/docs/interface``: every request of the interface, filled in with what is stored here, to be sent and answered."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import orjson

from service.pages.html import Content, Html, html, joined, link, tag
from service.pages.layout import document
from service.queries.trees import Tree

METHODS = ("get", "post", "put", "patch", "delete")
#: of requests that change nothing, beside all of GET
COMPUTED = ("analyses",)
ALSO_COMPUTED = ("/v1/trees/{ref}/evaluations", "/v1/equivalences")
#: what is asked for where a name or a choice is needed
CHOSEN = {"quantity": "metric", "target": "c", "file": "certificate"}
NEEDED = re.compile(r"\{\w+\}")


@dataclass(frozen=True)
class Stored:
    """What requests are filled in with, of what the viewer sees: references; empty where there is none."""

    tree: Tree | None
    part: str
    job: str
    address: str

    @property
    def coordinates(self) -> Sequence[str]:
        """Of the tree."""
        return [] if self.tree is None else orjson.loads(self.tree.summary)["coordinates"]

    def filled(self, path: str, query: Mapping[str, str]) -> str:
        """The path with names, as far as there are some."""
        tree = "" if self.tree is None else f"{self.tree.name}@{self.tree.revision}"
        ref = tree if path.startswith("/v1/trees") else self.part
        names = {"ref": ref, "name": ref.partition("@")[0], "job": self.job, **CHOSEN}
        for name, value in names.items():
            path = path.replace(f"{{{name}}}", value) if value else path
        return path + "".join(f"{'&' if k else '?'}{name}={value}" for k, (name, value) in enumerate(query.items()))


@dataclass(frozen=True)
class Operation:
    """One request of the document."""

    method: str
    path: str
    about: Mapping[str, Any]
    schemas: Mapping[str, Any]

    @property
    def group(self) -> str:
        """What it is about."""
        return next(iter(self.about.get("tags", ())), "others")

    @property
    def changes_nothing(self) -> bool:
        """Whether it is safe to be sent as it stands."""
        return self.method == "get" or self.group in COMPUTED or self.path in ALSO_COMPUTED

    def query(self) -> dict[str, str]:
        """Options that are needed."""
        asked = [each for each in self.about.get("parameters", ()) if each["in"] == "query" and each.get("required")]
        return {each["name"]: CHOSEN.get(each["name"], "") for each in asked}

    def body(self, stored: Stored) -> dict[str, Any] | None:
        """As much of a JSON body as is known here; None where there is none."""
        content = self.about.get("requestBody", {}).get("content", {})
        name = content.get("application/json", {}).get("schema", {}).get("$ref", "").rpartition("/")[2]
        if not name:
            return None
        members = set(_members(self.schemas, name))
        known = {
            "a": stored.part,
            "b": stored.part,
            "quantities": ["metric"],
            "q": [0.0] * len(stored.coordinates),
            "span": [0, 1],
        }
        return {member: value for member, value in known.items() if member in members}


def _members(schemas: Mapping[str, Any], name: str) -> Iterator[str]:
    """Members of a schema, and of those that it may be."""
    schema = schemas.get(name, {})
    yield from schema.get("properties", ())
    for other in (*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("allOf", ())):
        if "$ref" in other:
            yield from _members(schemas, other["$ref"].rpartition("/")[2])


def interface_page(openapi: Mapping[str, Any], stored: Stored) -> bytes:
    """The bytes of the page."""
    schemas = openapi["components"]["schemas"]
    found = [
        Operation(method, path, operations[method], schemas)
        for path, operations in openapi["paths"].items()
        for method in METHODS
        if method in operations
    ]
    groups = list(dict.fromkeys(each.group for each in found))
    here = joined([link(group, f"#{group}") for group in groups], " · ")
    sections = [
        html(tag("h2", group, id=group), [_operation(x, stored) for x in found if x.group == group]) for group in groups
    ]
    told = "Filled in with what is stored here. What changes nothing can be sent; change what is sent as you like."
    whole = tag("p", "The same as a document for programs: ", link("openapi.json", "/openapi.json"), ".")
    return document(
        "The interface by example - substructures",
        tag("h1", "The interface by example"),
        tag("p", told),
        whole,
        tag("p", here),
        *sections,
        crumbs=[("docs", "/docs")],
    )


def _section(group: str, operations: Sequence[Operation], stored: Stored) -> Html:
    return html(tag("h2", group, id=group), [_operation(each, stored) for each in operations])


def _operation(operation: Operation, stored: Stored) -> Html:
    path, body = stored.filled(operation.path, operation.query()), operation.body(stored)
    shown = None if body is None else orjson.dumps(body).decode()
    method = operation.method.upper()
    said = str(operation.about.get("description", operation.about.get("summary", ""))).partition("\n\n")[0]
    title = tag("summary", tag("code", f"{method} {operation.path}"), " ", tag("span", said, class_="quiet"))
    may_be_sent = operation.changes_nothing and not NEEDED.search(path)
    form = _form(method, path, shown) if may_be_sent else None
    texts = [
        tag("details", tag("summary", name), tag("pre", tag("code", text), tabindex="0"))
        for name, text in _texts(method, stored.address, path, shown).items()
    ]
    return tag("details", title, form, tag("div", texts, class_="copies"), class_="operation")


def _form(method: str, path: str, body: str | None) -> Html:
    fields: list[Content] = [tag("input", name="path", value=path, aria_label="Path", autocomplete="off")]
    if body is not None:
        fields.append(tag("textarea", body, name="body", aria_label="Body", rows="3", spellcheck="false"))
    fields.append(tag("button", "Send", type="submit"))
    return html(tag("form", fields, data_method=method, class_="send"), tag("div", class_="answer", aria_live="polite"))


def _texts(method: str, address: str, path: str, body: str | None) -> dict[str, str]:
    """The request in three languages."""
    url, verb = f"{address}{path}", "" if method in ("GET", "POST") else f"-X {method} "
    sent = "" if body is None else f" -H 'Content-Type: application/json' -d '{body}'"
    post = "-X POST " if method == "POST" and body is None else verb
    given = "" if body is None else f", {body}"
    if body is not None:
        matlab = f'webwrite("{url}", \'{body}\', weboptions("MediaType", "application/json"))'
    else:
        option = "" if method == "GET" else f', weboptions("RequestMethod", "{method.lower()}")'
        matlab = f'webread("{url}"{option})'
    python = f'with Client("{address}") as client:\n    print(client.request("{method}", "{path}"{given}).text)'
    return {
        "curl": f"curl -s {post}'{url}'{sent}",
        "Python": f"from substructures.client import Client\n\n{python}",
        "MATLAB": matlab,
    }
