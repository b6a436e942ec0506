// Draws a scene; without a graphics card roughly while things move, and finely once they rest.
import { WebGLRenderer } from "three/src/renderers/WebGLRenderer.js";

const REST = 250; // ms without another frame

/** Whether WebGL is computed by the processor, where smooth edges cost more than all the rest. */
function isSoftware() {
    const context = document.createElement("canvas").getContext("webgl2");
    const told = context?.getExtension("WEBGL_debug_renderer_info");
    const name = told ? context.getParameter(told.UNMASKED_RENDERER_WEBGL) : "";
    context?.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|softpipe|basic render/i.test(name);
}

export class Drawer {
    constructor(canvas) {
        this.isSoftware = isSoftware();
        this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: !this.isSoftware });
        this.renderer.setPixelRatio(this.isSoftware ? 1 : Math.min(devicePixelRatio, 2));
    }

    resize(width, height) {
        this.renderer.setSize(width, height, false);
    }

    draw(scene, camera) {
        if (this.isSoftware) {
            this.sharpen(1);
            clearTimeout(this.waiting);
            this.waiting = setTimeout(() => {
                this.sharpen(2);
                this.renderer.render(scene, camera);
            }, REST);
        }
        this.renderer.render(scene, camera);
    }

    sharpen(ratio) {
        if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    }
}
