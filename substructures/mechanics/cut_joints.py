"""The rows of joints that are cut, where loops are closed: what each type demands (notation.md, section 10)."""

from __future__ import annotations

PLACE = ("x", "y", "z")
#: the rows of every type of closure; the axis of a joint is the third one
ROWS: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("pin", "revolute"), (*PLACE, "rx", "ry")),
    **dict.fromkeys(("slider", "prismatic"), ("x", "y", "rx", "ry", "rz")),
    **dict.fromkeys(("ball", "spherical"), PLACE),
    **dict.fromkeys(("weld", "fixed"), (*PLACE, "rx", "ry", "rz")),
    "cylindrical": ("x", "y", "rx", "ry"),
    "universal": (*PLACE, "cross"),
    "planar": ("z", "rx", "ry"),
    "rod": ("length",),
}
#: rows of directions: (axis j of B, axis i of A, sign) with residual sign * m_j . e_i
TURNS = {"rx": (2, 1, -1), "ry": (2, 0, 1), "rz": (0, 1, 1), "cross": (1, 2, 1)}
#: the axis that such a row makes parallel
ALIGNED = {"rx": 2, "ry": 2, "rz": 0}
