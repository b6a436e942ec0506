"""The client of one server: all that its HTTP interface can do, by subjects."""

from __future__ import annotations

from substructures.client.evaluations import NumberCaller
from substructures.client.exchange import ExchangeCaller
from substructures.client.jobs import ServerLost
from substructures.client.problems import ProblemError
from substructures.client.sweeps import SweepCaller
from substructures.client.system import SystemCaller
from substructures.client.trees import TreeCaller

__all__ = ["Client", "ProblemError", "ServerLost"]


class Client(TreeCaller, NumberCaller, SweepCaller, ExchangeCaller, SystemCaller):
    """Talks to one server. All methods raise ProblemError, and httpx2.HTTPError when there is no answer.

    Each class below adds the requests of one subject: :mod:`.connection`, :mod:`.jobs`, :mod:`.drawings`,
    :mod:`.catalogue`, :mod:`.trees`, :mod:`.evaluations`, :mod:`.sweeps`, :mod:`.exchange`,
    :mod:`.system`.
    """
