// A part where it would be, and M of the whole, while its place is typed, picked or dragged.
import { Ahead } from "./ahead.js";
import { plain } from "./coupled.js";
import { misfit } from "./fitting.js";
import { element } from "./fragments.js";
import { ghost, sceneOf } from "./ghost.js";
import { once } from "./once.js";
import { answered, load } from "./program.js";
import { reached } from "./reached.js";
import { filled } from "./steps.js";
import { drawn } from "./viewing.js";

export class Placing {
    /** path: of the tree in the interface; spec: its document; form: of couplings; changed(form) hears of a drag. */
    constructor(path, spec, form, changed) {
        Object.assign(this, { path, form, changed, view: null, latest: 0, kept: new Map() });
        this.ahead = new Ahead(path, async () => (await this.scene()).poses.home);
        this.instances = JSON.parse(spec).instances ?? [];
        this.parts = document.getElementById("parts");
    }

    /** The scene of the tree, asked for once more where it could not be had. */
    scene() {
        return once(this.kept, "scene", async () => (await answered(await reached(`${this.path}/scene`))).json());
    }

    /** Draws the tree, whose frames pick(name) hears of. */
    async start(pick) {
        try {
            const [program] = await load(this.path);
            const scene = await this.scene();
            this.view = await drawn(scene);
            program.vectors.q?.set(scene.poses.home);
            this.view.pose(program);
            this.view.picks(pick);
            this.drag();
        } catch {
            // the picture of the server stays
        }
        document.getElementById("place").dataset.view = this.view ? "3d" : "picture";
        await this.rested(this.form); // a part that came with the address
    }

    /** Parts whose names, titles or words are like what was typed. */
    async search(words) {
        const answer = await reached(`/v1/substructures?${new URLSearchParams({ q: words, page_size: "12" })}`);
        if (!answer.ok) return;
        const { items } = await answer.json();
        const options = items.map(({ name, title, dof }) => element("option", { value: name, label: `${title}, ${dof} dof` }));
        this.parts.replaceChildren(...options);
    }

    /** The part where it would be, and M of the whole, before it is stored. */
    async rested(form) {
        if (form.dataset.action !== "couplings") return;
        const mine = ++this.latest; // what was asked for before may be answered later
        const coupling = filled(form);
        const { substructure, at, placement } = coupling;
        const [wanted] = substructure?.split("@") ?? [""];
        const found = () => [...this.parts.options].some(({ value }) => value === wanted);
        if (wanted && !found()) await this.search(wanted);
        if (form.dataset.method) return;
        const part = substructure && found() && at ? await sceneOf(substructure) : null;
        const differs = part ? await misfit(this.instances, at, substructure) : "";
        if (mine !== this.latest) return;
        this.view?.ghost(part && ghost(part, placement), at);
        await this.ahead.show(coupling, part?.scene.poses.home, differs);
    }

    /** The part follows the pointer, its place in the fields and M with it. */
    drag() {
        const fields = ["x", "y", "z"].map((name) => this.form.elements.namedItem(name));
        const digits = Math.max(0, Math.ceil(-Math.log10(this.view.size / 1000))); // a thousandth of what is seen
        let from = null;
        this.view.drag((shift) => {
            from ??= plain(filled(this.form).placement.position);
            shift?.forEach((x, i) => (fields[i].value = String(Number((from[i] + x).toFixed(digits)))));
            if (!shift) from = null;
            this.changed(this.form);
            this.rested(this.form);
        });
    }
}
