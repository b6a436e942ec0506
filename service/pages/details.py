"""The pages of one part and of one tree."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from service.messages.addresses import tree_path, version_path
from service.pages import words
from service.pages.found import links, proof, size
from service.pages.html import Content, Html, facts, html, joined, link, table, tag
from service.pages.layout import document
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.views.resources import part_warnings
from substructures.documents import read_json
from substructures.export import TARGETS
from substructures.loads.kinds import acts_on
from substructures.part.part import Part
from substructures.tree.model import Model

QUANTITIES = ("metric", "christoffel", "forces", "gravity", "coriolis", "kinematics")
#: targets of exports that take no version of their own; parts alone have no forces, so that none of them moves
OF_TREES = tuple(name for name in TARGETS if name != "fmu2")
OF_PARTS = tuple(name for name in OF_TREES if name not in ("fmu", "simulink"))
#: sections of a page, before and after those that are always there
Notes = tuple[Sequence[Html], Sequence[Html]]
OF_PART = "total: the whole stored program, with what coupling needs."
OF_TREE = "total: metric, Christoffel symbols and forces together."


def part_page(version: Version, aliases: Sequence[str], part: Part, work: Html, notes: Notes = ((), ())) -> bytes:
    """The bytes of the page of a version; ``work``: its first screen
    (:func:`service.pages.model.place.place`); ``notes``: what is said before and after its sections.
    """
    path, reference = version_path(version), f"{version.name}@{version.version}"
    certificate = {**read_json(version.certificate.encode()), "warnings": part_warnings(version)}
    return document(
        f"{reference} - substructures",
        tag("h1", version.title or version.name, dir="auto"),
        _first(reference, (version.dof, version.joints, version.mass), certificate),
        _acts(path, link("Couple onto a tree", f"/trees?part={reference}"), exported=OF_PARTS if version.dof else ()),
        _withdrawn(version),
        *notes[0],
        work,
        tag("p", version.description, dir="auto") if version.description else Html(),
        _split(path, reference, _about_part(version, aliases, part)),
        *_sections(
            words.coordinates(part.coordinates, part.joints),
            words.parameters(read_json(version.parameters.encode())),
            words.operations(read_json(version.operations.encode()), OF_PART),
            certificate,
        ),
        *notes[1],
        crumbs=[("catalogue", "/")],
    )


def _about_part(version: Version, aliases: Sequence[str], part: Part) -> Html:
    reference, definition = f"{version.name}@{version.version}", part.definition
    return facts(
        [
            ("Reference", tag("code", reference)),
            ("Aliases", joined([tag("code", f"{version.name}@{alias}") for alias in aliases])),
            ("Size", size(version.dof, version.joints)),
            ("Bodies", joined(part.bodies)),
            ("Ports", joined(part.ports) or "none"),
            ("Tags", joined(definition.tags)),
            ("License", definition.license),
            ("Source", definition.source),
            ("Owner", _owner(version)),
            ("Note", version.note),
            ("Published from", link(version.tree, f"/trees/{version.tree}") if version.tree else None),
            (
                "Derived from",
                link(version.derived_from, f"/substructures/{version.derived_from}") if version.derived_from else None,
            ),
            ("Stored", version.created[:10]),
            ("Derived", "here, of the definition"),
            ("Digest", tag("code", version.digest, class_="small")),
            ("As data", joined([link("JSON", version_path(version)), *links(version)], " · ")),
        ]
    )


def tree_page(tree: Tree, model: Model, work: Html, notes: Notes = ((), ())) -> bytes:
    """The bytes of the page of a revision of a tree; arguments as of :func:`part_page`."""
    path, summary = tree_path(tree), read_json(tree.summary.encode())
    reference = f"{tree.name}@{tree.revision}"
    acts = [link("Couple, load, close loops", f"/trees/{reference}/edit")]
    acts += [link("Simulate", f"/trees/{reference}/motion")] if tree.dof else []
    return document(
        f"{reference} - substructures",
        tag("h1", f"Tree {tree.name}"),
        _first(reference, (tree.dof, model.joints, tree.mass), summary["certificate"]),
        _acts(path, *acts, exported=OF_TREES if tree.dof else ()),
        *notes[0],
        work,
        _split(path, reference, _about_tree(tree, model, summary)),
        tag("h2", "Instances"),
        table(("name", "part", "mounted on"), map(_instance, summary["instances"])),
        *_loads(summary.get("loads", ())),
        *_closures(model),
        *_reduced(model),
        *_given(model, read_json(tree.spec.encode())),
        *_constraints(model),
        *_contacts(model),
        *_sections(
            words.coordinates(model.coordinates, model.joints),
            words.parameters(summary["parameters"]),
            words.operations(summary["operations"], OF_TREE),
            summary["certificate"],
        ),
        *notes[1],
        crumbs=[("trees", "/trees")],
    )


def _about_tree(tree: Tree, model: Model, summary: Mapping[str, Any]) -> Html:
    path, reference = tree_path(tree), f"{tree.name}@{tree.revision}"
    printed = [link(name, f"{path}/{name}?format=text") for name in QUANTITIES if tree.dof]
    base = f"{tree.name}@{tree.based_on}" if tree.based_on else ""
    return facts(
        [
            ("Reference", tag("code", reference)),
            ("Size", size(tree.dof, model.joints)),
            ("Gravity", f"{', '.join(map(_number, summary['gravity']))} (world axes, m/s^2)"),
            ("Changed from", link(base, f"/trees/{base}") if base else None),
            ("Owner", _owner(tree)),
            ("Note", tree.note),
            ("Stored", tree.created[:10]),
            ("Derived", "here, of the document and its parts"),
            ("Digest", tag("code", tree.digest, class_="small")),
            ("As data", link("JSON", path)),
            ("As text", joined(printed, " · ")),
        ]
    )


def _first(reference: str, figures: tuple[int, str, float | None], certificate: Mapping[str, Any]) -> Html:
    """What it is called, its size, mass and proof, in one line."""
    dof, joints, mass = figures
    kilograms = "" if mass is None else f"{mass:.4g} kg"
    proved = tag("a", proof(certificate), href="#certificate")
    return tag("p", joined(filter(None, (tag("code", reference), size(dof, joints), kilograms, proved)), " · "))


def _acts(path: str, *acts: Html, exported: Iterable[str]) -> Html:
    """What can be done with it."""
    links = [link(target, f"{path}/export?target={target}") for target in exported]
    report = link("Report", f"{path}/report?format=mathml"), link("JSON", path)
    menu = tag("details", tag("summary", "Export as code"), tag("p", joined(links, " · "), class_="small"))
    return tag("div", acts, menu if links else None, report, class_="acts")


def _owner(shown: Version | Tree) -> str:
    return shown.owner if shown.is_public else f"{shown.owner}, who alone sees it"


def _loads(loads: Sequence[Mapping[str, Any]]) -> list[Html]:
    """The loads of a tree: what acts between what."""
    pairs = [(x, acts_on(x)) for x in loads]
    rows = [(x["name"], x["type"], " - ".join(places[:-1]), "".join(places[-1:])) for x, places in pairs]
    return [tag("h2", "Loads"), table(("name", "type", "from", "on"), rows)] if rows else []


def _closures(model: Model) -> list[Html]:
    """The loops of a tree and of its parts."""
    rows = [(x.name, x.type, x.start, x.end, len(x.rows)) for x in model.closures]
    return [tag("h2", "Closures"), table(("name", "type", "from", "to", "rows"), rows)] if rows else []


def _reduced(model: Model) -> list[Html]:
    """The instances whose loops are in the formulas."""
    rows = [
        (each["instance"], *(", ".join(each[name]) for name in ("closures", "independent", "dependent")))
        for each in model.reduced
    ]
    names = "instance", "closures", "coordinates", "move with them"
    return [tag("h2", "Loops in the formulas"), table(names, rows)] if rows else []


def _given(model: Model, spec: Mapping[str, Any]) -> list[Html]:
    """The coordinates of a tree that move as is given, and those whose momentum is."""
    motions = [(name, _motion(spec["driven"][name])) for name in model.driven]
    momenta = [(name, _number(spec["ignored"][name])) for name in model.ignored]
    found = [tag("h2", "Given motions"), table(("coordinate", "motion"), motions)] if motions else []
    return found + ([tag("h2", "Given momenta"), table(("coordinate", "momentum"), momenta)] if momenta else [])


def _constraints(model: Model) -> list[Html]:
    """The velocity constraints of a tree."""
    rows = [(x["name"], x["type"], x.get("frame", x.get("expression", ""))) for x in model.velocity_constraints]
    return [tag("h2", "Velocity constraints"), table(("name", "type", "of"), rows)] if rows else []


def _contacts(model: Model) -> list[Html]:
    """The contacts of a tree."""
    rows = [(x["name"], x["point"], x.get("plane", "world"), x.get("when", "")) for x in model.contacts]
    return [tag("h2", "Contacts"), table(("name", "point", "plane", "when"), rows)] if rows else []


def _motion(given: Any) -> str:
    """What moves a coordinate."""
    if isinstance(given, Mapping) and "times" in given:
        return f"through {len(given['times'])} points, {given.get('interpolation', 'smooth')}"
    return "an input, with two derivatives" if isinstance(given, Mapping) and "input" in given else _number(given)


def _number(given: Any) -> str:
    """A number of a document, with its unit if it has one."""
    return f"{given['value']} {given['unit']}" if isinstance(given, Mapping) else str(given)


def _instance(instance: Mapping[str, Any]) -> tuple[Content, ...]:
    reference = instance.get("substructure")
    if reference is None:
        part: Content = f"{instance['definition']['name']} (a definition of its own)"
    else:
        name, _, digest = reference.partition("@")
        part = [link(name, f"/substructures/{reference}"), " ", tag("code", digest[:19], class_="quiet small")]
    return tag("code", instance["name"]), part, tag("code", instance.get("at", "world"))


def _withdrawn(version: Version) -> Html:
    if version.withdrawn_at is None:
        return Html()
    reason = f": {version.withdrawal_reason}" if version.withdrawal_reason else ""
    instead = html("; take ", link(version.successor, f"/substructures/{version.successor}"))
    said = f"Withdrawn on {version.withdrawn_at[:10]}{reason}"
    return tag("p", said, instead if version.successor else None, class_="warn")


def _split(path: str, reference: str, about: Html) -> Html:
    picture = tag("img", src=f"{path}/picture", alt=f"Picture of {reference}", width="320", height="240")
    report = link("Report: structure, derivation and formulas", f"{path}/report?format=mathml")
    return tag("div", tag("div", picture, tag("p", report), class_="picture"), about, class_="split", id="about")


def _sections(coordinates: Html, parameters: Html, operations: Html, certificate: Mapping[str, Any]) -> list[Html]:
    return [
        *(tag("h2", "Certificate", id="certificate"), words.certificate(certificate)),
        *(tag("h2", "Coordinates"), coordinates),
        tag("details", tag("summary", "Parameters as declared"), parameters, words.converted(certificate)),
        tag("details", tag("summary", "Operations"), operations),
    ]
