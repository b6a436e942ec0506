"""Modules that one opens to understand how something works, by running it: started by benchmarks/house.py.

python -P benchmarks/stories.py CHECKOUT (with CHECKOUT on PYTHONPATH) prints JSON: story -> modules.

A module belongs to a story when one of its functions is called in it. Left out are what every story is written in
(``substructures.expr``, ``.documents``, ``.errors``) and what is done before the story begins.

metric over parts   how coupling computes g: :func:`couple_parts` without Christoffel symbols, over formulas, on two
                    stored parts; and the modules of the two that lead there, ``couple`` and ``assemble``
Christoffel, HTTP   how Gamma gets its numbers: what runs in the operation ``TreeEvaluation`` behind a POST to
                    evaluations of a compiled tree
item of a job       how an item of the kind assemble is executed: what a supervisor with a local engine runs from the
                    queue to the stored result, and what a runner does in between (read the work, run it, write the
                    report); of the science only what the service itself calls, and without the SQL
"""

from __future__ import annotations

import ast
import asyncio
import importlib
import json
import sqlite3
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from functools import cache
from pathlib import Path
from time import monotonic, sleep
from types import FrameType, SimpleNamespace
from typing import Any

ROOT = Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else Path(__file__).parents[1]
SQL = ("service.queries", "service.database")
VOCABULARY = ("substructures.expr", "substructures.documents", "substructures.errors")
PART: dict[str, Any] = {
    "name": "pendulum",
    "parameters": {"l": {"value": 1}, "m": {"value": 2}},
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q"},
            "mass": "m",
            "com": ["l", 0, 0],
            "inertia": {"zz": "m*l^2/10"},
        }
    ],
    "ports": [{"name": "tip", "body": "rod", "position": ["l", 0, 0]}],
}
TREE: dict[str, Any] = {
    "name": "cell",
    "gravity": [0, "-g", 0],
    "parameters": {"g": {"value": 9.81}},
    "instances": [
        {"name": "arm", "substructure": "pendulum"},
        {"name": "hand", "substructure": "pendulum", "at": "arm.tip", "parameters": {"m": "arm.m/4"}},
    ],
}


class Listener:
    """Notes calls: (module that calls, module called); ``within``: only while a function of this folder runs."""

    def __init__(self) -> None:
        self.calls: set[tuple[str, str]] = set()
        self.within = ""
        self.is_on = False
        self._depth = threading.local()

    def __call__(self, frame: FrameType, event: str, _: object) -> None:
        if not self.is_on or event not in ("call", "return"):
            return
        name = module_of(frame)
        if not name:
            return
        inside = getattr(self._depth, "value", 0)
        if self.within and name.startswith(self.within):
            self._depth.value = inside = max(0, inside + (1 if event == "call" else -1))
        if event == "call" and (inside or not self.within) and frame.f_code.co_name != "<module>":
            self.calls.add((module_of(frame.f_back), name))

    @contextmanager
    def story(self, within: str = "") -> Iterator[set[tuple[str, str]]]:
        """Listen to what the block does."""
        self.calls, self.within, self.is_on = set(), within, True
        try:
            yield self.calls
        finally:
            self.is_on = False


def module_of(frame: FrameType | None) -> str:
    """The module of the checkout that a frame runs, or nothing."""
    return _module(frame.f_code.co_filename) if frame else ""


