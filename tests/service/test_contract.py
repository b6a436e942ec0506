"""The contract is true: its requests are sent, and its tables name what there is, no more and no less."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

import service
from service.jobs.kinds import KINDS
from service.messages.negotiation import FORMS, MEDIA_TYPES
from service.models.formulas import OPTIONS, QUANTITIES
from service.models.numbers import ANALYSES
from service.settings import Limits
from substructures.quantities.quantity import ANALYSIS, PART, TABLE, Quantity

FOLDER = Path(service.__file__).parent
PAGES = Path(__file__).parents[2] / "docs" / "reference" / "http"
INDEX = (PAGES / "index.md").read_text()
#: all pages, in the order of their sections
PAGE = "\n\n".join((PAGES / name).read_text() for name in re.findall(r"\]\((\w+\.md)\)", INDEX))
DOCUMENT = json.loads((FOLDER / "openapi.json").read_text())
SCHEMAS = DOCUMENT["components"]["schemas"]
REQUEST = re.compile(r"```http (\d{3})\n([A-Z]+) (\S+)\n((?:[A-Z][A-Za-z-]+: [^\n]*\n)*)(?:\n(.*?))?```", re.DOTALL)
#: what a status line of the framework may be, and where the code is given by a variable
FRAMEWORK = {"http-error"}
VARIED = {"cpu-limit"}


@dataclass(frozen=True)
class Example:
    """A request of the page."""

    status: int
    method: str
    path: str
    headers: dict[str, str]
    body: str | None


def examples() -> list[Example]:
    found = []
    for status, method, path, headers, body in REQUEST.findall(PAGE):
        given = dict(line.split(": ", 1) for line in headers.splitlines())
        found.append(Example(int(status), method, path, given, body or None))
    return found


def section(number: int) -> str:
    """The text of a section."""
    return re.split(r"^# (?=\d+\. )", PAGE, flags=re.MULTILINE)[number]


def spans(text: str) -> set[str]:
    """All words in code spans; names in one span are separated by commas."""
    flat = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
    return {word for span in re.findall(r"`([^`]+)`", flat) for word in re.split(r",\s+", span)}


def first_column(text: str, header: str) -> list[str]:
    """The code spans in the first column of the table with this header, split at commas."""
    table = text.split(f"| {header} |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    return [name for row in table for name in re.findall(r"`([^`]+)`", row.split("|")[1])]


def test_every_request_is_answered_as_it_says(client: TestClient) -> None:
    sent = examples()
    assert len(sent) == PAGE.count("```http") >= 25
    for each in sent:
        headers = {**({"Content-Type": "application/json"} if each.body else {}), **each.headers}
        answer = client.request(each.method, each.path, content=each.body, headers=headers)
        assert answer.status_code == each.status, f"{each.method} {each.path}: {answer.text[:1000]}"


def test_a_job_can_be_followed_as_it_says(client: TestClient) -> None:
    for each in examples()[: 1 + next(i for i, e in enumerate(examples()) if e.path == "/v1/jobs")]:
        if each.path in ("/v1/substructures", "/v1/trees", "/v1/jobs") and each.method == "POST" and each.body:
            answer = client.post(each.path, content=each.body, headers={"Content-Type": "application/json"})
    address = answer.headers["Location"]
    for path in ("", "/result", "/items"):
        assert client.get(address + path).status_code == 200
    assert client.post(f"{address}/cancel", json={}).json()["state"] == "cancelled"
    assert "event: state" in client.get(f"{address}/events").text
    assert client.get(f"{address}/archive").content[:2] == b"PK"


def test_every_endpoint_is_on_the_page() -> None:
    """Parameters of paths may have other names there."""
    written = {re.sub(r"\{\w+\}", "{}", path) for path in re.findall(r"(/v1/[\w{}/.-]+|/[a-z]+z|/metrics)", PAGE)}
    tables = section(2) + section(5)
    written |= {"/v1/substructures/{}/aliases/{}", "/v1/jobs/{}/items"} if ".../items?state=" in tables else set()
    written |= {f"/v1/trees/{{}}/{name}" for name in ANALYSES}
    there = {re.sub(r"\{\w+\}", "{}", path) for path in DOCUMENT["paths"]}
    assert there <= written, there - written


def test_tables_name_what_there_is() -> None:
    numbers, kinds = section(4), section(5)
    assert sorted(first_column(numbers, "name")) == sorted(ANALYSES)
    assert sorted(first_column(kinds, "kind")) == sorted(KINDS)
    assert sorted(first_column(numbers, "quantity")) == sorted(QUANTITIES)
    assert {*OPTIONS, *MEDIA_TYPES, *FORMS} <= spans(numbers)


def axes_of(quantity: Quantity) -> Iterator[str]:
    """As the page writes them: fields with equal axes together."""
    for axes, some in groupby(quantity.arrays, lambda array: array.axes):
        fields = ", ".join(array.field for array in some)
        short = ({"coordinates": "n", "axes": "3"}.get(axis, axis) for axis in axes)
        yield " ".join([*([f"`{fields}`"] if fields else []), *short])


def test_quantities_have_the_axes_and_arguments_of_the_table() -> None:
    rows = section(4).split("| of a tree |", 1)[1].split("\n\n", 1)[0].splitlines()[2:]
    told = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
    there = [row for row in TABLE.values() if row.source not in (ANALYSIS, PART)]
    assert [row[0] for row in told] == [f"`{quantity.name}`" for quantity in there]
    for (_, _, axes, arguments), quantity in zip(told, there, strict=True):
        assert axes == "; ".join(axes_of(quantity))
        assert arguments == " ".join(quantity.arguments)


@pytest.mark.parametrize("name", ANALYSES)
def test_fields_of_analyses(name: str) -> None:
    """Every field of the requests is in the row, but for those that a row with dots leaves out."""
    row = next(line for line in section(4).splitlines() if line.startswith(f"| `{name}` |"))
    if "as simulations" in row:
        row += next(line for line in section(4).splitlines() if line.startswith("| `simulations` |"))
    schema = ANALYSES[name].schema.__name__
    parts = ["SimulationRequest", "ClosedRequest", "RollingRequest"] if schema.startswith("Any") else [schema]
    fields = {field for part in parts for field in SCHEMAS[part]["properties"]}
    shared = {"q", "qd", "t", "inputs", "parameters"} if "..." in row else set()
    assert fields - shared <= spans(row), fields - shared - spans(row)


def test_limits_and_their_values(client: TestClient) -> None:
    rows = section(6).strip().split("| limit | default |", 1)[1].splitlines()
    written: dict[str, float] = {}
    for row in filter(None, rows[2:]):
        names, values = (column.strip() for column in row.split("|")[1:3])
        known = re.findall(r"`(\w+)`", names)
        written |= dict(zip(known, map(float, values.split(", ")), strict=True))
    assert written == client.get("/v1/limits").json()
    assert set(Limits.model_fields) <= set(written)


def codes() -> Iterator[str]:
    """The codes of all refusals in the source."""
    place = {"Refused": 1, "unprocessable": 0, "not_found": 1}
    for path in sorted(FOLDER.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name | ast.Attribute):
                name = node.func.id if isinstance(node.func, ast.Name) else node.func.attr
                at = place.get(name, len(node.args))
                if at < len(node.args) and isinstance(code := node.args[at], ast.Constant):
                    yield str(code.value)


def test_every_code_is_explained() -> None:
    found = {*codes(), *VARIED} - FRAMEWORK
    assert len(found) > 40
    assert found <= spans(section(6)), found - spans(section(6))
