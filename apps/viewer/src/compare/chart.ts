// One plot of uPlot with labelled axes and a legend of its own; drawn anew when the theme or the width changes.

import uPlot from "uplot";
import { el, nameCanvas } from "../dom";
import { palette } from "../palette";

const kFont = "12px system-ui, sans-serif";

export interface Line {
  name: string;
  color: number;               // index into the palette
  x: number[]; y: number[];
  steps?: boolean;             // a staircase, as of an empirical distribution
  points?: boolean;            // dots, with no line between them
  dots?: boolean;              // dots on the line
  bounds?: [number, number][]; // of each y: a bar from here to there
}

export interface ChartOptions {
  title: string;
  x: string; y: string;        // labels with units
  logX?: boolean; logY?: boolean;
  wholeX?: boolean;            // ticks at whole numbers only
  xRange?: [number, number];
  xTicks?: number[];           // else chosen
  yRange?: [number, number];
  diagonal?: boolean;          // equal values, and the same range on both axes
  lines: Line[];
  legend?: boolean;
  note?: string;
}

/// Values as a person writes them: 0.001, 0.1, 10, 1,000.
export const plain = (value: number) => value === 0 ? "0" : Math.abs(value) < 1e-4 || Math.abs(value) >= 1e6
  ? value.toExponential(0) : Number(value.toPrecision(6)).toLocaleString("en-US", { maximumSignificantDigits: 6 });

export const dashOf = (color: number) => color >= palette().series.length ? [6, 4] : undefined;
export const colorOf = (color: number) => palette().series[color % palette().series.length];

/// One sorted x for all lines, as uPlot wants it; a line has a gap where it has no value.
function aligned(lines: Line[]): uPlot.AlignedData {
  return uPlot.join(lines.map((line) => {
    const order = line.x.map((_, i) => i).sort((a, b) => line.x[a] - line.x[b]);
    return [order.map((i) => line.x[i]), order.map((i) => line.y[i])] as uPlot.AlignedData;
  }), lines.map(() => [0, 2]));
}

/// Of any number of values, where `Math.min(...values)` takes some hundred thousand arguments at most.
export const least = (values: number[]) => values.reduce((a, b) => Math.min(a, b), Infinity);
export const greatest = (values: number[]) => values.reduce((a, b) => Math.max(a, b), -Infinity);

function span(values: number[]): [number, number] {
  const low = least(values), high = greatest(values), margin = 0.06 * (high - low || Math.abs(high) || 1);
  return [low - margin, high + margin];
}

const decades = (values: number[]): [number, number] =>
  [10 ** Math.floor(Math.log10(least(values))), 10 ** Math.ceil(Math.log10(greatest(values) * 1.001))];

/// Scattered dots may share an x, which aligned data cannot: uPlot's own mode for them is replaced by a hook.
function drawDots(u: uPlot, lines: Line[]): void {
  const { ctx, bbox } = u, size = 3.2 * devicePixelRatio;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const line of lines.filter((each) => each.points)) {
    ctx.fillStyle = colorOf(line.color);
    ctx.globalAlpha = 0.75;
    line.x.forEach((x, i) => {
      ctx.beginPath();
      ctx.arc(u.valToPos(x, "x", true), u.valToPos(line.y[i], "y", true), size, 0, 2 * Math.PI);
      ctx.fill();
    });
  }
  ctx.restore();
}

function drawBounds(u: uPlot, lines: Line[]): void {
  const { ctx } = u, foot = 4 * devicePixelRatio;
  ctx.save();
  ctx.lineWidth = 1.5 * devicePixelRatio;
  for (const line of lines) {
    ctx.strokeStyle = colorOf(line.color);
    line.bounds?.forEach(([low, high], i) => {
      const x = u.valToPos(line.x[i], "x", true), [bottom, top] = [u.valToPos(low, "y", true), u.valToPos(high, "y", true)];
      ctx.beginPath();
      for (const [from, to] of [[[x, bottom], [x, top]], [[x - foot, bottom], [x + foot, bottom]], [[x - foot, top], [x + foot, top]]]) {
        ctx.moveTo(from[0], from[1]);
        ctx.lineTo(to[0], to[1]);
      }
      ctx.stroke();
    });
  }
  ctx.restore();
}

