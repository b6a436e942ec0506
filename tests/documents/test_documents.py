"""Documents: exact numbers, the same refusals in JSON and YAML, canonical bytes."""

from __future__ import annotations

from contextlib import suppress
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field

from substructures.documents import (
    MAX_DEPTH,
    MAX_DIGITS,
    DocumentPart,
    read_json,
    read_model,
    read_yaml,
    write_json,
    write_yaml,
)
from substructures.documents.fields import Name
from substructures.errors import InvalidDocument

READERS = pytest.mark.parametrize("read", [read_json, read_yaml])

finite = st.decimals(allow_nan=False, allow_infinity=False, min_value=-(10**30), max_value=10**30, places=30)
plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**40), 10**40) | finite | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


def fault_of(read: Any, data: bytes | Any) -> tuple[str, str, str]:
    with pytest.raises(InvalidDocument) as caught:
        read(data)
    (fault,) = caught.value.faults
    return fault.pointer, fault.code, fault.message


@READERS
def test_numbers_are_exact(read: Any) -> None:
    value = read(b'{"a": 0.1, "b": [1, -2.50, 6.02e23], "c": 12345678901234567890.123456789}')
    assert value == {
        "a": Decimal("0.1"),
        "b": [1, Decimal("-2.5"), Decimal("6.02e23")],
        "c": Decimal("12345678901234567890.123456789"),
    }
    assert type(value["b"][0]) is int


@READERS
@pytest.mark.parametrize(
    ("data", "pointer", "code", "place"),
    [
        (b'{"a": 1,\n "a": 2}', "/a", "duplicate-key", "line 2, column 2"),
        (b'{"a": [0, {"b": 1, "c": {}, "b": 2}]}', "/a/1/b", "duplicate-key", "line 1, column 29"),
        (b'{"a/b": {"~": {"x": 1, "x": 2}}}', "/a~1b/~0/x", "duplicate-key", "column 24"),
        (b'{"a": [[], ["x", ' + b"7" * 401 + b"]]}", "/a/1/1", "number", "column 18"),
        (b'{"a": 1e400}', "/a", "number", "column 7"),
        (b'{"a": 1e-400}', "/a", "number", "column 7"),
        (b'{"a": [1e999999999999]}', "/a/0", "number", "column 8"),
    ],
)
def test_refusals_have_pointer_and_place(read: Any, data: bytes, pointer: str, code: str, place: str) -> None:
    found = fault_of(read, data)
    assert found[:2] == (pointer, code)
    assert place in found[2]


@pytest.mark.parametrize(("read", "pointer"), [(read_json, ""), (read_yaml, "/a" + "/0" * (MAX_DEPTH - 1))])
def test_the_place_of_too_deep_nesting(read: Any, pointer: str) -> None:
    data = b'{"a": ' + b"[" * MAX_DEPTH + b"]" * MAX_DEPTH + b"}"
    assert fault_of(read, data) == (pointer, "nesting", "nested deeper than 64 levels (line 1, column 70)")


@READERS
def test_limits_are_inclusive(read: Any) -> None:
    assert read(b"[" + b"7" * MAX_DIGITS + b"]") == [int("7" * MAX_DIGITS)]
    assert read(b"[1e399]") == [Decimal("1e399")]
    assert read(b"[0." + b"0" * 700 + b"1e1000]") == [Decimal("1e299")]
    assert read(b"[" + b"{}, [[]], " * MAX_DEPTH + b"0]") == [{}, [[]]] * MAX_DEPTH + [0]
    read(b"[" * MAX_DEPTH + b"]" * MAX_DEPTH)


@READERS
def test_bytes_must_be_utf8(read: Any) -> None:
    assert fault_of(read, b'"\xff"')[1:] == ("encoding", "byte 1 is not UTF-8: invalid start byte")
    assert fault_of(read, '"a"'.encode("utf-16"))[2].endswith("this is UTF-16: save it as UTF-8")  # of PowerShell
    assert read(b'\xef\xbb\xbf{"q": 1}') == {"q": 1}
    assert fault_of(read, b'["\\ud800"]')[1] == "encoding"
    assert read('"\u00e9\U0001f600"'.encode()) == "\u00e9\U0001f600"


@pytest.mark.parametrize("word", ["NaN", "Infinity", "-Infinity"])
def test_json_has_no_nan(word: str) -> None:
    assert fault_of(read_json, f'{{"q": [0, {word}]}}'.encode()) == (
        "/q/1",
        "number",
        f"{word} is not a number (line 1, column 11)",
    )


@pytest.mark.parametrize("data", [b"", b"{", b'{"a": 1,}', b"[1 2]", b"01", b"'a'", b'"\\', b"1\xef\xbb\xbf"])
def test_json_syntax(data: bytes) -> None:
    _, code, message = fault_of(read_json, data)
    assert code == "syntax"
    assert "line" in message


