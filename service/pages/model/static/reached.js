// Requests to the server: what is said where none answers.
export const LOST = "the connection is lost: see whether the server runs, then try again";

/** The answer of the server. Throws what can be done where there is none, or where what stands before it answers. */
export async function reached(address, options = {}) {
    const answer = await fetch(address, options).catch((error) => {
        throw options.signal?.aborted ? error : new Error(LOST);
    });
    if (answer.status > 500 && !/json/.test(answer.headers.get("content-type"))) throw new Error(LOST);
    return answer;
}
