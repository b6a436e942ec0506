// All plots of a motion, over one span of time: the whole, or what is chosen by a button or by dragging with Shift.
import { element } from "../fragments.js";
import { Curves } from "./curves.js";
import { index } from "./trajectory.js";

const LEAST = 8; // times in a span

export class Plots {
    /** choose(t) is called for a time that was pointed at. */
    constructor(place, choose) {
        Object.assign(this, { place, choose, curves: [], now: 0 });
        this.closer = element("button", { type: "button", class: "copy", title: "half of the time, about the cursor" }, "zoom in");
        this.all = element("button", { type: "button", class: "copy" }, "all");
        const told = element("span", { class: "quiet" }, " or drag with Shift");
        this.bar = element("p", { class: "small bar" }, this.closer, this.all, told);
        this.closer.addEventListener("click", () => this.half());
        this.all.addEventListener("click", () => this.within([this.times[0], this.times[this.times.length - 1]]));
    }

    clear() {
        this.curves = [];
        this.place.replaceChildren();
    }

    /** Groups of columns over times; head: what stands above them. */
    show(groups, times, head) {
        Object.assign(this, { groups, times, head, folded: new Map() });
        this.within([times[0], times[times.length - 1]]);
    }

    within(span) {
        for (const { title, element: drawn } of this.curves) this.folded.set(title, !drawn.open);
        this.span = span;
        const width = Math.min(560, Math.max(280, this.place.clientWidth));
        const events = { at: this.choose, zoom: (from, to) => this.between(from, to) };
        this.curves = this.groups.map((group) => new Curves(group, this.times, span, width, events));
        for (const each of this.curves) if (this.folded.has(each.title)) each.element.open = !this.folded.get(each.title);
        this.all.hidden = span[0] <= this.times[0] && span[1] >= this.times[this.times.length - 1];
        this.place.replaceChildren(this.head, this.bar, ...this.curves.map((each) => each.element));
        this.mark(this.now);
    }

    /** Spans that hold too few times to be drawn stay as they are. */
    between(from, to) {
        const [low, high] = [Math.min(from, to), Math.max(from, to)];
        if (index(this.times, high) - index(this.times, low) >= LEAST) this.within([low, high]);
    }

    half() {
        const length = (this.span[1] - this.span[0]) / 2;
        const from = Math.min(this.span[1] - length, Math.max(this.span[0], this.now - length / 2));
        this.between(from, from + length);
    }

    /** The cursor at a time. */
    mark(t) {
        this.now = t;
        const k = index(this.times, t);
        for (const each of this.curves) each.mark(t, k);
    }
}
