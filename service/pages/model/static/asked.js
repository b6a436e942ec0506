// Requests of the interface: an answer, or the job that it became, followed until it has ended.
const PAUSE = 400; // ms

/** The JSON answer of a POST. told(words) hears how far a job is. Throws an Error that says what is wrong. */
export async function post(address, body, told = () => {}) {
    const headers = { "Content-Type": "application/json" };
    const answer = await fetch(address, { method: "POST", headers, body: JSON.stringify(body) });
    const found = await read(answer);
    return answer.status === 202 ? followed(found, told) : found;
}

async function read(answer) {
    const found = await answer.json();
    if (!answer.ok) throw new Error(found.errors?.map(({ message }) => message).join("; ") || found.detail);
    return found;
}

async function followed(job, told) {
    let now = job;
    while (["queued", "running"].includes(now.state)) {
        told(`job ${now.state}, ${Math.round(100 * (now.progress.fraction ?? 0))} %`);
        await new Promise((done) => setTimeout(done, PAUSE));
        now = await read(await fetch(job.links.self));
    }
    const { items } = await read(await fetch(job.links.items));
    if (items[0].problem) throw new Error(items[0].problem.detail);
    return read(await fetch(`${job.links.items}/0/files/result`));
}
