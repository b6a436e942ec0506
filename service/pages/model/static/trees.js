// Begins a tree with one part on the world, and shows it in the workbench.
import "./keys.js";
import { reached } from "./reached.js";
import { number } from "./steps.js";

const form = document.getElementById("begin");
const told = document.getElementById("told");

let busy = false;
addEventListener("pageshow", () => (busy = false)); // the way back shows the page as it was left

async function begin() {
    const value = (name) => form.elements.namedItem(name).value.trim();
    const part = value("substructure");
    const instance = part.split("@")[0].replaceAll("-", "_");
    const body = {
        name: value("name"),
        gravity: value("gravity").split(",").map(number),
        instances: [{ name: /^[A-Za-z]/.test(instance) ? instance : `part_${instance}`, substructure: part }],
    };
    const headers = { "Content-Type": "application/json", "If-None-Match": "*" };
    const answer = await reached("/v1/trees", { method: "POST", headers, body: JSON.stringify(body) });
    const found = await answer.json();
    if (answer.status === 412) throw new Error(`there is a tree '${body.name}': choose another name`);
    const faults = (found.errors ?? []).map(({ pointer, message }) => `${pointer}: ${message}`);
    if (!answer.ok) throw new Error(faults.join("; ") || found.detail);
    location.assign(answer.status === 202 ? `/jobs/${found.id}` : `/trees/${found.name}@${found.revision}/edit`);
}

for (const button of form?.querySelectorAll("button") ?? []) button.disabled = false;
form?.addEventListener("submit", (event) => {
    event.preventDefault();
    if (busy) return; // the second click of two
    busy = true;
    told.className = "quiet";
    told.textContent = "deriving and proving ...";
    begin().catch((error) => {
        told.className = "warn";
        told.textContent = error.message;
        busy = false;
    });
});
