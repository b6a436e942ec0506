"""The interface by example: requests filled in with what is stored, and answers as they are sent."""

from __future__ import annotations

import json
import re
from html import unescape
from typing import Any

import pytest
from fastapi.testclient import TestClient

from .one_store import filled, store
from .test_model_pages import Tab, address, browser, in_browser

__all__ = ["address", "browser", "filled", "store"]
EVALUATIONS = "form.send:has([name=path][value='/v1/trees/cell@2/evaluations'])"


def test_every_request_is_there(client: TestClient) -> None:
    """Also where nothing is stored: then nothing of a tree can be sent."""
    text = client.get("/docs/interface").text
    openapi = client.get("/openapi.json").json()
    for path, operations in openapi["paths"].items():
        for method in operations:
            assert f"{method.upper()} {path}" in text
    assert "/trees/{ref}/evaluations&quot;" not in text
    assert 'name="path" value="/v1/trees"' in text
    assert 'href="/docs/interface"' in client.get("/docs").text


def test_what_can_be_sent_is_answered_as_it_stands(filled: TestClient, address: str) -> None:
    """Whatever has a button, in a store with a tree."""
    assert address
    text = filled.get("/docs/interface").text
    sent = re.findall(r'<form data-method="(GET|POST)" class="send">(.*?)</form>', text)
    assert len(sent) > 40
    wrong: list[str] = []
    for method, form in sent:
        path = unescape(re.search(r'name="path" value="([^"]*)"', form)[1])  # type: ignore[index]
        body = re.search(r"<textarea[^>]*>(.*?)</textarea>", form)
        given = {"json": json.loads(unescape(body[1]))} if body else {}
        answer = filled.request(method, path, **given)
        is_right = "no-equilibrium" in answer.text or "no-folder" in answer.text  # of this state and this server
        if answer.status_code >= 400 and not is_right:
            wrong.append(f"{method} {path}: {answer.text}")
    assert wrong == []


@in_browser
@pytest.mark.parametrize("width", [1280, *[pytest.param(360, marks=pytest.mark.deep)]])
def test_what_is_sent_is_answered(browser: Any, address: str, filled: TestClient, width: int) -> None:
    tab = Tab(browser, address, "/docs/interface", width)
    tab.page.click(f"details:has({EVALUATIONS}) > summary")
    tab.page.fill(f"{EVALUATIONS} [name=body]", '{"q": [0.3, -0.8], "quantities": ["metric"]}')
    tab.page.click(f"{EVALUATIONS} button")
    answer = f'document.querySelector("{EVALUATIONS} + .answer pre")'
    tab.until(answer)
    told = filled.post("/v1/trees/cell@2/evaluations", json={"q": [0.3, -0.8], "quantities": ["metric"]}).json()
    assert json.loads(tab.page.evaluate(f"{answer}.textContent")) == told
    tab.page.fill(f"{EVALUATIONS} [name=body]", '{"q": [0.3]}')
    tab.page.click(f"{EVALUATIONS} button")
    tab.until(f"{answer}?.textContent.includes('urn:problem-type')")
    tab.wrong = [each for each in tab.wrong if "422" not in each]
    tab.close()
