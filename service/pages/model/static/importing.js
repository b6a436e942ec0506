// A robot file: read, derived and drawn before anything of it is stored.
import { element } from "./fragments.js";
import { reached } from "./reached.js";

const headers = ({ name }) => ({ "Content-Type": /\.zip$/i.test(name) ? "application/zip" : "application/octet-stream" });
const place = document.getElementById("import");
const [input, cut] = ["file", "cut"].map((id) => document.getElementById(id));
let [file, latest] = [null, 0];

/** What tells of a work, as long as no later one has begun. */
function telling() {
    const mine = ++latest;
    return (...content) => mine === latest && place.replaceChildren(...content);
}

/** The answer of the interface for the file. */
async function sent(file, more) {
    const given = { file: file.name.slice(0, 200), ...(cut.value.trim() ? { cut: cut.value.trim() } : {}), ...more };
    const answer = await reached(`/v1/imports?${new URLSearchParams(given)}`, { method: "POST", headers: headers(file), body: file });
    const told = await answer.json();
    if (!answer.ok) throw Object.assign(new Error(told.detail), { faults: told.errors ?? [] });
    return [answer.status, told];
}

function refused({ message, faults = [] }) {
    const lines = faults.length ? faults.map((fault) => fault.message) : [message];
    return [element("p", { class: "warn" }, "This cannot be stored:"), element("ul", {}, ...lines.map((line) => element("li", {}, line)))];
}

function remarks(rows) {
    if (!rows.length) return element("p", {}, "Nothing was left out or changed.");
    const alike = Map.groupBy(rows, ({ level, element: what, message }) => [level, what, message].join("\n"));
    const lines = [...alike.values()].map(([{ place: where, level, message }, ...more]) =>
        element("tr", {}, ...[level, where + (more.length ? ` and ${more.length} more` : ""), message]
            .map((text) => element("td", {}, String(text)))));
    const heads = ["level", "place", "remark"].map((name) => element("th", { scope: "col" }, name));
    const table = element("table", {}, element("thead", {}, element("tr", {}, ...heads)), element("tbody", {}, ...lines));
    return element("div", { class: "scroll", tabindex: "0", role: "group", "aria-label": "Remarks" }, table);
}

/** What would be stored, with a button that stores it. */
async function preview(file, tell) {
    tell(element("p", { class: "quiet" }, `reading and deriving ${file.name} ...`));
    const [, told] = await sent(file, { preview: "true" });
    const { picture, dof, joints, mass, warnings } = told.preview;
    const drawn = URL.createObjectURL(new Blob([picture], { type: "image/svg+xml" }));
    const image = element("img", { src: drawn, alt: `Picture of ${file.name}`, width: "320", height: "240" });
    image.addEventListener("load", () => URL.revokeObjectURL(drawn));
    const name = element("input", { id: "name", value: (told.tree ?? told.definition).name, "aria-label": "Name", maxlength: "64" });
    const seen = element("select", { id: "visibility", "aria-label": "Who sees it" },
        element("option", { value: "public" }, "everybody sees it"), element("option", { value: "private" }, "only its owner"));
    const button = element("button", { type: "button", id: "store" }, "Store");
    const wrong = element("div", { role: "alert" });
    button.addEventListener("click", () => {
        button.disabled = true;
        store(file, name.value.trim(), seen.value, telling()).catch((error) => {
            button.disabled = false;
            wrong.replaceChildren(...refused(error));
        });
    });
    const size = `${told.kind}: ${dof} dof ${joints}${mass === null ? "" : `, ${Number(mass.toPrecision(4))} kg`}`;
    const words = warnings.map(({ message }) => element("li", { class: "warn" }, message));
    const about = element("div", {}, element("p", {}, size), element("ul", {}, ...words),
        element("p", {}, name, " ", seen, " ", button), wrong, element("p", { class: "quiet small" }, "Nothing is stored yet."));
    tell(element("div", { class: "split" }, element("div", { class: "picture" }, image), about), remarks(told.report));
}

async function store(file, name, visibility, tell) {
    const more = { ...(name ? { name } : {}), ...(visibility === "private" ? { visibility } : {}) };
    const [status, told] = await sent(file, { store: "true", ...more });
    if (status === 202) return tell(element("p", {}, "It became ", element("a", { href: `/jobs/${told.id}` }, "a job"), "."));
    const reference = `${told.stored.name}@${told.stored.version}`;
    const address = `${told.tree ? "/trees/" : "/substructures/"}${reference}`;
    return tell(element("p", {}, "Stored as ", element("a", { href: address }, reference), "."), remarks(told.report));
}

if (input) {
    const read = () => {
        const tell = telling();
        if (file) preview(file, tell).catch((error) => tell(...refused(error)));
    };
    const chosen = (files) => {
        file = files[0] ?? file;
        read();
    };
    input.addEventListener("click", () => { input.value = ""; }); // the same file, which was changed, is one, too
    input.addEventListener("change", () => chosen(input.files));
    cut.addEventListener("change", read);
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
        event.preventDefault();
        if (!event.dataTransfer.files.length) return;
        input.files = event.dataTransfer.files;
        place.scrollIntoView({ block: "center" });
        chosen(input.files);
    });
}
