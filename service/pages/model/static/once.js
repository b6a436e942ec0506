// What is downloaded once for all that ask for it.

/** What was made for a key, which the map keeps; what failed is made anew when it is asked for again. */
export function once(kept, key, make) {
    if (!kept.has(key)) {
        const made = make();
        kept.set(key, made);
        made.catch(() => kept.delete(key));
    }
    return kept.get(key);
}
