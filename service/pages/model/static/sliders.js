// Sliders and parameters: what the user changes becomes the state of the page, and its address.
import { keep, kept, pinned } from "./address.js";

export class Sliders {
    /** chart: what sliders are of states; changed() is called when a value has changed, rested() when none has for a
     * while. */
    constructor(state, ranges, chart, changed, rested) {
        Object.assign(this, { state, ranges, chart, changed, rested });
        this.form = document.getElementById("sliders");
        this.ranged = [...this.form.querySelectorAll("[data-q]")];
        this.numbers = [...this.form.querySelectorAll("[data-number]")];
        this.rates = [...this.form.querySelectorAll("[data-rate]")];
        this.values = this.numbers.map((input) => Number(input.value));
        state.q.set(chart.state(this.values));
        this.form.addEventListener("input", (event) => this.moved(event.target));
        this.form.addEventListener("submit", (event) => event.preventDefault());
        document.getElementById("send").hidden = true;
        this.random = document.getElementById("random");
        this.random.hidden = false;
        this.random.addEventListener("click", () => this.set(chart.state(ranges.map(([low, high]) => low + (high - low) * Math.random()))));
    }

    /** A button for every pose of the definitions. */
    offer(poses) {
        for (const [name, pose] of Object.entries(poses)) {
            const button = Object.assign(document.createElement("button"), { type: "button", textContent: name });
            button.dataset.pose = name;
            button.addEventListener("click", () => this.set(pose));
            this.random.before(button);
        }
    }

    /** Rates, of which those that are no numbers stay as they are. */
    move(qd) {
        for (const [k, input] of this.rates.entries()) {
            if (!Number.isFinite(qd[k])) continue;
            input.value = String(qd[k]);
            this.state.qd[k] = qd[k];
        }
    }

    /** The state and the rates that the fields show. */
    given() {
        const [values, qd] = [this.numbers, this.rates].map((inputs) => inputs.map(({ valueAsNumber: x }) => (Number.isFinite(x) ? x : 0)));
        return [this.chart.state(values), qd];
    }

    moved(input) {
        const { q, number, rate } = input.dataset;
        const value = input.valueAsNumber;
        if (!Number.isFinite(value) || !input.validity.valid) return;
        if (rate !== undefined) this.state.qd[Number(rate)] = value;
        const k = Number(q ?? number);
        if (rate === undefined) {
            this.values[k] = value;
            this.state.q.set(this.chart.state(this.values));
            if (q === undefined) this.ranged[k].value = String(value);
            else this.numbers[k].value = input.value;
        }
        this.tell();
    }

    /** keeps: whether the address holds the pose, which somebody has chosen. */
    set(pose, keeps = true) {
        this.chart.values(pose).forEach((value, k) => {
            this.ranged[k].value = String(value);
            this.numbers[k].value = String(Number(value.toPrecision(6)));
            this.values[k] = Number(this.numbers[k].value);
        });
        this.state.q.set(this.chart.state(this.values));
        this.tell(keeps);
    }

    tell(keeps = true) {
        this.changed();
        clearTimeout(this.waiting);
        const [pose, qd] = [this.state.q, this.state.qd].map((values) => values.join(","));
        this.waiting = setTimeout(() => {
            if (keeps) {
                const address = pinned();
                address.searchParams.delete("q");
                address.searchParams.set("pose", pose);
                history.replaceState(null, "", address);
                keep("qd", /[1-9]/.test(qd) ? qd : "");
            }
            this.rested();
        }, 150);
    }
}

/** The table of parameters: those that differ from their defaults come first, and stand in the address. */
export function parameters(state, changed) {
    const body = document.getElementById("parameters");
    if (!body) return;
    const rows = [...body.rows];
    const all = document.getElementById("reset");
    const inputs = rows.map((row) => row.querySelector("[data-p]"));
    const update = () => {
        for (const input of inputs) if (!Number.isFinite(input.valueAsNumber)) reset(input); // empty is the default
        const differ = inputs.map((input) => input.value !== input.defaultValue);
        inputs.forEach((input, k) => {
            state.p[k] = input.valueAsNumber;
            rows[k].querySelector("[data-reset]").hidden = !differ[k];
        });
        body.append(...rows.filter((_, k) => differ[k]), ...rows.filter((_, k) => !differ[k]));
        const count = differ.filter(Boolean).length;
        all.hidden = count === 0;
        document.getElementById("changed").textContent = count ? `${count} changed` : "";
        keep("set", inputs.filter((_, k) => differ[k]).map((input) => `${input.ariaLabel}:${input.value}`).join(","));
        changed();
    };
    const reset = (input) => (input.value = input.defaultValue);
    const given = new Map(kept("set").split(",").map((text) => text.split(":")));
    const set = inputs.filter((input) => given.has(input.ariaLabel));
    for (const input of set) input.value = given.get(input.ariaLabel);
    if (set.length) update();
    body.addEventListener("change", update);
    body.addEventListener("click", ({ target }) => {
        if (target.dataset.reset === undefined) return;
        reset(inputs[Number(target.dataset.reset)]);
        update();
    });
    all.addEventListener("click", () => {
        inputs.forEach(reset);
        update();
    });
}

/** The parameters that differ from their defaults, by name. */
export function changedParameters() {
    const inputs = [...document.querySelectorAll("[data-p]")].filter((input) => input.value !== input.defaultValue);
    return Object.fromEntries(inputs.map((input) => [input.ariaLabel, input.valueAsNumber]));
}
