"""The clock of the store: this host's, set by that of the database where several hosts share one.

Leases and claims are compared among hosts, whose clocks may be minutes apart.
"""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

SMALL = timedelta(seconds=0.1)  # what the times of connections differ by anyway
_ahead = timedelta()  # of this host's clock


def time_now() -> datetime:
    """The time of the store in UTC."""
    return datetime.now(UTC) + _ahead


def set_by(asked: datetime, told: datetime, answered: datetime) -> None:
    """Set the clock: the database told its time between two times of this host, in UTC."""
    global _ahead
    found = told - (asked + (answered - asked) / 2)
    if abs(found - _ahead) > SMALL:
        _ahead = found
