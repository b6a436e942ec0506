// A mechanism in three dimensions: links, joints, ellipsoids of inertia, frames; posed by positions and rotations.
import * as THREE from "three/src/Three.Core.js";
import { WebGLRenderer } from "three/src/renderers/WebGLRenderer.js";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const COLOURS = ["#2a78ad", "#c7663a", "#4a9149", "#8f5bad", "#a8862c", "#6b7884"];
const SWITCHES = { links: true, joints: true, inertia: true, centres: false, frames: false, names: false };
const Y = new THREE.Vector3(0, 1, 0);

const BALLS = ["spherical", "universal"];

/** Of every frame the colour of its instance, or where there is only one, of its body. */
function colours(frames) {
    const instances = [...new Set(frames.map(({ instance }) => instance))];
    if (instances.length > 1) return frames.map(({ instance }) => instances.indexOf(instance));
    const bodies = frames.flatMap(({ kind }, k) => (kind === "body" ? [k] : []));
    return frames.map(({ kind, parent }, k) => Math.max(0, bodies.indexOf(kind === "port" ? parent : k)));
}

/** Of the ellipsoid of even density with a body's mass and moments: a = sqrt(5 s / m), s = (J1 + J2 + J3)/2 - J. */
function halfAxes({ mass, moments }) {
    const half = moments.reduce((sum, J) => sum + J, 0) / 2;
    return moments.map((J) => (mass > 0 ? Math.sqrt((5 * Math.max(half - J, 0)) / mass) : 0));
}

export class View {
    /** scene: of the interface, what there is to draw; the view replaces what is in the place. */
    constructor(place, scene) {
        this.place = place;
        this.told = scene;
        this.renderer = new WebGLRenderer({ antialias: true, alpha: true });
        this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        this.camera = new THREE.PerspectiveCamera(35, 1, 0.001, 1e4);
        this.camera.up.set(0, 0, 1);
        this.scene = new THREE.Scene();
        this.scene.add(new THREE.HemisphereLight(0xffffff, 0x666677, 2.6));
        this.headlight = new THREE.DirectionalLight(0xffffff, 1.2);
        this.scene.add(this.headlight);
        this.size = 1;
        this.groups = Object.fromEntries(Object.keys(SWITCHES).map((name) => [name, new THREE.Group()]));
        this.scene.add(...Object.values(this.groups));
        this.frames = scene.frames.map(() => new THREE.Matrix4());
        this.controls = new OrbitControls(this.camera, this.renderer.domElement);
        this.controls.addEventListener("change", () => this.draw());
        this.renderer.domElement.setAttribute("aria-label", "View; arrow keys turn it");
        this.renderer.domElement.tabIndex = 0;
        this.renderer.domElement.addEventListener("keydown", (event) => this.turn(event));
        place.replaceChildren(this.renderer.domElement, this.switches());
        new ResizeObserver(() => this.resize()).observe(place);
        this.build();
    }

