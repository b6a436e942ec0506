// Loads what draws in three dimensions, after the page can be used.
import { reached } from "./reached.js";

/** A scene in the place of the picture, with the switches of the view below it, where they hide nothing. */
export async function drawn(scene) {
    const { View } = await import("./view.js");
    const place = document.getElementById("view");
    const view = new View(place, scene);
    place.after(place.querySelector(".switches"));
    return view;
}

/** The view in three dimensions, null where there is no WebGL: the picture of the server stays. */
export async function shown(kind, reference, sliders) {
    try {
        const answer = await reached(`/v1/${kind}/${reference}/scene`);
        if (!answer.ok) return null;
        const scene = await answer.json();
        const view = await drawn(scene);
        sliders.offer({ ...scene.poses, ...limits(scene) });
        if (!new URL(location.href).searchParams.has("pose")) {
            sliders.set(scene.poses.home, false);
        }
        return view;
    } catch {
        return null;
    }
}

/** Poses at the limits of the coordinates that have some, the others at home. */
function limits({ joints, poses, positions }) {
    if (!joints.some((joint) => joint.limits)) return {};
    const of = new Map(joints.map(({ coordinate, limits: both }) => [coordinate, both]));
    const at = (side) => poses.home.map((x, k) => of.get(positions[k])?.[side] ?? x);
    return { "lower limits": at(0), "upper limits": at(1) };
}
