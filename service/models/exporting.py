"""Exports: quantities of trees and parts as files of a target, one file as it is, several as a zip."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from importlib import import_module
from typing import Any

from service.messages.refusals import unprocessable
from service.models.binding import DEFAULTS, PLACE, Parameters, bound, bound_names
from substructures.errors import InvalidArgument, MissingValue, listed
from substructures.export import (
    TARGETS,
    Exported,
    Interface,
    archive,
    exported_model,
    exported_part,
    files,
    interface_of_model,
    interface_of_part,
)
from substructures.export.contacts import CONTACTS, ContactLaw
from substructures.export.exported import check_name
from substructures.export.robots import MEDIA_TYPE, ROBOTS, file_of_part, file_of_tree
from substructures.export.rounding import read_ranges
from substructures.export.stages import staged
from substructures.expr.program import Program
from substructures.part.part import Part
from substructures.quantities.quantity import FORWARD, VELOCITY_DYNAMICS, askable
from substructures.quantities.sources import Sources
from substructures.tree.document import TreeSpec
from substructures.tree.given.ties import names_of
from substructures.tree.glossary import glossary, part_glossary
from substructures.tree.model import Model

#: prefix of functions where none is given
NAME = "model"
ZIP = "application/zip"
_MEDIA = {
    "json": "application/json",
    "zip": ZIP,
    "fmu": ZIP,
    "tex": "application/x-latex",
    "xhtml": "application/xhtml+xml",
}
#: quantities of a tree and of a part where none are named; those that are not stored are left out
OF_TREES, OF_PARTS = ("metric", "christoffel", "forces"), ("metric", "christoffel")


#: names of robots, which files are called by
ROBOT = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,63}")
#: a tree as a model to be simulated, with its energies and the poses of its frames where nothing is named
FMU, FMU2 = "fmu", "fmu2"
#: what moves ball joints there
CHANGES = "position_rates"
MOVING = (FMU, "simulink")  # targets that need accelerations
#: versions of FMUs, precisions, standards of C; the first ones are the defaults
FMI, PRECISIONS, STANDARDS = ("3.0", "2.0"), ("double", "single"), ("c99", "c89")
DEFAULT_OPTIONS = {"fmi": FMI[0], "precision": PRECISIONS[0], "ranges": "", "stages": False, "standard": STANDARDS[0]}
#: options of some targets by name
OF_TARGETS = {"fmi": ("fmu",), **dict.fromkeys(("precision", "ranges", "stages", "standard"), ("c",))}
OF_FMUS = ("metric", "forces", "kinetic_energy", "potential_energy", "position", "rotation")
#: formulas to be read, which have the independent elements anyway
WRITTEN = ("text", "latex", "mathml")
#: code, in which intermediate values have names
WITH_STEPS = tuple(name for name in TARGETS if name not in (*WRITTEN, FMU, FMU2, "interface", "javascript"))
#: with those that are the mechanism itself as a file, beside the targets that are functions
ALL_TARGETS = (*(name for name in TARGETS if name != FMU2), *ROBOTS)
#: targets for which a tree is asked for with its parts
WITH_PARTS = (*WITH_STEPS, *ROBOTS)
#: a tree document and its parts by instance
Document = Callable[[], tuple[TreeSpec, Mapping[str, Part]]]


@dataclass(frozen=True, slots=True)
class ExportRequest:
    """``together``: also a function with all quantities; ``packed``: independent elements alone; ``fmi``: the version
    of an FMU; of the functions in C ``precision``, the ``ranges`` of arguments that the bound of its rounding is for,
    ``stages``: what depends on parameters alone apart, ``standard``; ``independent``: the coordinates in whose
    velocities motions with constraints are, default chosen."""

    target: str
    quantities: tuple[str, ...] = ()
    name: str = ""
    bind: str = ""
    together: bool = False
    packed: bool = False
    fmi: str = FMI[0]
    precision: str = PRECISIONS[0]
    ranges: str = ""
    stages: bool = False
    standard: str = STANDARDS[0]
    independent: tuple[str, ...] = ()

    @property
    def identity(self) -> tuple[str, ...]:
        """What an ETag depends on beside the content."""
        flags = str(self.together), str(self.packed), str(self.stages)
        texts = self.fmi, self.precision, self.ranges, self.standard
        names = ",".join(self.quantities), ",".join(self.independent)
        return "export", self.target, *names, self.name, self.bind, *flags, *texts

    def require_motion(self, quantities: Sequence[str]) -> None:
        """Raises InvalidArgument (``/independent``) where no function is a motion in independent velocities."""
        if self.independent and VELOCITY_DYNAMICS not in quantities:
            message = f"'independent' is of the quantity '{VELOCITY_DYNAMICS}' and of FMUs with velocity constraints"
            raise InvalidArgument.at("/independent", "not-of-quantity", message)


@dataclass(frozen=True, slots=True)
class Package:
    """A file: its name, media type and content."""

    name: str
    media: str
    data: bytes


def prefix(wanted: str, called: str) -> str:
    """The prefix of functions: what is wanted, or the name of the tree or part where it can be one."""
    if wanted:
        return wanted
    try:
        return check_name(called.replace("-", "_"))
    except InvalidArgument:
        return NAME


@contextmanager
def _values_are_bound() -> Iterator[None]:
    """Raises Refused 422 for a parameter without a value, which exports take by ``bind``."""
    try:
        yield
    except MissingValue as error:
        message = f"'{error.name}' has no value: give one with bind={error.name}:value, or a default in its definition"
        raise unprocessable("missing-value", message, PLACE) from None


@_values_are_bound()
def tree_package(
    sources: Sources,
    called: str,
    reference: str,
    digest: str,
    request: ExportRequest,
    limit: int,
    document: Document,
    others: Mapping[str, Callable[[], Program]],
) -> Package:
    """A tree for a target. Raises InvalidArgument, InvalidDocument, TooLarge, Refused 422 for bad and missing
    bindings. ``document``: what the tree is made of, where the target asks for it; ``others``: what makes quantities
    that follow from it by an analysis.
    """
    _check(request)
    parameters = sources.model.parameters
    if request.target in ROBOTS:
        name, (spec, parts), bind = _robot_name(request, called), document(), _all_numbers(parameters, request)
        return _robot(request, name, file_of_tree(request.target, spec, parts, name, reference, digest, bind))
    known = askable(sources.model.program.outputs)
    chosen = OF_FMUS if request.target == FMU else OF_TREES
    names = request.quantities or tuple(name for name in chosen if name in known)
    names = tuple(dict.fromkeys((*_motion(sources.model, request), *names)))
    laws, more = _contacts(sources.model, request)
    if laws:
        names, others = (CONTACTS, *names), {**others, **more}
    request.require_motion(names)
    interface = _left(interface_of_model(sources.model, reference, digest), request)

    def numbers(program: Program) -> Program:
        """The program with numbers in place of parameters."""
        return bound(program, parameters, request.bind)

    words = glossary(*document(), model=sources.model.program) if request.target in WITH_STEPS else None
    name, flags = prefix(request.name, called), (request.together, request.packed)
    exported = exported_model(sources, interface, names, name, numbers, *flags, words, others)
    return _package(replace(exported, contacts=laws), request, limit)


def _motion(model: Model, request: ExportRequest) -> tuple[str, ...]:
    """The quantities of the motion, for targets that move. Raises InvalidArgument (``/target``)."""
    if request.target != FMU and (request.target in MOVING or FORWARD in request.quantities):
        _require_free(model, request)
    if request.target not in MOVING:
        return ()
    # with velocity constraints the motion is one in independent velocities
    motion = VELOCITY_DYNAMICS if model.velocity_constraints else FORWARD
    return (motion, CHANGES) if model.balls else (motion,)


def _require_free(model: Model, request: ExportRequest) -> None:
    """Raises InvalidArgument where accelerations would be without velocity constraints or contacts."""
    moves = request.target in MOVING
    pointer, what = ("/target", f"target={request.target}") if moves else ("/quantities", f"'{FORWARD}'")
    fmu = f"target={FMU}{', which Simulink reads, too' if moves else ''}"
    function = "" if moves else f"the quantity '{VELOCITY_DYNAMICS}', or "
    for field, instead in {"velocity_constraints": function, "contacts": ""}.items():
        if ties := getattr(model, field):
            kind, names = field.replace("_", " "), listed(f"'{name}'" for name in names_of(ties))
            message = f"{what} does not take {kind} into account ({names}): take {instead}{fmu}"
            raise InvalidArgument.at(pointer, f"has-{kind.replace(' ', '-')}", message)


def _contacts(
    model: Model, request: ExportRequest
) -> tuple[tuple[ContactLaw, ...], Mapping[str, Callable[[], Program]]]:
    """Of an FMU the contacts of the tree, and what makes the programs that they need."""
    if request.target != FMU or not model.contacts:
        return (), {}
    contacts = import_module("substructures.analysis.motion.problems.contacts").contacts_of(model)
    made = import_module("substructures.analysis.motion.contacts.exporting")
    return contacts, made.contact_programs(model, CONTACTS)


@_values_are_bound()
def part_package(part: Part, reference: str, digest: str, request: ExportRequest, limit: int) -> Package:
    """A part for a target, as it stands alone. Raises as :func:`tree_package`."""
    _check(request)
    if request.target in ROBOTS:
        name, bind = _robot_name(request, part.name), _all_numbers(part.parameters, request)
        return _robot(request, name, file_of_part(request.target, part, name, reference, digest, bind))
    names = request.quantities or tuple(name for name in OF_PARTS if name in part.program.outputs)
    request.require_motion(())
    interface = _left(interface_of_part(part, reference, digest), request)

    def numbers(program: Program) -> Program:
        """The program with numbers in place of parameters."""
        return bound(program, part.parameters, request.bind)

    name, flags = prefix(request.name, part.name), (request.together, request.packed)
    words = part_glossary(part) if request.target in WITH_STEPS else None
    exported = exported_part(part, interface, names, name, numbers, *flags, words)
    return _package(exported, request, limit)


def _check(request: ExportRequest) -> None:
    given = {name: getattr(request, name) for name in ("quantities", "together", "packed", *OF_TARGETS)}
    field = misplaced(request.target, given)
    if field is not None:
        raise InvalidArgument.at(f"/{field}", "not-of-target", f"target={request.target} does not take '{field}'")
    if request.ranges and request.precision != "single":
        message = "'ranges' is what the bound of single precision is for: take it with precision=single"
        raise InvalidArgument.at("/ranges", "not-of-target", message)
    if request.standard == "c89" and request.precision == "single":
        message = "C89 has no functions of single precision, such as sinf: take precision=double, or standard=c99"
        raise InvalidArgument.at("/standard", "not-of-target", message)


def _robot_name(request: ExportRequest, called: str) -> str:
    """The name of the robot and of its file. Raises InvalidArgument."""
    if request.name and not ROBOT.fullmatch(request.name):
        message = f"{request.name[:40]!r} names no robot: at most 64 letters, digits, _, - and ., no sign first"
        raise InvalidArgument.at("/name", "bad-name", message)
    return prefix(request.name, called)


def _all_numbers(parameters: Parameters, request: ExportRequest) -> Callable[[Program], Program]:
    """Puts numbers in place of all parameters: as asked for, else defaults."""
    return lambda program: bound(program, parameters, f"{request.bind},{DEFAULTS}")


def _robot(request: ExportRequest, name: str, text: bytes) -> Package:
    return Package(f"{name}.{ROBOTS[request.target].suffix}", f"{MEDIA_TYPE}; charset=utf-8", text)


def _left(interface: Interface, request: ExportRequest) -> Interface:
    return interface.bound(bound_names(interface.vectors["p"].with_default, request.bind))


def _package(exported: Exported, request: ExportRequest, limit: int) -> Package:
    target = FMU2 if request.target == FMU and request.fmi == "2.0" else request.target
    exported = staged(exported) if request.stages else exported
    ranges = read_ranges(request.ranges, exported.interface)
    kind = replace(exported, precision=request.precision, ranges=ranges, standard=request.standard)
    made = files(kind, target, limit)
    if len(made) > 1:
        return Package(f"{exported.name}_{request.target}.zip", ZIP, archive(made))
    ((name, data),) = made.items()
    return Package(name, _MEDIA.get(name.rpartition(".")[2], "text/plain; charset=utf-8"), data)


def read_item(item: Mapping[str, Any]) -> ExportRequest:
    """The export that an item of a job asks for; its fields are checked already."""
    given = tuple(item["quantities"])
    more = {name: item[name] for name in ("packed", *OF_TARGETS) if name in item}
    more["independent"] = tuple(item.get("independent", ()))
    return ExportRequest(item["target"], given, item["name"], item["bind"], item["together"], **more)


def misplaced(target: str, given: Mapping[str, Any]) -> str | None:
    """The first field, of those that differ from their defaults, that a target does not take."""
    without = {**dict.fromkeys(ROBOTS, ("quantities", "together", "packed")), **dict.fromkeys(WRITTEN, ("packed",))}
    fields = [*without.get(target, ()), *(name for name, targets in OF_TARGETS.items() if target not in targets)]
    return next((name for name in fields if given[name] and given[name] != DEFAULT_OPTIONS.get(name)), None)
