// What of a page its address holds, so that a reload, a bookmark and the way back show the same.

/** What the address holds under a name; "" where it holds nothing. */
export function kept(name) {
    return new URL(location.href).searchParams.get(name) ?? "";
}

/** The address, with the revision or version that is shown: another one may have no such pose, entry or parameter. */
export function pinned() {
    const address = new URL(location.href);
    const { kind, reference } = JSON.parse(document.getElementById("place").dataset.model);
    const [, , , ...rest] = address.pathname.split("/");
    address.pathname = ["", kind, reference, ...rest].join("/");
    return address;
}

/** Keeps a value, or forgets the name where there is none. */
export function keep(name, value) {
    const address = value === "" ? new URL(location.href) : pinned();
    if (value === "") address.searchParams.delete(name);
    else address.searchParams.set(name, value);
    history.replaceState(null, "", address);
}

/** Lets links to another page of the model take along the state that the address holds. */
export function lead(path) {
    const here = new URL(location.href).searchParams;
    const state = ["pose", "qd", "set"].filter((name) => here.has(name)).map((name) => [name, here.get(name)]);
    for (const each of document.links) if (each.pathname === path) each.search = new URLSearchParams(state);
}
