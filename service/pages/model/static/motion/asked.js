// Requests of the interface: an answer, or the job that it became, followed until it has ended.
import { element } from "../fragments.js";
import { LOST, reached } from "../reached.js";

const PAUSE = 400; // ms
const LATER = [502, 503, 504]; // of a server that starts anew, or of what stands before one
const JSON_TYPE = "application/json";
const headers = { "Content-Type": JSON_TYPE };

/** What a POST answers: JSON, or of another media type a blob. told(job, isLost) hears how far a job is, and whether the
 * server is waited for; the signal cancels it. Throws an Error that says what is wrong. */
export async function post(address, body, { told = () => {}, signal = undefined, media = JSON_TYPE } = {}) {
    const sent = { method: "POST", headers: { ...headers, Accept: media }, body: JSON.stringify(body), signal };
    let answer = await reached(address, sent);
    if (answer.status === 202) answer = await followed(await answer.json(), told, signal);
    return media === JSON_TYPE ? read(answer) : (await right(answer)).blob();
}

/** How far a job is that a request became, in words. */
export function heard({ id, state, progress }, isLost) {
    const share = progress.fraction ?? 0;
    const bar = element("progress", { ...(share ? { value: String(share) } : {}), max: "1", "aria-label": "progress" });
    const page = element("a", { href: `/jobs/${id}` }, "its page");
    const lost = isLost ? [": ", element("span", { class: "warn" }, "the connection is lost; it is tried again")] : [];
    return element("span", {}, bar, ` job ${state}, ${Math.round(100 * share)} %: `, page, ...lost);
}

async function right(answer) {
    if (answer.ok) return answer;
    const found = await answer.json();
    const faults = (found.errors ?? []).map(({ pointer, message }) => [pointer?.slice(1), message].filter(Boolean).join(": "));
    throw new Error(faults.join("; ") || found.detail);
}

async function read(answer) {
    return (await right(answer)).json();
}

/** The answer about a job, which goes on while nobody answers: then lost() hears so, and it is asked for again. */
async function awaited(address, lost, options) {
    for (;;) {
        const answer = await reached(address, options).catch((error) => {
            if (error.message !== LOST) throw error;
        });
        if (answer && !LATER.includes(answer.status)) return answer;
        lost();
        await rest();
    }
}

const rest = () => new Promise((done) => setTimeout(done, PAUSE));

async function followed(job, told, signal) {
    let now = job;
    const asked = (address, options) => awaited(address, () => told(now, true), options);
    while (["queued", "running", "cancelling"].includes(now.state)) {
        told(now, false);
        await rest();
        if (signal?.aborted && now.state !== "cancelling") {
            await asked(job.links.cancel, { method: "POST", headers, body: "{}" });
        }
        now = await read(await asked(job.links.self));
    }
    if (now.state === "cancelled") throw new Error("cancelled");
    const { items } = await read(await asked(job.links.items));
    const { problem, files } = items[0];
    if (!files.length) throw new Error(problem?.detail ?? `the job ${now.state}`);
    return asked(files[0].href); // also of a motion that is not right, and says so
}
