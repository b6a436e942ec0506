// Sliders and states: of ball and floating joints sliders are places and rotation vectors, states have quaternions.

const length = (v) => Math.hypot(...v);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** w, x, y, z of theta n; sin(theta/2)/theta is 1/2 to rounding where theta^2 is lost beside 1. */
function quaternion(vector) {
    const theta = length(vector);
    const scale = theta > 1e-8 ? Math.sin(theta / 2) / theta : 0.5;
    return [Math.cos(theta / 2), ...vector.map((x) => scale * x)];
}

/** theta n of w, x, y, z, |theta| at most pi. */
function rotationVector(turned) {
    const [w, ...vector] = turned[0] < 0 ? turned.map((x) => -x) : turned;
    const s = length(vector);
    const scale = s > 1e-8 ? (2 * Math.atan2(s, w)) / s : 2;
    return vector.map((x) => scale * x);
}

function product([a, ...u], [b, ...v]) {
    const c = cross(u, v);
    return [a * b - dot(u, v), ...u.map((x, i) => a * v[i] + b * x + c[i])];
}

/** R v of a quaternion. */
function turn([w, ...r], v) {
    const once = cross(r, v);
    const twice = cross(r, once);
    return v.map((x, i) => x + 2 * (w * once[i] + twice[i]));
}

export class Chart {
    /** turns: of every quaternion the number of its first slider and of its first position, and whether it floats. */
    constructor(turns) {
        this.turns = turns;
        [this.sliders, this.places] = [0, 1].map((which) => new Set(turns.map((each) => each[which])));
    }

    /** The state in which sliders are there. */
    state(values) {
        if (!this.turns.length) return values;
        const q = [];
        for (let k = 0; k < values.length; k += this.sliders.has(k) ? 3 : 1) {
            q.push(...(this.sliders.has(k) ? quaternion(values.slice(k, k + 3)) : [values[k]]));
        }
        return q;
    }

    /** Where sliders are in a state. */
    values(q) {
        if (!this.turns.length) return [...q];
        const [all, values] = [[...q], []];
        for (let i = 0; i < all.length; i += this.places.has(i) ? 4 : 1) {
            values.push(...(this.places.has(i) ? rotationVector(all.slice(i, i + 4)) : [all[i]]));
        }
        return values;
    }

    /** q' of rates: p' = R v and Q' = Q (0, w) / 2. */
    rates(q, qd) {
        if (!this.turns.length) return qd;
        const found = [];
        for (let k = 0; k < qd.length; k += this.sliders.has(k) ? 3 : 1) {
            found.push(...(this.sliders.has(k) ? [0, 0, 0, 0] : [qd[k]]));
        }
        for (const [k, i, floats] of this.turns) {
            const turned = q.slice(i, i + 4);
            product(turned, [0, ...qd.slice(k, k + 3)]).forEach((x, n) => (found[i + n] = x / 2));
            if (floats) turn(turned, qd.slice(k - 3, k)).forEach((x, n) => (found[i - 3 + n] = x));
        }
        return found;
    }

    /** A state displaced by d along coordinates: in the axes of bodies, and turned there. */
    moved(q, d) {
        const found = this.state(this.values(q).map((x, k) => x + d[k]));
        for (const [k, i, floats] of this.turns) {
            const turned = q.slice(i, i + 4);
            product(turned, quaternion(d.slice(k, k + 3))).forEach((x, n) => (found[i + n] = x));
            if (floats) turn(turned, d.slice(k - 3, k)).forEach((x, n) => (found[i - 3 + n] = q[i - 3 + n] + x));
        }
        return found;
    }

    /** Quaternions in a vector over their lengths. */
    normalise(q) {
        for (const i of this.places) {
            const size = length(q.slice(i, i + 4)) || 1;
            for (let n = i; n < i + 4; n++) q[n] /= size;
        }
    }
}
