"""Everything in a store verified, and what is wrong derived anew: the command ``substructures verify``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from service.database.connections import Connection, Database
from service.database.packed import pack
from service.integrity import checked, digest_of
from service.operations.catalogue import mend_part
from service.queries import catalogue, content, trees
from service.queries.formulas import FormulaRow, list_formulas
from service.queries.trees import Tree
from service.refusals import Refused
from service.summaries import part_content, tree_summary
from service.viewer import ANYBODY
from substructures.documents import read_json
from substructures.errors import SubstructuresError
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.part import Part, derive, recheck
from substructures.tree.document import TreeSpec
from substructures.tree.model import couple
from substructures.tree.plausibility import Plausibility
from substructures.tree.recheck import recheck_tree

#: what is stored of a part, and follows from its definition and program
FOLLOWS = ("program", "dof", "joints", "coordinates", "bodies", "ports", "parameters", "operations")


@dataclass(frozen=True, slots=True)
class Finding:
    """What was verified, e.g. ``substructure arm@2``.

    ``fault``: what is wrong, empty where nothing is; ``outcome``: what came of deriving it anew.
    """

    what: str
    digest: str
    fault: str = ""
    outcome: str = ""

    @property
    def is_sound(self) -> bool:
        """Whether it can be used now."""
        return not self.fault or self.outcome == MENDED


MENDED = "derived anew"


def verify_all(database: Database, repair: bool = False) -> Iterator[Finding]:
    """Every part, then every revision of every tree. With ``repair`` what is wrong is derived anew, if its own document
    is sound."""
    with database.read() as connection:
        contents = catalogue.all_contents(connection)
        revisions = trees.all_revisions(connection, ANYBODY)
    for digest, name in contents.items():
        what = f"substructure {name}" if name else "definition of a tree"
        yield _verified(database, what, digest, _check_part, _mend_part if repair else None)
    for tree, number in revisions:
        yield _verified(
            database, f"tree {tree}@{number}", f"{tree}@{number}", _check_tree, _mend_tree if repair else None
        )


def _verified(
    database: Database,
    what: str,
    key: str,
    check: Callable[[Connection, str], object],
    mend: Callable[[Connection, str], object] | None,
) -> Finding:
    fault = _fault(database, key, check)
    if not fault or mend is None:
        return Finding(what, key, fault)
    try:
        with database.write() as connection:
            mend(connection, key)
    except Exception as error:  # whatever it is, the next one is looked at, too
        return Finding(what, key, fault, f"cannot be derived anew: {told(error)}")
    again = _fault(database, key, check)
    return Finding(what, key, fault, (again and f"derived anew, and still wrong: {again}") or MENDED)


def _fault(database: Database, key: str, check: Callable[[Connection, str], object]) -> str:
    try:
        with database.read() as connection:
            check(connection, key)
    except Exception as error:  # damage may show as anything
        return told(error)
    return ""


def told(error: Exception) -> str:
    """What went wrong, in words."""
    is_known = isinstance(error, (Refused, SubstructuresError, ValueError))
    return str(error) if is_known and str(error) else f"{type(error).__name__}: {error}"


def _check_part(connection: Connection, digest: str) -> None:
    """Raises what is wrong with a part, its columns and the index of its formulas."""
    stored = content.get_part(connection, digest)
    if stored is None:
        raise ValueError("its definition is gone from the store; submit it again")
    part = Part.load(Definition.stored(read_json(stored.definition)), stored.program, read_json(stored.certificate))
    recheck(part)
    expected, row = part_content(part), content.get_row(connection, digest)
    wrong = [name for name in FOLLOWS if row[name] != expected.row[name]]
    if wrong:
        raise ValueError(f"what is stored beside its formulas is wrong: {', '.join(wrong)}")
    if list_formulas(connection, digest) != [FormulaRow(*values) for values in expected.formulas]:
        raise ValueError("the index of its formulas is wrong")


def _mend_part(connection: Connection, digest: str) -> None:
    definition = content.get_definition(connection, digest)
    if definition is None:
        raise ValueError("its definition is gone from the store; submit it again")
    mend_part(connection, part_content(derive(Definition.stored(read_json(definition)))))


def read_tree(connection: Connection, reference: str) -> tuple[Tree, TreeSpec]:
    """A revision whose document is sound."""
    name, _, number = reference.partition("@")
    tree = trees.get_damaged(connection, name, int(number))
    if tree is None:
        raise ValueError("it is gone from the store")
    checked("its document", tree.digest, tree.spec.encode())
    return tree, TreeSpec.stored(read_json(tree.spec.encode()))


def stored_definitions(connection: Connection, spec: TreeSpec) -> dict[str, Definition]:
    """What every instance is. Raises ValueError for what is gone."""
    found = {}
    for instance in spec.instances:
        digest = (instance.substructure or "").partition("@")[2]
        text = None if instance.definition is not None else content.get_definition(connection, digest)
        if text is None and instance.definition is None:
            raise ValueError(f"the definition {digest} of '{instance.name}' is gone from the store")
        found[instance.name] = instance.definition or Definition.stored(read_json(text or b""))
    return found


def _check_tree(connection: Connection, reference: str) -> None:
    """Raises what is wrong with a tree, its program and its summary."""
    tree, spec = read_tree(connection, reference)
    checked("its summary", tree.summary_digest, tree.summary.encode())
    data = content.get_program(connection, tree.program)
    if data is None:
        raise ValueError(f"its program {tree.program} is gone from the store")
    summary: dict[str, Any] = read_json(tree.summary.encode())
    recheck_tree(spec, stored_definitions(connection, spec), summary, Program.from_bytes(data))
    given = read_json(spec.canonical())
    if (summary["gravity"], summary["instances"]) != (given.get("gravity", [0, 0, 0]), given.get("instances", [])):
        raise ValueError("gravity or instances in its summary are not those of its document")


def _mend_tree(connection: Connection, reference: str) -> None:
    tree, spec = read_tree(connection, reference)
    parts = {}
    for name, definition in stored_definitions(connection, spec).items():
        stored = content.get_part(connection, definition.digest)
        parts[name] = derive(definition) if stored is None else Part.load(definition, stored.program, {})
    model = couple(spec, parts)
    content.replace_program(connection, model.program.digest, pack(model.program), len(model.program))
    summary = tree_summary(spec, model)
    mass = Plausibility(spec, {name: part.definition for name, part in parts.items()}).mass
    figures: dict[str, Any] = {"dof": model.dof, "joints": model.joints, "mass": mass}
    coupled = replace(tree, program=model.program.digest, summary=summary.decode(), **figures)
    trees.replace_model(connection, replace(coupled, summary_digest=digest_of(summary)))
