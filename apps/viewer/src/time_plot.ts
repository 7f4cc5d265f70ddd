// One plot along a plan: a time axis and a playhead that follows the slider.

import uPlot from "uplot";
import type { Plan } from "./data";
import { el, nameCanvas } from "./dom";
import { palette } from "./palette";

const kFont = "11px system-ui, sans-serif";

/// What stands on the time axis: seconds, or the number of the waypoint for a plan without time. `time` is in
/// waypoints; of a plan with time the last one may follow sooner than the others.
export class TimeScale {
  private readonly last: number;
  private readonly short: number;  // s between the last two
  constructor(private readonly period: number, private readonly duration: number, waypoints: number) {
    this.last = Math.max(0, waypoints - 1);
    this.short = duration - Math.max(0, this.last - 1) * period;
  }
  static of(plan: Plan): TimeScale { return new TimeScale(plan.period, plan.duration, plan.waypoints); }
  get label(): string { return this.period > 0 ? "s" : "waypoint"; }
  x(time: number): number {
    if (this.period <= 0) return time + 1;
    return time <= this.last - 1 ? time * this.period : this.duration - (this.last - time) * this.short;
  }
  time(x: number): number {
    if (this.period <= 0) return x - 1;
    const even = this.duration - this.short;
    return x <= even || this.short <= 0 ? x / this.period : this.last - (this.duration - x) / this.short;
  }
  axis(label?: string): uPlot.Axis {
    const whole = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];
    return axis({ scale: "x", label, size: 26, space: 46, incrs: this.period > 0 ? [0.05, 0.1, 0.2, 0.5, ...whole] : whole });
  }
}

/// A plot with a playhead that follows the time slider; pressing or dragging in it seeks.
export class TimePlot {
  readonly plot: uPlot;
  private readonly head = el("div", { class: "playhead" });

  constructor(private readonly box: HTMLElement, height: number, private readonly scale: TimeScale, options: Partial<uPlot.Options> & { series: uPlot.Series[] },
              data: uPlot.AlignedData, seek: (time: number) => void) {
    const { ink, muted } = palette();
    this.plot = new uPlot({
      width: box.clientWidth || 380, height, padding: [10, 12, 0, 0],
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, sync: { key: "plan" }, points: { size: 6 }, y: false },
      ...options,
    }, data, box);
    nameCanvas(this.plot, `${box.closest("section")?.querySelector("h2")?.textContent ?? "Plot"} against ${scale.label === "s" ? "time" : "waypoints"}: ${options.series.slice(1).map(({ label }) => label).join(", ")}`);
    this.head.style.background = ink;
    box.style.setProperty("--cursor", muted);
    this.plot.over.append(this.head);
    const at = (event: PointerEvent) =>
      seek(scale.time(this.plot.posToVal(event.clientX - this.plot.over.getBoundingClientRect().left, "x")));
    this.plot.over.addEventListener("pointerdown", (event) => { this.plot.over.setPointerCapture(event.pointerId); at(event); });
    this.plot.over.addEventListener("pointermove", (event) => { if (event.buttons & 1) at(event); });
    this.observer.observe(box);
  }

  private readonly observer = new ResizeObserver(() => {
    const width = this.box.clientWidth;
    if (width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.plot.height });
    this.showTime(this.time);
  });
  private time = 0;

  showTime(time: number): void {
    this.time = time;
    this.head.style.transform = `translateX(${this.plot.valToPos(this.scale.x(time), "x").toFixed(1)}px)`;
  }

  destroy(): void {
    this.observer.disconnect();
    this.plot.destroy();
  }
}

export function axis(extra: Partial<uPlot.Axis>): uPlot.Axis {
  const { muted, line } = palette();
  return { stroke: muted, font: kFont, labelFont: kFont, labelSize: 18, labelGap: 0, size: 46, gap: 4, space: 24,
           grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1, size: 4 }, ...extra };
}

/// A horizontal line at `value` of `scale`, and what lies beyond it (`side` -1: below, 1: above) tinted.
export function limitLine(u: uPlot, scale: string, value: number, color: string, side: -1 | 0 | 1, dash: number[] = []): void {
  const { left, top, width, height } = u.bbox, draw = u.ctx, y = u.valToPos(value, scale, true);
  draw.save();
  draw.beginPath();
  draw.rect(left, top, width, height);
  draw.clip();
  draw.fillStyle = draw.strokeStyle = color;
  draw.globalAlpha = 0.12;
  if (side < 0) draw.fillRect(left, y, width, Math.max(0, top + height - y));
  if (side > 0) draw.fillRect(left, top, width, Math.max(0, y - top));
  draw.globalAlpha = 1;
  draw.lineWidth = devicePixelRatio;
  draw.setLineDash(dash.map((length) => length * devicePixelRatio));
  draw.beginPath();
  draw.moveTo(left, Math.round(y) + 0.5);
  draw.lineTo(left + width, Math.round(y) + 0.5);
  draw.stroke();
  draw.restore();
}
