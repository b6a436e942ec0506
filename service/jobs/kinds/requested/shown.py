"""What pages in a browser compute with and tell about entries of formulas, made by runners for requests.

An item names a part (``substructure``, ``program``) or a tree (as :func:`service.jobs.kinds.trees.pinned`), with its
``reference`` and the most ``nodes`` that are printed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import orjson

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import tree_parts
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.kind import Blobs
from service.jobs.kinds.requested.reported import INSTANCE
from service.jobs.kinds.trees import source_of
from service.messages.refusals import unprocessable
from service.models.entries import entry
from service.models.exporting import NAME
from service.models.formulas import made
from service.models.source import Source
from service.schemas.jobs import ItemDocument
from substructures.export import Exported, exported_model, exported_part, interface_of_model, interface_of_part
from substructures.export.exported import Function, quantity_program
from substructures.export.interface import Interface
from substructures.export.software import SOFTWARE
from substructures.export.webassembly.functions import webassembly
from substructures.export.webassembly.layout import layout
from substructures.expr.hoist import hoisted
from substructures.expr.program import Program
from substructures.part.outputs import with_own_inertia
from substructures.part.part import INTERNAL, Part
from substructures.quantities.origins import movers_of_part, movers_of_tree, origins
from substructures.quantities.quantity import outputs_of
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec

#: of programs where none are named, those that there are; of origins always
OF_TREES = ("metric", "christoffel", "forces", "position", "rotation")
OF_PARTS = ("metric", "christoffel")
KINEMATICS = ("position", "rotation")
INTEGRALS = "first_integrals"
WITH_ORIGINS = ("metric", "christoffel", "forces", "gravity")


def _subject(item: ItemDocument, blobs: Blobs) -> Part | Source:
    if "substructure" in item:
        return part_of(item["substructure"].partition("@")[2], item["program"], blobs)
    return source_of(item, blobs, {"program_nodes": item["nodes"]})


def program_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """Files ``wasm`` and ``json``: quantities as a module, and what stands where in its memory. Raises InvalidArgument
    for unknown ``quantities``, TooLarge."""
    exported = _exported(_subject(item, blobs), item)
    made = webassembly(exported)
    return Outcome(files={"wasm": made.content, "json": orjson.dumps(layout(exported, made, SOFTWARE))})


def _exported(found: Part | Source, item: ItemDocument) -> Exported:
    digest, reference = item["digest"], item["reference"]
    if isinstance(found, Part):
        names, interface = item["quantities"], interface_of_part(found, reference, digest)
        if names:
            return exported_part(found, interface, names, NAME)
        made = exported_part(found, interface, _there(found.program, OF_PARTS), NAME)
        return replace(made, functions=(*made.functions, *_kinematics(found, interface, item["nodes"])))
    names = item["quantities"] or _there(found.model.program, OF_TREES)
    return exported_model(found.sources, interface_of_model(found.model, reference, digest), names, NAME)


def _kinematics(part: Part, interface: Interface, nodes: int) -> list[Function]:
    """Positions and rotations of all frames of a part mounted on the world, in the names of the part."""
    one = {"name": INSTANCE, "substructure": part.name, "level": "full"}
    spec = TreeSpec.read({"name": part.name, "instances": [one]})
    model = couple(spec, {INSTANCE: part}, nodes)
    found = []
    for name in KINEMATICS:
        program = hoisted(model.program.select([name]))
        symbols = tuple(replace(s, name=s.name.removeprefix(f"{INSTANCE}.")) for s in program.symbols)
        found.append(Function(name, replace(program, symbols=symbols), interface))
    return found


def _there(program: Program, names: tuple[str, ...]) -> list[str]:
    return [name for name in names if all(output in program.outputs for output in outputs_of(name))]


def origins_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """File ``json``: what every entry of metric, Christoffel symbols and forces comes from."""
    found = _subject(item, blobs)
    if isinstance(found, Part):
        names = _there(found.program, WITH_ORIGINS)
        program, movers = with_own_inertia(found, found.program.select(names)), movers_of_part(found)
    else:
        names = _there(found.model.program, WITH_ORIGINS)
        program, movers = found.model.program.select(names), movers_of_tree(*tree_parts(item["parts"], blobs))
    return Outcome(files={"json": orjson.dumps({"digest": item["digest"], **origins(program, movers)})})


def entry_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """File ``json``: one entry of a quantity, ``index``, as :func:`service.models.entries.entry` tells it."""
    found, quantity, index = _subject(item, blobs), item["quantity"], tuple(item["index"])
    if quantity == INTEGRALS and isinstance(found, Source):
        return Outcome(files={"json": orjson.dumps(_integral(found, *index))})
    told = entry(_quantity(found, quantity), quantity, index, _interface(found))
    return Outcome(files={"json": orjson.dumps(told)})


def integrals_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """File ``json``: the first integrals of a tree with their reasons, without their formulas."""
    found = _subject(item, blobs)
    told = made(found, INTEGRALS, {}).members["integrals"] if isinstance(found, Source) else []
    return Outcome(files={"json": orjson.dumps(told)})


def _integral(source: Source, number: int = -1, *_: int) -> dict[str, Any]:
    """One of them as an entry, which is a scalar."""
    found = made(source, INTEGRALS, {})
    integrals = found.members["integrals"]
    if not 0 <= number < len(integrals):
        raise unprocessable("component", f"there are {len(integrals)} first integrals, from 0 on", "/query/index")
    told = integrals[number]
    shown = entry(found.program.select([told["name"]]), told["name"], (), interface_of_model(source.model))
    return {**shown, "quantity": INTEGRALS, "index": [number], "of": [number], "integral": told}


def _quantity(found: Part | Source, name: str) -> Program:
    if isinstance(found, Source):
        return quantity_program(found.sources, name)
    known = [output for output in found.program.outputs if output not in INTERNAL]
    outputs = [output for output in outputs_of(name) if output in known]
    return with_own_inertia(found, found.program.select(outputs))


def _interface(found: Part | Source) -> Interface:
    return interface_of_part(found) if isinstance(found, Part) else interface_of_model(found.model)


REQUESTED = {"program": program_of, "origins": origins_of, "entry": entry_of, "integrals": integrals_of}
