// The shade of a part that is not there yet: lines in a frame, which can be dragged.
import * as THREE from "three/src/Three.Core.js";

export class Shade {
    constructor(scene, camera) {
        Object.assign(this, { scene, camera, lines: null, points: [] });
    }

    /** Lines between points of a frame that is there, told by its matrix; none without lines. */
    show(lines, frame) {
        if (this.lines) {
            this.scene.remove(this.lines);
            this.lines.geometry.dispose();
            this.lines.material.dispose();
        }
        this.lines = null;
        this.points = [];
        if (!lines) return;
        this.points = lines.flat().map((point) => new THREE.Vector3(...point));
        const material = new THREE.LineBasicMaterial({ color: "#d9480f" });
        this.lines = new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(this.points), material);
        this.lines.matrixAutoUpdate = false;
        this.lines.matrix.copy(frame);
        this.scene.add(this.lines);
    }

    ends() {
        return this.points.map((point) => point.clone().applyMatrix4(this.lines.matrix));
    }

    /** told(shift) hears how far the shade is dragged, in m along the axes of its frame; told(null) of the release. */
    drag(told) {
        const { canvas, controls } = this.camera;
        let held = null; // the pointer, the point that is dragged, where it began, the axes
        const down = (event) => {
            const ends = this.ends();
            const near = event.button === 0 && !held ? this.camera.nearest(ends, event) : -1;
            if (near < 0) return;
            controls.enabled = false;
            canvas.setPointerCapture(event.pointerId);
            const axes = new THREE.Matrix4().extractRotation(this.lines.matrix).transpose();
            held = { id: event.pointerId, point: ends[near], from: this.camera.facing(ends[near], event), axes };
        };
        const move = (event) => {
            if (!held) canvas.style.cursor = this.camera.nearest(this.ends(), event) < 0 ? "" : "grab";
            if (held?.id !== event.pointerId) return;
            const shift = this.camera.facing(held.point, event)?.sub(held.from).applyMatrix4(held.axes);
            if (shift) told(shift.toArray());
        };
        const release = (event) => {
            if (held?.id !== event.pointerId) return;
            held = null;
            controls.enabled = true;
            told(null);
        };
        canvas.addEventListener("pointerdown", down, { capture: true }); // before the controls hear of it
        canvas.addEventListener("pointermove", move);
        for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, release);
    }
}
