// The plots of one experiment.

import { el } from "../dom";
import { Chart, greatest, least, type ChartOptions, type Line } from "./chart";
import { isValid, type Experiment, type Planner, type Run, type Sweep } from "./data";

const kDegrees = 180 / Math.PI;

/// Share of all runs that were solved with a valid path within a time, up to the time limit. Null for so few
/// runs that the table says it all.
export function timeChart(experiment: Experiment): Chart | null {
  if (experiment.planners.every((planner) => planner.total < 3)) return null;
  const timesOf = experiment.planners.map((_, p) =>
    experiment.runs.filter((run) => run.planner === p && isValid(run)).map((run) => Math.max(run.time, 1e-6)).sort((a, b) => a - b));
  const all = timesOf.flat(), longest = Math.max(greatest(experiment.runs.map((run) => run.time)), 1e-6);
  const limit = experiment.timeLimit ?? longest;
  const first = 10 ** Math.floor(Math.log10(Math.min(least(all), limit / 10))), last = Math.max(greatest(all), limit);
  const lines = experiment.planners.map((planner, p): Line => {
    const times = timesOf[p], shares = times.map((_, i) => 100 * (i + 1) / planner.total);
    return { name: planner.label, color: p, steps: true, x: [first, ...times, last], y: [0, ...shares, shares.at(-1) ?? 0] };
  });
  return new Chart({ title: "Success against deadline: solved and valid within a time", x: "planning time, s", y: "runs, %", logX: true,
                     xRange: [first, last], yRange: [0, 104], lines });
}

/// A figure of valid runs against the option `width`, a line a problem; for many problems their median.
function againstWidth(experiment: Experiment, figure: (run: Run) => number | null): Line[] {
  const widthOf = experiment.planners.map((planner) => Number(planner.options.width));
  const figures = (problem: number | null, p: number) => experiment.runs
    .filter((run) => run.planner === p && isValid(run) && (problem === null || run.problem === problem)).map(figure).filter((value) => value !== null).sort((a, b) => a - b);
  const line = (name: string, color: number, problem: number | null): Line => {
    const out: Line = { name, color, x: [], y: [], dots: true };
    widthOf.map((width, p) => ({ width, p })).filter(({ width }) => Number.isFinite(width)).sort((a, b) => a.width - b.width).forEach(({ width, p }) => {
      const found = figures(problem, p), middle = found.length / 2;
      if (found.length === 0) return;
      out.x.push(width);
      out.y.push((found[Math.ceil(middle) - 1] + found[Math.floor(middle)]) / 2);
    });
    return out;
  };
  const few = experiment.problems.length <= 8;
  const lines = few ? experiment.problems.map((name, i) => line(name, i, i)) : [line("median of all problems", 0, null)];
  return lines.filter((each) => each.x.length > 0);
}

/// The planners that have a width, narrowest first.
function byWidth(experiment: Experiment): Planner[] {
  return experiment.planners.filter((planner) => Number.isFinite(Number(planner.options.width)))
    .sort((a, b) => Number(a.options.width) - Number(b.options.width));
}

/// The axis of widths.
function widthAxis(experiment: Experiment): Pick<ChartOptions, "x" | "logX" | "xRange" | "xTicks"> {
  const xTicks = [...new Set(byWidth(experiment).map((planner) => Number(planner.options.width)))];
  return { x: "beam width k", logX: true, xRange: [xTicks[0] / 1.25, xTicks.at(-1)! * 1.25], xTicks };
}

/// Share of all runs that were solved with a valid path against the option `width`. None where no planner has it.
export function shareCharts(experiment: Experiment): Chart[] {
  const planners = byWidth(experiment);
  if (planners.length === 0) return [];
  const line: Line = { name: "solved and valid", color: 0, dots: true, x: planners.map((planner) => Number(planner.options.width)),
                       y: planners.map((planner) => 100 * planner.valid / planner.total),
                       bounds: planners.map((planner) => [100 * planner.valid_share_95[0], 100 * planner.valid_share_95[1]]) };
  return [new Chart({ ...widthAxis(experiment), title: "Share solved against beam width", y: "runs, %", yRange: [0, 104], lines: [line], legend: false,
                     note: `Of ${planners[0].total} runs on ${planners[0].problems} ${planners[0].problems === 1 ? "problem" : "problems"} each; bars are intervals at 95 % confidence for problems like these.` })];
}

/// Cost and time against the option `width`. None where no planner has it.
export function widthCharts(experiment: Experiment): Chart[] {
  if (byWidth(experiment).length === 0) return [];
  const costs = againstWidth(experiment, (run) => run.cost), times = againstWidth(experiment, (run) => Math.max(run.time, 1e-6));
  const common = widthAxis(experiment);
  return [new Chart({ ...common, title: "Path cost against beam width", y: "path cost, J", lines: costs }),
          new Chart({ ...common, title: "Planning time against beam width", y: "planning time, s", logY: true, lines: times })];
}

