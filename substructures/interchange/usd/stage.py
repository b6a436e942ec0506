"""A USD file with those that it is composed of, opened by the package usd-core (optional).

Nothing is opened but what was given: every layer is looked through for what it refers to, before it is composed, and is
then read in a folder of its own, which is gone as soon as it is open.
"""

from __future__ import annotations

import importlib
import posixpath
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from substructures.interchange.report import Place, refuse
from substructures.interchange.xml import MAX_BYTES, SHOWN

CRATE = b"PXR-USDC"
#: what the file itself is called here
MAIN = "__stage__"
ENDINGS = (".usd", ".usda", ".usdc")
_MOST_LAYERS = 200
_SAID = re.compile(r" : '(.*?)'\s*$", re.DOTALL)


def package(name: str) -> Any:
    """A module of usd-core. Raises InvalidDocument where it is not installed."""
    try:
        return importlib.import_module(f"pxr.{name}")
    except ImportError:
        message = "USD files are read by the package usd-core: pip install usd-core"
        raise refuse(Place(0, "USD"), "not-installed", message) from None


def opened(data: bytes, files: Mapping[str, bytes]) -> Any:
    """The stage of a file; ``files``: by their paths from it.

    Raises InvalidDocument for what is no USD, for layers that are not given, and for arcs that lead nowhere.
    """
    usd = package("Usd")
    main = f"{MAIN}{'.usdc' if data.startswith(CRATE) else '.usda'}"
    with TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        _lay_out(folder, main, data, files)
        with refused(main, folder):
            stage = usd.Stage.Open(str(Path(folder, main)))
    errors = stage.GetCompositionErrors()
    if errors:
        path = getattr(errors[0], "rootSite", None)
        where = f"<{str(path.path)[:SHOWN]}>" if path is not None else "USD"
        message = "what it refers to is not there, or refers to itself: usdchecker says more"
        raise refuse(Place(0, where), "composition", message)
    return stage


def _lay_out(folder: str, main: str, data: bytes, files: Mapping[str, bytes]) -> None:
    """The file and all that it is composed of, at their paths in a folder."""
    waiting, seen = {main: data}, {main}
    while waiting:
        name, here = waiting.popitem()
        if len(here) > MAX_BYTES or len(seen) > _MOST_LAYERS:
            message = f"a layer has at most {MAX_BYTES:,} bytes, a stage {_MOST_LAYERS} layers: leave meshes out"
            raise refuse(Place(0, f"@{name[:SHOWN]}@"), "too-large", message)
        _require_text(name, here)
        path = Path(folder, name)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(here)
        for asset in _composed_of(path, name, folder):
            target = posixpath.normpath(posixpath.join(posixpath.dirname(name), asset))
            if not target.endswith(ENDINGS) or target.startswith(("/", "..")) or target not in files:
                message = (
                    f"this is not here, or no USD file below the one that is read ('{name[:SHOWN]}'): send it along "
                    "(zip, or import FOLDER), or make one file of all: usdcat --flatten in.usd -o out.usd"
                )
                raise refuse(Place(0, f"@{asset[:SHOWN]}@"), "external-file", message)
            if target not in seen:
                seen.add(target)
                waiting[target] = files[target]


def _require_text(name: str, data: bytes) -> None:
    """Raises InvalidDocument for what is neither binary nor UTF-8."""
    if not data.startswith(CRATE):
        try:
            data.decode()
        except UnicodeDecodeError as error:
            message = f"byte {error.start} is no UTF-8: save the file as text, or as binary (usdcat -o out.usdc)"
            raise refuse(Place(0, f"@{name[:SHOWN]}@"), "encoding", message) from None


def _composed_of(path: Path, name: str, folder: str) -> list[str]:
    """The paths of sublayers, references and payloads of a layer."""
    paths: list[Any] = []
    with refused(name, folder):
        layer = package("Sdf").Layer.OpenAsAnonymous(str(path))
        layer.Traverse("/", paths.append)
        if any(at.isEmpty for at in paths):  # to look into it would end the process
            raise refuse(Place(0, f"@{name[:SHOWN]}@"), "not-well-formed", "the file is damaged")
        specs = [(at, layer.GetPrimAtPath(at)) for at in paths if at.IsPrimPath()]
        clips = [str(at) for at, spec in specs if spec and spec.HasInfo("clips")]
        assets = [str(asset) for asset in layer.GetCompositionAssetDependencies()]
    if clips:
        message = "value clips are not followed: leave them out, motions are no part of a definition"
        raise refuse(Place(0, f"<{clips[0][:SHOWN]}>"), "external-file", message)
    return list(filter(None, assets))  # others are in itself


@contextmanager
def refused(name: str, folder: str = "") -> Iterator[None]:
    """What the package says of a file that it cannot read, as InvalidDocument; ``folder``: where that lies."""
    try:
        yield
    except (package("Tf").ErrorException, UnicodeDecodeError) as error:
        found = _SAID.search(str(error).strip())
        said = (found[1] if found else "it cannot be read as USD").replace(f"{folder}/", "") or "it is damaged"
        raise refuse(Place(0, f"@{name[:SHOWN]}@"), "not-well-formed", said.splitlines()[0][:200]) from None
