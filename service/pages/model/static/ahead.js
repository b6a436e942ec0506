// What a coupling would give, before anything is stored: M of the whole at home, computed here.
import { joinable, metric } from "./coupled.js";
import { element } from "./fragments.js";
import { short } from "./numbers.js";
import { once } from "./once.js";

const SMALL = 12; // from this many coordinates on cells are too small for numbers
const LOGARITHMIC = 6; // decades of the scale of colours

export class Ahead {
    /** path: of the tree in the interface; home(): a promise of its pose. */
    constructor(path, home) {
        this.place = document.getElementById("ahead");
        Object.assign(this, { path, home, programs: new Map(), latest: 0 });
    }

    /** M with a part on a frame, and what does not fit; nothing without a part. */
    async show({ substructure, name, at, placement }, home, differs) {
        const mine = ++this.latest;
        if (!home) return this.place.replaceChildren();
        const carried = `/v1/substructures/${encodeURIComponent(substructure)}`;
        const both = [[this.path, this.home], [carried, () => home]];
        const [host, part] = await Promise.all(both.map((each) => once(this.programs, each[0], () => joined(...each))));
        if (mine !== this.latest) return undefined; // something else was asked for meanwhile
        if (at !== "world" && !host.frames.includes(at)) return this.place.replaceChildren();
        const start = performance.now();
        const { size, all } = metric(host, part, at, placement);
        const took = (performance.now() - start).toFixed(2);
        const names = [...host.names, ...part.names.map((each) => `${name || "?"}.${each}`)];
        const isPlain = [...placement.position, ...placement.rpy].every((x) => typeof x === "number");
        const zero = isPlain ? "" : "; in it, expressions and numbers with units count as 0";
        const words = `Not stored yet: ${size} degrees of freedom, M at home, computed here in ${took} ms${zero}`;
        const warning = differs ? [element("p", { class: "warn small" }, differs)] : [];
        return this.place.replaceChildren(...warning, element("p", { class: "small" }, words), table(names, size, all));
    }
}

async function joined(address, home) {
    const [found, pose] = await Promise.all([joinable(address), home()]);
    found.program.vectors.q?.set(pose);
    return found;
}

function table(names, size, all) {
    const largest = Math.max(...all.map(Math.abs));
    const isSmall = size > SMALL;
    const heading = (scope) => (name, k) => element("th", { scope, title: name }, isSmall ? String(k + 1) : name);
    const cell = (x) => {
        const made = element("a", { title: String(x) }, isSmall ? "" : short(x));
        const share = x === 0 ? 0 : Math.max(0, 1 + Math.log10(Math.abs(x) / largest) / LOGARITHMIC);
        made.style.setProperty("--share", share.toFixed(3));
        made.classList.toggle("negative", x < 0);
        return element("td", {}, made);
    };
    const rows = names.map((name, k) => {
        const values = Array.from(all.subarray(k * size, (k + 1) * size));
        return element("tr", {}, heading("row")(name, k), ...values.map(cell));
    });
    const head = element("thead", {}, element("tr", {}, element("td"), ...names.map(heading("col"))));
    const made = element("table", { class: isSmall ? "grid small" : "grid" }, head, element("tbody", {}, ...rows));
    return element("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "M before it is stored" }, made);
}
