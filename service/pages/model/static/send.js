// Sends requests of the page of the interface by the session, and shows what is answered, as text.
import { element } from "./fragments.js";
import "./keys.js";
import { reached } from "./reached.js";

const MOST = 20_000; // characters that are shown

async function sent(form) {
    const { method } = form.dataset;
    const field = (name) => form.elements.namedItem(name)?.value;
    const path = field("path").trim();
    if (!path.startsWith("/v1/")) throw new Error("a path of this server that begins with /v1/ is needed");
    const body = field("body");
    const headers = body === undefined ? {} : { "Content-Type": "application/json" };
    const start = performance.now();
    const answer = await reached(path, { method, headers, body });
    const type = answer.headers.get("content-type") ?? "";
    const content = await answer.arrayBuffer();
    const took = (performance.now() - start).toFixed(0);
    const head = `${answer.status} ${type.split(";")[0]}, ${content.byteLength.toLocaleString("en")} bytes, ${took} ms`;
    return [head, shown(type, content)];
}

/** Text of an answer, JSON over several lines; nothing of what is no text. */
function shown(type, content) {
    if (!/json|text|xml|javascript/.test(type)) return "";
    const text = new TextDecoder().decode(content);
    const whole = /json/.test(type) && text.length < 50 * MOST ? JSON.stringify(JSON.parse(text), null, 2) : text;
    return whole.length > MOST ? `${whole.slice(0, MOST)}\n... ${(whole.length - MOST).toLocaleString("en")} characters more` : whole;
}

document.addEventListener("submit", (event) => {
    const form = event.target.closest("form.send");
    if (!form) return;
    event.preventDefault();
    const place = form.parentElement.querySelector(".answer");
    place.replaceChildren(element("p", { class: "quiet small" }, "waiting ..."));
    sent(form).then(
        ([head, text]) => place.replaceChildren(element("p", { class: "small" }, head),
            ...(text ? [element("pre", { tabindex: "0" }, element("code", {}, text))] : [])),
        (error) => place.replaceChildren(element("p", { class: "warn" }, error.message)),
    );
});
