// Plays something over time: a button, a bar, a speed.
import { short } from "./numbers.js";

export class Player {
    /** shown(t) draws a time, rested(t) is told where it stopped. */
    constructor(shown, rested) {
        Object.assign(this, { shown, rested, t: 0, length: 1, playing: false });
        const get = (id) => document.getElementById(id);
        [this.place, this.button, this.bar, this.clock, this.speed] = ["player", "play", "time", "clock", "speed"].map(get);
        this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
        this.bar.addEventListener("input", () => {
            this.stop();
            this.at(this.bar.valueAsNumber);
            this.rested(this.t);
        });
    }

    /** Something that lasts so many seconds. */
    load(length, t = 0) {
        this.length = length;
        this.place.hidden = false;
        this.bar.max = String(length);
        this.at(Math.min(t, length));
    }

    at(t) {
        this.t = t;
        this.bar.value = String(t);
        this.clock.textContent = `${short(t)} s`;
        this.shown(t);
    }

    play() {
        this.playing = true;
        this.button.textContent = "pause";
        if (this.t >= this.length) this.t = 0;
        let before = performance.now();
        const step = (now) => {
            if (!this.playing) return;
            const t = this.t + ((now - before) / 1000) * Number(this.speed.value);
            before = now;
            this.at(t > this.length ? 0 : t); // it begins again
            requestAnimationFrame(step);
        };
        requestAnimationFrame(step);
    }

    stop() {
        if (!this.playing) return;
        this.playing = false;
        this.button.textContent = "play";
        this.rested(this.t);
    }
}
