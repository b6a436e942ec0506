// Lines over time in one picture that can be folded, with values at a cursor; what is pointed at becomes the time.
import { element } from "../fragments.js";
import { short } from "../numbers.js";
import { offer, picture } from "./saving.js";
import { svg } from "../svg.js";

const [HEIGHT, LEFT, RIGHT, BOTTOM, ROW] = [132, 58, 8, 18, 14];
const COLOURS = 8;
const KEYS = 12; // names in a picture
const LETTER = 6.4; // width of one

/** at(t) is called for a time that was chosen, zoom(from, to) for a span that was dragged over with Shift. */
export class Curves {
    constructor({ title, unit, columns, small }, times, [first, last], width, { at, zoom }) {
        Object.assign(this, { times, first, last, columns, width, names: Object.keys(columns) });
        this.seen = times.flatMap((t, k) => (t >= first && t <= last ? [k] : []));
        this.title = unit ? `${title} [${unit}]` : title;
        this.keys = [];
        const top = this.legend();
        this.svg = svg("svg", { viewBox: `0 0 ${width} ${top + HEIGHT}`, role: "img", class: "line" });
        this.svg.append(svg("title", {}, `${title} over time: ${this.names.join(", ")}`), ...this.axes(top), ...this.lines(top), ...this.keys);
        this.cursor = svg("line", { x1: LEFT, x2: LEFT, y1: top, y2: top + HEIGHT - BOTTOM, class: "here" });
        this.span = svg("rect", { y: top, width: 0, height: HEIGHT - BOTTOM, class: "span" });
        this.svg.append(this.span, this.cursor);
        this.follow(at, zoom);
        const save = element("button", { type: "button", class: "copy", "aria-label": `${title} as SVG` }, "SVG");
        save.addEventListener("click", () => offer(picture(this.svg), `${title.replaceAll(/\W+/g, "-")}.svg`));
        this.element = element("details", { class: "curves" }, element("summary", {}, this.title), this.svg, save);
        this.element.open = !small;
    }

    x(t) {
        return LEFT + ((this.width - LEFT - RIGHT) * (t - this.first)) / (this.last - this.first || 1);
    }

    follow(at, zoom) {
        let from = null;
        this.svg.addEventListener("pointerdown", (event) => {
            from = event.shiftKey ? this.pointed(event) : null;
            this.svg.setPointerCapture(event.pointerId);
            if (from === null) at(this.pointed(event));
        });
        this.svg.addEventListener("pointermove", (event) => {
            if (!event.buttons) return;
            const t = this.pointed(event);
            if (from === null) return at(t);
            const [low, high] = [this.x(Math.min(from, t)), this.x(Math.max(from, t))];
            this.span.setAttribute("x", low);
            this.span.setAttribute("width", high - low);
        });
        this.svg.addEventListener("pointerup", (event) => {
            this.span.setAttribute("width", 0);
            if (from !== null) zoom(from, this.pointed(event));
        });
    }

    pointed({ clientX }) {
        const { left, width } = this.svg.getBoundingClientRect();
        const share = (((clientX - left) / width) * this.width - LEFT) / (this.width - LEFT - RIGHT);
        return this.first + (this.last - this.first) * Math.min(1, Math.max(0, share));
    }

    /** Names in rows, with room for their values; the height that they take. */
    legend() {
        let [x, y] = [LEFT, 11];
        const shown = this.names.slice(0, KEYS);
        const texts = this.names.length > KEYS ? [...shown, `and ${this.names.length - KEYS} more`] : shown;
        texts.forEach((text, k) => {
            const wide = LETTER * (text.length + 9);
            if (x > LEFT && x + wide > this.width) [x, y] = [LEFT, y + ROW];
            this.keys.push(svg("text", { x, y, class: `key c${k % COLOURS}` }, text));
            x += wide;
        });
        return y + 5;
    }

    axes(top) {
        const all = Object.values(this.columns).flatMap((values) => this.seen.map((k) => values[k])).filter(Number.isFinite);
        let [low, high] = all.reduce(([a, b], x) => [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
        if (!all.length) [low, high] = [-1, 1];
        const least = 1e-6 * Math.max(Math.abs(high), Math.abs(low)) || 1; // what is smaller is rounding
        if (high - low < least) [low, high] = [low - least, high + least];
        this.y = (value) => top + ((HEIGHT - BOTTOM) * (high - value)) / (high - low);
        const [zero, end] = [this.y(Math.min(high, Math.max(low, 0))), this.width - RIGHT];
        return [
            svg("line", { x1: LEFT, x2: end, y1: zero, y2: zero, class: "axis" }),
            svg("text", { x: LEFT - 4, y: top + 8, class: "end" }, short(high)),
            svg("text", { x: LEFT - 4, y: top + HEIGHT - BOTTOM, class: "end" }, short(low)),
            svg("text", { x: LEFT, y: top + HEIGHT - 4 }, `${short(this.first)} s`),
            svg("text", { x: end, y: top + HEIGHT - 4, class: "end" }, `${short(this.last)} s`),
        ];
    }

    lines() {
        return this.names.map((name, k) => {
            const values = this.columns[name];
            const points = this.seen.filter((i) => Number.isFinite(values[i]))
                .map((i) => `${this.x(this.times[i]).toFixed(1)},${this.y(values[i]).toFixed(1)}`);
            return svg("polyline", { points: points.join(" "), class: `curve c${k % COLOURS} dash${Math.floor(k / COLOURS) % 3}` });
        });
    }

    /** The cursor at a time, whose index among the times is k, and the values there. */
    mark(t, k) {
        if (!this.element.open) return;
        const x = this.x(Math.min(this.last, Math.max(this.first, t))).toFixed(1);
        this.cursor.setAttribute("x1", x);
        this.cursor.setAttribute("x2", x);
        const shown = Math.min(KEYS, this.names.length);
        for (let i = 0; i < shown; i++) this.keys[i].textContent = `${this.names[i]} ${short(this.columns[this.names[i]][k])}`;
    }
}
