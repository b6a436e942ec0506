"""How the generator of requests sends them (test_generated_requests.py): bodies of other types than JSON, and without a
look at the environment for proxies and passwords at each request, a seventh of its time.
"""

from __future__ import annotations

from typing import Any

import requests.sessions
import schemathesis

requests.sessions.get_environ_proxies = lambda *_, **__: {}
requests.sessions.get_netrc_auth = lambda *_: None


@schemathesis.serializer("application/zip")
def as_bytes(_: Any, value: Any) -> bytes:
    return value if isinstance(value, bytes) else str(value).encode()
