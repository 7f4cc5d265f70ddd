// Checks the types, bundles each page's script and style, and writes one self-contained HTML template a page:
// report_template.html (src/page.html, main.ts, page.css) and compare_template.html (src/compare/).
//   node build.mjs
import { execFileSync } from "node:child_process";
import { readFileSync, renameSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

execFileSync("node_modules/.bin/tsc", ["--project", "tsconfig.json"], { stdio: "inherit" });

// The libraries' own licences travel with their code.
function banner(libraries) {
  const licences = libraries.map((name) => {
    const { version } = JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8"));
    return `${name} ${version}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}`;
  });
  return `/*! This page contains:\n\n${licences.join("\n\n")}\n*/`;
}

async function bundle(entry, options) {
  const result = await build({
    entryPoints: [entry], bundle: true, minify: true, write: false, charset: "utf8",
    target: ["chrome110", "firefox115", "safari16.4"], logLevel: "warning", ...options,
  });
  return result.outputFiles[0].text;
}

async function writePage(output, { html, script, style, libraries }) {
  const code = await bundle(script, { format: "iife", legalComments: "inline", banner: { js: banner(libraries) } });
  const look = await bundle(style, {});
  if (/<\/(script|style)/i.test(code + look)) throw new Error("the bundle would end its own element");
  const page = readFileSync(html, "utf8")
    .replace("<!--STYLE-->", () => `<style>${look}</style>`)
    .replace("<!--SCRIPT-->", () => `<script>${code}</script>`);
  writeFileSync(`${output}.part`, page);
  renameSync(`${output}.part`, output);
}

await writePage("report_template.html",
  { html: "src/page.html", script: "src/main.ts", style: "src/page.css", libraries: ["three", "uplot"] });
await writePage("compare_template.html",
  { html: "src/compare/page.html", script: "src/compare/main.ts", style: "src/compare/page.css", libraries: ["uplot"] });