    switches() {
        const bar = document.createElement("div");
        bar.className = "switches";
        for (const [name, on] of Object.entries(SWITCHES)) {
            const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: on });
            box.addEventListener("change", () => this.show(name, box.checked));
            const label = document.createElement("label");
            label.append(box, name);
            bar.append(label);
            this.groups[name].visible = on;
        }
        const fit = Object.assign(document.createElement("button"), { type: "button", textContent: "fit" });
        fit.addEventListener("click", () => this.fit());
        bar.append(fit);
        return bar;
    }

    show(name, on) {
        this.groups[name].visible = on;
        if (name === "names") for (const label of this.labels) label.hidden = !on;
        this.draw();
    }

    build() {
        const colour = (k) => COLOURS[k % COLOURS.length];
        const solid = (k, more = {}) => new THREE.MeshStandardMaterial({ color: colour(k), roughness: 0.6, ...more });
        const rod = new THREE.CylinderGeometry(1, 1, 1, 16);
        const add = (group, geometry, material, more) => {
            const mesh = Object.assign(new THREE.Mesh(geometry, material), { userData: more });
            mesh.matrixAutoUpdate = false;
            this.groups[group].add(mesh);
            return mesh;
        };
        const { frames, joints, bodies } = this.told;
        const owner = colours(frames);
        const ball = new THREE.SphereGeometry(1, 24, 16);
        const loose = new Set(joints.filter(({ type }) => type === "free").map(({ frame }) => frame));
        const linked = frames.map(({ parent }, k) => [parent, k]).filter(([parent, k]) => parent >= 0 && !loose.has(k));
        const end = (frame, at = [0, 0, 0]) => ({ frame, at });
        this.links = linked.map(([a, b]) => add("links", rod, solid(owner[b]), { a: end(a), b: end(b) }));
        this.links.push(...bodies.map(({ frame, centre }) => add("links", rod, solid(owner[frame]), { a: end(frame), b: end(frame, centre) })));
        const pairs = [...this.told.loads.filter((load) => load.is_elastic), ...this.told.closures]
            .flatMap(({ ends }) => ends.slice(1).map((b, k) => ({ a: ends[k], b, thin: true })));
        this.springs = pairs.map((pair) => add("links", rod, solid(5), pair));
        const shape = ({ type, slides }) => (slides ? new THREE.BoxGeometry(1, 1, 1) : BALLS.includes(type) ? ball : rod);
        this.joints = joints.filter(({ frame }) => !loose.has(frame)).map((joint) => add("joints", shape(joint), solid(5), joint));
        const clear = { transparent: true, opacity: 0.5, depthWrite: false };
        this.bodies = bodies.map((body) => add("inertia", ball, solid(owner[body.frame], clear), { ...body, half: halfAxes(body) }));
        this.centres = bodies.map((body) => add("centres", ball, solid(1), body));
        this.triads = this.frames.map(() => {
            const triad = new THREE.AxesHelper(1);
            triad.matrixAutoUpdate = false;
            this.groups.frames.add(triad);
            return triad;
        });
        this.labels = frames.map(({ name }) => {
            const label = Object.assign(document.createElement("span"), { className: "label", textContent: name, hidden: true });
            this.place.append(label);
            return label;
        });
        this.lit = new Set();
    }

    /** Bodies of these names are shown in a colour of their own. */
    light(names) {
        this.lit = new Set(names.filter(Boolean));
        for (const mesh of this.bodies) {
            const on = this.lit.has(mesh.userData.name);
            mesh.material.opacity = this.lit.size === 0 ? 0.5 : on ? 0.8 : 0.1;
            mesh.material.emissive.set(on ? "#b35900" : "#000000");
        }
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
        const width = this.size / 130;
        for (const mesh of [...this.links, ...this.springs]) this.between(mesh, mesh.userData.thin ? width / 3 : width);
        for (const mesh of this.joints) this.joint(mesh, width);
        for (const mesh of this.bodies) this.body(mesh);
        for (const mesh of this.centres) this.centre(mesh, width);
        this.triads.forEach((triad, k) => triad.matrix.copy(this.frames[k]).scale(new THREE.Vector3().setScalar(this.size / 12)));
        if (!this.fitted) this.fit();
        this.draw();
    }

    at({ frame, at }) {
        const point = new THREE.Vector3(...at);
        return frame < 0 ? point : point.applyMatrix4(this.frames[frame]);
    }

    between(mesh, width) {
        const [a, b] = [this.at(mesh.userData.a), this.at(mesh.userData.b)];
        const axis = b.clone().sub(a);
        const length = axis.length();
        mesh.visible = length > 1e-9;
        const turn = new THREE.Quaternion().setFromUnitVectors(Y, axis.normalize());
        mesh.matrix.compose(a.add(b).multiplyScalar(0.5), turn, new THREE.Vector3(width, length, width));
    }

    joint(mesh, width) {
        const { frame, axis, slides } = mesh.userData;
        const turn = new THREE.Quaternion().setFromUnitVectors(Y, new THREE.Vector3(...axis).normalize());
        const size = slides ? [3 * width, 5 * width, 3 * width] : [2.2 * width, 4.5 * width, 2.2 * width];
        mesh.matrix.compose(new THREE.Vector3(), turn, new THREE.Vector3(...size)).premultiply(this.frames[frame]);
    }

    body(mesh) {
        const { frame, centre, half, axes: d } = mesh.userData;
        const least = this.size / (Math.max(...half) > 0 ? 200 : 50); // a point mass is seen, too
        const [a, b, c] = half.map((x) => Math.max(x, least));
        mesh.matrix.set(d[0][0] * a, d[0][1] * b, d[0][2] * c, centre[0], d[1][0] * a, d[1][1] * b, d[1][2] * c, centre[1],
            d[2][0] * a, d[2][1] * b, d[2][2] * c, centre[2], 0, 0, 0, 1);
        mesh.matrix.premultiply(this.frames[frame]);
    }

    centre(mesh, width) {
        const { frame, centre } = mesh.userData;
        mesh.matrix.makeScale(width, width, width).setPosition(...centre).premultiply(this.frames[frame]);
    }

    measure() {
        const box = new THREE.Box3();
        this.frames.forEach((_, k) => box.expandByPoint(this.at({ frame: k, at: [0, 0, 0] })));
        for (const { userData: { frame, centre, half } } of this.bodies) {
            const middle = this.at({ frame, at: centre });
            box.expandByPoint(middle.clone().addScalar(Math.max(...half))).expandByPoint(middle.addScalar(-Math.max(...half)));
        }
        this.size = box.getSize(new THREE.Vector3()).length() || 1;
        this.middle = box.getCenter(new THREE.Vector3());
    }

    fit() {
        this.measure();
        this.fitted = true;
        const distance = (0.5 * this.size) / Math.tan((this.camera.fov * Math.PI) / 360);
        const direction = new THREE.Vector3(1, -1.4, 0.8).normalize();
        this.camera.position.copy(this.middle).addScaledVector(direction, distance);
        this.camera.near = distance / 100;
        this.camera.far = distance * 100;
        this.controls.target.copy(this.middle);
        this.resize();
        this.controls.update();
    }

    turn(event) {
        const step = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
        if (!step) return;
        event.preventDefault();
        const away = this.camera.position.clone().sub(this.controls.target);
        const round = new THREE.Spherical().setFromVector3(new THREE.Vector3(away.x, away.z, -away.y));
        round.theta += step[0];
        round.phi = Math.min(Math.PI - 0.05, Math.max(0.05, round.phi + step[1]));
        const made = new THREE.Vector3().setFromSpherical(round);
        this.camera.position.copy(this.controls.target).add(new THREE.Vector3(made.x, -made.z, made.y));
        this.controls.update();
    }

    /** told(name) hears of the frame nearest to where somebody clicks, at most 30 pixels away. */
    picks(told) {
        let down = [0, 0];
        const { domElement } = this.renderer;
        domElement.addEventListener("pointerdown", ({ clientX, clientY }) => (down = [clientX, clientY]));
        domElement.addEventListener("click", ({ clientX, clientY, offsetX, offsetY }) => {
            if (Math.hypot(clientX - down[0], clientY - down[1]) > 4) return; // it was turned
            const away = this.frames.map((_, k) => Math.hypot(...this.pixel(k).map((x, i) => x - [offsetX, offsetY][i])));
            const near = away.indexOf(Math.min(...away));
            if (away[near] < 30) told(this.told.frames[near].name);
        });
    }

    pixel(k) {
        const { x, y } = this.at({ frame: k, at: [0, 0, 0] }).project(this.camera);
        return [((x + 1) * this.place.clientWidth) / 2, ((1 - y) * this.place.clientHeight) / 2];
    }

    /** Lines between points of a frame, by its name or the world: a part before it is stored. None without lines. */
    ghost(lines, frame) {
        if (this.shade) this.scene.remove(this.shade);
        this.shade = null;
        const k = this.told.frames.findIndex(({ name }) => name === frame);
        if (lines && (k >= 0 || frame === "world")) {
            const geometry = new THREE.BufferGeometry().setFromPoints(lines.flat().map((p) => new THREE.Vector3(...p)));
            this.shade = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: "#d9480f" }));
            this.shade.matrixAutoUpdate = false;
            if (k >= 0) this.shade.matrix.copy(this.frames[k]);
            this.scene.add(this.shade);
        }
        this.place.dataset.ghost = this.shade ? frame : "";
        this.draw();
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.place;
        if (!width || !height) return;
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.draw();
    }

    draw() {
        if (!this.fitted) return;
        this.headlight.position.copy(this.camera.position);
        this.renderer.render(this.scene, this.camera);
        if (!this.groups.names.visible) return;
        this.labels.forEach((label, k) => {
            const [left, top] = this.pixel(k);
            label.style.transform = `translate(${left.toFixed(0)}px, ${top.toFixed(0)}px)`;
        });
    }
}
