// A part where it would be: its scene, with the frames at home moved by a placement.
import { plain, turned } from "./coupled.js";
import { load } from "./program.js";
import { reached } from "./reached.js";

const kept = new Map();

/** The scene of a part with positions and rotations of its frames at home; null of what is no part. */
export async function sceneOf(reference) {
    if (!kept.has(reference)) {
        const address = `/v1/substructures/${encodeURIComponent(reference)}`;
        const answer = await reached(`${address}/scene`);
        if (!answer.ok) return null;
        const scene = await answer.json();
        const [program] = await load(address);
        program.vectors.q?.set(scene.poses.home);
        const [position, rotation] = ["position", "rotation"].map((name) => [...program.array(name)]);
        kept.set(reference, { scene, position, rotation });
    }
    return kept.get(reference);
}

/** Ends of links and ellipsoids' centres in the frame that carries the part; expressions count as 0. */
export function ghost({ scene, position, rotation }, { position: shift, rpy }) {
    const [R, t] = [turned(plain(rpy)), plain(shift)];
    const placed = ([x, y, z]) => [0, 1, 2].map((i) => R[3 * i] * x + R[3 * i + 1] * y + R[3 * i + 2] * z + t[i]);
    const at = (k, [x, y, z] = [0, 0, 0]) =>
        placed([0, 1, 2].map((i) => position[3 * k + i] + rotation[9 * k + 3 * i] * x + rotation[9 * k + 3 * i + 1] * y + rotation[9 * k + 3 * i + 2] * z));
    const links = scene.frames.flatMap(({ parent }, k) => (parent >= 0 ? [[at(parent), at(k)]] : []));
    const bodies = scene.bodies.map(({ frame, centre }) => [at(frame), at(frame, centre)]);
    return [...links, ...bodies];
}
