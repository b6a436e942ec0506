// Whether a part is made for the port that it is to be mounted on.
import { once } from "./once.js";
import { reached } from "./reached.js";

const kept = new Map();

/** The definition of a stored part; empty where it cannot be had. */
function definition(reference) {
    return once(kept, reference, async () => {
        const answer = await reached(`/v1/substructures/${encodeURIComponent(reference)}/definition`);
        if (!answer.ok) throw new Error(answer.statusText);
        return answer.json();
    }).catch(() => ({}));
}

/** What differs between the interface of a port, "arm.flange", of the tree with these instances and that of the part;
 * empty where one of them names none. */
export async function misfit(instances, at, substructure) {
    const [host, port] = at.split(".");
    const instance = instances.find(({ name }) => name === host);
    if (!instance) return "";
    const [carrier, part] = await Promise.all([instance.definition ?? definition(instance.substructure), definition(substructure)]);
    const given = carrier.ports?.find(({ name }) => name === port)?.interface;
    const made = part.mount?.interface;
    return given && made && given !== made ? `${at} is a '${given}', and ${substructure} is made for a '${made}'` : "";
}
