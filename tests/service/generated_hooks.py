"""How the generator of requests sends them (test_generated_requests.py): bodies of other types than JSON, and without a
look at the environment for proxies and passwords at each request, a seventh of its time.

Each place of a definition of a part is covered where parts and where trees are submitted. An instance that is coupled
or changed is read by the same class: its definition is one that is right, or anything that is none.
"""

from __future__ import annotations

from typing import Any

import requests.sessions
import schemathesis

requests.sessions.get_environ_proxies = lambda *_, **__: {}
requests.sessions.get_netrc_auth = lambda *_: None

COUPLINGS = {"/v1/trees/{ref}/couplings": "post", "/v1/trees/{ref}/couplings/{instance}": "patch"}
WHEEL = {"type": "revolute", "coordinate": "q"}
DEFINITION = {"name": "wheel", "bodies": [{"name": "wheel", "parent": "base", "joint": WHEEL, "mass": 1}]}


@schemathesis.hook
def before_load_schema(_: Any, document: dict[str, Any]) -> None:
    """Definitions of instances that are coupled or changed are DEFINITION."""
    schemas = document["components"]["schemas"]
    for path, method in COUPLINGS.items():
        content = document["paths"][path][method]["requestBody"]["content"]["application/json"]
        instance = schemas[content["schema"]["$ref"].rpartition("/")[2]]
        definition = {**instance["properties"]["definition"], "anyOf": [{"const": DEFINITION}, {"type": "null"}]}
        content["schema"] = {**instance, "properties": {**instance["properties"], "definition": definition}}


@schemathesis.serializer("application/zip")
def as_bytes(_: Any, value: Any) -> bytes:
    return value if isinstance(value, bytes) else str(value).encode()
