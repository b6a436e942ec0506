// Requests to the server: what is said where none answers.
export const LOST = "the connection is lost: see whether the server runs, then try again";

/** The answer of the server, all of it. Throws what can be done where there is none, where it ends before its end, or
 * where what stands before the server answers. */
export async function reached(address, options = {}) {
    const lost = (error) => {
        throw options.signal?.aborted ? error : new Error(LOST);
    };
    const answer = await fetch(address, options).catch(lost);
    if (answer.status > 500 && !/json/.test(answer.headers.get("content-type"))) throw new Error(LOST);
    const body = await answer.blob().catch(lost);
    const whole = new Response(body.size ? body : null, answer);
    return Object.defineProperty(whole, "url", { value: answer.url });
}
