// Root locus: the eigenvalues of an equilibrium over a parameter, in the complex plane.
import { element } from "../fragments.js";
import { short } from "../numbers.js";
import { svg } from "../svg.js";
import { heard, post } from "./asked.js";
import { constants } from "./request.js";
import { offer, picture } from "./saving.js";

const [HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [300, 58, 12, 12, 30];
const get = (id) => document.getElementById(id);
const tell = (...content) => get("roots").replaceChildren(...content);

/** Lets eigenvalues be drawn over the parameter that is chosen; given(): where the equilibrium is near to. */
export function locus(path, given) {
    const form = get("locus");
    if (!form) return;
    const { parameter, from, to, count } = form.elements;
    const range = () => {
        const value = Number(parameter.selectedOptions[0].dataset.value || NaN);
        [from.value, to.value] = value ? [value / 2, 2 * value].map((x) => String(Number(x.toPrecision(3)))) : ["0", "1"];
    };
    parameter.addEventListener("change", range);
    range();
    form.addEventListener("submit", (event) => {
        event.preventDefault();
        const [low, high, n] = [from, to, count].map((input) => input.valueAsNumber);
        const values = Array.from({ length: n }, (_, k) => low + ((high - low) * k) / Math.max(1, n - 1));
        tell("computing ...");
        const unit = parameter.selectedOptions[0].dataset.unit;
        const told = (...job) => tell(heard(...job));
        post(`${path}/root-loci`, { parameter: parameter.value, values, q: given(), ...constants() }, { told })
            .then((found) => drawn(found, parameter.value, unit))
            .catch((error) => tell(element("p", { class: "warn" }, error.message)));
    });
}

function drawn({ values, eigenvalues, stability, message }, name, unit) {
    const notes = message ? [element("p", { class: "warn small" }, message)] : [];
    if (!values.length) return tell(...notes);
    const shown = plane(values, eigenvalues, `${name}`, unit, Math.min(560, Math.max(280, get("roots").clientWidth)));
    const save = element("button", { type: "button", class: "copy", "aria-label": "root locus as SVG" }, "SVG");
    save.addEventListener("click", () => offer(picture(shown), `root-locus-${name}.svg`));
    const changes = values.flatMap((value, k) => (k && stability[k] !== stability[k - 1] ? [`${stability[k]} from ${short(value)} on`] : []));
    const words = `${name} from ${short(values[0])} (cross) to ${short(values[values.length - 1])} (circle) ${unit}: ${[stability[0], ...changes].join("; ")}`;
    tell(...notes, element("p", { class: "small", id: "locus-told", role: "status" }, words), shown, save);
}

function plane(values, eigenvalues, name, unit, width) {
    const extents = [0, 1].map((k) => {
        const parts = [...eigenvalues.flat().map((each) => each[k]), 0];
        return [Math.min(...parts), Math.max(...parts)];
    });
    const most = Math.max(...extents.map(([low, high]) => high - low)) || 1;
    const [[left, right], [bottom, top]] = extents.map(([low, high]) => {
        const room = 0.08 * Math.max(high - low, most / 4);
        return [low - room, high + room];
    });
    const x = (re) => LEFT + ((width - LEFT - RIGHT) * (re - left)) / (right - left);
    const y = (im) => TOP + ((HEIGHT - TOP - BOTTOM) * (top - im)) / (top - bottom);
    const made = svg("svg", { viewBox: `0 0 ${width} ${HEIGHT}`, role: "img", class: "line" });
    made.append(
        svg("title", {}, `Eigenvalues over ${name}; to the left of the axis they die away`),
        svg("line", { x1: LEFT, x2: width - RIGHT, y1: y(0), y2: y(0), class: "axis" }),
        svg("line", { x1: x(0), x2: x(0), y1: TOP, y2: HEIGHT - BOTTOM, class: "here" }),
        svg("text", { x: LEFT - 4, y: TOP + 8, class: "end" }, short(top)),
        svg("text", { x: LEFT - 4, y: HEIGHT - BOTTOM, class: "end" }, short(bottom)),
        svg("text", { x: LEFT, y: HEIGHT - 14 }, short(left)),
        svg("text", { x: width - RIGHT, y: HEIGHT - 14, class: "end" }, short(right)),
        svg("text", { x: (LEFT + width) / 2, y: HEIGHT - 3, class: "middle" }, "real part [1/s]; upwards the imaginary part"),
        ...eigenvalues.flatMap((found, k) => found.map((each) => {
            const told = svg("title", {}, `${name} = ${short(values[k])} ${unit}: ${short(each[0])} ${each[1] < 0 ? "-" : "+"} ${short(Math.abs(each[1]))}i`);
            const point = mark(x(each[0]), y(each[1]), k / Math.max(1, values.length - 1));
            point.append(told);
            return point;
        })),
    );
    return made;
}

/** A cross where the parameter begins, a circle where it ends, between them points from blue to red. */
function mark(x, y, share) {
    const colour = `hsl(${(220 + 140 * share).toFixed(0)} 65% 50%)`;
    const at = [x, y].map((value) => value.toFixed(1));
    if (share === 0) return svg("path", { d: `M${at}m-4-4l8 8m0-8l-8 8`, stroke: colour, "stroke-width": 2, fill: "none" });
    if (share === 1) return svg("circle", { cx: at[0], cy: at[1], r: 4.5, stroke: colour, "stroke-width": 2, fill: "none" });
    return svg("circle", { cx: at[0], cy: at[1], r: 2.4, fill: colour });
}
