// Bundles every page of web/src (a file page_NAME.ts) to OUT/page_NAME.js and OUT/page_NAME.css:
//     node build.mjs OUT [FOLDER with node_modules]
// giveway/report/page.py puts them into one HTML file, with the data and, where it computes, the batch library.
import { existsSync, readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const [out = "out", tools = here] = process.argv.slice(2).map((path) => resolve(path));
const esbuild = createRequire(join(tools, "package.json"))("esbuild");
// What a page has of others must come with their licence.
const licence = readFileSync(join(tools, "node_modules", "uplot", "LICENSE"), "utf8").replace(/\*\//g, "");
const common = {
  bundle: true, minify: true, write: true, target: "es2022", charset: "utf8", logLevel: "warning", legalComments: "none",
  nodePaths: [join(tools, "node_modules")],
};

// The text of giveway_batch.js as a script, for the workers that a page starts from itself.
const worker_text = {
  name: "worker",
  setup(build) {
    build.onResolve({ filter: /^giveway:worker$/ }, ({ path }) => ({ path, namespace: "worker" }));
    build.onLoad({ filter: /.*/, namespace: "worker" }, async () => {
      const footer = { js: "var serve=giveway.serve;" };
      const script = { ...common, write: false, format: "iife", globalName: "giveway", footer };
      const made = await esbuild.build({ ...script, entryPoints: [join(here, "giveway_batch.js")] });
      return { contents: made.outputFiles[0].text, loader: "text" };
    });
  },
};

const folders = readdirSync(join(here, "src")).map((name) => join(here, "src", name));
const pages = folders.flatMap((folder) =>
  readdirSync(folder).filter((name) => /^page_\w+\.ts$/.test(name)).map((name) => join(folder, name)),
);
await esbuild.build({ ...common, entryPoints: pages, entryNames: "[name]", outdir: out, format: "iife", plugins: [worker_text], banner: { js: `/*! uPlot:\n${licence}*/` } });
for (const page of pages) {
  const css = join(out, page.replace(/^.*[/\\](\w+)\.ts$/, "$1.css"));
  if (!existsSync(css)) {
    throw new Error(`${page} imports no style: import "../parts/theme.css"`);
  }
}