function drawDiagonal(u: uPlot): void {
  const { ctx } = u, [low, high] = [u.scales.x.min!, u.scales.x.max!];
  ctx.save();
  ctx.strokeStyle = palette().muted;
  ctx.setLineDash([5 * devicePixelRatio, 4 * devicePixelRatio]);
  ctx.lineWidth = devicePixelRatio;
  ctx.beginPath();
  ctx.moveTo(u.valToPos(low, "x", true), u.valToPos(low, "y", true));
  ctx.lineTo(u.valToPos(high, "x", true), u.valToPos(high, "y", true));
  ctx.stroke();
  ctx.restore();
}

export class Chart {
  readonly figure = el("figure", { class: "chart" });
  private readonly box = el("div", { class: "plot" });
  private readonly keys = el("div", { class: "keys" });
  private plot: uPlot | null = null;

  constructor(private options: ChartOptions) {
    this.figure.append(el("figcaption", {}, options.title), this.box);
    if (options.legend !== false) this.figure.append(this.keys);
    if (options.note) this.figure.append(el("p", { class: "note" }, options.note));
    new ResizeObserver(() => {
      const width = this.box.clientWidth;
      if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.height(width) });
    }).observe(this.box);
  }

  show(options: ChartOptions): void {
    this.options = options;
    this.draw();
  }

  private height(width: number): number { return Math.round(Math.min(320, Math.max(220, 0.62 * width))); }

  draw(): void {
    this.plot?.destroy();
    const { lines, logX, logY, diagonal } = this.options, { muted, line: grid, ink } = palette();
    const xs = lines.flatMap((line) => line.x), ys = lines.flatMap((line) => line.y);
    if (xs.length === 0) return this.box.replaceChildren(el("p", { class: "note" }, "Nothing to plot: no run was solved with a valid path."));
    this.box.replaceChildren();
    const both = span([...xs, ...ys]);
    const xRange = this.options.xRange ?? (logX ? decades(xs) : diagonal ? both : span(xs));
    const yRange = this.options.yRange ?? (logY ? decades(ys) : diagonal ? both : span(ys));
    const axis = (label: string, extra: Partial<uPlot.Axis>): uPlot.Axis => ({
      label, stroke: muted, font: kFont, labelFont: `600 ${kFont}`, labelSize: 20, gap: 5, space: 40,
      grid: { stroke: grid, width: 1 }, ticks: { stroke: grid, width: 1, size: 5 }, values: (_u, ticks) => ticks.map((v) => v === null ? "" : plain(v)), ...extra,
    });
    const { xTicks, wholeX } = this.options;
    const ticksX: Partial<uPlot.Axis> = xTicks ? { splits: () => xTicks, filter: (_u, splits) => splits }
      : wholeX ? { incrs: [1, 10, 100, 1000, 10000].flatMap((n) => [n, 2 * n, 5 * n]) } : {};
    const width = this.box.clientWidth || 480;
    this.plot = new uPlot({
      width, height: this.height(width), padding: [12, 18, 0, 4],
      legend: { show: false }, cursor: { drag: { x: false, y: false }, points: { show: false }, x: false, y: false },
      scales: { x: { time: false, distr: logX ? 3 : 1, range: () => xRange }, y: { distr: logY ? 3 : 1, range: () => yRange } },
      axes: [axis(this.options.x, { size: 34, space: 60, ...ticksX }), axis(this.options.y, { size: 56, space: 36 })],
      series: [{}, ...lines.map((line): uPlot.Series => ({
        label: line.name, stroke: colorOf(line.color), dash: dashOf(line.color), width: 2, spanGaps: true,
        paths: line.points ? () => null : line.steps ? uPlot.paths.stepped!({ align: 1 }) : uPlot.paths.linear!(),
        points: { show: line.dots === true, size: 7, fill: colorOf(line.color) },
      }))],
      hooks: { draw: [(u) => { if (diagonal) drawDiagonal(u); drawBounds(u, lines); drawDots(u, lines); }] },
    }, aligned(lines), this.box);
    this.box.style.color = ink;
    nameCanvas(this.plot, `${this.options.title}: ${this.options.y} against ${this.options.x}`);
    this.keys.replaceChildren(...lines.map((line) => el("span", { class: "key" },
      el("i", { style: `background:${colorOf(line.color)}`, class: dashOf(line.color) ? "dashed" : "" }), line.name)));
  }
}
