// An entry over one coordinate as a line, over two as a map.
import { svg } from "./svg.js";

const [WIDEST, HEIGHT, LEFT, BOTTOM] = [480, 160, 56, 20];
const POINTS = 240;
const CELLS = 64;

/** A line of value(x) over [low, high], with a mark at x = here; as wide as there is room, so that it is read. */
export function line(value, [low, high], here, format, room) {
    const width = Math.min(WIDEST, room);
    const xs = Array.from({ length: POINTS + 1 }, (_, k) => low + ((high - low) * k) / POINTS);
    const ys = xs.map(value);
    const finite = ys.filter(Number.isFinite);
    let [least, most] = [Math.min(...finite), Math.max(...finite)];
    if (!(most - least > 1e-12 * Math.max(Math.abs(most), Math.abs(least)))) [least, most] = [least - 1, most + 1];
    const x = (at) => LEFT + ((width - LEFT - 8) * (at - low)) / (high - low);
    const y = (at) => 8 + ((HEIGHT - BOTTOM - 8) * (most - at)) / (most - least);
    const points = xs.map((at, k) => `${x(at).toFixed(1)},${y(ys[k]).toFixed(1)}`).join(" ");
    const drawn = svg("svg", { viewBox: `0 0 ${width} ${HEIGHT}`, role: "img", "aria-label": "value over the coordinate", class: "line" });
    drawn.append(
        svg("line", { x1: LEFT, x2: width - 8, y1: y(Math.min(most, Math.max(least, 0))), y2: y(Math.min(most, Math.max(least, 0))), class: "axis" }),
        svg("line", { x1: x(here), x2: x(here), y1: 8, y2: HEIGHT - BOTTOM, class: "here" }),
        svg("polyline", { points, class: "curve" }),
        svg("circle", { cx: x(here), cy: y(value(here)), r: 3, class: "mark" }),
        svg("text", { x: LEFT - 4, y: 14, class: "end" }, format(most)),
        svg("text", { x: LEFT - 4, y: HEIGHT - BOTTOM, class: "end" }, format(least)),
        svg("text", { x: LEFT, y: HEIGHT - 4 }, format(low)),
        svg("text", { x: width - 8, y: HEIGHT - 4, class: "end" }, format(high)),
    );
    return drawn;
}

/** A map of value(x, y) over two intervals, blue below zero and red above. */
export function map(value, [left, right], [bottom, top]) {
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = CELLS;
    canvas.className = "map";
    const context = canvas.getContext("2d");
    const image = context.createImageData(CELLS, CELLS);
    const values = new Float64Array(CELLS * CELLS);
    let largest = 0;
    for (let i = 0; i < CELLS; i++) {
        for (let j = 0; j < CELLS; j++) {
            const x = left + ((right - left) * (j + 0.5)) / CELLS;
            const y = top - ((top - bottom) * (i + 0.5)) / CELLS;
            values[i * CELLS + j] = value(x, y);
            largest = Math.max(largest, Math.abs(values[i * CELLS + j]));
        }
    }
    values.forEach((v, k) => {
        const share = largest > 0 ? v / largest : 0;
        const [full, rest] = [255, Math.round(255 * (1 - Math.abs(share)))];
        image.data.set(share >= 0 ? [full, rest, rest, 255] : [rest, rest, full, 255], 4 * k);
    });
    context.putImageData(image, 0, 0);
    return [canvas, largest];
}
