// The workbench: every step is a request of the interface and a new revision, whose page is shown then.
import "./keys.js";
import { fragment } from "./fragments.js";
import { Placing } from "./placing.js";
import { reached } from "./reached.js";
import { filled, request, texts } from "./steps.js";

const JSON_TYPE = { "Content-Type": "application/json" };
const REST = 120; // ms without a key
const told = document.getElementById("told");
const bench = JSON.parse(document.getElementById("place").dataset.bench);
const path = `/v1/trees/${bench.reference}`;
const given = new URL(location.href).searchParams;
const revision = Number(bench.reference.split("@")[1]);
const of = Number(given.get("of") ?? revision); // the revision that this one is like, after undo and redo
const top = Number(given.get("top") ?? of);
let [picked, waiting, busy] = [document.querySelector("[data-pick]"), 0, false];

function tell(words, kind = "quiet") {
    told.replaceChildren(words);
    told.className = kind;
}

/** Takes a step, and shows what it made; what is pressed meanwhile is none, as a second click of two. */
async function step(...given) {
    if (busy) return;
    busy = true;
    await taken(...given).catch((error) => {
        busy = false;
        throw error;
    });
}

addEventListener("pageshow", () => (busy = false)); // the way back shows the page as it was left

async function taken(method, address, body, more = "") {
    tell("deriving and proving ...");
    const answer = await reached(address, { method, headers: JSON_TYPE, body });
    const found = await answer.json();
    const faults = (found.errors ?? []).map(({ pointer, message }) => `${pointer}: ${message}`);
    if (!answer.ok) throw new Error(faults.join("; ") || found.detail);
    if (answer.status === 202) location.assign(`/jobs/${found.id}`);
    else if (found.version) location.assign(`/substructures/${found.name}@${found.version}`);
    else location.assign(`/trees/${found.name}@${found.revision}/edit${more}`);
}

const placing = new Placing(path, bench.spec, document.querySelector("[data-action]"), (form) => show(form));
const tried = (work) => work.catch((error) => tell(error.message, "warn"));

/** Makes an earlier revision the newest one: its document is sent letter by letter. */
async function back(to) {
    const before = await fragment(`/trees/${bench.name}@${to}/edit`, "place");
    await step("POST", "/v1/trees", JSON.parse(before.dataset.bench).spec, `?of=${to}&top=${top}`);
}

const [undo, redo] = ["undo", "redo"].map((id) => document.getElementById(id));
if (undo) undo.hidden = of <= Number(undo.dataset.first);
redo.hidden = of >= top;
undo?.addEventListener("click", () => tried(back(of - 1)));
redo.addEventListener("click", () => tried(back(of + 1)));

/** A frame, picked in the outline or in the view, goes into the field that was used last. */
function pick(frame) {
    if (!picked) return;
    picked.closest("details").open = true;
    picked.value = picked.dataset.kind === "frames" && picked.value ? `${picked.value}, ${frame}` : frame;
    picked.dispatchEvent(new Event("input", { bubbles: true }));
    tell(`${picked.name}: ${frame}`);
    if (picked.dataset.kind === "frames") return;
    const fields = [...picked.form.querySelectorAll("[data-pick]:enabled")];
    picked = fields[(fields.indexOf(picked) + 1) % fields.length];
}

document.addEventListener("click", ({ target }) => {
    const { frame, remove, replace } = target.dataset;
    if (frame) pick(frame);
    if (remove) tried(step("DELETE", `${path}/${remove}`));
    if (replace) other(replace);
});

/** The form that gives an instance another part. */
function other(instance) {
    const form = document.querySelector("[data-method=PATCH]");
    form.closest("details").open = true;
    form.elements.namedItem("instance").value = instance;
    form.elements.namedItem("substructure").focus();
    show(form);
}

/** Of a load only the fields of its type are there, of parameters those of their instance. */
function chosen(form) {
    const { value } = form.elements.namedItem("type") ?? form.elements.namedItem("instance") ?? {};
    for (const set of form.querySelectorAll("[data-type]")) set.hidden = set.disabled = set.dataset.type !== value;
}

for (const form of document.querySelectorAll("[data-action]")) {
    form.addEventListener("focusin", ({ target }) => {
        if (target.dataset.pick) picked = target;
        show(form);
    });
    form.addEventListener("input", () => {
        chosen(form);
        show(form);
        clearTimeout(waiting);
        waiting = setTimeout(() => tried(placing.rested(form)), REST);
    });
    form.querySelector("[type=submit]").disabled = false;
    form.addEventListener("submit", (event) => {
        event.preventDefault();
        const [method, address] = request(form);
        tried(step(method, `${path}${address}`, JSON.stringify(filled(form))));
    });
}

function show(form) {
    for (const [name, text] of Object.entries(texts(location.origin, bench.reference, form))) {
        document.querySelector(`[data-request="${name}"]`).textContent = text;
    }
}

show(document.querySelector("[data-action]"));
tried(placing.start(pick));
