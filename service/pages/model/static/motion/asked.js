// Requests of the interface: an answer, or the job that it became, followed until it has ended.
import { reached } from "../reached.js";

const PAUSE = 400; // ms
const JSON_TYPE = "application/json";
const headers = { "Content-Type": JSON_TYPE };

/** What a POST answers: JSON, or of another media type a blob. told(job) hears how far a job is; the signal cancels
 * it. Throws an Error that says what is wrong. */
export async function post(address, body, { told = () => {}, signal = undefined, media = JSON_TYPE } = {}) {
    const sent = { method: "POST", headers: { ...headers, Accept: media }, body: JSON.stringify(body), signal };
    let answer = await reached(address, sent);
    if (answer.status === 202) answer = await followed(await answer.json(), told, signal);
    return media === JSON_TYPE ? read(answer) : (await right(answer)).blob();
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

async function followed(job, told, signal) {
    let now = job;
    while (["queued", "running", "cancelling"].includes(now.state)) {
        told(now);
        await new Promise((done) => setTimeout(done, PAUSE));
        if (signal?.aborted && now.state !== "cancelling") {
            await reached(job.links.cancel, { method: "POST", headers, body: "{}" });
        }
        now = await read(await reached(job.links.self));
    }
    if (now.state === "cancelled") throw new Error("cancelled");
    const { items } = await read(await reached(job.links.items));
    const { problem, files } = items[0];
    if (!files.length) throw new Error(problem?.detail ?? `the job ${now.state}`);
    return reached(files[0].href); // also of a motion that is not right, and says so
}
