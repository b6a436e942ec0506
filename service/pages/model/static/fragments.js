// Parts of pages from the server, which escapes them by the code that writes the pages.
import { LOST } from "./reached.js";

const GONE = { 404: "it is there no more", 401: "the session is over: sign in", 403: "it is not shown to you" };

/** The element with this id out of a page at an address, to be put into this one. */
export function fragment(address, id) {
    return new Promise((resolve, reject) => {
        const request = new XMLHttpRequest();
        request.open("GET", address);
        request.responseType = "document";
        request.addEventListener("load", () => {
            const found = request.status === 200 ? request.response?.getElementById(id) : null;
            if (found) resolve(document.importNode(found, true));
            else reject(new Error(GONE[request.status] ?? (request.status > 500 ? LOST : `${request.status}`)));
        });
        request.addEventListener("error", () => reject(new Error(LOST)));
        request.send();
    });
}

/** An element with attributes and children. */
export function element(name, attributes = {}, ...children) {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
}
