"""Everything in a store proven by deriving it anew, and what is wrong put right: the command ``substructures verify``.

A part is right when what this software derives of its definition is what is stored, by the digest of its program, and
figure by figure; a tree when coupling its parts gives what is stored. Nothing is sampled. What another version of the
software derived, or a server elsewhere, is told as such: it may be right, and this server does not vouch for it. Until
this software has looked at all of the store (:mod:`service.operations.renewing`), what has the seal of this server and
is of another version is no fault: it is not renewed yet, and not verified either.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from service.content.derivation import software
from service.content.integrity import NOT_SEALED, checked
from service.content.summaries import PartContent
from service.database.connections import Connection, Database
from service.messages.refusals import Refused
from service.messages.viewer import ANYBODY
from service.operations.renewal import part_anew, read_tree, renew_part, renew_tree, tree_anew
from service.queries import catalogue, content, idempotency, renewals, trees, versions
from service.queries.content import StoredPart
from service.queries.jobs import results
from service.queries.searching.formulas import FormulaRow, list_formulas, read_index
from service.queries.trees import Tree
from substructures.documents import read_json
from substructures.errors import SubstructuresError

#: columns of a part that say when and by whom, not what; its certificate is compared but for the time that it took
APART = ("created", "definition", "seal", "software", "recipe", "certificate", "outputs", "formulas", "index_digest")
FIGURES = ("program", "dof", "joints", "mass")


@dataclass(frozen=True, slots=True)
class Finding:
    """What was verified, e.g. ``substructure arm@2``.

    ``fault``: what is wrong, empty where nothing is; ``outcome``: what came of deriving it anew, or
    :data:`NOT_RENEWED`.
    """

    what: str
    digest: str
    fault: str = ""
    outcome: str = ""

    @property
    def is_sound(self) -> bool:
        """Whether it can be used now."""
        return not self.fault or self.outcome == MENDED

    @property
    def is_left(self) -> bool:
        """Whether it was not compared, as this version has not derived it yet."""
        return self.outcome == NOT_RENEWED


MENDED = "derived anew"
NOT_RENEWED = "not renewed yet, nor verified: another version derived it; a server or --repair derives it anew"


def verify_all(database: Database, repair: bool = False) -> Iterator[Finding]:
    """Every part with its number, every revision of every tree, every result of a job, which is compared with digest
    and seal, and every answer kept under an idempotency key. With ``repair`` what is wrong of parts and trees is
    derived anew, if its own document is sound; results that are wrong are computed anew when their jobs are submitted.
    """
    with database.read() as connection:
        contents = catalogue.all_contents(connection)
        revisions, kept = trees.all_revisions(connection, ANYBODY), results.all_keys(connection)
    for digest, name in contents.items():
        what = f"substructure {name}" if name else "definition of a tree"
        yield _verified(database, what, digest, _check_part, partial(renew_part, database) if repair else None)
    for tree, number in revisions:
        name = f"{tree}@{number}"
        yield _verified(database, f"tree {name}", name, _check_tree, partial(_renew_tree, database) if repair else None)
    for key in kept:
        if (found := _looked_at(database, f"result {key}", key, _check_result)).fault:
            yield found
            if repair:
                with database.write() as connection:
                    results.unseal(connection, key)
    yield from _wrong_answers(database)


def _wrong_answers(database: Database) -> Iterator[Finding]:
    with database.read() as connection:
        wrong = list(idempotency.wrong_answers(connection))
    for principal, key, fingerprint in wrong:
        what = f"answer under the Idempotency-Key '{key}' of '{principal}'"
        yield Finding(what, fingerprint, f"{NOT_SEALED}, and is not given again")


def _check_result(connection: Connection, key: str) -> bool:
    results.get_summary(connection, key)
    for file in results.list_files(connection, [key]).get(key, ()):
        results.get_file(connection, key, file.name)
    return True


def _renew_tree(database: Database, reference: str) -> None:
    renew_tree(database, *_parted(reference))


def _parted(reference: str) -> tuple[str, int]:
    name, _, number = reference.partition("@")
    return name, int(number)


def _verified(
    database: Database,
    what: str,
    key: str,
    check: Callable[[Connection, str], bool],
    mend: Callable[[str], object] | None,
) -> Finding:
    found = _looked_at(database, what, key, check)
    if mend is None or not (found.fault or found.is_left):
        return found
    try:
        mend(key)
    except Exception as error:  # whatever it is, the next one is looked at, too
        fault = found.fault or "another version of the software derived it"
        return replace(found, fault=fault, outcome=f"cannot be derived anew: {told(error)}")
    again = _looked_at(database, what, key, check)
    if again.fault or again.is_left:
        fault, outcome = found.fault or again.fault, f"derived anew, and still wrong: {again.fault or again.outcome}"
        return replace(found, fault=fault or NOT_RENEWED, outcome=outcome)
    return replace(found, outcome=MENDED)


def _looked_at(database: Database, what: str, key: str, check: Callable[[Connection, str], bool]) -> Finding:
    """What a check found, which says whether what is stored was compared."""
    try:
        with database.read() as connection:
            return Finding(what, key, outcome="" if check(connection, key) else NOT_RENEWED)
    except Exception as error:  # damage may show as anything
        return Finding(what, key, told(error))


def told(error: Exception) -> str:
    """What went wrong, in words."""
    is_known = isinstance(error, (Refused, SubstructuresError, ValueError))
    return str(error) if is_known and str(error) else f"{type(error).__name__}: {error}"


def _check_part(connection: Connection, digest: str) -> bool:
    """Raises what is wrong with a part, its columns and the index of its formulas; False: it is not renewed yet."""
    stored = content.get_part(connection, digest)
    if stored is None:
        raise ValueError("its definition is gone from the store; submit it again")
    name, its_own = catalogue.name_of(connection, digest), read_json(stored.definition)["name"]
    if name not in (None, its_own):
        raise ValueError(f"it is called '{name}' in the store, and '{its_own}' in its document")
    made = part_anew(connection, digest)
    if is_left := _is_left(connection, stored):
        list_formulas(connection, digest)
    else:
        _require_none(_wrong_of_part(content.get_row(connection, digest), made))
        _require_own(stored)
    if wrong_number := versions.wrong_number(connection, digest, renewals.is_ours(connection)):
        raise ValueError(wrong_number)
    if wrong := catalogue.wrong_latest(connection, digest):
        raise ValueError(f"what searches find of it is not what is stored of it: {', '.join(wrong)}")
    return not is_left


def _is_left(connection: Connection, stored: StoredPart | Tree) -> bool:
    """Whether it is as this server stored it with another version, and this one may not have looked at it yet."""
    return stored.is_derived and stored.software != software() and not renewals.is_done(connection)


def _wrong_of_part(row: Mapping[str, Any], made: PartContent) -> list[str]:
    """What of a part differs from what was derived anew."""
    wrong = [name for name in made.row if name not in APART and row[name] != made.row[name]]
    if _lasting(read_json(row["certificate"].encode())) != _lasting(read_json(made.row["certificate"].encode())):
        wrong.append("certificate")
    if read_index(row["outputs"], row["formulas"]) != [FormulaRow(*values) for values in made.formulas]:
        wrong.append("index of formulas")
    return wrong


def _lasting(certificate: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in certificate.items() if name != "seconds"}


def _require_none(wrong: list[str]) -> None:
    if wrong:
        raise ValueError(f"what is stored is not what this version derives of its document: {', '.join(wrong)}")


def _require_own(stored: StoredPart | Tree) -> None:
    if not stored.is_derived:
        raise ValueError("it was changed in the store, or this server has not derived it")
    if stored.software != software():
        raise ValueError("it was derived by another version of the software")


def _check_tree(connection: Connection, reference: str) -> bool:
    """Raises what is wrong with a tree, its program and its summary; False: it is not renewed yet."""
    name, number = _parted(reference)
    tree, _ = read_tree(connection, name, number)
    checked("its summary", tree.summary_digest, tree.summary.encode())
    if content.get_program(connection, tree.program) is None:
        raise ValueError(f"its program {tree.program} is gone from the store")
    found = tree_anew(connection, name, number)
    if not (is_left := _is_left(connection, tree)):
        wrong = [each for each in FIGURES if getattr(tree, each) != getattr(found.tree, each)]
        _require_none(wrong + _different(read_json(tree.summary.encode()), read_json(found.tree.summary.encode())))
        _require_own(tree)
    if trees.part_digests(connection, name, number) != dict(found.parts):
        raise ValueError("the parts that it is found by are not those of its document")
    if wrong := trees.wrong_latest(connection, tree):
        raise ValueError(f"what searches find of it is not what is stored of it: {', '.join(wrong)}")
    return not is_left


def _different(stored: Mapping[str, Any], made: Mapping[str, Any]) -> list[str]:
    """The members of a summary that differ."""
    before, now = ({**each, "certificate": _lasting(each.get("certificate", {}))} for each in (stored, made))
    return [f"summary ({name})" for name in sorted(before.keys() | now.keys()) if before.get(name) != now.get(name)]
