"""Bundles as files: fetched, unpacked, changed, packed and sent."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable
from typing import Any

from fastapi.testclient import TestClient

from service.content.bundles import LIST
from service.content.integrity import digest_of
from substructures.documents import write_json

ZIP = {"Content-Type": "application/zip"}


BUNDLES = "/v1/bundles"


Files = dict[str, bytes]


def fetched(client: TestClient, refs: str, **headers: str) -> bytes:
    answer = client.get(BUNDLES, params={"refs": refs}, headers=headers)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/zip"
    return answer.content


def sent(client: TestClient, data: bytes, query: str = "", **headers: str) -> Any:
    return client.post(BUNDLES + query, content=data, headers={**ZIP, **headers})


def unpacked(data: bytes) -> Files:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def packed(files: Files, method: int = zipfile.ZIP_STORED) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", method) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return buffer.getvalue()


def listed(files: Files, change: Callable[[Any], None]) -> Files:
    """With another list."""
    document = json.loads(files[LIST])
    change(document)
    return {**files, LIST: write_json(document)}


def consistent(files: Files, name: str, data: bytes) -> Files:
    """With another file, and all digests as they have to be for it."""
    old, new = digest_of(files[name]), digest_of(data)
    found = {**files, name: data}
    text = found[LIST].replace(old.encode(), new.encode())
    found[LIST] = text
    if name.endswith("definition.json"):
        folder = name.split("/")[0]
        moved = f"{folder.split('@')[0]}@{new.removeprefix('sha256:')[:12]}"
        found = {each.replace(folder, moved): data for each, data in found.items()}
        found[LIST] = text.replace(folder.encode(), moved.encode())
    return found


def path_of(files: Files, part: str, name: str) -> str:
    return next(path for path in files if path.startswith(f"{part}@") and path.endswith(name))


def changed_program(files: Files, change: Callable[[Any], None]) -> Files:
    path = path_of(files, "pendulum", "/program")
    program = json.loads(files[path])
    change(program)
    return consistent(files, path, write_json(program))
