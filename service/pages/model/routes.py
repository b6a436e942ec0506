"""``/substructures/{ref}`` and ``/trees/{ref}``, and the fragments of these pages: one entry, one grid."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Annotated

from fastapi import Depends, Query, Request, Response

from service.http.acting import in_time
from service.http.requests import StoreOf, ViewerOf, needs
from service.http.routing import router_of
from service.jobs.worker import Worker
from service.messages.refusals import not_found
from service.messages.viewer import Viewer
from service.operations import catalogue, differences, modules, pictures, trees
from service.operations.preconditions import withdrawn
from service.operations.sharing.sources import declared_parameters
from service.pages.account import PageRoute
from service.pages.bench import MOST, Bench, bench_page
from service.pages.details import part_page, tree_page
from service.pages.html import html
from service.pages.layout import answer, document
from service.pages.model.assets import scripted, with_scripts
from service.pages.model.chart import Chart
from service.pages.model.grid import posed
from service.pages.model.motion import motion_page
from service.pages.model.place import requests, view
from service.pages.model.screen import (
    Asked,
    Poses,
    Slice,
    Text,
    chosen_tab,
    entries_of,
    entry_of,
    first_screen,
    picture_of,
)
from service.pages.model.shown import Shown
from service.pages.versions import (
    MOST_COMPARED,
    SHOWN,
    levels_section,
    revisions_section,
    uses_section,
    versions_section,
    withdrawn_section,
)
from service.queries import aliases, uses, versions
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.store.store import Store
from substructures.export import Interface, interface_of_model, interface_of_part
from substructures.mechanics.state_names import ball_rows
from substructures.part.outputs import with_own_inertia
from substructures.part.part import Part
from substructures.tree.model import Model

Time = Annotated[str, Query(alias="t", max_length=40)]
Rates = Annotated[str, Query(alias="qd", max_length=50_000)]
Changed = Annotated[str, Query(alias="set", max_length=50_000)]
Fields = Annotated[str, Query(alias="run", max_length=50_000)]
#: revisions that a newer one is like after undo, and as far as can be done again; read by scripts
Like = Annotated[int, Query(alias="of", ge=0)]
Newest = Annotated[int, Query(alias="top", ge=0)]
Name = Annotated[str, Query(max_length=200)]
ADVICE = "take it as code instead"

router = router_of(PageRoute, include_in_schema=False, dependencies=[needs("read")])


AskedOf = Annotated[Asked, Depends()]


@router.get("/substructures/{ref}")
async def substructure(ref: str, request: Request, store: StoreOf, viewer: ViewerOf, asked: AskedOf) -> Response:
    """A part."""

    def shown_page(worker: Worker) -> Response:
        """In a thread."""
        with store.database.read() as connection:
            version = catalogue.find(connection, viewer, ref)
            names = aliases.aliases_of(connection, (version.name, version.version))[0]
            part = store.required_part(connection, version.digest)
            gone = uses.withdrawn_in_part(connection, viewer, version.digest)
            all_of_it = versions.page_versions(connection, viewer, version.name, None, SHOWN + 1)
            used = uses.page(connection, viewer, version.name, version.version, None, SHOWN + 1)
        shown = of_part(version, part, asked.pose, asked.q)
        work = first_screen(store, shown, lambda: modules.of_version(store, version), worker, asked)
        told = html(work, requests(shown, _address(request)) if shown.coordinates else None)
        _, levels = differences.levels(store, viewer, worker, shown.reference, MOST_COMPARED)
        built = [*levels_section(levels), *versions_section(all_of_it), *uses_section(used, shown.reference)]
        notes = withdrawn_section(gone), built
        return _answer(request, part_page(version, names, part, told, notes))

    return await in_time(request, shown_page, ADVICE)


@router.get("/trees/{ref}")
async def tree(ref: str, request: Request, store: StoreOf, viewer: ViewerOf, asked: AskedOf) -> Response:
    """A revision of a tree, the latest for a bare name."""

    def shown_page(worker: Worker) -> Response:
        """In a thread."""
        with store.database.read() as connection:
            found = trees.find(connection, viewer, ref)
            model = store.model(connection, found)
            gone = withdrawn(connection, viewer, found)
            all_of_it = versions.page_revisions(connection, viewer, found.name, None, SHOWN + 1)
        shown = of_tree(found, model, asked.pose, asked.q)
        work = first_screen(store, shown, partial(modules.of_revision, store, found, has_parts=True), worker, asked)
        told = html(work, requests(shown, _address(request)))
        notes = withdrawn_section(gone), revisions_section(all_of_it)
        return _answer(request, tree_page(found, model, told, notes))

    return await in_time(request, shown_page, ADVICE)


@router.get("/trees/{ref}/motion")
def motion(
    ref: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    pose: Poses = None,
    _qd: Rates = "",
    _set: Changed = "",
    _t: Time = "",
    _run: Fields = "",
) -> Response:
    """Motions of a tree; rates, parameters, what is run and the time that is shown are read by scripts."""
    with store.database.read() as connection:
        found = trees.find(connection, viewer, ref)
        model = store.model(connection, found)
    shown = of_tree(found, model, pose, None)
    return _answer(request, motion_page(shown, picture_of(shown)), "motion/motion.js")


@router.get("/trees/{ref}/edit")
def workbench(
    ref: str,
    request: Request,
    store: StoreOf,
    viewer: ViewerOf,
    substructure: Name = "",
    _of: Like = 0,
    _top: Newest = 0,
) -> Response:
    """What changes a tree, step by step, beginning with a ``substructure``; what was undone is read by scripts."""
    with store.database.read() as connection:
        found = trees.find(connection, viewer, ref)
        model = store.model(connection, found)
        newest = versions.page_revisions(connection, viewer, found.name, None, MOST + 1)
        older = versions.page_revisions(connection, viewer, found.name, found.revision, 1)
        before = trees.find(connection, viewer, f"{found.name}@{older[0].revision}") if older else None
        parameters = declared_parameters(connection, found)
    frames: dict[str, list[str]] = {}
    for name in model.frames:
        frames.setdefault(name.partition(".")[0], []).append(name.partition(".")[2])
    shown = of_tree(found, model, None, None)
    bench = Bench(found, before, [each.revision for each in newest], frames, parameters)
    made = bench_page(bench, view(shown, picture_of(shown)), substructure)
    return _answer(request, made, "workbench.js")


@router.get("/{kind}/{ref}/entry")
async def one_entry(
    kind: str, ref: str, request: Request, store: StoreOf, viewer: ViewerOf, entry: Text, pose: Poses = None
) -> Response:
    """The panel of an entry alone."""

    def fragment(worker: Worker) -> Response:
        """In a thread."""
        shown, subject = _found(kind, ref, store, viewer, pose)
        return answer(request, document(shown.reference, entry_of(shown, subject, worker, entry)))

    return await in_time(request, fragment, ADVICE)


@router.get("/{kind}/{ref}/grid")
async def one_grid(
    kind: str, ref: str, request: Request, store: StoreOf, viewer: ViewerOf, tab: Text, slice_: Slice = 0
) -> Response:
    """The grid of a quantity alone."""

    def fragment(worker: Worker) -> Response:
        """In a thread."""
        shown, subject = _found(kind, ref, store, viewer, None)
        drawn = entries_of(shown, subject, worker, chosen_tab(shown, tab), slice_, None)
        return answer(request, document(shown.reference, posed(drawn, ())))

    return await in_time(request, fragment, ADVICE)


def _address(request: Request) -> str:
    return f"{request.url.scheme}://{request.headers['host']}"


def of_part(version: Version, part: Part, pose: str | None, q: list[str] | None) -> Shown:
    """A part as it stands alone."""
    joints = [joint.coordinate for joint in part.topology.joints]
    interface, chart = interface_of_part(part), Chart(part.coordinates, ball_rows(part.topology.balls, joints))
    return Shown(
        "substructures",
        f"{version.name}@{version.version}",
        (version.digest, version.program),
        part.joints,
        interface,
        part.program.outputs,
        lambda names: with_own_inertia(part, part.program.select(list(names))),
        chart,
        _pose(pose, q, chart, interface, part.joints),
    )


def of_tree(found: Tree, model: Model, pose: str | None, q: list[str] | None) -> Shown:
    """A revision of a tree."""
    reference, program = f"{found.name}@{found.revision}", model.program
    interface, chart = interface_of_model(model), Chart(model.coordinates, model.balls)
    return Shown(
        "trees",
        reference,
        (found.digest, found.program),
        model.joints,
        interface,
        program.outputs,
        lambda _: program,
        chart,
        _pose(pose, q, chart, interface, model.joints),
    )


def _found(
    kind: str, ref: str, store: Store, viewer: Viewer, pose: str | None
) -> tuple[Shown, Callable[[], modules.Subject]]:
    if kind not in ("trees", "substructures"):
        raise not_found(f"there is nothing at '/{kind[:80]}'", "not-found")
    with store.database.read() as connection:
        if kind == "trees":
            tree_found = trees.find(connection, viewer, ref)
            model = store.model(connection, tree_found)
            shown = of_tree(tree_found, model, pose, None)
            return shown, lambda: modules.of_revision(store, tree_found, has_parts=True)
        version = catalogue.find(connection, viewer, ref)
        shown = of_part(version, store.required_part(connection, version.digest), pose, None)
        return shown, lambda: modules.of_version(store, version)


def _pose(pose: str | None, q: list[str] | None, chart: Chart, interface: Interface, joints: str) -> tuple[float, ...]:
    """The state that is asked for, by where sliders are or as it is; none for that at home."""
    if q:
        values = pictures.read_pose(",".join(q), [{"P": "m", "R": "rad"}[kind] for kind in joints])
        return chart.state(values or ())
    return pictures.read_pose(pose, interface.vectors["q"].units) or ()


def _answer(request: Request, page: bytes, script: str = "main.js") -> Response:
    return with_scripts(answer(request, scripted(page, script)))
