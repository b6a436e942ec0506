"""Log lines on stderr, each with the id of the request."""

from __future__ import annotations

import logging

from service.http.request_id import current_request_id

FORMAT = "%(asctime)s %(levelname)s %(name)s [%(request_id)s] %(message)s"


class _WithRequestId(logging.Filter):
    def filter(self, record: logging.LogRecord) -> bool:
        """Let every record pass, with the id."""
        record.request_id = current_request_id()
        return True


def configure(level: int = logging.INFO) -> None:
    """Set the process's logging up."""
    # what the lines do not show need not be found out for every request
    logging.logThreads = logging.logProcesses = logging.logMultiprocessing = False
    handler = logging.StreamHandler()
    handler.addFilter(_WithRequestId())
    logging.basicConfig(level=level, format=FORMAT, handlers=[handler], force=True)
    logging.getLogger("alembic").setLevel(logging.WARNING)
    logging.getLogger("httpx2").setLevel(logging.WARNING)