def test_a_paired_surrogate_is_a_character() -> None:
    assert read_json(b'"\\ud83d\\ude00"') == "\U0001f600"


def test_scanning_for_depth_is_linear() -> None:
    assert fault_of(read_json, b'"' + b'\\"' * 500_000)[1] == "syntax"


def test_yaml_has_no_surprises() -> None:
    text = b"""
    words: [on, off, yes, no, y, n, 1:30, 2001-01-01, 0o17, 0x1F, 010, 1_000, 1e, <<, pi/2, -g]
    values: [true, false, null, ~, +1, .5, -1., 1E3]
    strings: ["1", 'true', "", null ]
    """
    value = read_yaml(text)
    assert value["words"] == [w.strip() for w in text.decode().split("[")[1].split("]")[0].split(",")]
    assert value["values"] == [True, False, None, None, 1, Decimal("0.5"), -1, 1000]
    assert value["strings"] == ["1", "true", "", None]


@pytest.mark.parametrize(
    ("data", "pointer", "code"),
    [
        (b"a: &x 1\nb: *x", "/a", "anchor"),
        (b"b: [1, *x]", "/b/1", "anchor"),
        (b"a: !!python/object/apply:os.system [id]", "/a", "tag"),
        (b"a: !!int 3", "/a", "tag"),
        (b"---\na: 1\n---\nb: 2", "", "syntax"),
        (b"x: {1: a}", "/x", "key"),
        (b"x: {true: a}", "/x", "key"),
        (b"? [a, b]\n: c", "", "key"),
        (b"x:\n- a\n- y: .nan", "/x/1/y", "number"),
        (b"x: [.inf]", "/x/0", "number"),
        (b"a: b: c", "", "syntax"),
        (b"a: [1, 2", "/a/2", "syntax"),
        (b'a: "\\UFFFFFFFF"', "/a", "syntax"),
        (b"a: \x07", "", "encoding"),
        (b"%YAML 3.0\n---\na: 1", "", "syntax"),
        (b"\ta: 1", "", "syntax"),
    ],
)
def test_yaml_refusals(data: bytes, pointer: str, code: str) -> None:
    assert fault_of(read_yaml, data)[:2] == (pointer, code)


def test_nested_yaml_stops_early() -> None:
    assert fault_of(read_yaml, b"[" * 200_000)[1] == "nesting"
    assert fault_of(read_yaml, b"- " * 65)[1] == "nesting"


def test_canonical_bytes() -> None:
    data = {
        "b": Decimal("1.500"),
        "a": [Decimal("1E+3"), Decimal("-0.0"), 1e-7, None, True, "\u00e9"],
        "c": {},
        "d": [],
    }
    assert (
        write_json([Decimal("7" * MAX_DIGITS), int("7" * MAX_DIGITS)])
        == f"[{'7' * MAX_DIGITS},{'7' * MAX_DIGITS}]".encode()
    )
    expected = '{"a":[1000,0,0.0000001,null,true,"\u00e9"],"b":1.5,"c":{},"d":[]}'
    assert write_json(data) == expected.encode()


@pytest.mark.parametrize(
    ("data", "pointer", "code"),
    [
        ({"a": [float("nan")]}, "/a/0", "number"),
        ([Decimal("Infinity")], "/0", "number"),
        ([Decimal("1e400")], "/0", "number"),
        ([10**400], "/0", "number"),
        ({"a": {1: 2}}, "/a", "key"),
        ({"a": {1, 2}}, "/a", "type"),
        (["\ud800"], "", "encoding"),
    ],
)
def test_only_plain_data_is_written(data: Any, pointer: str, code: str) -> None:
    assert fault_of(write_json, data)[:2] == (pointer, code)


def in_numpy(data: Any, as_array: bool) -> Any:
    """The same with NumPy's scalars, and arrays of them, for what they can hold exactly."""
    if isinstance(data, dict):
        return {name: in_numpy(x, as_array) for name, x in data.items()}
    if isinstance(data, list):
        alike = as_array and data and {type(x) for x in data} in ({float}, {bool})
        return np.array(data) if alike else [in_numpy(x, as_array) for x in data]
    if isinstance(data, bool):
        return np.bool_(data)
    if isinstance(data, int):
        return np.int64(data) if abs(data) < 2**63 else data
    return {float: np.float64, str: np.str_}.get(type(data), lambda x: x)(data)


@given(
    st.recursive(
        st.none() | st.booleans() | st.integers(-(10**20), 10**20) | st.floats(-1e99, 1e99) | st.text(),
        lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
        max_leaves=20,
    ),
    st.booleans(),
)
def test_numbers_of_numpy_have_the_bytes_of_plain_ones(data: Any, as_array: bool) -> None:
    with suppress(InvalidDocument):  # a lone surrogate
        assert write_json(in_numpy(data, as_array)) == write_json(data)


