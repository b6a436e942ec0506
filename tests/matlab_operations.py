"""The functions for MATLAB and Octave that are made of the OpenAPI document, one for each operation.

``python tests/matlab_operations.py`` writes them; a test compares them with what is there, and runs them.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap
from typing import Any

import service
import substructures.client

DOCUMENT = Path(service.__file__).parent / "openapi.json"
PLACE = Path(substructures.client.__file__).parent / "matlab" / "+substructures" / "api.m"
HEAD = """classdef api
  % API  A function for each operation of the interface, made of its OpenAPI document.
  %
  %   answer = substructures.api.evaluate_tree ("cell", struct ("quantities", "metric", "q", 0.5))
  %   answer = substructures.api.list_substructures ("tag", "arm", "page_size", 10)
  %
  % What the path names comes first, then the document that is sent (struct () where nothing is to be said), then names
  % and values of the query, or of headers, which begin with a capital ("If-Match", "Prefer").
  methods (Static)
"""


def functions() -> str:
    """All operations whose bodies are JSON, if they have any."""
    paths = json.loads(DOCUMENT.read_text())["paths"]
    operations = [(method, path, each) for path, methods in paths.items() for method, each in methods.items()]
    texts = ("\n".join(_function(*operation)) for operation in operations if _is_json(operation[2]))
    return HEAD + "\n\n".join(texts) + "\n  end\nend\n"


def _is_json(operation: dict[str, Any]) -> bool:
    return "requestBody" not in operation or "application/json" in operation["requestBody"]["content"]


def _function(method: str, path: str, operation: dict[str, Any]) -> Iterator[str]:
    names = re.findall(r"{(\w+)}", path)
    body = ["body"] if "requestBody" in operation else []
    query = [each["name"] for each in operation.get("parameters", []) if each["in"] == "query"]
    yield f"    function answer = {operation['operationId']} ({', '.join([*names, *body, 'varargin'])})"
    said = operation.get("description", "").partition("\n\n")[0].replace("\n", " ")
    said = f"{method.upper()} {path}: {said or operation['summary'] + '.'}"
    if query:
        said += f" Query: {', '.join(query)}."
    yield from (f"      % {line}" for line in wrap(said, 100, break_long_words=False))
    given = f"{{{', '.join(names)}}}, {{{', '.join(body)}}}"
    yield f"      answer = substructures.call ('{method}', '{path}', ..."
    yield f"        {given}, varargin);"
    yield "    end"


if __name__ == "__main__":
    PLACE.write_text(functions())
