"""A USD file as a robot: rigid bodies with masses on the tree of their joints, and joints that close loops.

The tree begins at what stands still, then at the roots of articulations; joints with ``excludeFromArticulation`` are
taken last. Those that are left close loops.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from heapq import heappop, heappush

import numpy as np

from substructures.interchange.merge import judge, together, vector
from substructures.interchange.numbers import ORIGIN, ZERO, Number, Triple, decimal_of, is_zero, value
from substructures.interchange.report import Place, Report, refuse
from substructures.interchange.robot import Inertial, Link, Motion, Robot, in_order
from substructures.interchange.rotations import to_rpy, turned_inertia
from substructures.interchange.usd.joints import Joint, joints_of, names_of
from substructures.interchange.usd.scene import Pose, Prim, Scene, Units, given, place_of, rotation_of, written
from substructures.interchange.usd.stage import MAIN, opened, package, refused

EARTH = decimal_of(9.81)
#: what other programs add to a stage and act by, by the last word of the attribute
_ACTING = {
    "armature", "jointFriction", "frictionloss", "linearDamping", "angularDamping", "disableGravity", "gravcomp",
    "springref", "ref", "stiffness", "damping",
}  # fmt: skip
_OWN = ("physics", "drive", "limit", "xformOp")


def read_usd(data: bytes, included: Mapping[str, bytes] | None = None) -> Robot:
    """The robot of a USD file. ``included``: contents of the layers that it refers to, by their paths from it.

    Raises InvalidDocument with the path of the prim.
    """
    report = Report()
    stage = opened(data, {} if included is None else included)
    with refused(MAIN):
        scene = Scene(stage, Units.of(stage, report))
        if not scene.bodies:
            message = "there is no rigid body: prims with PhysicsRigidBodyAPI are links"
            raise refuse(Place(0, "USD"), "no-links", message)
        return _Reader(scene, report).robot()


class _Reader:
    """Goes through the joints from the bodies that are reached."""

    def __init__(self, scene: Scene, report: Report) -> None:
        self.scene, self.report = scene, report
        self.names = names_of(list(scene.bodies))
        self.links: list[Link] = []
        self.joints = sorted(joints_of(scene, report), key=lambda joint: joint.is_cut)
        self.left = dict(enumerate(self.joints))
        self.reached: set[str | None] = set()
        self._at: dict[str | None, list[int]] = {}
        for k, joint in enumerate(self.joints):
            for end in joint.ends:
                self._at.setdefault(end, []).append(k)
        self._due: list[int] = []  # a heap: numbers of joints at what is reached

    def robot(self) -> Robot:
        """Everything together."""
        self._reach(None)
        self._grow()
        for path in self._roots():
            if path not in self.reached:
                self._root(path)
                self._grow()
        self._tell_of_others()
        loops = tuple(joint.loop(self.names, self.report) for joint in self.left.values())
        gravity, place = self._gravity()
        layer = self.scene.stage.GetRootLayer()
        name = layer.defaultPrim or self.scene.prims[0].GetName()
        return Robot(str(name), in_order(self.links), self.report, loops=loops, gravity=gravity, gravity_place=place)

    def _reach(self, path: str | None) -> None:
        self.reached.add(path)
        for k in self._at.get(path, ()):
            heappush(self._due, k)

    def _grow(self) -> None:
        """By the first joint that leads to a body that is not reached, as long as there is one."""
        while self._due:
            k = heappop(self._due)
            if not self.reached.issuperset(self.joints[k].ends):
                self._carried(self.left.pop(k))

    def _carried(self, joint: Joint) -> None:
        """The body behind a joint."""
        child = 1 if joint.ends[0] in self.reached else 0
        path, over = str(joint.ends[child]), joint.ends[1 - child]
        placed = joint.placed(child)
        motions = joint.motions(child, self.scene, self.report)
        self._link(path, None if over is None else self.names[over], placed, motions, joint.name)

    def _roots(self) -> Iterator[str]:
        """Roots of articulations, then bodies that are no body1, then any."""
        api, carried = package("UsdPhysics").ArticulationRootAPI, {joint.ends[1] for joint in self.joints}
        yield from (path for path, prim in self.scene.bodies.items() if prim.HasAPI(api))
        yield from (path for path in self.scene.bodies if path not in carried)
        yield from self.scene.bodies

    def _root(self, path: str) -> None:
        pose = self.scene.upright(self.scene.frame(self.scene.bodies[path])[0])
        message = "no joint carries this body: it is fixed to the interface (base=floating: free)"
        self.report.warning(place_of(self.scene.bodies[path]), message, "topology")
        self._link(path, None, pose, (), "")

    def _link(self, path: str, parent: str | None, pose: Pose, motions: tuple[Motion, ...], joint: str) -> None:
        prim = self.scene.bodies[path]
        self._reach(path)
        shown = any(each.IsA(package("UsdGeom").Gprim) for each in self.scene.below(path))
        place, inertial = vector(pose.r), self._inertial(path, shown)
        link = Link(self.names[path], parent, place_of(prim), place, to_rpy(pose.R), motions, inertial, joint, shown)
        self.links.append(link)

    def _inertial(self, path: str, shown: bool) -> Inertial:
        """Of the body, or the sum of what hangs on it; told where the format computes more of the shapes."""
        prim, below = self.scene.bodies[path], self.scene.below(path)
        found = [each for each in below if self._mass(each)]
        if prim in found:
            return self._weighed(prim, shown)
        if any(self._has_density(each) and not _is_on(each, found) for each in below):
            message = "masses of shapes by a density are not computed: give the body physics:mass"
            self.report.lost(place_of(prim), message, "physics")
        if prim.HasAPI(package("UsdPhysics").MassAPI) and any(x and math.isfinite(x) for x in _distribution(prim)):
            message = "centerOfMass and diagonalInertia of a body without mass are left out: give it physics:mass"
            self.report.lost(place_of(prim), message, "physics")
        return together([self._weighed(each, shown) for each in found])

    def _has_density(self, prim: Prim) -> bool:
        """Whether it has a mass by a density: its own, or that of the format, which every shape in contacts has."""
        physics = package("UsdPhysics")
        collides = prim.HasAPI(physics.CollisionAPI) and given(prim, "physics:collisionEnabled", "bool")
        return bool(collides or prim.GetAttribute("physics:density").Get())

    def _mass(self, prim: Prim) -> Number:
        if not prim.HasAPI(package("UsdPhysics").MassAPI):
            return ZERO
        return written(given(prim, "physics:mass", "float"), place_of(prim)) * self.scene.units.mass

    def _weighed(self, prim: Prim, shown: bool) -> Inertial:
        """Mass, mass centre and R diag(I) R^T of a prim, in the frame of its body."""
        com, moments = (given(prim, f"physics:{name}", "Vec3f") for name in ("centerOfMass", "diagonalInertia"))
        axes = given(prim, "physics:principalAxes", "Quatf")
        place, units = place_of(prim), self.scene.units
        if not all(map(math.isfinite, com)):
            com = (0.0, 0.0, 0.0)
            if shown:
                self.report.lost(place, "no centerOfMass: it is taken to be at the origin of the body", "physics")
        R = rotation_of(axes, prim) if axes.GetReal() or any(axes.GetImaginary()) else np.eye(3)
        pose = self.scene.inside(prim, com, R, place)
        if not any(moments):
            self.report.lost(place, "no diagonalInertia: the body is a point mass", "physics")
        unit = units.mass * units.length**2
        six = turned_inertia((*(written(x, place) * unit for x in moments), ZERO, ZERO, ZERO), pose.R)
        found = Inertial(self._mass(prim), vector(pose.r), six)
        judge(place, found.mass, found.com, six, self.report)
        return found

    def _gravity(self) -> tuple[Triple | None, Place | None]:
        """Of the first scene of the file; down, and of the earth, where it does not say."""
        for prim in self.scene.prims:
            if prim.IsA(package("UsdPhysics").Scene):
                size, place = given(prim, "physics:gravityMagnitude", "float"), place_of(prim)
                along = [float(written(x, place)) for x in given(prim, "physics:gravityDirection", "Vec3f")]
                g = EARTH if size < 0 else written(size, place) * self.scene.units.length
                way = self.scene.units.up @ np.array(along) if any(along) else np.array([0, 0, -1.0])
                return vector(value(g) * way / np.linalg.norm(way)) if not is_zero(g) else ORIGIN, place
        return None, None

    def _tell_of_others(self) -> None:
        for prim, name in self._acting():
            message = f"{name} is not read: what it says of the mechanics is left out"
            self.report.lost(place_of(prim), message)

    def _acting(self) -> Iterator[tuple[Prim, str]]:
        """What other programs say of the mechanics, and bodies that are moved by hand."""
        joint, copies = package("UsdPhysics").Joint, package("UsdGeom").PointInstancer
        for prim in self.scene.prims:
            kind = str(prim.GetTypeName())
            is_other = any(word in kind for word in ("Joint", "Tendon", "Equality", "Actuator")) and not prim.IsA(joint)
            if is_other or (prim.IsA(copies) and any(_is_on(body, [prim]) for body in self.scene.bodies.values())):
                yield prim, kind
            for attribute in prim.GetAuthoredAttributes():
                space, _, name = attribute.GetName().rpartition(":")
                is_own = not space or space.split(":")[0] in _OWN
                if (not is_own and name in _ACTING and attribute.Get()) or (
                    name == "kinematicEnabled" and attribute.Get()
                ):
                    yield prim, attribute.GetName()
            for schema in prim.GetAppliedSchemas():
                if any(word in schema for word in ("Mimic", "Tendon", "Equality")):
                    yield prim, schema


def _distribution(prim: Prim) -> list[float]:
    return [x for name in ("centerOfMass", "diagonalInertia") for x in given(prim, f"physics:{name}", "Vec3f")]


def _is_on(prim: Prim, others: list[Prim]) -> bool:
    return any(prim.GetPath().HasPrefix(other.GetPath()) for other in others)
