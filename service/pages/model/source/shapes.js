// What is drawn of a mechanism: links, springs, joints, ellipsoids of inertia, centres of mass, frames.
import * as THREE from "three/src/Three.Core.js";

const COLOURS = ["#2a78ad", "#c7663a", "#4a9149", "#8f5bad", "#a8862c", "#6b7884"];
const BALLS = ["spherical", "universal", "ball"];
const LOOSE = ["free", "floating"];
const Y = new THREE.Vector3(0, 1, 0);

/** Of every frame the colour of its instance, or where there is only one, of its body. */
function colours(frames) {
    const instances = [...new Set(frames.map(({ instance }) => instance))];
    if (instances.length > 1) return frames.map(({ instance }) => instances.indexOf(instance));
    const bodies = frames.flatMap(({ kind }, k) => (kind === "body" ? [k] : []));
    return frames.map(({ kind, parent }, k) => Math.max(0, bodies.indexOf(kind === "port" ? parent : k)));
}

/** Of the ellipsoid of even density with a body's mass and moments: a = sqrt(5 s / m), s = (J1 + J2 + J3)/2 - J. */
function halfAxes({ mass, moments }) {
    const half = moments.reduce((sum, J) => sum + J, 0) / 2;
    return moments.map((J) => (mass > 0 ? Math.sqrt((5 * Math.max(half - J, 0)) / mass) : 0));
}

/** Where a point of a frame is, of the world for -1. */
export function at(frames, { frame, at: place = [0, 0, 0] }) {
    const point = new THREE.Vector3(...place);
    return frame < 0 ? point : point.applyMatrix4(frames[frame]);
}

/** Meshes in groups by name, put where frames are. */
export class Shapes {
    constructor(groups, { frames, joints, bodies, loads, closures }) {
        const colour = (k) => COLOURS[k % COLOURS.length];
        const solid = (k, more = {}) => new THREE.MeshLambertMaterial({ color: colour(k), ...more });
        const [rod, ball] = [new THREE.CylinderGeometry(1, 1, 1, 16), new THREE.SphereGeometry(1, 24, 16)];
        const add = (group, geometry, material, more) => {
            const mesh = Object.assign(new THREE.Mesh(geometry, material), { userData: more });
            mesh.matrixAutoUpdate = false;
            groups[group].add(mesh);
            return mesh;
        };
        const owner = colours(frames);
        const loose = new Set(joints.filter(({ type }) => LOOSE.includes(type)).map(({ frame }) => frame));
        const linked = frames.map(({ parent }, k) => [parent, k]).filter(([parent, k]) => parent >= 0 && !loose.has(k));
        const link = (k, a, b) => add("links", rod, solid(owner[k]), { a, b });
        this.links = [
            ...linked.map(([a, b]) => link(b, { frame: a }, { frame: b })),
            ...bodies.map(({ frame, centre }) => link(frame, { frame }, { frame, at: centre })),
        ];
        const pairs = [...loads.filter((load) => load.is_elastic), ...closures]
            .flatMap(({ ends }) => ends.slice(1).map((b, k) => ({ a: ends[k], b })));
        this.springs = pairs.map((pair) => add("links", rod, solid(5), pair));
        const shape = ({ type, slides }) => (slides ? new THREE.BoxGeometry(1, 1, 1) : BALLS.includes(type) ? ball : rod);
        this.joints = joints.filter(({ frame }) => !loose.has(frame)).map((joint) => add("joints", shape(joint), solid(5), joint));
        const clear = { transparent: true, opacity: 0.5, depthWrite: false };
        this.bodies = bodies.map((body) => add("inertia", ball, solid(owner[body.frame], clear), { ...body, half: halfAxes(body) }));
        this.centres = bodies.map((body) => add("centres", ball, solid(1), body));
        this.triads = frames.map(() => {
            const triad = new THREE.AxesHelper(1);
            triad.matrixAutoUpdate = false;
            groups.frames.add(triad);
            return triad;
        });
    }

    /** Bodies of these names are shown in a colour of their own. */
    light(names) {
        const lit = new Set(names.filter(Boolean));
        for (const { userData, material } of this.bodies) {
            const on = lit.has(userData.name);
            material.opacity = lit.size === 0 ? 0.5 : on ? 0.8 : 0.1;
            material.emissive.set(on ? "#b35900" : "#000000");
        }
    }

    /** The box around frames and ellipsoids. */
    box(frames) {
        const box = new THREE.Box3();
        frames.forEach((_, frame) => box.expandByPoint(at(frames, { frame })));
        for (const { userData: { frame, centre, half } } of this.bodies) {
            const middle = at(frames, { frame, at: centre });
            box.expandByPoint(middle.clone().addScalar(Math.max(...half))).expandByPoint(middle.addScalar(-Math.max(...half)));
        }
        return box;
    }

    /** Put everything where the frames are; size: of the whole, which says how thick things are. */
    place(frames, size) {
        const width = size / 130;
        for (const mesh of this.links) between(mesh, frames, width);
        for (const mesh of this.springs) between(mesh, frames, width / 3);
        for (const mesh of this.joints) joint(mesh, frames, width);
        for (const mesh of this.bodies) body(mesh, frames, size);
        for (const { userData: { frame, centre }, matrix } of this.centres) {
            matrix.makeScale(width, width, width).setPosition(...centre).premultiply(frames[frame]);
        }
        const length = new THREE.Vector3().setScalar(size / 12);
        this.triads.forEach(({ matrix }, k) => matrix.copy(frames[k]).scale(length));
    }
}

function between(mesh, frames, width) {
    const [a, b] = [at(frames, mesh.userData.a), at(frames, mesh.userData.b)];
    const axis = b.clone().sub(a);
    const length = axis.length();
    mesh.visible = length > 1e-9;
    const turn = new THREE.Quaternion().setFromUnitVectors(Y, axis.normalize());
    mesh.matrix.compose(a.add(b).multiplyScalar(0.5), turn, new THREE.Vector3(width, length, width));
}

function joint({ userData: { frame, axis, slides }, matrix }, frames, width) {
    const turn = new THREE.Quaternion().setFromUnitVectors(Y, new THREE.Vector3(...axis).normalize());
    const size = slides ? [3 * width, 5 * width, 3 * width] : [2.2 * width, 4.5 * width, 2.2 * width];
    matrix.compose(new THREE.Vector3(), turn, new THREE.Vector3(...size)).premultiply(frames[frame]);
}

function body({ userData: { frame, centre, half, axes: d }, matrix }, frames, size) {
    const least = size / (Math.max(...half) > 0 ? 200 : 50); // a point mass is seen, too
    const [a, b, c] = half.map((x) => Math.max(x, least));
    matrix.set(d[0][0] * a, d[0][1] * b, d[0][2] * c, centre[0], d[1][0] * a, d[1][1] * b, d[1][2] * c, centre[1],
        d[2][0] * a, d[2][1] * b, d[2][2] * c, centre[2], 0, 0, 0, 1);
    matrix.premultiply(frames[frame]);
}
