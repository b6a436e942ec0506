"""What a joint of a stage leaves free: degrees of freedom with the limits and drives of each.

A PhysicsJoint moves along and about the axes X, Y, Z of its frame in body0 (``transX``, ``rotX``, ...), but where a
PhysicsLimitAPI locks one, low > high. What it slides comes before the one axis that it turns about; two of these are
refused, as the format does not say which one carries the other, three are a ball.
Source: https://openusd.org/release/api/class_usd_physics_limit_a_p_i.html
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from substructures.interchange.report import Report, refuse
from substructures.interchange.usd.scene import Prim, given, place_of
from substructures.interchange.usd.stage import package

Kind = Literal["fixed", "chain", "spherical", "free"]
_ONE: dict[str, Literal["revolute", "prismatic"]] = {
    "PhysicsRevoluteJoint": "revolute",
    "PhysicsPrismaticJoint": "prismatic",
}
_NONE: dict[str, Kind] = {"PhysicsFixedJoint": "fixed", "PhysicsSphericalJoint": "spherical"}
GENERIC = "PhysicsJoint"
KINDS = (*_ONE, *_NONE, GENERIC)
_AXES = "XYZ"


@dataclass(frozen=True)
class Degree:
    """``limits``: the attributes that have them, if any; ``drive``: the instance of PhysicsDriveAPI; ``suffix``: of
    its name, where there are several.
    """

    type: Literal["revolute", "prismatic"]
    axis: int
    limits: tuple[str, str] | None
    drive: str
    suffix: str = ""


def degrees_of(prim: Prim, report: Report) -> tuple[Kind, tuple[Degree, ...]]:
    """Of a joint of one of KINDS; those of a ball, and of a joint that leaves all free, are not listed.

    Raises InvalidDocument for axes that are not there, and two rotations.
    """
    name = str(prim.GetTypeName())
    if name in _NONE:
        if _NONE[name] == "spherical":
            _tell_of_ranges(prim, report)
        return _NONE[name], ()
    if name in _ONE:
        axis = given(prim, "physics:axis", "str")
        if axis not in tuple(_AXES):
            raise refuse(place_of(prim), "bad-value", f"physics:axis is '{axis[:20]}', and none of {', '.join(_AXES)}")
        drive = "angular" if _ONE[name] == "revolute" else "linear"
        _tell_of_ranges(prim, report, drive)
        limits = ("physics:lowerLimit", "physics:upperLimit")
        return "chain", (Degree(_ONE[name], _AXES.index(axis), limits, drive),)
    slides, turns = ([x for x in _AXES if not _is_locked(prim, f"{way}{x}")] for way in ("trans", "rot"))
    if prim.HasAPI(package("UsdPhysics").LimitAPI, "distance"):
        report.lost(place_of(prim), "limits of a distance are left out: add a closure of the type 'rod' to a tree")
    if len(turns) == 3 and len(slides) in (0, 3):
        _tell_of_ranges(prim, report)
        return "free" if slides else "spherical", ()
    if len(turns) > 1:
        message = (
            f"it slides along {' '.join(slides) or 'nothing'} and turns about {' '.join(turns)}, and the format does "
            "not say which axis carries the other: write joints of one degree of freedom one after the other, with "
            "bodies without mass between them"
        )
        raise refuse(place_of(prim), "not-read", message)
    names = [*(f"trans{x}" for x in slides), *(f"rot{x}" for x in turns)]
    return "chain" if names else "fixed", tuple(_degree(prim, name, len(names) > 1) for name in names)


def _degree(prim: Prim, name: str, is_one_of_several: bool) -> Degree:
    limits = tuple(f"limit:{name}:physics:{end}" for end in ("low", "high"))
    has_limits = prim.HasAPI(package("UsdPhysics").LimitAPI, name)
    way: Literal["revolute", "prismatic"] = "revolute" if name.startswith("rot") else "prismatic"
    suffix = f"_{name}" if is_one_of_several else ""
    return Degree(way, _AXES.index(name[-1]), (limits[0], limits[1]) if has_limits else None, name, suffix)


def _is_locked(prim: Prim, name: str) -> bool:
    """Raises InvalidDocument for an axis that is held elsewhere than at zero."""
    if not prim.HasAPI(package("UsdPhysics").LimitAPI, name):
        return False
    low, high = (given(prim, f"limit:{name}:physics:{end}", "float") for end in ("low", "high"))
    if low == high != 0:
        message = f"{name} is held at {low:g}: place the frames of the joint there, and lock it by low > high"
        raise refuse(place_of(prim), "not-read", message)
    return bool(low >= high)


def _tell_of_ranges(prim: Prim, report: Report, own: str = "") -> None:
    """Of what turns freely, or of axes beside its ``own``."""
    which = f"other than '{own}' of a joint about one axis" if own else "of a joint that turns about all axes"
    for what, api in (("ranges", "PhysicsLimitAPI:"), ("drives", "PhysicsDriveAPI:")):
        if any(each.startswith(api) and each != f"{api}{own}" for each in prim.GetAppliedSchemas()):
            report.lost(place_of(prim), f"the {what} {which} are left out: add loads that act as they do")
