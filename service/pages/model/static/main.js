// The page of a part or a tree: one state, which sliders and parameters change, and what is drawn of it.
import "./keys.js";
import { keep, kept, lead } from "./address.js";
import { Chart } from "./chart.js";
import { Grid } from "./grid.js";
import { eigenvalues, short } from "./numbers.js";
import { Panel } from "./panel.js";
import { load } from "./program.js";
import { Sliders, parameters } from "./sliders.js";
import { shown } from "./viewing.js";

const place = document.getElementById("place");
if (place) start(JSON.parse(place.dataset.model)).catch((error) => failed(error));

async function start({ kind, reference, ranges, names, turns }) {
    const path = `/${kind}/${reference}`;
    const [program, layout] = await load(`/v1${path}`);
    const [chart, dof] = [new Chart(turns), layout.vectors.qd.names.length];
    const state = program.vectors; // q, qd, u, p are written where the program reads them
    let view = null;
    const panel = new Panel(path, state, { ranges, names, chart }, (bodies) => view?.light(bodies));
    const grid = new Grid(path, program, (entry) => {
        keep("entry", entry);
        panel.choose(entry);
    });
    let asked = 0;
    const draw = () => {
        asked = 0;
        const start = performance.now();
        grid.draw();
        panel.draw();
        view?.pose(program);
        place.dataset.drawn = String(Number(place.dataset.drawn ?? 0) + 1);
        place.dataset.milliseconds = (performance.now() - start).toFixed(3);
    };
    const changed = () => (asked ||= requestAnimationFrame(draw));
    const rested = () => {
        lead(`${path}/motion`);
        if (!program.has("metric")) return;
        const found = eigenvalues(program.array("metric"), dof);
        const shown = found.length > 8 ? [...found.slice(0, 4), NaN, ...found.slice(-3)] : found;
        document.getElementById("eigenvalues").textContent = shown.map((x) => (x === x ? short(x) : "…")).join(", ");
    };
    const sliders = new Sliders(state, ranges, chart, changed, rested);
    sliders.move(kept("qd").split(",").map(Number));
    parameters(state, () => {
        changed();
        rested();
    });
    draw();
    rested();
    place.dataset.ready = "1";
    requestAnimationFrame(() => setTimeout(async () => {
        view = await shown(kind, reference, sliders);
        view?.light((document.getElementById("entry").dataset.bodies ?? "").split(" "));
        view?.pose(program);
        place.dataset.view = view ? "3d" : "picture";
    }));
}

function failed(error) {
    const told = document.createElement("p");
    told.className = "warn small";
    told.textContent = `Numbers are computed by the server: this browser cannot run the program of the model (${error.message}).`;
    place.before(told);
}
