// One experiment: its table, what the paper says, its plots, and the runs that failed.

import { el } from "../dom";
import { colorOf, plain, type Chart } from "./chart";
import { isValid, type Experiment, type Planner } from "./data";
import { costScatter, profileCharts, timeChart, widthCharts } from "./plots";

const statusWords: Record<string, string> = {
  start_invalid: "start invalid", goal_invalid: "goal invalid", no_path: "no path", timed_out: "timed out",
};
const seconds = (value: number | null) => value === null ? "–" : value < 1e-3 ? `${plain(Number((value * 1e6).toPrecision(3)))} µs`
  : value < 1 ? `${plain(Number((value * 1e3).toPrecision(3)))} ms` : `${plain(Number(value.toPrecision(3)))} s`;
const figure = (value: number | null, digits = 4) => value === null ? "–" : plain(Number(value.toPrecision(digits)));

const unsolved = (planner: Planner) =>
  Object.entries(planner.unsolved).map(([status, count]) => `${statusWords[status] ?? status} ${count}`).join(", ");

/// Valid, solved but not valid, not solved: a bar of all runs.
function bar(planner: Planner): HTMLElement {
  const share = (count: number) => `width:${(100 * count / Math.max(planner.total, 1)).toFixed(2)}%`;
  return el("div", { class: "bar", role: "img", "aria-label": `${planner.valid} valid, ${planner.solved - planner.valid} solved but not valid, ${planner.total - planner.solved} not solved` },
    el("i", { class: "valid", style: share(planner.valid) }), el("i", { class: "invalid", style: share(planner.solved - planner.valid) }));
}

function table(experiment: Experiment): HTMLElement {
  const head = ["planner", "runs", "solved / valid / total", "time, median", "time, p95", "cost, J", "length, rad", "steps", "not solved"];
  const numeric = new Set([2, 3, 4, 5, 6, 7]);
  const rows = experiment.planners.map((planner, p) => {
    const options = Object.entries(planner.options).map(([key, value]) => `${key} = ${value}`).join("\n");
    const name = el("span", { title: `${planner.planner}\n${options}` }, planner.label);
    const swatch = el("i", { class: "swatch", style: `background:${colorOf(p)}`, "data-color": String(p) });
    const promise = planner.certified ? [] : [el("small", { class: "uncertified", title: "This planner does not prove its edges" }, "not certified")];
    const broken = planner.valid < planner.solved;
    return el("tr", {}, el("td", { class: "planner" }, swatch, name, ...promise), el("td", { class: "runs" }, bar(planner)),
      el("td", { class: `number${broken ? " bad" : ""}` }, `${planner.solved} / ${planner.valid} / ${planner.total}`),
      ...[seconds(planner.time_median_s), seconds(planner.time_p95_s), figure(planner.cost_median_joules), figure(planner.length_median_rad), figure(planner.steps_median, 6)].map((text) => el("td", { class: "number" }, text)),
      el("td", {}, unsolved(planner)));
  });
  return el("div", { class: "table-box", tabindex: "0", role: "region", "aria-label": experiment.name },
    el("table", {}, el("thead", {}, el("tr", {}, ...head.map((name, i) => el("th", numeric.has(i) ? { class: "number" } : {}, name)))), el("tbody", {}, ...rows)));
}

function legend(): HTMLElement {
  const key = (kind: string, text: string) => el("span", {}, el("i", { class: `box ${kind}` }), text);
  return el("p", { class: "note legend" }, key("valid", "valid"), key("invalid", "solved, but the independent check refuses the path"), key("", "not solved"));
}

function sayings(experiment: Experiment): HTMLElement | null {
  const said = [["In the paper", experiment.paper], ["Here", experiment.notes]].filter(([, text]) => text !== "");
  if (said.length === 0) return null;
  return el("div", { class: "sayings" }, ...said.map(([who, text]) => el("div", {}, el("h3", {}, who), el("p", {}, text))));
}

function failures(experiment: Experiment): HTMLElement | null {
  const failed = experiment.runs.filter((run) => !isValid(run));
  if (failed.length === 0) return null;
  const shown = failed.slice(0, 300);
  const word = (status: string, check: string) => status === "solved" ? `solved, ${check}` : statusWords[status] ?? status;
  const rows = shown.map((run) => el("tr", {}, el("td", {}, experiment.problems[run.problem]), el("td", {}, experiment.planners[run.planner].label),
    el("td", { class: "bad" }, word(run.status, run.check)), el("td", { class: "why" }, run.explanation ?? "")));
  const rest = failed.length > shown.length ? [el("p", { class: "note" }, `${failed.length - shown.length} more are in results.csv.`)] : [];
  return el("details", failed.length <= 12 ? { open: "" } : {}, el("summary", {}, `Runs without a valid path: ${failed.length} of ${experiment.runs.length}`),
    el("div", { class: "table-box" }, el("table", {}, el("thead", {}, el("tr", {}, ...["problem", "planner", "answer", "explanation"].map((name) => el("th", {}, name)))), el("tbody", {}, ...rows))), ...rest);
}

/// Of teams: what the program prints.
function teamTable(experiment: Experiment, [head, ...rows]: string[][]): HTMLElement {
  const cells = (row: string[]) => row.map((text, i) => i === 0 || i === row.length - 1 ? el("td", {}, text.replaceAll("_", " ")) : el("td", { class: "number" }, text));
  const first = (cell: HTMLElement, p: number) => {
    cell.className = "planner";
    cell.prepend(el("i", { class: "swatch", style: `background:${colorOf(p)}`, "data-color": String(p) }));
    return cell;
  };
  return el("div", { class: "table-box", tabindex: "0", role: "region", "aria-label": experiment.name },
    el("table", {}, el("thead", {}, el("tr", {}, ...head.map((name, i) => el("th", i === 0 || i === head.length - 1 ? {} : { class: "number" }, name)))),
       el("tbody", {}, ...rows.map((row, p) => { const [name, ...rest] = cells(row); return el("tr", {}, first(name, p), ...rest); }))));
}

/// Links to the animations, which lie beside the page.
function animations(experiment: Experiment): HTMLElement | null {
  if (experiment.pages.length === 0) return null;
  const links = experiment.pages.map((page) => el("a", { class: "animation", href: page.file }, `▶ ${page.name.replaceAll("_", " ")}`));
  return el("p", { class: "animations" }, experiment.pages.length === 1 ? "Animation: " : "Animations: ", ...links);
}

/// The section and its charts, which are to be drawn once it is in the document.
export function section(experiment: Experiment, number: number): { element: HTMLElement; charts: Chart[] } {
  const charts: Chart[] = [], times = timeChart(experiment);
  if (times) charts.push(times);
  if (experiment.plots.includes("cost_against_width")) charts.push(...widthCharts(experiment));
  if (experiment.plots.includes("profiles")) charts.push(...profileCharts(experiment));
  const figures = charts.map((chart) => chart.figure), scatter = costScatter(experiment);
  if (scatter) {
    charts.push(scatter.chart);
    figures.push(scatter.figure);
  }
  const parts = [el("h2", {}, experiment.title || experiment.name), el("p", { class: "conditions" }, experiment.conditions),
                 ...(experiment.table ? [teamTable(experiment, experiment.table)] : [table(experiment), legend()]),
                 animations(experiment), sayings(experiment), el("div", { class: "charts" }, ...figures), failures(experiment)];
  return { element: el("section", { id: `e${number}` }, ...parts.filter((part) => part !== null)), charts };
}
