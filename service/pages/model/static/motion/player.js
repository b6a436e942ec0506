// Plays something over time: a button, a bar with ticks of what happened, a speed, again and again or once.
import { element } from "../fragments.js";
import { short } from "../numbers.js";

const MOST = 200; // ticks
const NAMED = 12; // buttons

export class Player {
    /** shown(t) draws a time, rested(t) is told where it stopped. */
    constructor(shown, rested) {
        Object.assign(this, { shown, rested, t: 0, length: 1, playing: false });
        const get = (id) => document.getElementById(id);
        [this.place, this.button, this.bar, this.clock, this.speed] = ["player", "play", "time", "clock", "speed"].map(get);
        [this.loop, this.ticks, this.happened] = ["loop", "ticks", "happened"].map(get);
        this.button.addEventListener("click", () => (this.playing ? this.stop() : this.play()));
        this.bar.addEventListener("input", () => this.choose(this.bar.valueAsNumber));
    }

    /** Something that lasts so many seconds, with events: names and times. */
    load(length, t = 0, events = []) {
        this.length = length;
        this.place.hidden = false;
        this.bar.max = String(length);
        this.ticks.replaceChildren(...events.slice(0, MOST).map(({ name, t: at }) => {
            const tick = element("span", { title: `${name} at ${short(at)} s` });
            tick.style.setProperty("--at", String(at / length));
            return tick;
        }));
        const buttons = events.slice(0, NAMED).map(({ name, t: at }) => {
            const button = element("button", { type: "button", class: "copy" }, `${name}: ${short(at)} s`);
            button.addEventListener("click", () => this.choose(at));
            return button;
        });
        const more = events.length > NAMED ? [`and ${events.length - NAMED} more`] : [];
        this.happened.replaceChildren(...buttons, ...more);
        this.at(Math.min(t, length));
    }

    at(t) {
        this.t = t;
        this.bar.value = String(t);
        this.clock.textContent = `${short(t)} s`;
        this.shown(t);
    }

    /** Stops at a time that somebody chose. */
    choose(t) {
        this.stop();
        this.at(t);
        this.rested(t);
    }

    play() {
        this.playing = true;
        this.button.textContent = "pause";
        if (this.t >= this.length) this.t = 0;
        let before = performance.now();
        const step = (now) => {
            if (!this.playing) return;
            const t = this.t + (Math.max(0, now - before) / 1000) * Number(this.speed.value);
            before = now;
            const over = t > this.length;
            this.at(!over ? t : this.loop.checked ? t % this.length : this.length);
            if (over && !this.loop.checked) this.stop();
            else requestAnimationFrame(step);
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
