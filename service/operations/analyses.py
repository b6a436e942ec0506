"""Analyses of stored trees: what they work on, their limit of time, and their answers."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import orjson

from service.analyses.formulas import made
from service.analyses.formulas.constraints import velocity_equations_of
from service.analyses.formulas.entry import Made, Options
from service.analyses.grouping import grouped_text
from service.analyses.numbers import ANALYSES
from service.analyses.printing import Style, made_text
from service.analyses.results import trajectory_of, written
from service.analyses.source import Source
from service.answers import Answer
from service.negotiation import MEDIA_TYPES
from service.operations import trees
from service.operations.sources import sources_of, tree_parts
from service.queries.trees import Tree
from service.store import Store
from service.viewer import Viewer
from substructures.export import interface_of_model
from substructures.tree.model import Model


def source_of(store: Store, tree: Tree, model: Model) -> Source:
    """What analyses of a stored tree work on."""
    tools = store.settings.limits, store.kernels.folder, store.kernels
    return Source(sources_of(store, tree, model), tree.digest, *tools, lambda: tree_parts(store, tree))


def printed(source: Source, quantity: str, options: Options, style: Style) -> Answer:
    """A quantity that follows from the model, in the format chosen; its description is in the JSON answer.

    Raises InvalidDocument (pointers into the query), TooLarge, Refused 422.
    """
    return _printed(source, quantity, made(source, quantity, options), style)


def grouped(source: Source, quantity: str, style: Style) -> Answer:
    """A quantity in grouped symbols, with what they stand for. Raises InvalidDocument, TooLarge, Refused 422."""
    interface = interface_of_model(source.model, digest=source.digest)
    text = grouped_text(source, quantity, style, interface)
    return Answer(200, text.encode(), {"Content-Type": MEDIA_TYPES[style.format]})


def velocity_equations(store: Store, viewer: Viewer, ref: str, document: Any, style: Style) -> Answer:
    """The equations of a stored tree with velocity constraints as formulas. Raises as :func:`printed`, Refused 404."""
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
        model = store.model(connection, tree)
    source = source_of(store, tree, model)
    return _printed(source, "velocity_equations", velocity_equations_of(source, document), style)


def _printed(source: Source, quantity: str, found: Made, style: Style) -> Answer:
    interface = interface_of_model(source.model, digest=source.digest)
    text = made_text(found, quantity, interface, source, style)
    return Answer(200, text.encode(), {"Content-Type": MEDIA_TYPES[style.format]})


def analyse(store: Store, viewer: Viewer, ref: str, name: str, request: Any, media: str) -> Answer:
    """The result of an analysis of ANALYSES in one of its media types.

    Raises Refused 404, InvalidDocument, MissingValue, TooLarge, TimeoutError.
    """
    analysis = ANALYSES[name]
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
        model = store.model(connection, tree)
    time_limit = TimeLimit(store.settings.limits.sync_seconds)
    result = analysis.compute(source_of(store, tree, model), request, time_limit)
    headers = {"Content-Type": media}
    motion = trajectory_of(result)
    if motion is not None:  # a CSV file has no place for them
        headers |= {"Trajectory-Status": motion.status, "Trajectory-Right": orjson.dumps(motion.is_right).decode()}
    return Answer(200, written(result, media, model), headers)


class TimeLimit:
    """A listener of progress that ends the work when its time is over: nobody waits for it any longer."""

    def __init__(self, seconds: float) -> None:
        self._end = perf_counter() + seconds

    def __call__(self, share: float) -> None:
        """Raises TimeoutError, which answers as work that is waited for too long: with a job or 503."""
        if perf_counter() > self._end:
            raise TimeoutError(f"{100 * share:.0f} % was done in the time of a request")
