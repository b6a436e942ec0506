"""Gaps of contacts and their rows as formulas.

Of a point with the origin c and a plane with the origin p, the axes e_1, e_2, e_3 (the normal) and the angular velocity
omega, r = c - p:

    g_N = e_3 . r,    g_N' = e_3 . (c' - p' - omega x r),    v_T = e_1, e_2 . (c' - p' - omega x r)

Each of the three velocities is a row G_ka q'^a + G_k0, and the acceleration G_ka q''^a + c_k with what of its
derivative by time has no q''. G_k0 is the velocity that given motions (``driven``) alone make.
(F. Pfeiffer and C. Glocker, Multibody Dynamics with Unilateral Contacts, 1996, chapter 4.)
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from substructures.analysis.arguments import require_read
from substructures.analysis.equations.expressions import vector
from substructures.analysis.motion.problems.contacts import WORLD, Contact, contacts_of
from substructures.errors import InvalidDocument, among
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Program, array
from substructures.mechanics.linear3 import Vector, add, apply, cross, sub, transpose
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.model import KINEMATICS, Model

GAP, ROWS, RATE, BIAS, WHEN = "gap", "rows", "rate", "bias", "when"
#: velocities of frames where the coordinates rest, of trees with given motions
DRIVEN = ("U_0", "Omega_0")
#: one comparison
_COMPARED = re.compile(r"([^<>=]+)([<>])=?([^<>=]+)")


def contact_rows(model: Model, contacts: Sequence[Contact]) -> Program:
    """Outputs of k contacts: ``gap`` (k,) [m], ``rows`` (k, 3, n) along e_3, e_1 and e_2, ``rate`` (k, 3) = G_0,
    ``bias`` (k, 3) = G' q' + G_0', and ``when`` (k,), positive where a contact acts.

    Raises InvalidArgument (``/contacts/i/point``, ...), with ``immovable`` where no coordinate moves it to its plane.
    """
    f = Workspace(model)
    scope, kinematics = f.scope, f.outputs([*KINEMATICS, *DRIVEN[: 2 * bool(model.driven)]])  # symbols come first
    scope.declare("t", "time", "s")
    gaps, rows, whens = list[Expr](), list[list[Expr]](), list[Expr]()
    for i, contact in enumerate(contacts):
        pointer = f"/contacts/{i}"
        if contact.name in [other.name for other in contacts[:i]]:
            scope.fault(f"{pointer}/name", "duplicate-name", f"a second contact '{contact.name}'")
        for name in ("point", "plane"):
            frame = getattr(contact, name)
            if frame not in model.frames and (name, frame) != ("plane", WORLD):
                known = among(frame, model.frames)
                scope.fault(f"{pointer}/{name}", "unknown-frame", f"unknown frame '{frame[:80]}'{known}")
                break
        else:
            gap, three = _rows(f, kinematics, contact)
            gaps.append(gap)
            rows += three
            if all(x.is_zero for x in three[0][: f.n]):
                message = f"no coordinate moves '{contact.point}' towards '{contact.plane}': leave the contact out"
                scope.fault(pointer, "immovable", message)
        whens.append(_when(f, contact.when, f"{pointer}/when"))
    require_read(scope)
    outputs = {
        GAP: vector(gaps),
        ROWS: array((len(gaps), 3, f.n), lambda k, r, a: rows[3 * k + r][a]),
        RATE: array((len(gaps), 3), lambda k, r: rows[3 * k + r][f.n]),
        BIAS: array((len(gaps), 3), lambda k, r: _along(f, rows[3 * k + r])),
        WHEN: vector(whens),
    }
    return f.program(outputs)


def check_contacts(model: Model) -> None:
    """Raises InvalidInput (``/contacts``, ``/contacts/i/...``) for contacts of a tree that are none."""
    if model.contacts:
        for field in ("closures", "velocity_constraints"):
            if getattr(model, field):
                message = f"'contacts' and '{field}' do not go together: leave one of them out"
                raise InvalidDocument.at("/contacts", "not-supported", message)
        contact_rows(model, contacts_of(model))


def _rows(f: Workspace, kinematics: Mapping[str, Entries], contact: Contact) -> tuple[Expr, list[list[Expr]]]:
    """The gap, and along e_3, e_1, e_2 the velocities of unit rates, and last that of given motions."""
    zero, frames = f.graph.zero, f.model.frames

    def vector_of(name: str, k: int, *index: int) -> Vector:
        """Three elements of a kinematic output."""
        x, y, z = (kinematics[name].get((k, *index, i), zero) for i in range(3))
        return x, y, z

    def rotation(k: int) -> tuple[Vector, Vector, Vector]:
        """To the axes of the world."""
        return vector_of("rotation", k, 0), vector_of("rotation", k, 1), vector_of("rotation", k, 2)

    def twists(k: int) -> list[tuple[Vector, Vector]]:
        """U and Omega of a frame for each coordinate, and for what is given."""
        free = [(vector_of("U", k, a), vector_of("Omega", k, a)) for a in range(f.n)]
        given = [vector_of(name, k) if f.model.driven else (zero, zero, zero) for name in DRIVEN]
        return [*free, (given[0], given[1])]

    k = frames.index(contact.point)
    r, moved = vector_of("position", k), [apply(rotation(k), u) for u, _ in twists(k)]
    if contact.plane != WORLD:
        p = frames.index(contact.plane)
        axes, r = transpose(rotation(p)), sub(r, vector_of("position", p))
        local = apply(axes, r)
        # in the axes of the plane: R_p^T c'_a - U_a - Omega_a x R_p^T r
        moved = [sub(apply(axes, u), add(v, cross(w, local))) for u, (v, w) in zip(moved, twists(p), strict=True)]
        r = local
    lift = f.graph.lift
    across = {"point_plane": (0, 1), "point_line": (0,)}[contact.type]
    rows = [[lift(column[i]) for column in moved] for i in (2, *across)]
    return lift(r[2]), rows + [[zero] * (f.n + 1)] * (3 - len(rows))


def _along(f: Workspace, row: Sequence[Expr]) -> Expr:
    """(d_b G_a) q'^a q'^b, and what else changes with the time; of ball joints along p' = R v, Q' = 1/2 Q (0, w)."""
    rates = [f.velocity_symbol(a) for a in range(f.n)]
    changes = f.moved(rates) | (f.time if f.model.driven else {})
    velocity = f.graph.sum(x * v for x, v in zip(row, [*rates, f.graph.one], strict=True))
    (slopes,) = gradient([velocity], list(changes))
    return f.graph.sum(x * v for x, v in zip(slopes, changes.values(), strict=True))


def _when(f: Workspace, text: str | None, pointer: str) -> Expr:
    """Positive where a comparison holds."""
    if text is None:
        return f.graph.one
    found = _COMPARED.fullmatch(text)
    if found is None:
        message = f"'{text[:80]}' is not one comparison, such as 'leg.q1 > 0'"
        f.scope.fault(pointer, "not-a-comparison", message)
        return f.graph.one
    left, right = (f.scope.read(side.strip(), pointer) for side in found.group(1, 3))
    return f.graph.lift(left - right if found.group(2) == ">" else right - left)
