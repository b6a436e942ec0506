// The catalogue: results while one types, facets and order without loading the page anew; the address follows.
import { element, fragment } from "./fragments.js";
import "./importing.js";
import "./keys.js";

const REST = 120; // ms without a key
const form = document.getElementById("search");
const box = document.getElementById("filter");
let [waiting, latest] = [0, 0];

/** Puts the results of an address in the place of those that are shown. */
async function show(address, remember) {
    const mine = ++latest;
    const place = document.getElementById("results");
    place.setAttribute("aria-busy", "true");
    try {
        const found = await fragment(address, "results");
        if (mine !== latest) return; // something else was asked for meanwhile
        place.replaceWith(found);
        if (remember) history[remember](null, "", address);
    } catch (error) {
        place.removeAttribute("aria-busy");
        place.querySelector("[role=status]").replaceChildren(element("span", { class: "warn" }, `No results: ${error.message}.`));
    }
}

function asked() {
    const given = [...new FormData(form)].filter(([, value]) => value);
    return given.length ? `/?${new URLSearchParams(given)}` : "/";
}

form.addEventListener("input", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => show(asked(), "replaceState"), REST);
});
form.addEventListener("submit", (event) => {
    event.preventDefault();
    clearTimeout(waiting);
    show(asked(), "pushState");
});
document.addEventListener("click", (event) => {
    const chosen = event.target.closest?.(".facets a");
    if (!chosen || event.ctrlKey || event.metaKey || event.shiftKey || event.button) return;
    event.preventDefault();
    show(chosen.getAttribute("href"), "pushState");
});
addEventListener("popstate", () => {
    const given = new URL(location.href).searchParams;
    box.value = given.get("q") ?? "";
    form.elements.sort.value = given.get("sort") ?? "";
    show(location.pathname + location.search, "");
});
