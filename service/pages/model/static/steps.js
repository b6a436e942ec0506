// What a form of the workbench sends, and the same as requests for other programs.
const PLACEMENT = { position: ["x", "y", "z"], rpy: ["roll", "pitch", "yaw"] };
const METHODS = { couplings: "couple", loads: "load", closures: "close_loop" };

const WITH_UNIT = /^([-+]?[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*([a-zA-Zµ°%].*)$/;

const DIGITS = 15; // that a number keeps

/** A number, one with a unit behind it, else the expression, as which more digits are kept. */
export function number(text) {
    const given = text.trim();
    if (given === "") return 0;
    if (Number.isFinite(Number(given))) return given.replace(/[eE].*|[^0-9]/g, "").length > DIGITS ? given : Number(given);
    const [, value, unit] = WITH_UNIT.exec(given) ?? [];
    return unit ? { value, unit } : given;
}

const split = (text) => text.split(",").map((each) => each.trim());
/** By kind of a field what it sends; undefined where it is left empty. */
const KINDS = {
    text: ({ value }) => value.trim() || undefined,
    number: ({ value }) => (value.trim() ? number(value) : undefined),
    vector: ({ value }) => (value.trim() ? split(value).map(number) : undefined),
    frames: ({ value }) => split(value).filter(Boolean),
    flag: ({ checked }) => checked || undefined,
};

/** The body of the request of a form. */
export function filled(form) {
    const value = (name) => form.elements.namedItem(name)?.value.trim() ?? "";
    const numbers = (names) => names.map((name) => number(value(name)));
    const body = value("name") ? { name: value("name") } : {};
    if (form.dataset.action === "couplings" && !form.dataset.method) {
        const placement = Object.fromEntries(Object.entries(PLACEMENT).map(([key, names]) => [key, numbers(names)]));
        return { ...body, substructure: value("substructure"), at: value("at"), placement };
    }
    if (value("type")) body.type = value("type");
    for (const input of form.querySelectorAll("[data-kind]")) {
        if (input.matches(":disabled")) continue;
        const found = KINDS[input.dataset.kind](input);
        const of = input.dataset.member ? (body[input.dataset.member] ??= {}) : body;
        if (found !== undefined) of[input.name] = found;
    }
    return body;
}

/** Method and path behind that of the tree. */
export function request({ dataset: { action, method }, elements }) {
    const instance = elements.namedItem("instance")?.value;
    const path = action === "tree" ? "" : `/${action}`;
    return [method ?? "POST", instance ? `${path}/${instance}` : path];
}

/** By program the text that does the same. */
export function texts(origin, reference, form) {
    const [[method, path], body] = [request(form), filled(form)];
    const [url, json] = [`${origin}/v1/trees/${reference}${path}`, JSON.stringify(body)];
    const verb = method === "POST" ? "" : `-X ${method} `;
    const option = method === "POST" ? "" : `, weboptions("RequestMethod", "${method.toLowerCase()}")`;
    const matlab = `webwrite("${url}", "json", '${json.replaceAll("'", "''")}'${option})`;
    return {
        curl: `curl -s ${verb}${url} -H 'Content-Type: application/json' -d '${json.replaceAll("'", "'\\''")}'`,
        Python: `from substructures.client import Client\n\nwith Client("${origin}") as client:\n    print(client.${call(reference, form, body)})`,
        MATLAB: matlab,
    };
}

// JSON of texts, numbers, lists and objects is Python, too, but for its truth values
function call(reference, form, body) {
    const { action } = form.dataset;
    const python = JSON.stringify(body).replaceAll(":true", ":True");
    if (action === "tree") return `change_tree("${reference}", **${python})`;
    if (action === "publish") return `publish("${reference}", **${python})`;
    const instance = form.elements.namedItem("instance")?.value;
    if (instance) return `change_coupling("${reference}", "${instance}", **${python})`;
    return `${METHODS[action]}("${reference}", ${python})`;
}
