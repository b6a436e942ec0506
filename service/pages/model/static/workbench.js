// The workbench: every step is a request of the interface and a new revision, whose page is shown then.
import "./keys.js";
import { Ahead } from "./ahead.js";
import { element, fragment } from "./fragments.js";
import { load } from "./program.js";
import { filled, request, texts } from "./steps.js";
import { ghost, sceneOf } from "./ghost.js";

const JSON_TYPE = { "Content-Type": "application/json" };
const REST = 120; // ms without a key
const told = document.getElementById("told");
const bench = JSON.parse(document.getElementById("place").dataset.bench);
const path = `/v1/trees/${bench.reference}`;
const given = new URL(location.href).searchParams;
const revision = Number(bench.reference.split("@")[1]);
const of = Number(given.get("of") ?? revision); // the revision that this one is like, after undo and redo
const top = Number(given.get("top") ?? of);
let [picked, waiting, view, ahead] = [document.querySelector("[data-pick]"), 0, null, null];

function tell(words, kind = "quiet") {
    told.replaceChildren(words);
    told.className = kind;
}

/** Takes a step, and shows what it made. */
async function step(method, address, body, more = "") {
    tell("deriving and proving ...");
    const answer = await fetch(address, { method, headers: JSON_TYPE, body });
    const found = await answer.json();
    const faults = (found.errors ?? []).map(({ pointer, message }) => `${pointer}: ${message}`);
    if (!answer.ok) throw new Error(faults.join("; ") || found.detail);
    if (answer.status === 202) location.assign(`/jobs/${found.id}`);
    else if (found.version) location.assign(`/substructures/${found.name}@${found.version}`);
    else location.assign(`/trees/${found.name}@${found.revision}/edit${more}`);
}

const tried = (work) => work.catch((error) => tell(error.message, "warn"));

/** Makes an earlier revision the newest one: its document is sent letter by letter. */
async function back(to) {
    const before = await fragment(`/trees/${bench.name}@${to}/edit`, "place");
    await step("POST", "/v1/trees", JSON.parse(before.dataset.bench).spec, `?of=${to}&top=${top}`);
}

const [undo, redo] = ["undo", "redo"].map((id) => document.getElementById(id));
if (undo) undo.hidden = of < 2;
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

/** Of a load only the fields of its type are there. */
function chosen(form) {
    for (const set of form.querySelectorAll("[data-type]")) {
        set.hidden = set.disabled = set.dataset.type !== form.elements.namedItem("type").value;
    }
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
        waiting = setTimeout(() => tried(rested(form)), REST);
    });
    form.addEventListener("submit", (event) => {
        event.preventDefault();
        const [method, address] = request(form);
        tried(step(method, `${path}/${address}`, JSON.stringify(filled(form))));
    });
}

function show(form) {
    for (const [name, text] of Object.entries(texts(location.origin, bench.reference, form))) {
        document.querySelector(`[data-request="${name}"]`).textContent = text;
    }
}

/** Parts whose names, titles or words are like what was typed. */
async function search(words) {
    const answer = await fetch(`/v1/substructures?${new URLSearchParams({ q: words, page_size: "12" })}`);
    if (!answer.ok) return;
    const { items } = await answer.json();
    const options = items.map(({ name, title, dof }) => element("option", { value: name, label: `${title}, ${dof} dof` }));
    document.getElementById("parts").replaceChildren(...options);
}

/** The part where it would be, and M of the whole, before it is stored. */
async function rested(form) {
    const coupling = filled(form);
    const { substructure, at, placement } = coupling;
    if (form.dataset.action !== "couplings") return;
    const found = () => [...document.getElementById("parts").options].some(({ value }) => value === substructure.split("@")[0]);
    if (substructure && !found()) await search(substructure);
    if (form.dataset.method) return;
    const part = found() && at ? await sceneOf(substructure) : null;
    view?.ghost(part && ghost(part, placement), at);
    await ahead?.show(coupling, part?.scene.poses.home);
}

async function start() {
    show(document.querySelector("[data-action]"));
    try {
        const [program] = await load(path);
        const scene = await (await fetch(`${path}/scene`)).json();
        ahead = new Ahead(path, scene.poses.home);
        const { View } = await import("./view.js");
        view = new View(document.getElementById("view"), scene);
        program.vectors.q?.set(scene.poses.home);
        view.pose(program);
        view.picks(pick);
    } catch {
        // the picture of the server stays
    }
    document.getElementById("place").dataset.view = view ? "3d" : "picture";
    tried(rested(document.querySelector("[data-action]"))); // a part that came with the address
}
start();
