// The page of motions: runs from the state of the sliders, plays it, plots it; modes about a state.
import { post } from "./asked.js";
import { Curves } from "./curves.js";
import { element } from "./fragments.js";
import { short } from "./numbers.js";
import { Player } from "./player.js";
import { load } from "./program.js";
import { Sliders } from "./sliders.js";
import { shown } from "./viewing.js";

const COUNT = 600; // times of a motion
const place = document.getElementById("place");
const get = (id) => document.getElementById(id);
start(JSON.parse(place.dataset.model)).catch((error) => tell(error.message, "warn"));

async function start({ kind, reference, ranges }) {
    const path = `/v1/${kind}/${reference}`;
    const [program, layout] = await load(path);
    const state = program.vectors;
    const given = new URL(location.href).searchParams;
    let [motion, plots, view] = [null, [], null];
    get("without").hidden = true;
    const draw = () => {
        view?.pose(program);
        place.dataset.pose = [...state.q].join(",");
    };
    const sliders = new Sliders(state, ranges, () => requestAnimationFrame(draw), () => {});
    const player = new Player((t) => {
        motion(t);
        for (const plot of plots) plot.mark(t);
        draw();
    }, keep);

    const run = async () => {
        player.stop();
        const inputs = Object.fromEntries([...document.querySelectorAll("[data-input]")]
            .filter(({ value }) => value.trim())
            .map(({ dataset, value }) => [dataset.input, value]));
        const [from, rates] = sliders.given();
        const body = { q: from, qd: rates, span: [0, get("span").valueAsNumber], count: COUNT, inputs };
        tell("computing ...");
        const found = await post(`${path}/simulations`, body, tell);
        const names = layout.vectors.q.names;
        const column = (rows, k) => rows.map((row) => row[k]);
        const columns = (rows, names_) => Object.fromEntries(names_.map((name, k) => [name, column(rows, k)]));
        const at = (t) => player.at(t);
        plots = [
            new Curves("coordinates", found.t, columns(found.q, names), short, at),
            new Curves("velocities", found.t, columns(found.qd, layout.vectors.qd.names), short, at),
            ...Object.entries(found.series).map(([name, values]) => new Curves(name, found.t, { [name]: values }, short, at)),
        ];
        get("plots").replaceChildren(...plots.map((plot) => plot.element));
        verdict(found);
        table(found, names);
        motion = (t) => interpolated(found, t, state);
        place.dataset.run = JSON.stringify(body);
        player.load(found.t[found.t.length - 1], Number(given.get("t") ?? 0));
        if (!given.has("t")) player.play();
        given.delete("t");
    };
    get("motion").addEventListener("submit", (event) => {
        event.preventDefault();
        run().catch((error) => tell(error.message, "warn"));
    });
    get("linearise").addEventListener("click", async () => {
        get("modes").replaceChildren("computing ...");
        try {
            const [q] = sliders.given();
            const found = await post(`${path}/linearisations`, { q });
            modes(found, (mode) => {
                plots = [];
                motion = (t) => swung(state, q, mode, t);
                player.load(period(mode));
                player.play();
            });
        } catch (error) {
            get("modes").replaceChildren(element("p", { class: "warn" }, error.message));
        }
    });
    view = await shown(kind, reference, sliders);
    draw();
    place.dataset.view = view ? "3d" : "picture";
    if (given.has("t")) await run();
    place.dataset.ready = "1";
}

function tell(words, kind = "quiet") {
    get("verdict").replaceChildren(words);
    get("verdict").className = kind;
}

function keep(t) {
    const address = new URL(location.href);
    address.searchParams.set("t", String(t));
    history.replaceState(null, "", address);
}

function interpolated({ t: times, q, qd }, t, state) {
    let [low, high] = [0, times.length - 1];
    while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (times[middle] <= t) low = middle;
        else high = middle;
    }
    const h = times[high] - times[low] || 1;
    const s = (t - times[low]) / h;
    // Hermite's cubic, which has the positions and velocities of the trajectory
    q[low].forEach((a, k) => {
        const [b, va, vb] = [q[high][k], qd[low][k] * h, qd[high][k] * h];
        state.q[k] = a + s * (va + s * (3 * (b - a) - 2 * va - vb + s * (2 * (a - b) + va + vb)));
        state.qd[k] = qd[low][k] + s * (qd[high][k] - qd[low][k]);
    });
}

function verdict({ is_right: right, status, message, checks }) {
    const worst = checks.map(({ name, relative, holds }) => `${name} ${holds ? "holds" : "fails"} to ${short(relative)}`);
    const words = right === null ? "not judged" : right ? "right" : "not right";
    tell(`${status}, ${words}: ${worst.join("; ")}${message ? `; ${message}` : ""}`, right ? "right" : "warn");
}

function table(found, names) {
    const heads = ["t", ...names, ...names.map((name) => `${name}'`), ...Object.keys(found.series)];
    const rows = found.t.map((t, k) => [t, ...found.q[k], ...found.qd[k], ...Object.values(found.series).map((x) => x[k])]);
    const text = [heads, ...rows].map((row) => row.join(",")).join("\n");
    get("csv").href = URL.createObjectURL(new Blob([`${text}\n`], { type: "text/csv" }));
    get("csv").hidden = false;
}

function period({ eigenvalue: [, imaginary] }) {
    return imaginary ? (2 * Math.PI) / Math.abs(imaginary) : 2;
}

function swung(state, q, { shape, eigenvalue: [, imaginary] }, t) {
    const [c, s] = [Math.cos(imaginary * t), Math.sin(imaginary * t)];
    shape.forEach(([re, im], k) => (state.q[k] = q[k] + 0.3 * (re * c - im * s)));
}

function modes({ modes: found, stability }, play) {
    const rows = found.map((mode, k) => {
        const button = element("button", { type: "button" }, "play");
        button.addEventListener("click", () => play(mode));
        const told = `${short(mode.hertz ?? 0)} Hz, damping ratio ${short(mode.damping_ratio ?? 0)}`;
        return element("tr", {}, element("td", {}, String(k + 1)), element("td", {}, told), element("td", {}, button));
    });
    const words = stability ? `${stability.verdict}: ${stability.reason}` : "";
    get("modes").replaceChildren(element("p", { class: "small" }, words), element("table", {}, element("tbody", {}, ...rows)));
}
