"""Which failures are passing ones, and how long to wait before a request is sent again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import monotonic, sleep
from typing import TypeVar

import httpx2

from substructures.client.problems import ProblemError

Result = TypeVar("Result")
#: seconds: the first pause, how much longer each one is than the one before, and what is too long to wait for
FIRST, GROWTH, LONGEST = 0.1, 3.0, 30.0
GATEWAY = (502, 503, 504)  # what stands before a server, or its database, that is gone for a while


@dataclass(frozen=True, slots=True)
class Retries:
    """At most ``count`` more attempts; an earlier attempt that is still being served is waited for, ``patience`` s."""

    count: int
    patience: float

    def ask(self, send: Callable[[], Result], is_repeatable: bool) -> Result:
        """What ``send`` gives, after as many attempts as it takes. Raises what the last one raises.

        ``is_repeatable``: sending it twice does not do it twice. Otherwise it is only sent again where it has not been
        taken: no connection was made, or 429.
        """
        attempt, begun = 0, monotonic()
        while True:
            try:
                return send()
            except (httpx2.TransportError, ProblemError) as error:
                is_served = attempt > 0 and _code(error) == "idempotency-in-flight"
                if is_served and monotonic() - begun < self.patience:
                    sleep(_retry_after(error) or FIRST)
                    continue
                pause = max(_retry_after(error) or 0.0, FIRST * GROWTH**attempt)
                if attempt >= self.count or pause > LONGEST or not _is_passing(error, is_repeatable):
                    raise _told(error) from None
            sleep(pause)
            attempt += 1


def _told(error: httpx2.TransportError | ProblemError) -> httpx2.TransportError | ProblemError:
    """The same, saying where nothing answers in place of 'Connection refused'."""
    if not isinstance(error, httpx2.ConnectError | httpx2.ConnectTimeout):
        return error
    url = error.request.url
    told = f"nothing answers at {url.scheme}://{url.netloc.decode()} ({error}); 'substructures serve' starts a server"
    return type(error)(told, request=error.request)


def _is_passing(error: Exception, is_repeatable: bool) -> bool:
    if isinstance(error, ProblemError):
        return error.status == 429 or (is_repeatable and error.status in GATEWAY and _is_worth_waiting(error))
    if isinstance(error, httpx2.ConnectError):
        return True  # at once; a host that is silent has taken all of the time that was given
    return is_repeatable and isinstance(error, httpx2.NetworkError | httpx2.RemoteProtocolError)


def _is_worth_waiting(error: ProblemError) -> bool:
    """The service says when it is, by ``Retry-After``; what stands before it says nothing."""
    return error.retry_after is not None or "code" not in error.problem


def _retry_after(error: Exception) -> float | None:
    return error.retry_after if isinstance(error, ProblemError) else None


def _code(error: Exception) -> str | None:
    return error.problem.get("code") if isinstance(error, ProblemError) else None