@cache
def _module(file: str) -> str:
    if not file.startswith((f"{ROOT}/substructures/", f"{ROOT}/service/")):
        return ""
    return ".".join(Path(file).relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


def chosen(names: set[str]) -> list[str]:
    """Without the vocabulary."""
    return sorted(name for name in names if name and not name.startswith(VOCABULARY))


def found(name: str, *arguments: str) -> Any:
    """A function or class by its name, and, of several, by the names of its first parameters, wherever it stands."""
    for file in sorted([*(ROOT / "substructures").rglob("*.py"), *(ROOT / "service").rglob("*.py")]):
        for node in ast.parse(file.read_text()).body:
            if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.name == name:
                given = [a.arg for a in node.args.args] if isinstance(node, ast.FunctionDef) else []
                if given[: len(arguments)] == list(arguments):
                    module = ".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
                    return getattr(importlib.import_module(module), name)
    raise LookupError(f"there is no '{name}' with the parameters {arguments}")


def metric(listener: Listener, spec: Any, parts: dict[str, Any]) -> list[str]:
    """How coupling computes g."""
    couple, assemble = found("couple", "spec", "parts"), found("assemble", "spec", "parts")
    couple_parts, over_formulas = found("couple_parts", "run"), found("over_formulas")
    for _ in range(2):  # what parts work out once is known the second time
        assembly = assemble(spec, parts)
        with listener.story() as calls:
            couple_parts(over_formulas(assembly.scope.graph), assembly.mounted, assembly.gravity, False)
    return chosen({called for _, called in calls} | {couple.__module__, assemble.__module__})


async def posted(app: Any, path: str, body: Any) -> int:
    """The status of a POST, sent without a socket."""
    scope = {
        "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": "POST", "scheme": "http",
        "path": path, "raw_path": path.encode(), "query_string": b"", "root_path": "", "server": ("localhost", 80),
        "client": ("127.0.0.1", 1), "headers": [(b"host", b"localhost"), (b"content-type", b"application/json")],
    }  # fmt: skip
    statuses: list[int] = []
    waiting = [{"type": "http.request", "body": json.dumps(body).encode(), "more_body": False}]

    async def receive() -> dict[str, Any]:
        if not waiting:
            await asyncio.sleep(3600)
        return waiting.pop()

    async def send(message: dict[str, Any]) -> None:
        statuses.extend([message["status"]] if "status" in message else [])

    await app(scope, receive, send)
    return statuses[0]


async def christoffel(listener: Listener, app: Any) -> list[str]:
    """How Gamma gets its numbers over HTTP."""
    quantities, states = {"quantities": ["christoffel"]}, {"q": [0.1, 0.2]}
    ready = [("substructures", PART), ("trees", TREE), ("trees/cell/kernels", quantities)]
    evaluation = "/v1/trees/cell/evaluations"
    for path, body in [*((f"/v1/{path}", body) for path, body in ready), (evaluation, quantities | states)]:
        status = await posted(app, path, body)
        if status not in (200, 201):
            raise RuntimeError(f"{path}: {status}")
    with listener.story(found("TreeEvaluation").__module__) as calls:
        await posted(app, evaluation, quantities | states)
    return chosen({called for _, called in calls})


async def queued(listener: Listener, app: Any, store: Any, file: Path) -> set[str]:
    """What a supervisor does with an item."""
    status = await posted(app, "/v1/jobs", {"kind": "assemble", "items": [{**TREE, "name": "other"}]})
    if status != 202:
        raise RuntimeError(f"the job was not accepted: {status}")
    supervised, engine_of = found("supervised", "store", "engine"), found("engine_of", "settings")
    engine = engine_of(store.settings)
    limit = monotonic() + 120
    with listener.story() as calls, supervised(store, engine), closing(sqlite3.connect(file)) as connection:
        while connection.execute("SELECT state FROM jobs").fetchall() != [("succeeded",)]:
            if monotonic() > limit:
                raise RuntimeError("the job does not end")
            sleep(0.1)
    return {called for _, called in calls if called.startswith("service")}


def ran(listener: Listener, part: Any, limits: Any) -> set[str]:
    """What a runner does with an item."""
    kinds, wire = importlib.import_module("service.jobs.kinds"), importlib.import_module("service.jobs.engines.wire")
    engine, documents = (
        importlib.import_module("service.jobs.engines.engine"),
        importlib.import_module("substructures.documents"),
    )
    own = found("software")()
    version = found("StoredVersion")(part.name, part.definition.digest, part.program.digest, own)
    blobs = {version.digest: part.definition.canonical(), version.program: part.program.to_bytes()}
    library = SimpleNamespace(version=lambda _: version, tree=lambda _: None, catalogue=list, blob=blobs.get)
    (expanded,) = kinds.expand(kinds.submission({"kind": "assemble", "items": [TREE]}), limits, library)
    resolved = documents.read_json(documents.write_json(kinds.resolve("assemble", expanded, library)[0]))
    sent = wire.work_frame(engine.Work("1", "assemble", resolved, blobs, engine.Budget(60.0, 2**31))).to_bytes()
    with listener.story() as calls:
        (frame,) = wire.MessageReader().feed(sent)
        work = wire.read_work(frame, {})
        outcome = kinds.run(work.kind, dict(work.item), work.blobs, lambda _: None)
        wire.report_frame(engine.AttemptReport(work.id, 1.0, outcome), last=False).to_bytes()
    if outcome.problem is not None:
        raise RuntimeError(str(outcome.problem))
    return {called for by, called in calls if called.startswith("service") or by.startswith("service")}


def main() -> None:
    """Print the stories."""
    listener = Listener()
    sys.setprofile(listener)
    threading.setprofile(listener)
    definitions, documents = found("Definition"), found("TreeSpec")
    derive: Callable[..., Any] = found("derive", "definition")
    part, spec = derive(definitions.read(PART)), documents.read(TREE)
    settings = found("Settings")
    told = {"metric over parts": metric(listener, spec, {"arm": part, "hand": part})}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "store.db"
        with found("open_store")(settings(database=f"sqlite:///{file}", catalogue=False, workers=1)) as store:
            app = found("create_app")(store)
            told["Christoffel, HTTP"] = asyncio.run(christoffel(listener, app))
            held = asyncio.run(queued(listener, app, store, file))
    done = chosen(held | ran(listener, part, settings().limits) | {"service.jobs.engines.runner"})
    told["item of a job"] = [name for name in done if not name.startswith(SQL)]
    sys.stdout.write(json.dumps(told))


if __name__ == "__main__":
    main()
