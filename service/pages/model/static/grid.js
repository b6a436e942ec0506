// The grid of a quantity: numbers and colours by |value|; links choose an entry, a slice, a quantity.
import { keep } from "./address.js";
import { element, fragment } from "./fragments.js";
import { short } from "./numbers.js";

const LOGARITHMIC = 6; // decades of the scale of colours

export class Grid {
    /** choose(entry) is called for an entry that was chosen. */
    constructor(path, program, choose) {
        this.path = path;
        this.program = program;
        this.latest = 0;
        this.read();
        document.querySelector(".formulas").addEventListener("click", (event) => {
            const link = event.target.closest("a");
            if (!link || event.ctrlKey || event.metaKey || event.shiftKey) return;
            const { tab, slice, entry } = link.dataset;
            if (tab === undefined && slice === undefined && entry === undefined) return;
            event.preventDefault();
            if (entry !== undefined) choose(entry);
            else this.show(tab ?? this.quantity, Number(slice ?? 0));
        });
        document.querySelector(".formulas").addEventListener("keydown", (event) => this.walk(event));
    }

    read() {
        const table = document.querySelector("#grid table");
        this.quantity = table?.dataset.quantity ?? "";
        this.cells = [...document.querySelectorAll("#grid a[data-at]")].map((cell) => [
            cell,
            Number(cell.dataset.at),
            cell.parentElement.classList.contains("zero"),
        ]);
        this.colours = [];
        this.isSmall = table?.classList.contains("small") ?? false;
    }

    async show(quantity, slice) {
        const mine = ++this.latest;
        const failed = (error) => element("p", { class: "warn", id: "grid" }, `This cannot be shown: ${error.message}`);
        const found = await fragment(`${this.path}/grid?tab=${quantity}&slice=${slice}`, "grid").catch(failed);
        if (mine !== this.latest) return; // something else was asked for meanwhile
        document.getElementById("grid").replaceWith(found);
        keep("tab", quantity);
        keep("slice", slice ? String(slice) : "");
        for (const link of document.querySelectorAll(".tabs a")) {
            if (link.dataset.tab === quantity) link.setAttribute("aria-current", "page");
            else link.removeAttribute("aria-current");
        }
        this.read();
        this.draw();
    }

    /** Numbers in the state that the program has. */
    draw() {
        if (!this.program.has(this.quantity)) return;
        const values = this.program.array(this.quantity);
        let largest = 0;
        for (const [, at] of this.cells) largest = Math.max(largest, Math.abs(values[at]));
        for (const [k, [cell, at, zero]] of this.cells.entries()) {
            if (zero) continue;
            const size = Math.abs(values[at]);
            const share = size > 0 ? Math.max(0, 1 + Math.log10(size / largest) / LOGARITHMIC) : 0;
            const colour = (values[at] < 0 ? "-" : "") + share.toFixed(3);
            if (colour !== this.colours[k]) {
                cell.style.setProperty("--share", share.toFixed(3));
                cell.classList.toggle("negative", values[at] < 0);
                this.colours[k] = colour; // most stay, and thousands of styles take their time
            }
            if (!this.isSmall) cell.textContent = short(values[at]);
        }
    }

    /** Arrow keys go from cell to cell. */
    walk(event) {
        const step = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0] }[event.key];
        const cell = event.target.closest("#grid td");
        if (!step || !cell) return;
        const row = cell.parentElement.parentElement.rows[cell.parentElement.rowIndex - 1 + step[0]];
        const next = row?.cells[cell.cellIndex + step[1]]?.querySelector("a");
        if (!next) return;
        event.preventDefault();
        next.focus();
    }
}
