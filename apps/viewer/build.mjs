// Checks the types, bundles the page's script and style, and writes one self-contained HTML template.
//   node build.mjs OUTPUT.html
import { execFileSync } from "node:child_process";
import { readFileSync, renameSync, writeFileSync } from "node:fs";
import { build } from "esbuild";

const output = process.argv[2];

execFileSync("node_modules/.bin/tsc", ["--project", "tsconfig.json"], { stdio: "inherit" });

// The libraries' own licences travel with their code.
const licences = ["three", "uplot"].map((name) => {
  const { version } = JSON.parse(readFileSync(`node_modules/${name}/package.json`, "utf8"));
  return `${name} ${version}\n\n${readFileSync(`node_modules/${name}/LICENSE`, "utf8").trim()}`;
});
const banner = `/*! This page contains:\n\n${licences.join("\n\n")}\n*/`;

async function bundle(entry, options) {
  const result = await build({
    entryPoints: [entry], bundle: true, minify: true, write: false, charset: "utf8",
    target: ["chrome110", "firefox115", "safari16.4"], logLevel: "warning", ...options,
  });
  return result.outputFiles[0].text;
}

const script = await bundle("src/main.ts", { format: "iife", legalComments: "inline", banner: { js: banner } });
const style = await bundle("src/page.css", {});
if (/<\/(script|style)/i.test(script + style)) throw new Error("the bundle would end its own element");

const html = readFileSync("src/page.html", "utf8")
  .replace("<!--STYLE-->", () => `<style>${style}</style>`)
  .replace("<!--SCRIPT-->", () => `<script>${script}</script>`);
writeFileSync(`${output}.part`, html);
renameSync(`${output}.part`, output);
