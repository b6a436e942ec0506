// What a form of the workbench sends, and the same as requests for other programs.
const PLACEMENT = { position: ["x", "y", "z"], rpy: ["roll", "pitch", "yaw"] };
const METHODS = { couplings: "couple", loads: "load", closures: "close_loop" };

/** A number where it is one, else the expression. */
function number(text) {
    const given = text.trim();
    return given === "" ? 0 : Number.isFinite(Number(given)) ? Number(given) : given;
}

/** The body of the request of a form. */
export function filled(form) {
    const value = (name) => form.elements.namedItem(name)?.value.trim() ?? "";
    const numbers = (names) => names.map((name) => number(value(name)));
    if (form.dataset.action === "publish") return { name: value("name"), ...(value("title") && { title: value("title") }) };
    const body = { name: value("name") };
    if (form.dataset.action === "couplings") {
        const placement = Object.fromEntries(Object.entries(PLACEMENT).map(([key, names]) => [key, numbers(names)]));
        return { ...body, substructure: value("substructure"), at: value("at"), placement };
    }
    Object.assign(body, { type: value("type") || "spring", from: value("from"), to: value("to") });
    if (form.dataset.action === "closures") return value("length") ? { ...body, length: number(value("length")) } : body;
    const [stiffness, damping, length] = numbers(["stiffness", "damping", "length"]);
    return { ...body, stiffness, damping, length };
}

/** By program the text that does the same. */
export function texts(origin, reference, action, body) {
    const url = `${origin}/v1/trees/${reference}/${action}`;
    const json = JSON.stringify(body);
    const call = action === "publish"
        ? `publish("${reference}", **${python(body)})`
        : `${METHODS[action]}("${reference}", ${python(body)})`;
    const matlab = `webwrite("${url}", '${json.replaceAll("'", "''")}', weboptions("MediaType", "application/json"))`;
    return {
        curl: `curl -s ${url} -H 'Content-Type: application/json' -d '${json.replaceAll("'", "'\\''")}'`,
        Python: `from substructures.client import Client\n\nwith Client("${origin}") as client:\n    print(client.${call})`,
        MATLAB: matlab,
    };
}

// JSON of texts, numbers, lists and objects is Python, too
const python = (body) => JSON.stringify(body);
