// The program of a model as WebAssembly: memory is laid out once, a call writes into it, arrays are views of it.
import { reached } from "./reached.js";

/** A module with its layout (program.json): vectors to be written, functions to be called by quantity. */
export class Program {
    constructor(module, layout) {
        const { exports } = new WebAssembly.Instance(module, { math: Math });
        const missing = layout.pages - exports.memory.buffer.byteLength / 65536;
        if (missing > 0) exports.memory.grow(missing);
        const buffer = exports.memory.buffer;
        this.vectors = {};
        for (const [symbol, { at, length, defaults }] of Object.entries(layout.vectors)) {
            if (at === undefined) continue;
            this.vectors[symbol] = new Float64Array(buffer, at, length);
            if (defaults) this.vectors[symbol].set(defaults.map((x) => x ?? NaN));
        }
        this.functions = new Map(
            layout.functions.map((each) => {
                const places = each.arguments.map((s) => (s === "t" ? 0 : (s === "x" ? each.x : layout.vectors[s]).at));
                const results = each.outputs.map(({ name, at, shape }) => {
                    const size = shape.reduce((product, n) => product * n, 1);
                    return [name, new Float64Array(buffer, at, size)];
                });
                const addresses = [...places, ...each.outputs.map(({ at }) => at)];
                const time = each.arguments.indexOf("t");
                return [each.quantity, { run: exports[each.name], addresses, time, results: Object.fromEntries(results) }];
            }),
        );
    }

    has(quantity) {
        return this.functions.has(quantity);
    }

    /** The arrays of a quantity, by output, valid until the next call. */
    call(quantity, t = 0) {
        const { run, addresses, time, results } = this.functions.get(quantity);
        if (time >= 0) addresses[time] = t;
        run(...addresses);
        return results;
    }

    /** The array of a quantity with one output. */
    array(quantity, t = 0) {
        return Object.values(this.call(quantity, t))[0];
    }
}

/** The program of the model at an address of the interface: of all that a page shows, or of quantities. */
export async function load(address, quantities = []) {
    const query = quantities.length ? `?quantities=${quantities.join(",")}` : "";
    const [layout, module] = await Promise.all([
        reached(`${address}/program.json${query}`).then(answered).then((answer) => answer.json()),
        WebAssembly.compileStreaming(reached(`${address}/program.wasm${query}`).then(answered)),
    ]);
    return [new Program(module, layout), layout];
}

/** An answer that is a success. */
export function answered(answer) {
    if (!answer.ok) throw new Error(`${answer.url}: ${answer.status}`);
    return answer;
}

/** A program out of base 64. */
export function unpacked(text, layout) {
    return new Program(new WebAssembly.Module(Uint8Array.from(atob(text), (c) => c.charCodeAt(0))), layout);
}
