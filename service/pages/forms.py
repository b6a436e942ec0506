"""Forms of the workbench: one for every step, those of loads as the documents of their types are."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, get_args

from service.pages.html import Content, Html, tag
from substructures.loads.kinds import AnyTreeLoad
from substructures.tree.document import Closure

LOOPS = get_args(Closure.model_fields["type"].annotation)
PLACEMENT = (("x", "m"), ("y", "m"), ("z", "m"), ("roll", "rad"), ("pitch", "rad"), ("yaw", "rad"))
INSTANCE = {"pattern": "[A-Za-z][A-Za-z0-9_]*", "title": "a letter, then letters, digits and _"}
ENDS = ("from", "to")
FIRST = (*ENDS, "coordinate", "along")
UNIT = re.compile(r"(N|J|m|rad)\b")


def couple(part: str, at: str) -> Html:
    """An instance more; ``part`` and ``at`` are filled in."""
    numbers = [field(name, unit, value="0", inputmode="decimal") for name, unit in PLACEMENT]
    form = tag(
        "form",
        field("substructure", list="parts", required="required", placeholder="search as you type", value=part),
        field("name", required="required", value=_instance(part), **INSTANCE),
        frame_field("at", at),
        tag("fieldset", tag("legend", "placement: numbers or expressions, or drag the part"), numbers),
        submit("Couple"),
        data_action="couplings",
        class_="step",
    )
    return tag("details", tag("summary", "Couple a part"), form, tag("datalist", id="parts"), open="open")


def _instance(part: str) -> str:
    """A name for an instance of a part, as the part is called."""
    name = part.partition("@")[0].replace("-", "_")
    return f"part_{name}" if name[:1].isdigit() else name


def change(instances: Sequence[str]) -> Html:
    """Another part or place for an instance, which keeps what it carries."""
    chosen = _choice("instance", instances, "instance")
    fields = (
        field("substructure", list="parts", placeholder="as it is", data_kind="text"),
        frame_field("at", placeholder="as it is", data_kind="text", required=None),
    )
    return _form("Replace or move an instance", "couplings", chosen, fields, method="PATCH") if instances else Html()


Settable = Mapping[str, tuple[Mapping[str, Any], Mapping[str, Any]]]


def parameters(instances: Settable) -> Html:
    """Values for the parameters of an instance; ``instances``: by name what is declared, and what is given."""
    shown = {name: each for name, each in instances.items() if each[0]}
    sets = [
        tag(
            "fieldset",
            tag("legend", f"{name}: values, with units, or expressions; empty is the default"),
            [_parameter(each, about, given.get(each)) for each, about in declared.items()],
            data_type=name,
            **_shut(k),
        )
        for k, (name, (declared, given)) in enumerate(shown.items())
    ]
    chosen = _choice("instance", list(shown), "instance")
    return _form("Set parameters", "couplings", chosen, sets, method="PATCH") if shown else Html()


def _parameter(name: str, about: Mapping[str, Any], given: Any) -> Html:
    default = about.get("value")
    return field(
        name,
        about.get("unit", ""),
        value="" if given is None else written(given),
        placeholder="to be given" if default is None else written(default),
        title=about.get("description") or None,
        data_kind="number",
        data_member="parameters",
    )


def gravity(given: Sequence[Any]) -> Html:
    """The acceleration of gravity of a tree."""
    shown = ", ".join(map(written, given))
    words = "x, y, z in world axes: numbers or expressions in parameters of the tree"
    entered = field("gravity", "m/s²", value=shown, required="required", title=words, data_kind="vector")
    return _form("Set gravity", "tree", entered, method="PATCH")


def written(given: Any) -> str:
    """A number of a document as it is typed: with its unit if it has one."""
    return f"{given['value']} {given['unit']}" if isinstance(given, Mapping) else str(given)


def _shut(k: int) -> dict[str, str]:
    """Attributes of a set of fields that is not the first one."""
    return {} if k == 0 else {"hidden": "hidden", "disabled": "disabled"}


def load(coordinates: Sequence[str]) -> Html:
    """A load of any type; only the fields of the chosen type are there."""
    types = _choice("type", list(_loads()), "type")
    sets = [
        tag(
            "fieldset",
            tag("legend", name),
            [_given(each, schema, required, coordinates) for each, schema, required in fields],
            data_type=name,
            **_shut(k),
        )
        for k, (name, fields) in enumerate(_loads().items())
    ]
    return _form("Add a load", "loads", field("name", required="required", **INSTANCE), types, sets)


def loop() -> Html:
    """A closure."""
    ends = frame_field("from", data_kind="text"), frame_field("to", "world", data_kind="text")
    length = field("length", "m", placeholder="of a rod", data_kind="number")
    name = field("name", required="required", **INSTANCE)
    return _form("Close a loop", "closures", name, _choice("type", LOOPS, "type"), ends, length)


def publish(name: str) -> Html:
    """The tree as a part."""
    title = field("title", data_kind="text")
    return _form("Publish as a part", "publish", field("name", value=name, required="required"), title)


def field(name: str, unit: str = "", **attributes: str | int | None) -> Html:
    """A labelled input."""
    label = f"{name.replace('_', ' ')} " if not unit else f"{name.replace('_', ' ')} in {unit} "
    return tag("label", label, tag("input", name=name, **{"autocomplete": "off", **attributes}))


def frame_field(name: str, value: str = "", **attributes: str | int | None) -> Html:
    """An input that takes a frame, typed or picked."""
    return field(name, "", list="frames", value=value, data_pick="1", **{"required": "required", **attributes})


def _choice(name: str, values: Sequence[str], label: str) -> Html:
    return tag("label", f"{label} ", tag("select", [tag("option", each, value=each) for each in values], name=name))


def submit(title: str, **attributes: str) -> Html:
    """A button that a script makes usable: before that, a browser would ask for a page with the fields as its query."""
    return tag("button", title, type="submit", disabled="disabled", **attributes)


def _form(title: str, action: str, *fields: Content, method: str | None = None) -> Html:
    form = tag("form", fields, submit(title), data_action=action, data_method=method, class_="step")
    return tag("details", tag("summary", title), form)


@cache
def _loads() -> Mapping[str, Sequence[tuple[str, Mapping[str, Any], bool]]]:
    """By type of load: its fields with their schemas, and whether they are needed."""
    schema = AnyTreeLoad.model_json_schema()
    found = {}
    for reference in schema["oneOf"]:
        load = schema["$defs"][reference["$ref"].rpartition("/")[2]]
        needed = load.get("required", ())
        fields = [(name, of, name in needed) for name, of in load["properties"].items() if name not in ("type", "name")]
        ordered = sorted(
            fields, key=lambda each: (FIRST.index(each[0]) if each[0] in FIRST else len(FIRST), not each[2])
        )
        found[load["properties"]["type"]["const"]] = ordered
    return found


def _given(name: str, schema: Mapping[str, Any], needed: bool, coordinates: Sequence[str]) -> Html:
    """A field as its schema says."""
    said = [each.strip() for each in schema.get("description", "").split(";")]
    unit = next(filter(UNIT.match, said), "")
    words = "; ".join(each for each in said if each and each != unit) or None
    required = "required" if needed else None
    if name in ENDS:
        return frame_field(name, str(schema.get("default", "")), required=required, data_kind="text")
    if name == "coordinate":
        options = [tag("option", each, value=each) for each in coordinates]
        return tag("label", "coordinate ", tag("select", options, name=name, data_kind="text"))
    if "enum" in schema:
        values = [str(each) for each in schema["enum"]]
        options = [tag("option", each, value=each) for each in values]
        return tag("label", f"{name} ", tag("select", options, name=name, data_kind="text"), title=words)
    if schema.get("type") == "boolean":
        return tag("label", tag("input", type="checkbox", name=name, data_kind="flag"), f" {name}: {words}")
    if name == "along":
        return frame_field(name, placeholder="two frames or more", data_kind="frames", required=required)
    is_vector = schema.get("maxItems") == 3
    hint = "x, y, z" if is_vector else "0" if schema.get("default") == 0 else None
    kind = "vector" if is_vector else "number"
    return field(name, unit, data_kind=kind, required=required, placeholder=hint, title=words)
