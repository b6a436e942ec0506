"""``modelDescription.xml`` of both versions, and what else an FMU says of itself in XML.

Functional Mock-up Interface, 3.0.2 (sections 2.4 and 2.5) and 2.0.4 (section 2.2), Modelica Association.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from fractions import Fraction
from xml.etree import ElementTree as Tree

from substructures.documents.units import BASE, UnknownUnitError, read_unit
from substructures.export.fmu.variables import TOLERANCE, Layout, Variable
from substructures.export.software import SOFTWARE
from substructures.tree.model import KINEMATICS

#: shown in degrees: factor of the displayed number
_DEGREES = 57.29577951308232
_SHOWN = {"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"}
_NAMES = {"canGetAndSetFMUState": "canGetAndSetFMUstate", "canSerializeFMUState": "canSerializeFMUstate"}
_NAMES |= {"providesDirectionalDerivatives": "providesDirectionalDerivative"}
_ABILITIES = ("canGetAndSetFMUState", "canSerializeFMUState", "providesDirectionalDerivatives")
_STEPS = "canHandleVariableCommunicationStepSize"


def text(root: Tree.Element) -> bytes:
    """A document."""
    Tree.indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + Tree.tostring(root, encoding="utf-8") + b"\n"


def description3(layout: Layout, token: str) -> bytes:
    """``modelDescription.xml`` of version 3.0."""
    root = _root(layout, "3.0", {"instantiationToken": token})
    for kind in ("ModelExchange", "CoSimulation"):
        more = {_STEPS: "true"} if kind == "CoSimulation" else {}
        if layout.exported.contacts and kind == "ModelExchange":
            more = {"needsCompletedIntegratorStep": "true"}
        told = {"modelIdentifier": layout.exported.name, **dict.fromkeys(_abilities(layout), "true"), **more}
        Tree.SubElement(root, kind, told)
    _units(root, layout.variables)
    Tree.SubElement(Tree.SubElement(root, "LogCategories"), "Category", {"name": "logStatusError"})
    _experiment(root)
    variables = Tree.SubElement(root, "ModelVariables")
    for each in layout.variables:
        told = {"name": each.name, "valueReference": str(each.at), **_kind(each)}
        told |= {"unit": each.unit} if _has_unit(each) else {}
        told |= {"derivative": str(each.of)} if each.of is not None else {}
        told |= {"start": repr(each.start)} if each.start is not None else {}
        one = Tree.SubElement(variables, "Float64", told)
        for n in each.shape:
            Tree.SubElement(one, "Dimension", {"start": str(n)})
    structure = Tree.SubElement(root, "ModelStructure")
    for name, chosen in _structure(layout.variables):
        for each in chosen:
            Tree.SubElement(structure, name, {"valueReference": str(each.at)})
    for each in layout.variables:
        if each.role == "indicator":
            Tree.SubElement(structure, "EventIndicator", {"valueReference": str(each.at)})
    return text(root)


def description2(layout: Layout, token: str, sources: Sequence[str]) -> bytes:
    """``modelDescription.xml`` of version 2.0, where every number is a variable."""
    root = _root(layout, "2.0", {"guid": token, "numberOfEventIndicators": str(2 * len(layout.exported.contacts))})
    for kind in ("ModelExchange", "CoSimulation"):
        more = {_STEPS: "true"} if kind == "CoSimulation" else {}
        told = {"modelIdentifier": layout.exported.name, **{_NAMES[a]: "true" for a in _abilities(layout)}, **more}
        files = Tree.SubElement(Tree.SubElement(root, kind, told), "SourceFiles")
        for source in sources:
            Tree.SubElement(files, "File", {"name": source})
    _units(root, layout.variables)
    Tree.SubElement(Tree.SubElement(root, "LogCategories"), "Category", {"name": "logStatusError"})
    _experiment(root)
    every = [element for each in layout.variables for element in each.elements()]
    number = {each.at: i for i, each in enumerate(every, 1)}
    variables = Tree.SubElement(root, "ModelVariables")
    for each in every:
        told = {"name": each.name, "valueReference": str(each.at), **_kind(each)}
        one = Tree.SubElement(variables, "ScalarVariable", told)
        real = {"unit": each.unit} if _has_unit(each) else {}
        real |= {"derivative": str(number[each.of])} if each.of is not None else {}
        real |= {"start": repr(each.start)} if each.start is not None else {}
        Tree.SubElement(one, "Real", real)
    structure = Tree.SubElement(root, "ModelStructure")
    groups = {"Output": "Outputs", "ContinuousStateDerivative": "Derivatives", "InitialUnknown": "InitialUnknowns"}
    for name, chosen in _structure(every):
        group = Tree.SubElement(structure, groups[name])
        for each in chosen:
            Tree.SubElement(group, "Unknown", {"index": str(number[each.at])})
    return text(root)


def _abilities(layout: Layout) -> Sequence[str]:
    """Derivatives of the formulas are not those of a motion with contacts."""
    return _ABILITIES[:-1] if layout.exported.contacts else _ABILITIES


def build_description(layout: Layout, sources: Sequence[str]) -> bytes:
    """``sources/buildDescription.xml`` of version 3.0."""
    root = Tree.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    one = Tree.SubElement(root, "BuildConfiguration", {"modelIdentifier": layout.exported.name})
    files = Tree.SubElement(one, "SourceFileSet", {"language": "C99"})
    for name in sources:
        Tree.SubElement(files, "SourceFile", {"name": name})
    Tree.SubElement(one, "Library", {"name": "m", "external": "true"})
    return text(root)


def terminals(layout: Layout, version: str) -> bytes | None:
    """``terminalsAndIcons.xml``: a terminal for each frame whose pose is an output; None where there is none."""
    found: dict[str, list[Variable]] = {}
    for each in layout.variables:
        frame, dot, name = each.name.rpartition(".")
        if dot and name in KINEMATICS and frame in layout.interface.frames:
            found.setdefault(frame, []).extend([each] if version == "3.0" else each.elements())
    if not found:
        return None
    root = Tree.Element("fmiTerminalsAndIcons", {"fmiVersion": "3.0"})
    group = Tree.SubElement(root, "Terminals")
    for frame, members in found.items():
        told = {"name": frame, "matchingRule": "bus", "terminalKind": "org.substructures.frame"}
        one = Tree.SubElement(group, "Terminal", told)
        for member in members:
            name = member.name.removeprefix(f"{frame}.")
            told = {"variableName": member.name, "memberName": name, "variableKind": "signal"}
            Tree.SubElement(one, "TerminalMemberVariable", told)
    return text(root)


def _root(layout: Layout, version: str, more: dict[str, str]) -> Tree.Element:
    interface = layout.interface
    made_from = f"{interface.reference or layout.exported.name}, {interface.digest}"
    about = f"{re.sub('[^ -~]', '?', made_from)}: equations of motion of a mechanism"
    told = {"fmiVersion": version, "modelName": layout.exported.name, **more, "description": about}
    told |= {"generationTool": SOFTWARE, "variableNamingConvention": "structured"}
    told |= {"license": "the output of a program, which belongs to whoever had it made"}
    return Tree.Element("fmiModelDescription", told)


def _experiment(root: Tree.Element) -> None:
    told = {"startTime": "0.0", "stopTime": "1.0", "tolerance": repr(TOLERANCE)}
    Tree.SubElement(root, "DefaultExperiment", told)


def _kind(each: Variable) -> dict[str, str]:
    told = {"causality": each.causality, "variability": each.variability}
    told |= {"description": each.description} if each.description else {}
    if each.causality in ("output", "local"):
        told["initial"] = "calculated" if each.start is None else "exact"
    return told


def _structure(variables: Iterable[Variable]) -> list[tuple[str, list[Variable]]]:
    every = list(variables)
    outputs = [each for each in every if each.causality == "output"]
    rates = [each for each in every if each.of is not None]
    unknown = [each for each in outputs if each.start is None]
    initial = sorted([*unknown, *rates], key=lambda each: each.at)
    return [("Output", outputs), ("ContinuousStateDerivative", rates), ("InitialUnknown", initial)]


def _has_unit(each: Variable) -> bool:
    """Whether its unit is a product of powers with whole exponents."""
    return bool(each.unit) and _exponents(each.unit) is not None


def _exponents(unit: str) -> dict[str, int] | None:
    try:
        read = read_unit(unit)
    except UnknownUnitError:
        return None
    if read.factor != 1 or read.pi or any(Fraction(n).denominator != 1 for n in read.dimension):
        return None
    found = {name: int(n) for name, n in zip(BASE, read.dimension, strict=True) if n}
    turns = {"rad": 1, "rad/s": 1, "rad/s^2": 1}.get(unit, 0)
    return found | ({"rad": turns} if turns else {})


def _units(root: Tree.Element, variables: Iterable[Variable]) -> None:
    found = dict.fromkeys(each.unit for each in variables if _has_unit(each))
    if not found:
        return
    group = Tree.SubElement(root, "UnitDefinitions")
    for unit in found:
        one = Tree.SubElement(group, "Unit", {"name": unit})
        Tree.SubElement(one, "BaseUnit", {name: str(n) for name, n in (_exponents(unit) or {}).items()})
        if unit in _SHOWN:
            Tree.SubElement(one, "DisplayUnit", {"name": _SHOWN[unit], "factor": repr(_DEGREES)})
