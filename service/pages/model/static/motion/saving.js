// Downloads: what the interface makes of a motion, and pictures as they are shown.
import { post } from "./asked.js";

const COPIED = ["fill", "stroke", "stroke-width", "stroke-dasharray", "font-family", "font-size", "text-anchor", "opacity"];

/** Offers something as a file. */
export function offer(blob, name) {
    const address = URL.createObjectURL(blob);
    Object.assign(document.createElement("a"), { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
}

/** The answer of the interface to the same request, as a file. */
export async function save(address, body, media, name, told) {
    offer(await post(address, body, { media, told }), name);
}

/** A picture with the colours that it has here, as a file of its own. */
export function picture(shown) {
    const copy = shown.cloneNode(true);
    const [from, to] = [shown, copy].map((each) => [each, ...each.querySelectorAll("*")]);
    from.forEach((each, k) => {
        const style = getComputedStyle(each);
        for (const name of COPIED) to[k].setAttribute(name, style.getPropertyValue(name));
        to[k].removeAttribute("class");
    });
    const [, , width, height] = copy.getAttribute("viewBox").split(" ");
    const paper = document.createElementNS(copy.namespaceURI, "rect");
    for (const [name, value] of Object.entries({ width, height, fill: getComputedStyle(document.body).backgroundColor })) {
        paper.setAttribute(name, value);
    }
    copy.setAttribute("width", width);
    copy.setAttribute("height", height);
    copy.prepend(paper);
    return new Blob([new XMLSerializer().serializeToString(copy)], { type: "image/svg+xml" });
}
