"""``/docs/interface``: every request of the interface, filled in with what is stored here, to be sent and answered."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import orjson

from service.pages.documents_folder import FOLDER
from service.pages.html import Content, Html, html, joined, link, tag
from service.pages.layout import document
from service.queries.trees import Tree

METHODS = ("get", "post", "put", "patch", "delete")
#: of requests that change nothing, beside all of GET
COMPUTED = ("analyses",)
ALSO_COMPUTED = ("/v1/trees/{ref}/evaluations", "/v1/equivalences")
#: what is asked for where a choice is needed
CHOSEN = {"quantity": "metric", "target": "c", "format": "text"}
NEEDED = re.compile(r"\{\w+\}|=(?:&|$)")
#: of which one of several members is needed, or a tree with loops
OF_A_CHOICE = tuple(
    f"/v1/trees/{{ref}}/{name}"
    for name in ("steady-motions", "reduced-equations", "excitations", "identifications", "periodic-orbits")
)
#: an answer without an end
STREAMS = "/events"
#: how the documents write requests that are tried: method, path, headers, body
REQUEST = re.compile(r"```http \d{3}\n([A-Z]+) (\S+)\n(?:[A-Z][A-Za-z-]+: [^\n]*\n)*\n(\{.*?)\n?```", re.DOTALL)


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

    def filled(self, path: str, query: Sequence[str]) -> str:
        """The path with names, as far as there are some, and with options that are needed."""
        tree = "" if self.tree is None else f"{self.tree.name}@{self.tree.revision}"
        ref = tree if path.startswith("/v1/trees") else self.part
        names = {"ref": ref, "name": ref.partition("@")[0], "job": self.job, **CHOSEN}
        for name, value in names.items():
            path = path.replace(f"{{{name}}}", value) if value else path
        options = {"to": ref, "refs": self.part, **CHOSEN}
        return path + "".join(f"{'&' if k else '?'}{name}={options.get(name, '')}" for k, name in enumerate(query))


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

    @property
    def query(self) -> list[str]:
        """Options that are needed."""
        asked = [each for each in self.about.get("parameters", ()) if each["in"] == "query" and each.get("required")]
        return [each["name"] for each in asked]

    def body(self, stored: Stored) -> tuple[str | None, bool]:
        """A JSON body, and whether it is a whole one of what is stored here; of others that of the documents. None
        where there is none.
        """
        content = self.about.get("requestBody", {}).get("content", {})
        name = content.get("application/json", {}).get("schema", {}).get("$ref", "").rpartition("/")[2]
        if not name:
            return None, not content
        known = {
            "a": stored.part,
            "b": stored.part,
            "quantities": ["metric"],
            "q": [0.0] * len(stored.coordinates),
            "span": [0, 1],
        }
        forms = list(_forms(self.schemas, name))
        for members, needed in forms:
            if self.changes_nothing and needed <= known.keys() and self.path not in OF_A_CHOICE:
                return _json({member: value for member, value in known.items() if member in members}), True
        some = {member: value for member, value in known.items() if member in forms[0][0]}
        return _example(self.method.upper(), self.path) or _json(some), False


def _json(document: Mapping[str, Any]) -> str:
    return orjson.dumps(document).decode()


def _forms(schemas: Mapping[str, Any], name: str) -> Iterator[tuple[set[str], set[str]]]:
    """Members of a schema, or of each that it may be, and those of them that are needed."""
    schema = schemas.get(name, {})
    others = [
        each["$ref"].rpartition("/")[2]
        for kind in ("anyOf", "oneOf")
        for each in schema.get(kind, ())
        if "$ref" in each
    ]
    if others:
        for other in others:
            yield from _forms(schemas, other)
    else:
        yield set(schema.get("properties", ())), set(schema.get("required", ()))


@cache
def _examples() -> tuple[tuple[str, str, str], ...]:
    """Method, path and body of the requests in the documents."""
    texts = [path.read_text(encoding="utf-8") for path in sorted((FOLDER / "reference" / "http").glob("*.md"))]
    return tuple((m[1], m[2].partition("?")[0], m[3]) for text in texts for m in REQUEST.finditer(text))


def _example(method: str, template: str) -> str:
    pattern = re.compile(re.sub(r"\{\w+\}", "[^/]+", template))
    return next((body for m, path, body in _examples() if m == method and pattern.fullmatch(path)), "")


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
    sections = [_section(group, [x for x in found if x.group == group], stored) for group in groups]
    told = "Filled in with what is stored here. What changes nothing can be sent; change what is sent as you like."
    none = "No tree is stored that you see, so that requests of trees cannot be sent." if stored.tree is None else ""
    whole = tag("p", "The same as a document for programs: ", link("openapi.json", "/openapi.json"), ".")
    return document(
        "The interface by example - substructures",
        tag("h1", "The interface by example"),
        tag("p", told),
        tag("p", none, class_="warn") if none else Html(),
        whole,
        tag("p", here),
        *sections,
        crumbs=[("docs", "/docs")],
    )


def _section(group: str, operations: Sequence[Operation], stored: Stored) -> Html:
    return html(tag("h2", group, id=group), [_operation(each, stored) for each in operations])


def _operation(operation: Operation, stored: Stored) -> Html:
    path = stored.filled(operation.path, operation.query)
    shown, is_whole = operation.body(stored)
    method = operation.method.upper()
    said = str(operation.about.get("description", operation.about.get("summary", ""))).partition("\n\n")[0]
    title = tag("summary", tag("code", f"{method} {operation.path}"), " ", tag("span", said, class_="quiet"))
    may_be_sent = operation.changes_nothing and is_whole and not NEEDED.search(path) and not path.endswith(STREAMS)
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
        matlab = f'webwrite("{url}", "json", \'{body}\')' if method == "POST" else ""
    else:
        option = "" if method == "GET" else f', weboptions("RequestMethod", "{method.lower()}")'
        matlab = f'webread("{url}"{option})'
    python = f'with Client("{address}") as client:\n    print(client.request("{method}", "{path}"{given}).text)'
    found = {
        "curl": f"curl -s {post}'{url}'{sent}",
        "Python": f"from substructures.client import Client\n\n{python}",
        "MATLAB": matlab,
    }
    return {name: text for name, text in found.items() if text}
