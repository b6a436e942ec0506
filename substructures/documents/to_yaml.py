"""The YAML writer: documents as people keep them in files, the same text for the same data.

Keys stay in their order, what fits a line is on one, and no lines are wrapped that were not wrapped before, so that a
change of one number is a change of one line. What is written is read back exactly (:func:`.from_yaml.read_yaml`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from typing import Any

import yaml

from substructures.documents.from_yaml import read_yaml
from substructures.documents.to_json import write_json
from substructures.errors import InvalidDocument

WIDTH = 120  # of a collection on one line
ENDLESS = 10**9


class _Writer(yaml.SafeDumper):
    """Without anchors, which the reader refuses."""

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002 -- called so
        """All of it is written where it stands."""
        return True

    def increase_indent(self, flow: bool = False, indentless: bool = False) -> None:  # noqa: ARG002 -- called so
        """Lists stand further in than their keys."""
        super().increase_indent(flow, False)


def write_yaml(value: Mapping[str, Any] | Sequence[Any]) -> bytes:
    """A YAML document. Plain data: mappings, lists, tuples, texts, exact numbers, True, False, None."""
    return yaml.dump(
        value, Dumper=_Writer, sort_keys=False, allow_unicode=True, width=ENDLESS, default_flow_style=False
    ).encode()


def _text(writer: _Writer, value: str) -> yaml.Node:
    """Quoted where the reader would take it for something else."""
    style = None
    if "\n" in value:
        style = '"'
    else:
        try:
            is_plain = read_yaml(value.encode()) == value
        except InvalidDocument:
            is_plain = False
        style = None if is_plain else '"'
    return writer.represent_scalar("tag:yaml.org,2002:str", value, style=style)


def _number(writer: _Writer, value: Decimal | int) -> yaml.Node:
    """As in JSON, whatever PyYAML takes it for."""
    text = write_json(value).decode()
    tag: str = writer.resolve(yaml.ScalarNode, text, (True, False))  # type: ignore[no-untyped-call]
    return writer.represent_scalar(tag, text)


def _mapping(writer: _Writer, value: Mapping[str, Any]) -> yaml.Node:
    return writer.represent_mapping("tag:yaml.org,2002:map", value.items(), flow_style=_fits(value))


def _list(writer: _Writer, value: Sequence[Any]) -> yaml.Node:
    return writer.represent_sequence("tag:yaml.org,2002:seq", value, flow_style=_fits(value))


def _fits(value: Any) -> bool:
    """Whether a collection stands on a line of its own: there are but numbers, words and short lists in it."""
    inner = value.values() if isinstance(value, Mapping) else value
    is_flat = not any(isinstance(x, Mapping) or (isinstance(x, list | tuple) and not _is_plain(x)) for x in inner)
    return is_flat and len(write_json(value)) <= WIDTH


def _is_plain(value: Sequence[Any]) -> bool:
    return not any(isinstance(x, Mapping | list | tuple) for x in value)


_WRITTEN: dict[Any, Callable[[_Writer, Any], yaml.Node]] = {
    str: _text,
    Decimal: _number,
    int: _number,
    dict: _mapping,
    list: _list,
    tuple: _list,
}
for _kind, _represented in _WRITTEN.items():
    _Writer.add_representer(_kind, _represented)
