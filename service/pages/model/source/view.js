// A mechanism in three dimensions, posed by positions and rotations; what there is to draw is the interface's scene.
import * as THREE from "three/src/Three.Core.js";
import { Camera } from "./camera.js";
import { Drawer } from "./drawer.js";
import { Shade } from "./shade.js";
import { Shapes, at } from "./shapes.js";

const SWITCHES = { links: true, joints: true, inertia: true, centres: false, frames: false, names: false };

function made(name, properties) {
    return Object.assign(document.createElement(name), properties);
}

export class View {
    /** scene: of the interface, what there is to draw; the view replaces what is in the place. */
    constructor(place, scene) {
        this.place = place;
        this.told = scene;
        const canvas = Object.assign(document.createElement("canvas"), { tabIndex: 0 });
        canvas.setAttribute("aria-label", "View; arrow keys turn it");
        this.drawer = new Drawer(canvas);
        this.camera = new Camera(canvas, () => this.draw());
        this.scene = new THREE.Scene();
        this.scene.add(new THREE.HemisphereLight(0xffffff, 0x666677, 2.6));
        this.headlight = new THREE.DirectionalLight(0xffffff, 1.2);
        this.groups = Object.fromEntries(Object.keys(SWITCHES).map((name) => [name, new THREE.Group()]));
        this.scene.add(this.headlight, ...Object.values(this.groups));
        this.shade = new Shade(this.scene, this.camera);
        this.size = 1;
        this.frames = scene.frames.map(() => new THREE.Matrix4());
        this.shapes = new Shapes(this.groups, scene);
        this.labels = scene.frames.map(({ name }) => made("span", { className: "label", textContent: name, hidden: true }));
        place.replaceChildren(canvas, this.switches(), ...this.labels);
        new ResizeObserver(() => this.resize()).observe(place);
    }

    switches() {
        const bar = made("div", { className: "switches" });
        for (const [name, on] of Object.entries(SWITCHES)) {
            const box = made("input", { type: "checkbox", checked: on });
            box.addEventListener("change", () => this.show(name, box.checked));
            const label = document.createElement("label");
            label.append(box, name);
            bar.append(label);
            this.groups[name].visible = on;
        }
        const box = made("input", { type: "checkbox" });
        box.addEventListener("change", () => (this.followed = box.checked));
        const follow = document.createElement("label");
        follow.append(box, "follow");
        const fit = made("button", { type: "button", textContent: "fit" });
        fit.addEventListener("click", () => this.fit());
        bar.append(follow, fit);
        return bar;
    }

    show(name, on) {
        this.groups[name].visible = on;
        if (name === "names") for (const label of this.labels) label.hidden = !on;
        this.draw();
    }

    /** Bodies of these names are shown in a colour of their own. */
    light(names) {
        this.shapes.light(names);
        this.draw();
    }

    /** Put everything where the program has it. */
    pose(program) {
        const [r, R] = [program.array("position"), program.array("rotation")];
        this.frames.forEach((frame, k) => {
            const [m, p] = [R.subarray(9 * k), r.subarray(3 * k)];
            frame.set(m[0], m[1], m[2], p[0], m[3], m[4], m[5], p[1], m[6], m[7], m[8], p[2], 0, 0, 0, 1);
        });
        if (!this.fitted) this.measure();
        const middle = this.frames.reduce((sum, _, frame) => sum.add(at(this.frames, { frame })), new THREE.Vector3());
        middle.divideScalar(this.frames.length);
        if (this.followed) this.camera.shift(middle.clone().sub(this.middle));
        this.middle = middle;
        this.shapes.place(this.frames, this.size);
        if (!this.fitted) this.fit();
        this.draw();
    }

    /** What is drawn lies within it. */
    box() {
        return this.shapes.box(this.frames);
    }

    measure(box = this.box()) {
        this.size = box.getSize(new THREE.Vector3()).length() || 1;
        return box;
    }

    fit(box) {
        this.camera.fit(this.measure(box), this.size);
        this.fitted = true;
        this.resize();
        this.camera.controls.update();
    }

    /** told(name) hears of the frame nearest to where somebody clicks, at most 30 pixels away. */
    picks(told) {
        const { canvas } = this.camera;
        let down = [0, 0];
        canvas.addEventListener("pointerdown", ({ clientX, clientY }) => (down = [clientX, clientY]));
        canvas.addEventListener("click", (event) => {
            if (Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return; // it was turned
            const near = this.camera.nearest(this.frames.map((_, frame) => at(this.frames, { frame })), event);
            if (near >= 0) told(this.told.frames[near].name);
        });
    }

    /** Lines between points of a frame, by its name or the world: a part before it is stored. None without lines. */
    ghost(lines, frame) {
        const k = this.told.frames.findIndex(({ name }) => name === frame);
        const known = lines && (k >= 0 || frame === "world");
        this.shade.show(known ? lines : null, k >= 0 ? this.frames[k] : new THREE.Matrix4());
        this.place.dataset.ghost = known ? frame : "";
        this.draw();
    }

    /** told([dx, dy, dz]) hears how far the ghost is dragged from where the drag began, in m along the axes of its
     * frame, in the plane that faces the camera; told(null) hears of the release. */
    drag(told) {
        this.shade.drag(told);
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.place;
        if (!width || !height) return;
        this.drawer.resize(width, height);
        this.camera.resize(width, height);
        this.draw();
    }

    draw() {
        if (!this.fitted) return;
        this.headlight.position.copy(this.camera.seen.position);
        this.drawer.draw(this.scene, this.camera.seen);
        if (!this.groups.names.visible) return;
        this.labels.forEach((label, frame) => {
            const [left, top] = this.camera.pixel(at(this.frames, { frame }));
            label.style.transform = `translate(${left.toFixed(0)}px, ${top.toFixed(0)}px)`;
        });
    }
}
