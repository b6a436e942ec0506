// Builds ../static/view.js out of view.js and three: npm ci --ignore-scripts && node build.mjs [FOLDER]
import { createHash } from "node:crypto";
import { readFile, writeFile } from "node:fs/promises";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = (name) => fileURLToPath(new URL(name, import.meta.url));
const core = here("node_modules/three/src/Three.Core.js");
const folder = process.argv[2] ?? here("../static");
const licence = await readFile(here("node_modules/three/LICENSE"), "utf8");
await build({
    entryPoints: [here("view.js")],
    outfile: `${folder}/view.js`,
    absWorkingDir: here("."),
    bundle: true,
    minify: true,
    format: "esm",
    target: "es2022",
    legalComments: "none",
    // OrbitControls shall share the core, not bring all of three along
    plugins: [{ name: "core", setup: (made) => made.onResolve({ filter: /^three$/ }, () => ({ path: core })) }],
    banner: { js: `/* three.js 0.180.0\n${licence.replaceAll("*/", "* /")}*/` },
});
const digest = createHash("sha256").update(await readFile(`${folder}/view.js`)).digest("hex");
await writeFile(`${folder}/view.sha256`, `${digest}  view.js\n`);
