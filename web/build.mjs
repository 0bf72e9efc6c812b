// Writes the page that ships, in src/inerter/app/web/, or elsewhere: node build.mjs [FOLDER].
import { build } from "esbuild";
import { cp, mkdir, readFile, rm, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const folder = process.argv[2] ?? join(here, "../src/inerter/app/web");
const { dependencies } = JSON.parse(await readFile(join(here, "package.json"), "utf8"));

await rm(folder, { recursive: true, force: true });
await mkdir(folder, { recursive: true });
await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.js" },
  outdir: folder,
  bundle: true,
  format: "esm",
  target: "es2022",
  minify: true,
  legalComments: "none",
  metafile: false,
});
for (const file of ["index.html", "icon.svg"]) await cp(join(here, "src", file), join(folder, file));

const licences = [];
for (const [name, version] of Object.entries(dependencies)) {
  const text = await readFile(join(here, "node_modules", name, "LICENSE"), "utf8");
  licences.push(`${name} ${version}\n\n${text.trim()}\n`);
}
await writeFile(join(folder, "licences.txt"), licences.join(`\n${"-".repeat(72)}\n\n`));
