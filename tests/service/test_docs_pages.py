"""The documentation as pages of a server."""

from __future__ import annotations

import re

from fastapi.testclient import TestClient

from service.pages.documents import names
from service.pages.documents_folder import FOLDER

from .drawings import DRAWINGS
from .reading import Page


def shown(client: TestClient, path: str) -> str:
    answer = client.get(path)
    assert answer.status_code == 200, path
    return answer.text


def test_every_page_is_there_and_its_links_lead_somewhere(client: TestClient) -> None:
    pages = {name: shown(client, "/docs" if name == "index" else f"/docs/{name}") for name in names()}
    assert len(pages) == len(list(FOLDER.rglob("*.md"))) > 15
    pages["interface"] = shown(client, "/docs/interface")
    for name, text in pages.items():
        assert '<main id="content">' in text
        for address in re.findall(r'href="(/docs[^"]*)"', text):
            target, _, anchor = address.partition("#")
            found = pages[target.removeprefix("/docs").strip("/") or "index"]
            assert not anchor or f'id="{anchor}"' in found, (name, address)
    assert "<table>" in pages["reference/http/jobs"]
    assert 'id="5-jobs"' in pages["reference/http/jobs"]


def test_drawings_are_those_of_their_script(client: TestClient) -> None:
    text = shown(client, "/docs/explanation/notation")
    for name, draw in DRAWINGS.items():
        assert f'src="/docs/explanation/{name}"' in text
        found = client.get(f"/docs/explanation/{name}")
        assert (found.headers["content-type"], found.text) == ("image/svg+xml", draw().text())


def test_a_search_finds_sections(client: TestClient) -> None:
    text = shown(client, "/docs?q=pareto")
    assert "/docs/how-to/sweeps#" in text
    assert "Nothing has these words" in shown(client, "/docs?q=xylophone")
    hostile = Page(shown(client, "/docs?q=%3Cscript%3Ealert(1)%3C/script%3E"))
    assert ("value", "<script>alert(1)</script>") in hostile.attributes


def test_a_search_shows_whole_words_as_they_are_read(client: TestClient) -> None:
    found = Page(shown(client, "/docs?q=friction")).text
    assert "Simulate, linearise, control: Simulate" not in found
    assert "... (formulas and numbers). Points that touch a floor have impacts, friction and rest by the" in found


def test_pages_that_are_not_there(client: TestClient) -> None:
    for path in ("/docs/nothing", "/docs/../README", "/docs/%2e%2e/README", "/docs//etc/passwd"):
        assert client.get(path).status_code == 404, path
    assert "did you mean" in client.get("/docs/how-to/sweep").json()["detail"]
