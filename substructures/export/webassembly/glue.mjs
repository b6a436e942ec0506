// Generated code. Vectors are arrays of numbers in the order of `description.vectors`, or objects by their names, from
// which what has a default may be left out; arrays come back dense and row-major, as Float64Array.

/** What was exported: names, order, units, shapes and defaults of everything. */
export const description = "@description@";

const HEAP = "@heap@";

/** The functions, from the bytes of the module or from a compiled module. */
export function create(source) {
    const module = source instanceof WebAssembly.Module ? source : new WebAssembly.Module(source);
    const { exports } = new WebAssembly.Instance(module, { math: Math });
    const calls = description.functions.map((each) => [each.name, caller(exports, each)]);
    return Object.freeze(Object.fromEntries(calls));
}

/** The functions, from the file of the module beside this one. */
export async function load(url = new URL("@name@.wasm", import.meta.url)) {
    if (url.protocol !== "file:") return create(await WebAssembly.compileStreaming(fetch(url)));
    const { readFile } = await import("node:fs/promises");
    return create(await readFile(url));
}

function caller(exports, { name, arguments: given, outputs, x }) {
    const vectors = given.map((symbol) => [symbol, symbol === "x" ? x : description.vectors[symbol]]);
    const sizes = outputs.map(({ shape }) => shape.reduce((product, length) => product * length, 1));
    const total = [...vectors.map(([, vector]) => vector.length), ...sizes].reduce((sum, length) => sum + length, 0);
    return (...values) => {
        if (values.length > given.length) {
            throw new TypeError(`${name}(${given.join(", ")}) takes ${given.length} arguments, not ${values.length}`);
        }
        const checked = vectors.map(([symbol, vector], k) => read(name, symbol, vector, values[k]));
        const memory = reserve(exports.memory, HEAP + 8 * total);
        let at = HEAP;
        const place = (length) => (at += 8 * length) - 8 * length;
        const addresses = checked.map((value) => {
            if (typeof value === "number") return value;
            const address = place(value.length);
            new Float64Array(memory, address, value.length).set(value);
            return address;
        });
        const results = sizes.map(place);
        exports[name](...addresses, ...results);
        const arrays = results.map((address, k) => new Float64Array(memory, address, sizes[k]).slice());
        return outputs.length === 1 ? arrays[0] : Object.fromEntries(outputs.map((each, k) => [each.name, arrays[k]]));
    };
}

function reserve(memory, size) {
    const missing = size - memory.buffer.byteLength;
    if (missing > 0) memory.grow(Math.ceil(missing / 65536));
    return memory.buffer;
}

function read(name, symbol, vector, value) {
    if (value === undefined) return defaults(name, symbol, vector);
    if (symbol === "t") {
        if (typeof value === "number") return value;
        throw new TypeError(`${name}: t is a number, not ${String(value).slice(0, 40)}`);
    }
    if (isNamed(value)) return fromNames(name, symbol, vector, value);
    if (typeof value !== "object" || value === null || value.length !== vector.length) {
        throw new RangeError(
            `${name}: ${symbol} has ${vector.length} numbers (${vector.names.slice(0, 8).join(", ")}` +
                `${vector.length > 8 ? ", ..." : ""}), not ${value?.length ?? String(value).slice(0, 40)}`,
        );
    }
    const wrong = Array.prototype.findIndex.call(value, (x) => typeof x !== "number");
    if (wrong >= 0) throw new TypeError(`${name}: ${symbol}[${wrong}] (${vector.names[wrong]}) is no number`);
    return value;
}

function isNamed(value) {
    return typeof value === "object" && value !== null && !ArrayBuffer.isView(value) && !(Symbol.iterator in value);
}

function fromNames(name, symbol, vector, given) {
    const unknown = Object.keys(given).find((each) => !vector.names.includes(each));
    if (unknown !== undefined) {
        throw new RangeError(`${name}: ${symbol} has no '${unknown}' (${vector.names.slice(0, 8).join(", ")})`);
    }
    const values = vector.names.map((each, i) => (Object.hasOwn(given, each) ? given[each] : vector.defaults?.[i]));
    const missing = values.findIndex((x) => typeof x !== "number");
    if (missing >= 0) throw new TypeError(`${name}: ${symbol} needs a number for '${vector.names[missing]}'`);
    return values;
}

function defaults(name, symbol, vector) {
    const missing = vector.names.filter((_, i) => (vector.defaults?.[i] ?? null) === null);
    if (vector.length === 0 || (vector.defaults && missing.length === 0)) return vector.defaults ?? [];
    throw new TypeError(`${name}: ${symbol} is missing (without default: ${missing.slice(0, 8).join(", ")})`);
}
