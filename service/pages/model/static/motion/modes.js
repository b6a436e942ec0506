// Modes about a state: frequencies and damping, each to be played; where nothing rests, the way to what does.
import { element } from "../fragments.js";
import { short } from "../numbers.js";
import { heard, post } from "./asked.js";
import { constants } from "./request.js";

const place = document.getElementById("modes");
const told = (...job) => place.replaceChildren(heard(...job));
const PERIODS = 5;
const TURN = 0.3; // rad that a joint of a mode moves at most
const SHARE = 0.15; // of the size of the whole that one slides at most

/** given(): the state; found(q): it is another one; play(length, at): plays at(t), the coordinates. */
export class Modes {
    constructor(path, { joints, chart }, { given, found, play, size }) {
        Object.assign(this, { path, joints, chart, given, found, play, size });
        document.getElementById("linearise").addEventListener("click", () => this.tried(this.about(this.given())));
    }

    tried(work) {
        place.replaceChildren("computing ...");
        work.catch((error) => place.replaceChildren(element("p", { class: "warn" }, error.message)));
    }

    async about(q) {
        const found = await post(`${this.path}/linearisations`, { q, ...constants() }, { told });
        if (!found.is_equilibrium) return this.elsewhere(q, found);
        this.q = found.q ?? q;
        const { verdict, reason } = found.stability;
        const rows = found.modes.map((mode, k) => this.row(mode, k, found.coordinates));
        const heads = ["mode", "frequency", "damping ratio", "eigenvalue", "most of it", ""];
        const table = element("table", {},
            element("thead", {}, element("tr", {}, ...heads.map((text) => element(text ? "th" : "td", {}, text)))),
            element("tbody", {}, ...rows));
        place.replaceChildren(element("p", { class: "small" }, `${verdict}: ${reason}`),
            element("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Modes" }, table));
    }

    row(mode, k, names) {
        const { eigenvalue: [re, im], hertz, damping_ratio: ratio, shape } = mode;
        const button = element("button", { type: "button", class: "copy", "aria-label": `play mode ${k + 1}` }, "play");
        button.addEventListener("click", () => this.swing(mode));
        const sizes = shape.map(([a, b]) => Math.hypot(a, b));
        const most = names[sizes.indexOf(Math.max(...sizes))];
        const texts = [String(k + 1), im ? `${short(hertz ?? 0)} Hz` : "none", im ? short(ratio ?? 0) : "", complex([re, im]), most];
        return element("tr", {}, ...texts.map((text) => element("td", {}, text)), element("td", {}, button));
    }

    /** Nothing rests here: what would, and where the nearest equilibrium is. */
    elsewhere(q, { qdd }) {
        const button = element("button", { type: "button" }, "Go to the nearest equilibrium");
        button.addEventListener("click", () => this.tried(this.rest(q)));
        const most = Math.max(...qdd.map(Math.abs));
        const words = `This state does not rest: accelerations up to ${short(most)} (rad/s², m/s²). Modes are those of an equilibrium.`;
        place.replaceChildren(element("p", { class: "small" }, words), button);
    }

    async rest(q) {
        const { found } = await post(`${this.path}/equilibria`, { starts: [q], ...constants() }, { told });
        if (!found.length) throw new Error("no equilibrium was found from here: start nearer to one");
        const away = (other) => Math.max(...other.q.map((x, k) => Math.abs(x - q[k])));
        const nearest = found.reduce((best, each) => (away(each) < away(best) ? each : best));
        this.found(nearest.q);
        await this.about(nearest.q);
    }

    /** Oscillations for some periods, growing or dying away; what does not oscillate for three of its times. */
    swing({ shape, eigenvalue: [re, im] }) {
        const sizes = shape.map(([a, b], k) => Math.hypot(a, b) / (this.joints[k] === "P" ? SHARE * this.size() : TURN));
        const scale = 1 / Math.max(...sizes, 1e-300);
        const length = im ? (PERIODS * 2 * Math.PI) / Math.abs(im) : re ? 3 / Math.abs(re) : 2;
        const grown = (t) => (im || re ? Math.exp(re > 0 ? re * (t - length) : re * t) : t / length);
        this.play(length, (t) => this.chart.moved(this.q, shape.map(([a, b]) =>
            scale * grown(t) * (a * Math.cos(im * t) - b * Math.sin(im * t)))));
    }
}

export function complex([re, im]) {
    return im ? `${short(re)} ${im < 0 ? "-" : "±"} ${short(Math.abs(im))}i` : short(re);
}
