// Whether a motion is right: what was checked, how far it is off, and why it has to hold.
import { element } from "../fragments.js";
import { short } from "../numbers.js";

/** The sentence, and whether it is a good one, without warnings. */
export function verdict({ is_right: right, status, message, warnings }) {
    const words = right === null ? "not judged" : right ? "right" : "not right";
    const more = [message, ...(warnings ?? []).map((each) => each.message ?? each)].filter(Boolean);
    return [[`${status}, ${words}`, ...more].join("; "), right && !warnings?.length ? "right" : "warn"];
}

/** All checks as a table that is folded where all hold. */
export function table({ checks, series }) {
    const held = checks.filter(({ holds }) => holds).length;
    const cell = (...children) => element("td", {}, ...children);
    const rows = checks.map(({ name, reason, unit, worst, relative, limit, holds, time }) => {
        const first = series[name]?.[0];
        const told = holds ? "holds" : `fails${time === null ? "" : ` at ${short(time)} s`}`;
        const why = element("th", { scope: "row", title: reason }, name);
        const plain = unit === "1" ? "" : ` ${unit}`;
        return element("tr", {}, why, cell(Number.isFinite(first) ? `${short(first)}${plain}` : ""), cell(`${short(worst)}${plain}`),
            cell(short(relative)), cell(short(limit)), element("td", { class: holds ? "right" : "warn" }, told));
    });
    const heads = ["", "at first", "drift", "relative", "at most", "verdict"].map((text) => element(text ? "th" : "td", {}, text));
    const body = element("table", {}, element("thead", {}, element("tr", {}, ...heads)), element("tbody", {}, ...rows));
    const reasons = checks.map(({ name, reason }) => element("li", {}, `${name}: ${reason}`));
    const words = `${held} of ${checks.length} checks hold: integrals, balances, steps`;
    const made = element("details", { class: "checks" }, element("summary", {}, words),
        element("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Checks" }, body),
        element("ul", { class: "plain small quiet" }, ...reasons));
    made.open = held < checks.length;
    return made;
}
