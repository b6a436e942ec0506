// The page of motions: runs from the state of the sliders, plays it, plots it; modes and roots about a state.
import "../keys.js";
import { kept, lead } from "../address.js";
import { Chart } from "../chart.js";
import { load } from "../program.js";
import { Sliders, parameters } from "../sliders.js";
import { shown } from "../viewing.js";
import { heard, post } from "./asked.js";
import { table, verdict } from "./checks.js";
import { locus } from "./locus.js";
import { Modes } from "./modes.js";
import { Player } from "./player.js";
import { Plots } from "./plots.js";
import { happening, keep, request, restore, time } from "./request.js";
import { save } from "./saving.js";
import { groups, interpolated } from "./trajectory.js";

const place = document.getElementById("place");
const get = (id) => document.getElementById(id);
const [SEEN, FAR] = [21, 4]; // poses that the view is fitted to, unless they take so many times the room of one
const size = ({ min, max }) => max.distanceTo(min);
const tried = (work) => work.catch((error) => tell(error.message, "warn"));
tried(start(JSON.parse(place.dataset.model)));

async function start({ kind, reference, ranges, joints, turns }) {
    const path = `/v1/${kind}/${reference}`;
    const back = () => lead(`/${kind}/${reference}`);
    const [program, layout] = await load(path);
    const [state, chart] = [program.vectors, new Chart(turns)];
    let [motion, found, view, running, asked] = [null, null, null, null, null];
    const plots = new Plots(get("plots"), (t) => player.choose(t));
    get("without").hidden = true;
    const draw = () => {
        view?.pose(program);
        place.dataset.pose = [...state.q].join(",");
    };
    const sliders = new Sliders(state, ranges, chart, () => {
        player.stop(); // what is moved is seen
        for (const [k, values] of sliders.given().entries()) [state.q, state.qd][k].set(values);
        requestAnimationFrame(draw);
    }, back);
    sliders.move(kept("qd").split(",").map(Number));
    const player = new Player((t) => {
        const before = performance.now();
        motion(t);
        if (found) plots.mark(t);
        draw();
        place.dataset.milliseconds = (performance.now() - before).toFixed(3);
    }, (t) => found && keep(t));

    parameters(state, () => {
        player.stop();
        draw();
        back();
    });
    const run = async () => {
        player.stop();
        running = new AbortController();
        const body = request(sliders.given());
        tell("computing ...");
        busy(true);
        try {
            found = await post(`${path}/simulations`, body, { told: followed, signal: running.signal });
        } finally {
            busy(false);
        }
        asked = body;
        plots.show(groups(found, layout, program), found.t, table(found));
        tell(...verdict(found));
        get("saves").hidden = false;
        motion = (t) => interpolated(found, t, state, chart);
        place.dataset.run = JSON.stringify(body);
        const named = found.events.map((event) => ({ t: event.t, name: happening(body, event) }));
        const until = found.t[found.t.length - 1];
        if (view) within(until);
        player.load(until, time() ?? 0, named);
        keep(player.t, body);
        back();
    };
    /** All of the motion is seen, unless it goes far away. */
    const within = (until) => {
        const boxes = Array.from({ length: SEEN }, (_, k) => {
            motion((until * k) / (SEEN - 1));
            view.pose(program);
            return view.box();
        });
        const far = FAR * size(boxes[0]);
        const all = boxes.reduce((sum, box) => sum.union(box));
        if (size(all) <= far) view.fit(all);
    };
    const play = (length, at) => {
        player.stop();
        found = null;
        plots.clear();
        get("saves").hidden = true;
        motion = (t) => state.q.set(at(t));
        player.load(length);
        player.play();
    };
    get("motion").addEventListener("submit", (event) => {
        event.preventDefault();
        forget();
        tried(run().then(() => player.play()));
    });
    get("cancel").addEventListener("click", () => running?.abort(new Error("cancelled")));
    get("reactions").addEventListener("change", () => found && tried(run()));
    for (const button of document.querySelectorAll("[data-media]")) {
        const name = `${reference.replace("@", "-")}.${button.dataset.media.match(/csv|npz|svg/)[0]}`;
        button.addEventListener("click", () =>
            tried(save(`${path}/simulations`, asked, button.dataset.media, name, followed).then(() => tell(...verdict(found)))));
    }
    new Modes(path, { joints, chart }, {
        play, given: () => sliders.given()[0], found: (q) => sliders.set(q), size: () => view?.told.sphere.radius ?? 1,
    });
    locus(path, () => sliders.given()[0]);
    for (const button of document.querySelectorAll("[type=submit]")) button.disabled = false;
    restore();
    back();
    view = await shown(kind, reference, sliders);
    draw();
    place.dataset.view = view ? "3d" : "picture";
    if (time() !== null) await run();
    place.dataset.ready = "1";
}

function busy(is) {
    get("cancel").hidden = !is;
    get("run").disabled = get("reactions").disabled = is;
}

/** A new motion begins at its beginning. */
function forget() {
    const address = new URL(location.href);
    address.searchParams.delete("t");
    history.replaceState(null, "", address);
}

const followed = (...job) => tell(heard(...job));

function tell(words, kind = "quiet") {
    get("verdict").replaceChildren(words);
    get("verdict").className = kind;
}
