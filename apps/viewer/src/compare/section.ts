// All experiments in one table; and one experiment: its table, what the paper says, its plots, and the runs that failed.

import { el } from "../dom";
import { colorOf, dashOf, plain, type Chart } from "./chart";
import { isValid, type Experiment, type Figure, type Meanings, type Overview, type Planner, type Run, type Sweep } from "./data";
import { sortable } from "./sortable";
import { costScatter, profileCharts, resolutionCharts, shareCharts, timeChart, widthCharts } from "./plots";

const statusWords: Record<string, string> = {
  start_invalid: "start invalid", goal_invalid: "goal invalid", no_path: "no path", timed_out: "timed out", out_of_memory: "out of memory",
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

/// The problem of a run, with its 3D page where there is one: the run's own, else the problem's.
function linked(experiment: Experiment, run: Run): HTMLElement | string {
  const name = experiment.problems[run.problem], file = run.page ?? experiment.pages.find((each) => each.problem === run.problem)?.file;
  return file ? el("a", { href: file, title: "in 3D" }, name) : name;
}

function boxed(label: string, inner: HTMLElement): HTMLElement {
  return el("div", { class: "table-box", tabindex: "0", role: "region", "aria-label": label }, inner);
}

const cell = (text: string, value: number | null) => el("td", value === null ? { class: "number" } : { class: "number", "data-value": String(value) }, text);
const share = (value: number) => (100 * value).toFixed(value > 0 && value < 1 ? 1 : 0);

/// A planner's colour; striped where another has the same.
const swatch = (color: number) =>
  el("i", { class: dashOf(color) ? "swatch dashed" : "swatch", style: `background:${colorOf(color)}`, "data-color": String(color) });

/// The planner's name with its colour, options on hovering, and what it does not promise.
function nameCell(planner: Planner, color: number, ...marks: HTMLElement[]): HTMLElement {
  const options = Object.entries(planner.options).map(([key, value]) => `${key} = ${value}`).join("\n");
  const promise = planner.certified ? [] : [el("small", { class: "mark", title: "This planner does not prove its edges" }, "not certified")];
  return el("td", { class: "planner", "data-value": String(color) },
    el("span", { class: "name", title: `${planner.planner}\n${options}` }, swatch(color), planner.label),
    ...promise, ...marks);
}

/// A bar, the counts, and the share of valid runs with its interval.
function successCells(planner: Planner): HTMLElement[] {
  const [low, high] = planner.valid_share_95, success = planner.valid / Math.max(planner.total, 1);
  return [el("td", { class: "runs", "data-value": String(planner.valid) }, bar(planner)),
    el("td", { class: `number${planner.valid < planner.solved ? " bad" : ""}`, "data-value": String(planner.solved) }, `${planner.solved} / ${planner.valid} / ${planner.total}`),
    cell(`${share(success)} (${share(low)}–${share(high)})`, success)];
}

const timeCells = (planner: Planner) => [planner.time_median_s, planner.cpu_median_s, planner.time_p95_s].map((value) => cell(seconds(value), value));

/// What the CPU to plan was spent on, in shares: a bar, and its seconds on hovering. Sorts by the share of proofs.
function workCell(planner: Planner): HTMLElement {
  const parts: [string, number | null][] = [["search", planner.search_cpu_mean_s], ["shortcuts", planner.shortcut_cpu_mean_s], ["proofs", planner.proof_cpu_mean_s]];
  const whole = parts.reduce((sum, [, value]) => sum + (value ?? 0), 0);
  if (whole === 0) return cell("–", null);
  const words = parts.map(([name, value]) => value === null ? `no ${name}` : `${name} ${share(value / whole)} % (${seconds(value)})`).join(", ");
  const beside = `before it, space ${seconds(planner.space_cpu_mean_s)}; after it, check ${seconds(planner.check_cpu_mean_s)}`;
  return el("td", { class: "work", "data-value": String((planner.proof_cpu_mean_s ?? 0) / whole), title: `CPU of a solved run, mean: ${words}; ${beside}` },
    el("div", { class: "bar", role: "img", "aria-label": words }, ...parts.map(([name, value]) => el("i", { class: name, style: `width:${(100 * (value ?? 0) / whole).toFixed(2)}%` }))),
    el("small", {}, parts.map(([, value]) => value === null ? "–" : share(value / whole)).join(" / ")));
}

/// Of the length of a path in joint space, in which turns and slides count alike.
const lengthUnit = ({ prismatic }: Experiment) => !prismatic.includes(true) ? "rad" : !prismatic.includes(false) ? "m" : "rad and m";

function table(experiment: Experiment): HTMLElement {
  const head = ["planner", "runs", "solved / valid / total", "success, % (95\u00a0%)", "time, median", "CPU, median", "time, p95", "search / shortcuts / proofs, %", "cost, J", `length, ${lengthUnit(experiment)}`, "steps", "not solved"];
  const rows = experiment.planners.map((planner, p) => el("tr", {}, nameCell(planner, p), ...successCells(planner), ...timeCells(planner),
    workCell(planner), cell(figure(planner.cost_median_joules), planner.cost_median_joules), cell(figure(planner.length_median_rad), planner.length_median_rad),
    cell(figure(planner.steps_median, 6), planner.steps_median), el("td", {}, unsolved(planner))));
  return boxed(experiment.name, sortable(head, new Set([2, 3, 4, 5, 6, 8, 9, 10]), rows));
}

/// All experiments of single robots: only planners with the same runs are told apart by it, and the others say so.
export function overviewSection(overview: Overview): HTMLElement {
  const head = ["planner", "experiments", "runs", "solved / valid / total", "success, % (95\u00a0%)", "time, median", "CPU, median", "time, p95", "search / shortcuts / proofs, %",
                "shared: time", "shared: cost, J", `shared: length, ${overview.length_unit}`, "not solved"];
  const rows = overview.planners.map((row, p) => {
    const part = row.comparable ? [] : [el("small", { class: "mark", title: `It has ${row.total} of the ${overview.runs} runs` }, "* only some runs")];
    const mixed = row.same_options ? [] : [el("small", { class: "mark", title: "Planner or options differ between experiments; shown are the first one's" }, "options differ")];
    return el("tr", row.comparable ? {} : { class: "apart" }, nameCell(row, p, ...part, ...mixed), cell(`${row.experiments} of ${overview.experiments}`, row.experiments),
      ...successCells(row), ...timeCells(row), workCell(row), cell(seconds(row.shared.time_median_s), row.shared.time_median_s),
      cell(figure(row.shared.cost_median_joules), row.shared.cost_median_joules), cell(figure(row.shared.length_median_rad), row.shared.length_median_rad),
      el("td", {}, unsolved(row)));
  });
  return el("section", { id: "all" }, el("h2", {}, "All experiments"),
    el("p", { class: "conditions" }, overview.notes.join(" ")), boxed("all experiments", sortable(head, new Set([1, 3, 4, 5, 6, 7, 9, 10, 11]), rows)), legend(), workLegend());
}

/// Experiments that differ in resolution alone, side by side.
export function sweepSection(sweep: Sweep, number: number): { element: HTMLElement; charts: Chart[] } {
  const head = ["planner", "voxels, mm", "runs", "solved / valid / total", "success, % (95\u00a0%)", "time, median", "CPU, median", "time, p95"];
  const rows = sweep.planners.flatMap(({ points }, p) => points.map((point, i) => el("tr", {}, nameCell(point, p),
    cell(figure(1000 * sweep.resolutions_m[i]), sweep.resolutions_m[i]), ...successCells(point), ...timeCells(point))));
  const charts = resolutionCharts(sweep);
  return { charts, element: el("section", { id: `r${number}` }, el("h2", {}, `Effect of resolution: ${sweep.experiments.join(", ")}`),
    el("p", { class: "conditions" }, sweep.note), boxed("effect of resolution", sortable(head, new Set([1, 3, 4, 5, 6, 7]), rows)), legend(),
    el("div", { class: "charts" }, ...charts.map((chart) => chart.figure))) };
}

/// Each pair of planners on the problems that both had.
function pairs(experiment: Experiment): HTMLElement | null {
  if (experiment.pairs.length === 0 || experiment.problems.length < 3) return null;
  const label = (p: number) => experiment.planners[p].label;
  const p = (value: number) => value < 1e-4 ? "< 0.0001" : plain(Number(value.toPrecision(2)));
  const ratio = (of: Figure) => of.problems === 0 ? [cell("–", null), cell("–", null)] : [cell(`× ${plain(Number(of.ratio.toPrecision(3)))}`, of.ratio), cell(p(of.p), of.p)];
  const rows = experiment.pairs.map((pair) => el("tr", {}, el("td", {}, `${label(pair.first)} : ${label(pair.second)}`),
    cell(`${pair.firstMore} : ${pair.secondMore}`, pair.firstMore - pair.secondMore), cell(p(pair.successP), pair.successP),
    ...ratio(pair.cpu), ...ratio(pair.cost), el("td", { class: "why" }, pair.words)));
  const head = ["planners", "solves more", "p (sign)", "CPU", "p (rank)", "cost", "p (rank)", "in words"];
  return el("details", experiment.pairs.length <= 6 ? { open: "", class: "pairs" } : { class: "pairs" }, el("summary", {}, `Paired comparisons: ${experiment.pairs.length}`),
    el("p", { class: "note" }, "Problem by problem, the first planner against the second; each problem counts once, by the median of its seeds. \"Solves more\" counts problems of which one has more valid runs; CPU and cost are of problems that both solve. p is how probable a difference as large would be if neither were better (sign test; Wilcoxon's signed-rank test), corrected for the number of pairs (Holm): below 0.05 the words call it a difference."),
    boxed(`pairs of ${experiment.name}`, sortable(head, new Set([1, 2, 3, 4, 5, 6]), rows)));
}

/// The worst runs of each planner, with their pages where those were drawn.
function worst(experiment: Experiment): HTMLElement | null {
  if (experiment.worst.length === 0) return null;
  const best = new Map<number, number>();
  for (const run of experiment.runs.filter(isValid)) best.set(run.problem, Math.min(best.get(run.problem) ?? Infinity, run.cost ?? Infinity));
  const excess = (run: Run) => !isValid(run) || run.cost === null ? null : best.get(run.problem)! > 0 ? run.cost / best.get(run.problem)! : 1;
  const mm = (run: Run) => run.clearance === null || !isValid(run) ? null : 1000 * run.clearance;
  const rows = experiment.worst.map(({ kind, run: index }) => {
    const run = experiment.runs[index], times = excess(run);
    return el("tr", {}, el("td", {}, experiment.planners[run.planner].label), el("td", {}, kind), el("td", {}, linked(experiment, run)),
      cell(seconds(run.time), run.time), cell(seconds(run.cpu), run.cpu), cell(figure(mm(run), 3), mm(run)),
      cell(isValid(run) ? figure(run.cost) : "–", isValid(run) ? run.cost : null), cell(times === null ? "–" : `× ${plain(Number(times.toPrecision(3)))}`, times),
      el("td", { class: "id" }, run.id));
  });
  const head = ["planner", "worst", "problem", "time", "CPU", "clearance, mm", "cost, J", "of the best", "run"];
  return el("details", { class: "worst" }, el("summary", {}, "Worst cases of each planner"),
    el("p", { class: "note" }, "Failed: the longest run without a valid path. Of valid runs: slowest, tightest (by the least clearance that the check proves, which may be less than there is) and dearest (against the best path of any planner). Underlined problems open in 3D."),
    boxed(`worst cases of ${experiment.name}`, sortable(head, new Set([3, 4, 5, 6, 7]), rows)));
}

function legend(): HTMLElement {
  const key = (kind: string, text: string) => el("span", {}, el("i", { class: `box ${kind}` }), text);
  return el("p", { class: "note legend" }, key("valid", "valid"), key("invalid", "solved, but not proved valid by the independent check"), key("", "not solved"));
}

function workLegend(): HTMLElement {
  const key = (kind: string, text: string) => el("span", {}, el("i", { class: `box ${kind}` }), text);
  return el("p", { class: "note legend" }, "CPU to plan, of all solved runs together:", key("search", "search"), key("shortcuts", "shortcuts"), key("proofs", "proofs of edges, during both"));
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
  const rows = shown.map((run) => el("tr", {}, el("td", {}, linked(experiment, run)), el("td", {}, experiment.planners[run.planner].label),
    el("td", { class: "bad" }, word(run.status, run.check)), el("td", { class: "why" }, run.explanation ?? ""), el("td", { class: "id" }, run.id)));
  const rest = failed.length > shown.length ? [el("p", { class: "note" }, `${failed.length - shown.length} more are in results.csv.`)] : [];
  return el("details", failed.length <= 12 ? { open: "" } : {}, el("summary", {}, `Runs without a valid path: ${failed.length} of ${experiment.runs.length}`),
    boxed(`failures of ${experiment.name}`, sortable(["problem", "planner", "answer", "explanation", "run"], new Set(), rows)), ...rest);
}

/// The options in force, each with what it means.
function options(experiment: Experiment, meanings: Meanings): HTMLElement | null {
  const rows = experiment.planners.flatMap((planner) => Object.entries(planner.options).map(([option, value]) => el("tr", {},
    el("td", {}, planner.label), el("td", {}, option), el("td", {}, value), el("td", { class: "why" }, meanings[planner.planner]?.[option] ?? ""))));
  if (rows.length === 0) return null;
  return el("details", {}, el("summary", {}, "Options of the planners"),
    boxed(`options of ${experiment.name}`, sortable(["planner", "option", "value", "meaning"], new Set(), rows)));
}

/// Of teams: what the program prints.
function teamTable(experiment: Experiment, [head, ...rows]: string[][]): HTMLElement {
  const cells = (row: string[]) => row.map((text, i) => i === 0 || i === row.length - 1 ? el("td", {}, text.replaceAll("_", " ")) : el("td", { class: "number" }, text));
  const first = (cell: HTMLElement, p: number) => {
    cell.className = "planner";
    cell.prepend(swatch(p));
    return cell;
  };
  return el("div", { class: "table-box", tabindex: "0", role: "region", "aria-label": experiment.name },
    el("table", {}, el("thead", {}, el("tr", {}, ...head.map((name, i) => el("th", i === 0 || i === head.length - 1 ? { scope: "col" } : { class: "number", scope: "col" }, name)))),
       el("tbody", {}, ...rows.map((row, p) => { const [name, ...rest] = cells(row); return el("tr", {}, first(name, p), ...rest); }))));
}

/// Links to the animations, which lie beside the page.
function animations(experiment: Experiment): HTMLElement | null {
  if (experiment.pages.length === 0) return null;
  const links = experiment.pages.map((page) => el("a", { class: "animation", href: page.file }, `▶ ${page.name.replaceAll("_", " ")}`));
  return el("p", { class: "animations" }, experiment.pages.length === 1 ? "Animation: " : "Animations: ", ...links);
}

/// The section and its charts, which are to be drawn once it is in the document.
export function section(experiment: Experiment, number: number, meanings: Meanings): { element: HTMLElement; charts: Chart[] } {
  const charts: Chart[] = [], times = timeChart(experiment);
  if (times) charts.push(times);
  if (experiment.plots.includes("share_against_width")) charts.push(...shareCharts(experiment));
  if (experiment.plots.includes("cost_against_width")) charts.push(...widthCharts(experiment));
  if (experiment.plots.includes("profiles")) charts.push(...profileCharts(experiment));
  const figures = charts.map((chart) => chart.figure), scatter = costScatter(experiment);
  if (scatter) {
    charts.push(scatter.chart);
    figures.push(scatter.figure);
  }
  const parts = [el("h2", {}, experiment.title || experiment.name), el("p", { class: "conditions" }, experiment.conditions),
                 ...(experiment.table ? [teamTable(experiment, experiment.table)] : [table(experiment), legend(), workLegend()]),
                 animations(experiment), sayings(experiment), el("div", { class: "charts" }, ...figures), pairs(experiment), worst(experiment), failures(experiment), options(experiment, meanings)];
  return { element: el("section", { id: `e${number}` }, ...parts.filter((part) => part !== null)), charts };
}
