// What is asked for on the page of motions: the fields of its form, and the same in the address.
import { pinned } from "../address.js";
import { changedParameters } from "../sliders.js";

const COUNT = 600; // times of a motion
const get = (id) => document.getElementById(id);
const fields = () => [...document.querySelectorAll("[data-input]")];
const rates = () => [...document.querySelectorAll("[data-rate]")];

/** The inputs that are given, by name. */
export function inputs() {
    return Object.fromEntries(fields()
        .filter(({ value }) => value.trim())
        .map(({ dataset, value }) => [dataset.input, value]));
}

/** Parameters, and the inputs that are numbers: about which is linearised. */
export function constants() {
    const numbers = Object.entries(inputs()).map(([name, value]) => [name, Number(value)]);
    const constant = Object.fromEntries(numbers.filter(([, value]) => Number.isFinite(value)));
    return { inputs: constant, parameters: changedParameters() };
}

/** The body of a request for the motion from a start. */
export function request([q, qd]) {
    const quantities = get("events").value.split(";").map((text) => text.trim()).filter(Boolean);
    const action = get("stop").checked ? "stop" : "record";
    const events = quantities.map((quantity, k) => ({ name: `event${k + 1}`, quantity, action }));
    const reactions = get("reactions").value ? [get("reactions").value] : false;
    const span = [0, get("span").valueAsNumber];
    return { q, qd, span, count: COUNT, inputs: inputs(), parameters: changedParameters(), events, reactions };
}

/** What happens at an event of the answer: the quantity that was asked for comes there, or what a contact does. */
export function happening({ events }, { name, kind }) {
    return kind ? `${name}: ${kind.replace("_", " ")}` : events[Number(name.slice(5)) - 1].quantity;
}

/** The address holds all of a motion, and the time that is shown. */
export function keep(t, body = null) {
    const address = pinned();
    address.searchParams.set("t", String(Number(t.toFixed(4))));
    if (body) {
        const { q, qd, span, inputs, reactions } = body; // parameters stand there already
        const kept = { inputs, reactions, span: span[1], events: get("events").value, stop: get("stop").checked };
        address.searchParams.set("pose", q.join(","));
        address.searchParams.set("qd", qd.join(","));
        address.searchParams.set("run", JSON.stringify(kept));
    }
    history.replaceState(null, "", address);
}

/** The time that the address holds; null where it holds none. */
export function time() {
    const t = Number(new URL(location.href).searchParams.get("t") ?? NaN);
    return Number.isFinite(t) ? t : null;
}

/** Fills the fields by the address. */
export function restore() {
    const kept = new URL(location.href).searchParams.get("run");
    if (!kept) return;
    try {
        fill(JSON.parse(kept));
    } catch {
        // an address that was cut off: the fields stay as they are
    }
}

function fill({ span, qd, inputs: values, events, stop, reactions }) {
    if (span) get("span").value = String(span);
    for (const [k, input] of rates().entries()) if (Number.isFinite(qd?.[k])) input.value = String(qd[k]);
    for (const input of fields()) input.value = values?.[input.dataset.input] ?? "";
    get("events").value = events ?? "";
    get("stop").checked = Boolean(stop);
    get("reactions").value = reactions?.[0] ?? "";
    get("more").open = Boolean(events || reactions || Object.keys(values ?? {}).length);
}
