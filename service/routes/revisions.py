"""New revisions of trees: prepared where it may take long, then stored and answered."""

from __future__ import annotations

from collections.abc import Callable

from fastapi import Response

from service.database.connections import Connection
from service.http.acting import Act, Commit
from service.messages.addresses import tree_path
from service.messages.answers import Answer, json_answer
from service.operations import modules, trees
from service.operations.jobs.job_results import BASE_REVISION, IS_EXACT
from service.operations.preconditions import tree_tag, withdrawn
from service.routes.deferred import deferred
from service.views.resources import tree_view


def revision(act: Act, prepare: Callable[[], trees.Revision]) -> Callable[[], Commit]:
    """What ``Act`` runs: prepare a revision, then store it and answer it."""

    def prepared() -> Commit:
        """Couple."""
        ready = prepare()

        def commit(connection: Connection) -> Answer:
            """Store the revision and answer it."""
            tree, is_new = trees.commit(connection, act.viewer, ready)
            gone = withdrawn(connection, act.viewer, tree)
            headers = {"Location": tree_path(tree), "ETag": tree_tag(tree, gone)}
            return json_answer(tree_view(tree, gone), 201 if is_new else 200, headers)

        return commit

    return prepared


def changed(act: Act, change: Callable[[], trees.TreeChange]) -> Response:
    """Store a changed tree, at once or by a job."""

    def later() -> Commit:
        """The job that stores the same change."""
        found = change()
        members = {BASE_REVISION: found.base.revision, IS_EXACT: found.is_exact}
        return deferred(act, "assemble", found.document, found.step, members)()

    prepared = revision(act, lambda: trees.prepare_change(act.store, act.viewer, act.worker, change()))
    return shown_soon(act, act.run(prepared, later))


def shown_soon(act: Act, answer: Response) -> Response:
    """The answer. Where a page has asked, it shows the tree now, and finds what it computes with."""
    ref = answer.headers.get("location", "").rpartition("/")[2]
    if answer.status_code == 201:
        act.afterwards(lambda worker: modules.program(modules.of_tree(act.store, act.viewer, ref), worker, ()))
    return answer
