// The page of `clearway compare`: reads what the program wrote into it, and shows it.

import { strangeWords } from "../address";
import "../errors";
import { byId, el } from "../dom";
import { isDark } from "../palette";
import { colorOf, type Chart } from "./chart";
import { readPage } from "./data";
import { overviewSection, section, sweepSection } from "./section";

const asked = new URLSearchParams(location.hash.slice(1)).get("dark");
const systemDark = matchMedia("(prefers-color-scheme: dark)");
const charts: Chart[] = [];

function setTheme(dark: boolean): void {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  byId("theme").textContent = dark ? "Light" : "Dark";
  for (const chart of charts) chart.draw();
  for (const swatch of document.querySelectorAll<HTMLElement>("[data-color]")) swatch.style.background = colorOf(Number(swatch.dataset.color));
}

const page = readPage();
byId("title").textContent = page.title;
byId("subtitle").textContent = page.subtitle;
byId("about").textContent = page.about;
if (page.overview) {
  byId("experiments").append(overviewSection(page.overview));
  byId("contents").append(el("a", { href: "#all" }, "All experiments"));
}
page.resolutions.forEach((sweep, i) => {
  const made = sweepSection(sweep, i);
  byId("experiments").append(made.element);
  charts.push(...made.charts);
  byId("contents").append(el("a", { href: `#r${i}` }, page.resolutions.length === 1 ? "Resolution" : `Resolution: ${sweep.experiments.join(", ")}`));
});
page.experiments.forEach((experiment, i) => {
  const made = section(experiment, i, page.meanings);
  byId("experiments").append(made.element);
  charts.push(...made.charts);
  byId("contents").append(el("a", { href: `#e${i}` }, experiment.title || experiment.name));
});
const strange = strangeWords(["dark"], []);
if (strange !== "") byId("subtitle").after(el("p", { class: "bad", role: "status" }, strange));
byId("contents").hidden = page.experiments.length < 2;
setTheme(asked === null ? systemDark.matches : asked === "1");
byId("theme").addEventListener("click", () => setTheme(!isDark()));
if (asked === null) systemDark.addEventListener("change", (event) => setTheme(event.matches));
document.body.dataset.experiments = String(page.experiments.length);
document.body.dataset.charts = String(charts.length);
document.body.dataset.ready = "1";
