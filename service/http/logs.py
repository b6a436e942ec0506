"""Log lines on stderr, each with the id of the request."""

from __future__ import annotations

import logging
import time

from service.http.request_id import current_request_id

DAY = "%Y-%m-%d %H:%M:%S"
FORMAT = "%(asctime)s %(levelname)s %(name)s [%(request_id)s] %(message)s"


class _Lines(logging.Formatter):
    """Writes the time of day anew once a second."""

    _now = (-1, "")

    def formatTime(self, record: logging.LogRecord, datefmt: str | None = None) -> str:  # noqa: N802 -- of the library
        """The time as ever."""
        second, written = self._now
        if int(record.created) != second:
            second, written = int(record.created), time.strftime(datefmt or DAY, time.localtime(record.created))
            self._now = second, written
        return f"{written},{int(record.msecs):03d}"


class _WithRequestId(logging.Filter):
    def filter(self, record: logging.LogRecord) -> bool:
        """Let every record pass, with the id."""
        record.request_id = current_request_id()
        return True


def configure(level: int = logging.INFO) -> None:
    """Set the process's logging up."""
    # what the lines do not show need not be found out for every request
    logging.logThreads = logging.logProcesses = logging.logMultiprocessing = False
    logging._srcfile = None  # nor from where they are written (HOWTO of the library, section Optimization)
    handler = logging.StreamHandler()
    handler.addFilter(_WithRequestId())
    handler.setFormatter(_Lines(FORMAT))
    logging.basicConfig(level=level, handlers=[handler], force=True)
    logging.getLogger("alembic").setLevel(logging.WARNING)
    logging.getLogger("httpx2").setLevel(logging.WARNING)
