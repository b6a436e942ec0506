// Numbers for people, and eigenvalues of symmetric matrices.

/** Three digits, as short as can be. */
export function short(x) {
    if (!Number.isFinite(x)) return "?";
    if (x === 0) return "0";
    const size = Math.abs(x);
    return size >= 1e5 || size < 0.01 ? x.toExponential(1) : String(Number(x.toPrecision(3)));
}

/** The eigenvalues of a symmetric matrix (row-major, n x n) in ascending order, by Jacobi's rotations. */
export function eigenvalues(matrix, n) {
    const a = Float64Array.from(matrix);
    for (let sweep = 0; sweep < 30; sweep++) {
        let off = 0;
        for (let p = 0; p < n; p++) for (let q = p + 1; q < n; q++) off += a[p * n + q] ** 2;
        if (!(off > 1e-24)) break;
        for (let p = 0; p < n; p++) for (let q = p + 1; q < n; q++) rotate(a, n, p, q);
    }
    return Array.from({ length: n }, (_, k) => a[k * n + k]).sort((x, y) => x - y);
}

function rotate(a, n, p, q) {
    const apq = a[p * n + q];
    if (Math.abs(apq) < 1e-300) return;
    const theta = (a[q * n + q] - a[p * n + p]) / (2 * apq);
    const t = (theta >= 0 ? 1 : -1) / (Math.abs(theta) + Math.hypot(theta, 1));
    const c = 1 / Math.hypot(t, 1);
    const s = t * c;
    for (let k = 0; k < n; k++) {
        const [x, y] = [a[k * n + p], a[k * n + q]];
        a[k * n + p] = c * x - s * y;
        a[k * n + q] = s * x + c * y;
    }
    for (let k = 0; k < n; k++) {
        const [x, y] = [a[p * n + k], a[q * n + k]];
        a[p * n + k] = c * x - s * y;
        a[q * n + k] = s * x + c * y;
    }
}
