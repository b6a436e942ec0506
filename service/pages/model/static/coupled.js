// The mass matrix of a tree that was never stored: two stored programs, joined by the formulas of coupling over numbers.
import { load } from "./program.js";

const OF_TREE = ["metric", "U", "Omega"];
const OF_PART = ["metric", "f", "n", "composite.m", "composite.s", "composite.J"];

/** Fixed-axis roll, pitch, yaw: R = Rz(yaw) Ry(pitch) Rx(roll), rows after each other. */
export function turned([roll, pitch, yaw]) {
    const [[a, b], [c, d], [e, f]] = [roll, pitch, yaw].map((angle) => [Math.cos(angle), Math.sin(angle)]);
    return [e * c, e * d * b - f * a, e * d * a + f * b, f * c, f * d * b + e * a, f * d * a - e * b, -d, c * b, c * a];
}

/** Expressions count as 0 before the server has read them. */
export const plain = (values) => values.map((x) => (typeof x === "number" ? x : 0));

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** The program of a part, or of a tree, with what coupling needs of it. */
export async function joinable(address) {
    const [program, layout] = await load(address, address.includes("/trees/") ? OF_TREE : OF_PART);
    return { program, frames: layout.frames, names: layout.vectors.qd.names.map((name) => name.slice(0, -1)) };
}

/**
 * Twists of the interface, in its axes, of unit velocities of the host: U_Ia = A (U_ha + Omega_ha x z), Omega_Ia = A
 * Omega_ha, with A from the axes of the frame to those of the interface. Of the world there are none.
 */
function twists({ program, frames, names }, frame, { position, rpy }) {
    const k = frames.indexOf(frame);
    const [n, R, z] = [names.length, turned(plain(rpy)), plain(position)];
    if (k < 0) return names.map(() => [[0, 0, 0], [0, 0, 0]]);
    const [U, Omega] = [[...program.array("U")], [...program.array("Omega")]];
    const back = (v) => [0, 1, 2].map((i) => R[i] * v[0] + R[3 + i] * v[1] + R[6 + i] * v[2]);
    return names.map((_, a) => {
        const [u, w] = [U, Omega].map((all) => all.slice(3 * (k * n + a), 3 * (k * n + a) + 3));
        const shifted = cross(w, z);
        return [back(u.map((x, i) => x + shifted[i])), back(w)];
    });
}

/**
 * g of host and part together, row-major, coordinates of the host first, and its size. What the part carries as a whole
 * (m, s, J) loads the host, g_ab += m U_a.U_b + U_a.(Omega_b x s) + U_b.(Omega_a x s) + Omega_a.(tr J - J) Omega_b;
 * between the two g_ac = U_a . f_c + Omega_a . n_c; the part's own stays.
 */
export function metric(host, part, frame, placement) {
    const [n, p] = [host.names.length, part.names.length];
    const size = n + p;
    const all = new Float64Array(size * size);
    const put = (i, j, x) => (all[i * size + j] = all[j * size + i] = x);
    const beyond = twists(host, frame, placement);
    const [m] = part.program.array("composite.m");
    const [s, J] = ["composite.s", "composite.J"].map((name) => [...part.program.array(name)]);
    const trace = J[0] + J[4] + J[8];
    const tensor = (w) => w.map((x, i) => trace * x - dot(J.slice(3 * i, 3 * i + 3), w));
    const own = host.program.array("metric");
    for (let a = 0; a < n; a++) for (let b = a; b < n; b++) {
        const [[U, W], [V, X]] = [beyond[a], beyond[b]];
        put(a, b, own[a * n + b] + m * dot(U, V) + dot(U, cross(X, s)) + dot(V, cross(W, s)) + dot(W, tensor(X)));
    }
    if (p === 0) return { size, all };
    const [f, h] = ["f", "n"].map((name) => [...part.program.array(name)]);
    const row = (all, c) => all.slice(3 * c, 3 * c + 3);
    for (let a = 0; a < n; a++) for (let c = 0; c < p; c++) {
        put(a, n + c, dot(beyond[a][0], row(f, c)) + dot(beyond[a][1], row(h, c)));
    }
    const within = part.program.array("metric");
    for (let c = 0; c < p; c++) for (let d = c; d < p; d++) put(n + c, n + d, within[c * p + d]);
    return { size, all };
}