/// Success and time of each planner against the edge of the voxels.
export function resolutionCharts(sweep: Sweep): Chart[] {
  const mm = sweep.resolutions_m.map((resolution) => Number((1000 * resolution).toPrecision(6)));
  const axis = { x: "edge of a voxel, mm", logX: true, xRange: [mm[0] / 1.2, mm.at(-1)! * 1.2] as [number, number], xTicks: mm };
  const success = sweep.planners.map(({ label, points }, p): Line => ({
    name: label, color: p, dots: true, x: mm, y: points.map((point) => 100 * point.valid / Math.max(point.total, 1)),
    bounds: points.map((point) => [100 * point.valid_share_95[0], 100 * point.valid_share_95[1]]) }));
  const times = sweep.planners.map(({ label, points }, p): Line => {
    const known = mm.map((x, i) => ({ x, y: points[i].time_median_s })).filter(({ y }) => y !== null);
    return { name: label, color: p, dots: true, x: known.map(({ x }) => x), y: known.map(({ y }) => Math.max(y!, 1e-6)) };
  });
  return [new Chart({ ...axis, title: "Success against resolution", y: "valid runs, %", yRange: [0, 104], lines: success,
                      note: "Bars are intervals at 95 % confidence for problems like these." }),
          new Chart({ ...axis, title: "Time against resolution", y: "median planning time, s", logY: true, lines: times,
                      note: "Of solved runs, whichever those are at each resolution." })];
}

/// Joint values along the path of each planner to the first problem, as the paper plots them.
export function profileCharts(experiment: Experiment): Chart[] {
  const anglesOnly = !experiment.prismatic.includes(true), lengthsOnly = !experiment.prismatic.includes(false);
  const refused = (p: number) => experiment.runs.some((run) => run.planner === p && run.problem === 0 && run.run === 1 && run.check !== "valid");
  return experiment.profiles.map(({ planner, waypoints }) => new Chart({
    title: `Joint profiles: ${experiment.planners[planner].label}, ${experiment.problems[0]}${refused(planner) ? " (path refused by the check)" : ""}`,
    x: "waypoint", wholeX: true, y: anglesOnly ? "joint value, deg" : lengthsOnly ? "joint value, m" : "joint value, deg or m",
    lines: experiment.joints.map((name, j): Line => ({
      name, color: j, x: waypoints.map((_, i) => i), y: waypoints.map((q) => experiment.prismatic[j] ? q[j] : q[j] * kDegrees), dots: waypoints.length < 25,
    })),
  }));
}

/// Cost of one planner's paths against another's, both to be chosen. Null when there are no two to compare.
export function costScatter(experiment: Experiment): { figure: HTMLElement; chart: Chart } | null {
  const costOf = experiment.planners.map((_, p) => {
    const costs = new Map<string, number>();
    for (const run of experiment.runs) if (run.planner === p && isValid(run) && run.cost !== null) costs.set(`${run.problem}/${run.run}`, run.cost);
    return costs;
  });
  const solvers = experiment.planners.map((_, p) => p).filter((p) => costOf[p].size > 0);
  const shared = (a: number, b: number) => [...costOf[a].keys()].filter((key) => costOf[b].has(key)).length;
  const pairs = solvers.flatMap((a) => solvers.filter((b) => b < a).map((b) => ({ a, b, count: shared(a, b) })));
  const best = pairs.reduce((most, pair) => pair.count > most.count ? pair : most, { a: 0, b: 0, count: 0 });
  if (best.count < 3) return null;
  const options = (a: number, b: number): ChartOptions => {
    const keys = [...costOf[a].keys()].filter((key) => costOf[b].has(key));
    const cheaper = keys.filter((key) => costOf[b].get(key)! < costOf[a].get(key)!).length;
    return {
      title: "Path cost, problem by problem", diagonal: true, legend: false,
      x: `${experiment.planners[a].label}, J`, y: `${experiment.planners[b].label}, J`,
      lines: [{ name: "problems", color: b, points: true, x: keys.map((key) => costOf[a].get(key)!), y: keys.map((key) => costOf[b].get(key)!) }],
      note: `Runs that both solved. Below the dashed line ${experiment.planners[b].label} is cheaper: ${cheaper} of ${keys.length}.`,
    };
  };
  const select = (chosen: number, name: string) => el("select", { "aria-label": name },
    ...solvers.map((p) => el("option", p === chosen ? { value: String(p), selected: "" } : { value: String(p) }, experiment.planners[p].label)));
  const across = select(best.a, "planner across"), up = select(best.b, "planner up");
  const chart = new Chart(options(best.a, best.b));
  const note = chart.figure.querySelector(".note")!;
  const choose = () => {
    const chosen = options(Number(across.value), Number(up.value));
    note.textContent = chosen.note!;
    chart.show(chosen);
  };
  for (const box of [across, up]) box.addEventListener("change", choose);
  chart.figure.insertBefore(el("div", { class: "choice" }, el("label", {}, "across ", across), el("label", {}, "up ", up)), chart.figure.children[1]);
  return { figure: chart.figure, chart };
}
