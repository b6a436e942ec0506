// The panel of one entry: its value and terms in the state of the page, copies, plots over coordinates.
import { element, fragment } from "./fragments.js";
import { short } from "./numbers.js";
import { line, map } from "./plot.js";
import { unpacked } from "./program.js";

export class Panel {
    /** state: vectors q, qd, u, p of the page; sliders: their ranges and names, and the chart that makes states of
     * them; lit(bodies) is told whose entry is shown. */
    constructor(path, state, { ranges, names, chart }, lit) {
        Object.assign(this, { path, state, ranges, names, chart, lit, over: [0, -1], latest: 0 });
        this.read();
    }

    async choose(entry) {
        const mine = ++this.latest;
        this.place.setAttribute("aria-busy", "true");
        const told = (error) => element("p", { class: "warn" }, `This entry cannot be shown: ${error.message}`);
        const failed = (error) => element("section", { id: "entry" }, told(error));
        const found = await fragment(`${this.path}/entry?entry=${entry}`, "entry").catch(failed);
        if (mine !== this.latest) return; // something else was asked for meanwhile
        this.place.replaceWith(found);
        for (const cell of document.querySelectorAll("#grid a")) {
            cell.classList.toggle("chosen", cell.dataset.entry === entry);
        }
        this.read();
        this.draw();
    }

    read() {
        const { dataset } = (this.place = document.getElementById("entry"));
        this.program = dataset.module ? unpacked(dataset.module, JSON.parse(dataset.layout)) : null;
        this.lit(dataset.bodies ? dataset.bodies.split(" ") : []);
        if (!this.program) return;
        this.quantity = [...this.program.functions.keys()][0];
        this.sign = Number(dataset.sign);
        for (const each of this.place.querySelectorAll("[data-copy]")) this.copying(each);
        this.choosers();
    }

    copying(details) {
        const button = element("button", { type: "button", class: "copy" }, "copy");
        button.addEventListener("click", async () => {
            await navigator.clipboard.writeText(details.querySelector("code").textContent);
            button.textContent = "copied";
        });
        details.append(button);
    }

    choosers() {
        const plots = document.getElementById("plots");
        const options = (none) => [
            ...(none ? [element("option", { value: -1 }, "no second coordinate")] : []),
            ...this.names.map((name, k) => element("option", { value: k }, name)),
        ];
        const selects = ["over", "and over"].map((word, k) => {
            const select = element("select", { "aria-label": `plotted ${word}` }, ...options(k === 1));
            select.value = String(Math.min(this.over[k], this.names.length - 1));
            select.addEventListener("change", () => {
                this.over[k] = Number(select.value);
                this.plot();
            });
            return select;
        });
        this.canvas = element("div", { class: "plot" });
        plots.replaceChildren(element("p", { class: "small" }, "plotted over ", selects[0], " and ", selects[1]), this.canvas);
    }

    results() {
        for (const [symbol, vector] of Object.entries(this.program.vectors)) vector.set(this.state[symbol]);
        return this.program.call(this.quantity, 0);
    }

    /** The value and the terms in the state of the page. */
    draw() {
        if (!this.program) return;
        const results = this.results();
        const scalar = Object.entries(results).find(([name]) => name !== "terms")[1][0];
        document.getElementById("value").textContent = String(this.sign * scalar);
        const terms = results.terms ?? [];
        const largest = terms.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
        terms.forEach((x, k) => {
            const [bar, told] = this.place.querySelectorAll(`[data-term="${k}"]`);
            if (!bar) return; // of a single term there is no list
            bar.style.setProperty("--share", largest > 0 ? String(Math.abs(x) / largest) : "0");
            bar.classList.toggle("negative", x < 0);
            told.textContent = short(x);
        });
        cancelAnimationFrame(this.waiting);
        this.waiting = requestAnimationFrame(() => this.plot());
    }

    plot() {
        const [first, second] = this.over;
        if (!this.program || !this.names.length) return;
        this.results();
        const { q } = this.program.vectors;
        if (!q) return this.canvas.replaceChildren("It is the same in every pose.");
        const output = Object.entries(this.program.call(this.quantity)).find(([name]) => name !== "terms")[1];
        const values = this.chart.values(this.state.q);
        const here = values[first];
        const value = (x, y) => {
            values[first] = x;
            if (second >= 0) values[second] = y;
            q.set(this.chart.state(values));
            this.program.call(this.quantity);
            return this.sign * output[0];
        };
        if (second < 0 || second === first) {
            this.canvas.replaceChildren(line((x) => value(x), this.ranges[first], here, short, this.canvas.clientWidth));
        } else {
            const [drawn, largest] = map(value, this.ranges[first], this.ranges[second]);
            const told = `${this.names[first]} to the right, ${this.names[second]} upwards; red up to ${short(largest)}, blue below 0`;
            this.canvas.replaceChildren(drawn, element("p", { class: "quiet small" }, told));
        }
    }
}
