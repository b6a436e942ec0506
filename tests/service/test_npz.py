"""Evaluations as npz, in and out."""

from __future__ import annotations

import io
import pickle
import zipfile
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from substructures.errors import InvalidDocument, TooLarge
from substructures.formats.arrays import read_npz, view_npz, write_npz

from .one_store import double, filled, store

__all__ = ["double", "filled", "store"]  # fixtures

NPZ = {"Content-Type": "application/x-npz"}
URL = "/v1/trees/cell/evaluations"


def packed(**arrays: Any) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def test_npz_equals_json(double: TestClient) -> None:
    q, tau = np.linspace(-1, 1, 20).reshape(10, 2), np.arange(10.0)
    body = packed(
        q=q,
        qd=2 * q,
        quantities=np.array(["metric", "forces", "kinematics"]),
        **{"inputs.tau.arm.q": tau, "parameters.arm.m": 3.0},
    )
    answer = double.post(URL, content=body, headers=NPZ)
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/x-npz"), answer.text
    arrays = np.load(io.BytesIO(answer.content), allow_pickle=False)
    request = {
        "q": q.tolist(), "qd": (2 * q).tolist(), "quantities": ["metric", "forces", "kinematics"],
        "inputs": {"tau.arm.q": tau.tolist()}, "parameters": {"arm.m": 3},
    }  # fmt: skip
    expected = double.post(URL, json=request).json()
    # the interpreter answers until the kernel is compiled: equal to a few units of the last place
    np.testing.assert_allclose(arrays["metric"], expected["metric"], rtol=1e-14, atol=1e-13)
    np.testing.assert_allclose(arrays["forces"], expected["forces"], rtol=1e-14, atol=1e-13)
    np.testing.assert_allclose(
        arrays["kinematics.position"], expected["kinematics"]["position"], rtol=1e-14, atol=1e-14
    )
    assert arrays["coordinates"].tolist() == expected["coordinates"]
    assert arrays["failures.state"].tolist() == []
    mixed = double.post(URL, json=request, headers={"Accept": "application/x-npz"})
    assert mixed.headers["content-type"] == "application/x-npz"
    back = double.post(URL, content=body, headers={**NPZ, "Accept": "application/json"}).json()
    assert back.keys() == expected.keys()
    np.testing.assert_allclose(back["forces"], expected["forces"], rtol=1e-14, atol=1e-13)


def broken() -> dict[str, bytes]:
    good = packed(q=np.zeros(2), quantities=np.array(["metric"]))
    lying = io.BytesIO()
    with zipfile.ZipFile(lying, "w") as archive:
        member = io.BytesIO()
        np.lib.format.write_array_header_1_0(member, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)})
        archive.writestr("q.npy", member.getvalue() + b"\0" * 16)
    return {
        "empty": b"",
        "text": b"q=1",
        "cut": good[: len(good) // 2],
        "damaged": good.replace(np.lib.format.magic(1, 0) + b"v", np.lib.format.magic(1, 0) + b"w"),
        "pickle": pickle.dumps({"q": [0, 0]}),
        "objects": packed(q=np.array([{}, {}], dtype=object)),
        "complex": packed(q=np.zeros(2, complex)),
        "shape": lying.getvalue(),
        "nan": packed(q=np.array([0, np.nan]), quantities=np.array(["metric"])),
    }


def headed(header: str, data: bytes = bytes(8), version: bytes = b"\1\0") -> bytes:
    """An npz file whose ``q`` has this header."""
    text = header.encode()
    length = len(text).to_bytes(2 if version == b"\1\0" else 4, "little")
    stream = io.BytesIO(packed(quantities=np.array(["metric"])))
    with zipfile.ZipFile(stream, "a") as archive:
        archive.writestr("q.npy", b"\x93NUMPY" + version + length + text + data)
    return stream.getvalue()


HEADER = "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }"
HEADERS = {
    "nested": "(" * 5000,
    "nested lists": "[" * 4000 + "]" * 4000,
    "signs": "-" * 9000 + "1",
    "indents": "  {'a'\n\t (:",
    "open quotes": "{'descr': '''",
    "operators": "not " * 2000 + "1",
    "nothing": "",
    "no keys": "{}",
    "another key": HEADER.replace("}", "'x': (1,)}"),
    "a key twice": HEADER.replace("'descr'", "'shape': (1,), 'descr'").replace("'fortran_order': False,", ""),
    "structured": HEADER.replace("'<f8'", "[('a', '<f8')]"),
    "repeated": HEADER.replace("<f8", "(2,3)f8"),
    "no type": HEADER.replace("<f8", "<q99"),
    "wide": HEADER.replace("<f8", "<U999999999"),
    "objects": HEADER.replace("<f8", "|O"),
    "negative": HEADER.replace("(1,)", "(-1,)"),
    "a long number": HEADER.replace("(1,)", "(" + "9" * 8000 + ",)"),
    "a large number": HEADER.replace("(1,)", "(0, 999999999999999999, 999999999999999999)"),
    "dimensions": HEADER.replace("(1,)", "(" + "1," * 65 + ")"),
    "commas": HEADER.replace("(1,)", "(,)"),
    "letters": HEADER.replace("(1,)", "(L,)"),
    "behind": HEADER + "[]",
}


@pytest.mark.parametrize("what", HEADERS)
def test_hostile_headers(double: TestClient, what: str) -> None:
    answer = double.post(URL, content=headed(HEADERS[what]), headers=NPZ)
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["pointer"] in ("/q", "")


@pytest.mark.parametrize(
    "header",
    [
        HEADER,
        HEADER.replace(", }", "}\n"),
        HEADER.replace("(1,)", "(1L,)"),
        HEADER.replace("'", '"'),
        "{'shape':(1,),'fortran_order':False,'descr':'<f8'}",
        "{ 'fortran_order' : True,\n 'shape' : ( 1 , ), 'descr' : '<f8' }   ",
    ],
)
@pytest.mark.parametrize("version", [b"\1\0", b"\2\0", b"\3\0"])
def test_headers_as_others_write_them(filled: TestClient, header: str, version: bytes) -> None:
    answer = filled.post(URL, content=headed(header, version=version), headers={**NPZ, "Accept": "application/json"})
    assert (answer.status_code, answer.json()["count"]) == (200, 1)


@pytest.mark.parametrize("method", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_other_ways_to_pack(double: TestClient, method: int) -> None:
    plain, stream = zipfile.ZipFile(io.BytesIO(packed(q=np.zeros(2)))), io.BytesIO()
    with zipfile.ZipFile(stream, "w", method) as archive:
        archive.writestr("q.npy", plain.read("q.npy"))
    whole = stream.getvalue()
    start = whole.index(b"q.npy") + 5
    damaged = whole[:start] + b"\xff" * 15 + whole[start + 15 :]
    for content in (whole, damaged):
        answer = double.post(URL, content=content, headers=NPZ)
        assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "npz")


def test_a_directory_that_takes_memory(double: TestClient) -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for k in range(40_000):
            archive.writestr(f"{k}.npy", b"")
    answer = double.post(URL, content=stream.getvalue(), headers=NPZ)
    assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "too-large")


