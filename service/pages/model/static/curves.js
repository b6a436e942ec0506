// Lines over time in one picture, with a cursor; what is pointed at becomes the time.
const SVG = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [560, 150, 58, 8, 18, 18];
const COLOURS = 8;
const MOST = 700; // points of a line

function svg(name, attributes, text = "") {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.textContent = text;
    return made;
}

/** A picture of columns by name over times; at(t) is called for a time that was chosen. */
export class Curves {
    constructor(title, times, columns, format, at) {
        const [first, last] = [times[0], times[times.length - 1]];
        this.x = (t) => LEFT + ((WIDTH - LEFT - RIGHT) * (t - first)) / (last - first || 1);
        const every = Math.max(1, Math.ceil(times.length / MOST));
        const kept = times.map((_, k) => k).filter((k) => k % every === 0 || k === times.length - 1);
        const all = Object.values(columns).flat().filter(Number.isFinite);
        let [low, high] = all.reduce(([a, b], x) => [Math.min(a, x), Math.max(b, x)], [Infinity, -Infinity]);
        const least = 1e-6 * Math.max(Math.abs(high), Math.abs(low)) || 1; // what is smaller is rounding
        if (high - low < least) [low, high] = [low - least, high + least];
        const y = (value) => TOP + ((HEIGHT - TOP - BOTTOM) * (high - value)) / (high - low);
        const names = Object.keys(columns);
        this.element = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", class: "line" });
        this.element.append(
            svg("title", {}, `${title}: ${names.join(", ")}`),
            svg("line", { x1: LEFT, x2: WIDTH - RIGHT, y1: y(Math.min(high, Math.max(low, 0))), y2: y(Math.min(high, Math.max(low, 0))), class: "axis" }),
            svg("text", { x: LEFT - 4, y: TOP + 6, class: "end" }, format(high)),
            svg("text", { x: LEFT - 4, y: HEIGHT - BOTTOM, class: "end" }, format(low)),
            svg("text", { x: LEFT, y: HEIGHT - 4 }, `${format(first)} s`),
            svg("text", { x: WIDTH - RIGHT, y: HEIGHT - 4, class: "end" }, `${format(last)} s`),
        );
        let place = LEFT;
        names.forEach((name, k) => {
            const points = kept.map((i) => `${this.x(times[i]).toFixed(1)},${y(columns[name][i]).toFixed(1)}`).join(" ");
            const colour = `curve c${k % COLOURS}`;
            this.element.append(svg("polyline", { points, class: colour }));
            if (place < WIDTH - 90) this.element.append(svg("text", { x: place, y: 11, class: `key c${k % COLOURS}` }, name));
            place += 6.2 * name.length + 10;
        });
        this.cursor = svg("line", { x1: LEFT, x2: LEFT, y1: TOP, y2: HEIGHT - BOTTOM, class: "here" });
        this.element.append(this.cursor);
        this.element.addEventListener("pointerdown", (event) => {
            const { left, width } = this.element.getBoundingClientRect();
            const share = (((event.clientX - left) / width) * WIDTH - LEFT) / (WIDTH - LEFT - RIGHT);
            at(first + (last - first) * Math.min(1, Math.max(0, share)));
        });
    }

    mark(t) {
        this.cursor.setAttribute("x1", this.x(t));
        this.cursor.setAttribute("x2", this.x(t));
    }
}