@pytest.mark.parametrize("value", [np.float32(0.5), np.float64(0.5), np.array(0.5)])
def test_every_float_of_numpy_is_written(value: Any) -> None:
    assert write_json({"a": [value]}) == b'{"a":[0.5]}'


@pytest.mark.parametrize("value", [np.float64("nan"), np.float32("inf"), np.array([1, np.nan])])
def test_not_a_number_is_refused_in_numpy_as_well(value: Any) -> None:
    with pytest.raises(InvalidDocument, match="is not a number"):
        write_json([value])


def test_writing_has_the_same_depth() -> None:
    data: Any = []
    for _ in range(MAX_DEPTH - 1):
        data = [data]
    assert read_json(write_json(data)) == data
    assert fault_of(write_json, [data])[1] == "nesting"


@given(plain)
def test_round_trip(data: Any) -> None:
    written = write_json(data)
    assert read_json(written) == data
    assert write_json(read_json(written)) == written


@given(st.binary(max_size=60) | st.text(alphabet="[]{}:,\"\\ \n-&*!|>%@`#?'0eE.+a", max_size=60).map(str.encode))
def test_arbitrary_bytes_raise_nothing_else(data: bytes) -> None:
    for read in (read_json, read_yaml):
        with suppress(InvalidDocument):
            write_json(read(data))


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ({"q": [Decimal("1.2"), None]}, 'found {"q":[1.2,null]}'),
        ("x" * 100, 'found "' + "x" * 79 + "..."),
        ({1: 2}, ""),
    ],
)
def test_messages_show_what_was_found_as_json(value: object, shown: str) -> None:
    class One(DocumentPart):
        field: int

    with pytest.raises(InvalidDocument) as caught:
        read_model(One, {"field": value})
    (fault,) = caught.value.faults
    assert fault.message.endswith(shown)
    assert ("found" in fault.message) == bool(shown)


def test_thousands_of_faults_take_one_look_at_the_schema(monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes milliseconds to make: 5,000 parameters of bad names took a minute."""

    class Inner(DocumentPart):
        field: int

    class Outer(DocumentPart):
        inner: list[Inner]
        lists: list[list[int]]

    looks = []
    made = Outer.model_json_schema
    monkeypatch.setattr(Outer, "model_json_schema", lambda: looks.append(1) or made())
    with pytest.raises(InvalidDocument) as caught:
        read_model(Outer, {"inner": ["text"] * 300, "lists": [1] * 300})
    assert len(caught.value.faults) == 600
    assert len(looks) == 1


def test_some_values_may_stand_for_lists_of_one() -> None:
    class Many(DocumentPart):
        lists: list[list[int]]

    assert read_model(Many, {"lists": [1, 2]}).lists == [[1], [2]]
    with pytest.raises(InvalidDocument):
        read_model(Many, {"lists": [1] * 1000})


@pytest.mark.parametrize(
    "value",
    [
        {"a": "1e-3", "b": "yes", "c": "null", "d": "0x10", "e": "1:30", "f": "", "g": " x ", "h": "a: b", "i": "- x"},
        {"a": Decimal("1e-30"), "b": Decimal("0.1"), "c": -3, "d": 10**30, "e": Decimal("123456789.000000001")},
        {"a": [True, False, None], "b": [[1, 2], [3, 4]], "c": [{"x": [1]}], "d": {}, "e": [], "f": ()},
        {
            "a": "line\nline\n",
            "b": "tab\t",
            "c": "ä€𝄞",
            "d": "#x",
            "e": "'\"",
            "f": "*a",
            "g": "&a",
            "h": "!x",
            "i": "%",
        },
        {"1": "key", "null": 1, "on": 2, "a b": 3, "": 4},
        [1, "x" * 300, {"y": "z" * 300}],
    ],
)
def test_yaml_that_is_written_is_read_back_exactly(value: Any) -> None:
    def plain(x: Any) -> Any:
        if isinstance(x, dict):
            return {key: plain(y) for key, y in x.items()}
        return [plain(y) for y in x] if isinstance(x, list | tuple) else x

    text = write_yaml(value)
    assert read_yaml(text) == plain(value)
    assert write_yaml(read_yaml(text)) == text


@given(st.dictionaries(st.text(), plain, max_size=4))
def test_any_plain_data_in_yaml(value: dict[str, Any]) -> None:
    text = write_yaml(value)
    assert write_json(read_yaml(text)) == write_json(value)


class _Names(DocumentPart):
    names: tuple[Name, ...] = Field(min_length=2)


@pytest.mark.parametrize(
    ("names", "places"), [(["a", "1b"], ["/names/1"]), (["a"], ["/names"]), (["1b"], ["/names/0", "/names"])]
)
def test_a_wrong_entry_makes_no_list_too_short(names: list[str], places: list[str]) -> None:
    with pytest.raises(InvalidDocument) as caught:
        read_model(_Names, {"names": names})
    assert [fault.pointer for fault in caught.value.faults] == places