@pytest.mark.parametrize("name", ["parameters", "inputs", "along", "along.inputs", "t", "parameters.", "qd", ""])
def test_arrays_called_as_objects_are(filled: TestClient, name: str) -> None:
    for value in (np.zeros(2), np.zeros((2, 2, 2)), np.array(1.0), np.array(["a", "b"]), np.zeros(0)):
        stream = io.BytesIO(packed(q=np.zeros(1), quantities=np.array(["metric"])))
        with zipfile.ZipFile(stream, "a") as archive, archive.open(f"{name}.npy", "w") as member:
            np.lib.format.write_array(member, value)
        for preference in ({}, {"Prefer": "respond-async"}):
            answer = filled.post(URL, content=stream.getvalue(), headers={**NPZ, **preference})
            assert answer.status_code in (200, 202, 422), (value, answer.text)
            if name in ("parameters", "inputs"):
                assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, f"/{name}")


@pytest.mark.parametrize("kind", broken())
def test_broken_files(double: TestClient, kind: str) -> None:
    answer = double.post(URL, content=broken()[kind], headers=NPZ)
    assert answer.status_code == 422, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["errors"]


def test_bombs_are_refused_before_they_unpack() -> None:
    stream = io.BytesIO()
    np.savez_compressed(stream, q=np.zeros(10**6))
    assert len(stream.getvalue()) < 20_000
    with pytest.raises(TooLarge, match="8,000"):
        read_npz(stream, 10**6)


@pytest.mark.parametrize("write", [np.savez, np.savez_compressed])
def test_damaged_bytes_are_refused_or_harmless(write: Callable[..., None]) -> None:
    stream = io.BytesIO()
    write(stream, q=np.arange(6.0), names=np.array(["metric"]))
    chance, refused = np.random.default_rng(1), 0
    for _ in range(2000):
        damaged = bytearray(stream.getvalue())
        for _ in range(chance.integers(1, 4)):
            damaged[chance.integers(len(damaged))] = chance.integers(256)
        try:
            read_npz(io.BytesIO(damaged[: chance.integers(1, 10 * len(damaged))]), 10**6)
        except (InvalidDocument, TooLarge):
            refused += 1
    assert refused > 1000


def test_round_trip() -> None:
    arrays = {
        "large": np.arange(3e5),
        "a": np.arange(6.0).reshape(2, 3),
        "b": np.array(["x", "yz"]),
        "c": np.float64(3),
        "d": np.zeros((0, 2)),
    }
    file = write_npz(arrays)
    written = b"".join(file.pieces)
    assert file.size == len(written)
    assert zipfile.ZipFile(io.BytesIO(written)).testzip() is None
    for name, value in np.load(io.BytesIO(written)).items():  # as everybody reads it
        np.testing.assert_array_equal(value, arrays[name])
    for name, value in view_npz(np.frombuffer(written, np.uint8)).items():
        assert not value.flags.owndata, name
        np.testing.assert_array_equal(value, arrays[name])
    found = read_npz(io.BytesIO(written), 10**7)
    for name, value in arrays.items():
        np.testing.assert_array_equal(found[name], value)
    fortran = io.BytesIO()
    np.savez(fortran, a=np.asfortranarray(arrays["a"]))
    np.testing.assert_array_equal(read_npz(fortran, 10**6)["a"], arrays["a"])


def test_members_that_are_no_arrays() -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("../../etc/passwd", "root")
    with pytest.raises(InvalidDocument) as caught:
        read_npz(stream, 10**6)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [("/..~1..~1etc~1passwd", "npy")]
