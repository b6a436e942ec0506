"""Operations that are read when they are first asked for: of the hundred and more of a server most never are.

FastAPI reads the parameters of a function and builds validators for them where it is decorated, and again where its
router is included in an app: a seventh of the time in which a server starts. Here a route knows its path and methods,
and the router of the app is given the routes themselves.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any

from fastapi.routing import APIRoute, APIRouter
from starlette.routing import Route
from starlette.types import Receive, Scope, Send

TEMPLATE = "#/components/schemas/{model}"
PROBLEM: dict[int | str, dict[str, Any]] = {
    "default": {
        "description": "Problem document",
        "headers": {
            "Retry-After": {
                "description": "seconds, where the same request can succeed later (some of 409 and 503)",
                "schema": {"type": "integer"},
            }
        },
        "content": {"application/problem+json": {"schema": {"$ref": TEMPLATE.format(model="Problem")}}},
    }
}


def operation_id(route: APIRoute) -> str:
    """The name of an operation, and of a method of a generated client: that of the function that answers."""
    return route.name


class Operation(Route):
    """A path with methods; ``kind`` says what answers."""

    def __init__(
        self, kind: type[APIRoute], path: str, endpoint: Callable[..., Any], *, methods: list[str], **given: Any
    ) -> None:
        super().__init__(path, endpoint)
        self.methods = set(methods)  # HEAD is for service.http.middleware
        self._given = {"path": path, "endpoint": endpoint, "methods": methods, **given}
        self._kind = kind

    @cached_property
    def read(self) -> APIRoute:
        """The route with the parameters of its function."""
        return self._kind(**self._given)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer as the route that was read does."""
        scope["route"] = self.read
        await self.read.handle(scope, receive, send)


def router_of(kind: type[APIRoute] = APIRoute, **given: Any) -> APIRouter:
    """A router of such operations; ``given``: as of FastAPI's."""
    made: Any = partial(Operation, kind)
    return APIRouter(route_class=made, responses=PROBLEM, generate_unique_id_function=operation_id, **given)
