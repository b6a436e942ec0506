// A motion that was computed: its state at a time, and what is plotted of it.

/** The state at a time: Hermite's cubic, which has the positions and velocities of the results. */
export function interpolated({ t: times, q, qd }, t, state, chart) {
    const low = Math.max(0, index(times, t));
    const high = Math.min(low + 1, times.length - 1);
    const h = times[high] - times[low] || 1;
    const s = (t - times[low]) / h;
    const [before, after] = [low, high].map((at) => chart.rates(q[at], qd[at]));
    q[low].forEach((a, k) => {
        const [b, va, vb] = [q[high][k], before[k] * h, after[k] * h];
        state.q[k] = a + s * (va + s * (3 * (b - a) - 2 * va - vb + s * (2 * (a - b) + va + vb)));
    });
    chart.normalise(state.q);
    qd[low].forEach((v, k) => (state.qd[k] = v + s * (qd[high][k] - v)));
}

/** The last of times that is not after t. */
export function index(times, t) {
    let [low, high] = [0, times.length - 1];
    while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (times[middle] <= t) low = middle;
        else high = middle;
    }
    return times[high] <= t ? high : low;
}

/** Of series that are plotted as they are. */
const UNITS = { power: "W", powers: "W" };

/** What is plotted: titles with unit and columns by name; small: folded at first. */
export function groups(found, { vectors }, program) {
    const rest = new Map(Object.entries(found.series));
    const take = (name) => {
        const values = rest.get(name);
        rest.delete(name);
        return values;
    };
    const told = [
        ...byUnit("coordinates", vectors.q, found.q),
        ...byUnit("velocities", vectors.qd, found.qd),
        ...energies(found, take, program),
        ...drifts(found),
        ...inputs(vectors.u, take),
        ...reactions(found, take),
        ...byUnit("accelerations", vectors.qdd, take("qdd")).map((group) => ({ ...group, small: true })),
    ];
    for (const { name } of found.checks) rest.delete(name); // drawn by their drift
    const further = [...rest].map(([name, values]) => {
        const many = Array.isArray(values[0]);
        const columns = many ? listed(values[0].map((_, k) => String(k + 1)), values) : { [name]: values };
        return { title: name.replaceAll("_", " "), unit: UNITS[name] ?? "", columns, small: many || name.endsWith("residual") };
    });
    return [...told, ...further].filter(({ columns }) => Object.keys(columns).length);
}

function listed(names, rows) {
    return Object.fromEntries(names.map((name, k) => [name, rows.map((row) => row[k])]));
}

function byUnit(title, { names, units }, rows) {
    if (!rows) return [];
    const columns = listed(names, rows);
    const of = (unit) => Object.fromEntries(names.filter((_, k) => units[k] === unit).map((name) => [name, columns[name]]));
    return [...new Set(units)].map((unit) => ({ title, unit, columns: of(unit) }));
}

/** Kinetic energy by the metric of the program where it is not told, and what is left of the energy. */
function energies(found, take, program) {
    const all = take("energy");
    const kinetic = take("kinetic_energy") ?? (program.has("metric") ? found.q.map((q, k) => moving(program, q, found.qd[k])) : null);
    if (!kinetic) return all ? [{ title: "energy", unit: "J", columns: { energy: all } }] : [];
    const potential = take("potential_energy") ?? all?.map((x, k) => x - kinetic[k]);
    const work = take("work");
    const columns = { kinetic };
    if (potential) Object.assign(columns, { potential, total: all ?? kinetic.map((x, k) => x + potential[k]) });
    if (work?.some((x) => x !== 0)) columns["work of forces"] = work;
    return [{ title: "energies", unit: "J", columns }];
}

function moving(program, q, qd) {
    program.vectors.q.set(q);
    const M = program.array("metric");
    return qd.reduce((sum, v, i) => sum + 0.5 * v * qd.reduce((row, w, j) => row + M[i * qd.length + j] * w, 0), 0);
}

/** How far first integrals are from their first values, in parts of their size. */
function drifts({ checks, series }) {
    const balance = series.work && series.energy?.map((x, k) => x - series.work[k]);
    const followed = { ...series, ...(balance ? { "energy-balance": balance } : {}) };
    const columns = checks.flatMap(({ name, rule, scale }) => {
        const values = rule === "constant" ? followed[name] : null;
        return values && !Array.isArray(values[0]) ? [[name, values.map((x) => (x - values[0]) / (scale || 1))]] : [];
    });
    return [{ title: "drift of first integrals, relative", unit: "", columns: Object.fromEntries(columns) }];
}

function inputs({ names, units }, take) {
    const found = names.flatMap((name, k) => {
        const values = take(name);
        return values ? [[name, units[k], values]] : [];
    });
    return [...new Set(found.map(([, unit]) => unit))].map((unit) => {
        const columns = Object.fromEntries(found.filter((each) => each[1] === unit).map(([name, , values]) => [name, values]));
        return { title: "inputs", unit, columns };
    });
}

/** Force and moment of the joints, along the axes of the world. */
function reactions({ joints }, take) {
    for (const name of ["reaction_force", "reaction_moment"]) take(name);
    const kinds = [["force", "N"], ["moment", "N m"]].map(([kind, unit]) => [kind, unit, take(`reaction_${kind}_world`)]);
    const told = kinds.filter(([, , rows]) => rows?.[0]?.length);
    return told.flatMap(([kind, unit, rows]) => joints.map((joint, k) => {
        const columns = listed(["x", "y", "z"], rows.map((row) => row[k]));
        return { title: `${kind} at ${joint}, in the world`, unit, columns };
    }));
}
