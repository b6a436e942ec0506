// From where a mechanism is seen: turned by pointer and arrow keys, fitted to a box; points on the screen.
import * as THREE from "three/src/Three.Core.js";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const TURNS = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };

export class Camera {
    /** canvas: what is pointed at; moved() is called when it is seen from elsewhere. */
    constructor(canvas, moved) {
        this.canvas = canvas;
        this.seen = new THREE.PerspectiveCamera(35, 1, 0.001, 1e4);
        this.seen.up.set(0, 0, 1);
        this.controls = new OrbitControls(this.seen, canvas);
        this.controls.addEventListener("change", moved);
        canvas.addEventListener("keydown", (event) => this.turn(event));
    }

    /** The sphere about a box touches the edges of the picture, be it wide or tall. */
    fit(box, size) {
        const middle = box.getCenter(new THREE.Vector3());
        const { clientWidth: width, clientHeight: height } = this.canvas;
        const half = Math.atan(Math.tan((this.seen.fov * Math.PI) / 360) * Math.min(1, width / height || 1));
        const distance = (0.5 * size) / Math.sin(half);
        this.seen.position.copy(middle).addScaledVector(new THREE.Vector3(1, -1.4, 0.8).normalize(), distance);
        this.seen.near = distance / 100;
        this.seen.far = distance * 100;
        this.controls.target.copy(middle);
    }

    /** Goes along with what is seen. */
    shift(way) {
        this.seen.position.add(way);
        this.controls.target.add(way);
        this.seen.updateMatrixWorld();
    }

    resize(width, height) {
        this.seen.aspect = width / height;
        this.seen.updateProjectionMatrix();
    }

    turn(event) {
        const step = TURNS[event.key];
        if (!step) return;
        event.preventDefault();
        const away = this.seen.position.clone().sub(this.controls.target);
        const round = new THREE.Spherical().setFromVector3(new THREE.Vector3(away.x, away.z, -away.y));
        round.theta += step[0];
        round.phi = Math.min(Math.PI - 0.05, Math.max(0.05, round.phi + step[1]));
        const made = new THREE.Vector3().setFromSpherical(round);
        this.seen.position.copy(this.controls.target).add(new THREE.Vector3(made.x, -made.z, made.y));
        this.controls.update();
    }

    /** Where a point is on the canvas, in pixels. */
    pixel(point) {
        const { x, y } = point.clone().project(this.seen);
        return [((x + 1) * this.canvas.clientWidth) / 2, ((1 - y) * this.canvas.clientHeight) / 2];
    }

    /** Of points the nearest to a place on the canvas, at most 30 pixels away; -1 where there is none. */
    nearest(points, { offsetX, offsetY }) {
        const away = points.map((point) => {
            const [x, y] = this.pixel(point);
            return Math.hypot(x - offsetX, y - offsetY);
        });
        const least = Math.min(...away);
        return least < 30 ? away.indexOf(least) : -1;
    }

    /** What is at a place on the canvas, in the plane through a point that faces the camera. */
    facing(point, { offsetX, offsetY }) {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        const ray = new THREE.Raycaster();
        ray.setFromCamera(new THREE.Vector2((2 * offsetX) / width - 1, 1 - (2 * offsetY) / height), this.seen);
        const normal = this.seen.getWorldDirection(new THREE.Vector3());
        const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(normal, point);
        return ray.ray.intersectPlane(plane, new THREE.Vector3());
    }
}
