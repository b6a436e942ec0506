"""What results of a job have in common and is stored already, so that it is not sent again with each of them."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence

from service.content.tree_content import TreeSummary
from service.database.connections import Connection
from service.queries import content
from service.queue.rounds import Ended

JOBS, LATEST = 64, 32  # digests are remembered of so many jobs, and so many of each


class Known:
    """Digests of programs and forms of summaries that trees of a job have, by job. For one thread."""

    def __init__(self) -> None:
        self._of: OrderedDict[str, OrderedDict[str, None]] = OrderedDict()

    def of(self, job: str) -> Sequence[str]:
        """Digests of a job, the latest ones."""
        return list(self._of.get(job, ()))

    def note(self, connection: Connection, ended: Iterable[Ended]) -> None:
        """Remember what came with these ends, where it is stored."""
        for each in ended:
            if each.attempt.kind != "assemble" or each.outcome is None or each.outcome.problem is not None:
                continue
            sent = _sent(each.outcome.summary["program"], each.outcome.files)
            known = self._of.setdefault(each.attempt.job, OrderedDict())
            self._of.move_to_end(each.attempt.job)
            for digest in content.stored_of(connection, sent - known.keys()):
                known[digest] = None
            while len(known) > LATEST:
                known.popitem(last=False)
        while len(self._of) > JOBS:
            self._of.popitem(last=False)


def _sent(program: str, files: Mapping[str, bytes]) -> set[str]:
    """The digests of what came along."""
    form = TreeSummary.of_files(files)
    found = {program} if "program" in files else set()
    return found | ({form.form_digest} if form.form is not None and form.form_digest is not None else set())
