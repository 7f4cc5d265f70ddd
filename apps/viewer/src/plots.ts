// The plots along a plan: joint values, joint speeds and clearance, one time axis, one playhead.

import uPlot from "uplot";
import type { Arrays, Plan } from "./data";
import { byId, el, metres } from "./dom";
import { palette } from "./palette";

const kDegrees = 180 / Math.PI;
const kHeight = 140, kLabel = 18;  // pixels
const kFont = "11px system-ui, sans-serif";

/// What stands on the time axis: seconds, or the number of the waypoint for a plan without time.
class TimeScale {
  constructor(private readonly period: number) {}
  get label(): string { return this.period > 0 ? "s" : "waypoint"; }
  x(time: number): number { return this.period > 0 ? time * this.period : time + 1; }
  time(x: number): number { return this.period > 0 ? x / this.period : x - 1; }
  axis(label?: string): uPlot.Axis {
    const whole = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000, 10000];
    return axis({ scale: "x", label, size: 26, space: 46, incrs: this.period > 0 ? [0.1, 0.2, 0.5, ...whole] : whole });
  }
}

/// A plot with a playhead that follows the time slider; pressing or dragging in it seeks.
class TimePlot {
  readonly plot: uPlot;
  private readonly head = el("div", { class: "playhead" });

  /// @param x of a time in waypoints, and back
  constructor(private readonly box: HTMLElement, height: number, private readonly scale: TimeScale, options: Partial<uPlot.Options> & { series: uPlot.Series[] },
              data: uPlot.AlignedData, seek: (time: number) => void) {
    const { ink, muted } = palette();
    this.plot = new uPlot({
      width: box.clientWidth || 380, height, padding: [10, 12, 0, 0],
      legend: { show: false },
      cursor: { drag: { x: false, y: false }, sync: { key: "plan" }, points: { size: 6 }, y: false },
      ...options,
    }, data, box);
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

function axis(extra: Partial<uPlot.Axis>): uPlot.Axis {
  const { muted, line } = palette();
  return { stroke: muted, font: kFont, labelFont: kFont, labelSize: 18, labelGap: 0, size: 46, gap: 4, space: 24,
           grid: { stroke: line, width: 1 }, ticks: { stroke: line, width: 1, size: 4 }, ...extra };
}

export class Plots {
  onSeek: (time: number) => void = () => {};
  private joints: TimePlot | null = null;
  private clearance: TimePlot | null = null;
  private speeds: TimePlot | null = null;
  private scale = new TimeScale(0);
  private keys: HTMLElement[] = [];
  private values: Float32Array[] = [];
  private clearances: Float32Array = new Float32Array();
  private plan: Plan | null = null;
  private time = 0;
  private degrees = false;
  private hidden = new Set<string>();

  constructor(private readonly arrays: Arrays) {
    const unit = byId<HTMLButtonElement>("angle-unit");
    unit.addEventListener("click", () => {
      this.degrees = !this.degrees;
      unit.textContent = this.degrees ? "radians" : "degrees";
      this.redraw();
    });
  }

  show(plan: Plan): void {
    this.plan = plan;
    this.hidden.clear();
    const all = this.arrays.f32(plan.values);
    this.values = plan.joints.map((_, j) => all.subarray(j * plan.waypoints, (j + 1) * plan.waypoints));
    this.clearances = this.arrays.f32(plan.clearance);
    this.redraw();
  }

  /// Builds the plots anew: for another plan, unit or theme.
  redraw(): void {
    for (const plot of [this.joints, this.speeds, this.clearance]) plot?.destroy();
    this.joints = this.speeds = this.clearance = null;
    const plan = this.plan;
    byId("joint-card").hidden = !plan || plan.waypoints < 1 || plan.joints.length === 0;
    byId("clearance-card").hidden = !plan || this.clearances.length < 1;
    byId("speed-card").hidden = !plan || plan.period <= 0 || plan.waypoints < 3 || plan.joints.length === 0;
    if (!plan) return;
    this.scale = new TimeScale(plan.period);
    byId("clearance-name").textContent = plan.period > 0 ? "Separation in time" : "Clearance along the path";
    const steps = Array.from({ length: plan.waypoints }, (_, i) => this.scale.x(i));
    if (!byId("joint-card").hidden) this.drawJoints(plan, steps);
    if (!byId("speed-card").hidden) this.drawSpeeds(plan, steps);
    if (!byId("clearance-card").hidden) this.drawClearance(steps);
    document.body.dataset.plots = String(Number(this.joints !== null) + Number(this.clearance !== null));
    this.showTime(this.time);
  }

  private drawJoints(plan: Plan, steps: number[]): void {
    const colors = palette().series, angle = this.degrees ? "deg" : "rad";
    const factor = (j: number) => !plan.prismatic[j] && this.degrees ? kDegrees : 1;
    const hasAngles = plan.prismatic.includes(false), hasLengths = plan.prismatic.includes(true);
    byId("angle-unit").hidden = !hasAngles;
    const series: uPlot.Series[] = [{}, ...plan.joints.map((name, j) => ({
      label: name, scale: plan.prismatic[j] ? "m" : angle, stroke: colors[j % colors.length], width: 1.8, pxAlign: 0,
      show: !this.hidden.has(name), points: { show: steps.length < 12 }, dash: j >= colors.length ? [6, 4] : undefined,
    }))];
    const axes = [this.scale.axis()];
    if (hasAngles) axes.push(axis({ scale: angle, label: angle }));
    if (hasLengths) axes.push(axis({ scale: "m", label: "m", ...(hasAngles ? { side: 1, grid: { show: false } } : {}) }));
    this.joints = new TimePlot(byId("joint-plot"), kHeight, this.scale, {
      series, axes, scales: { x: { time: false } }, hooks: { setCursor: [(u) => this.showKeys(u.cursor.idx ?? null)] },
    }, [steps, ...this.values.map((v, j) => Array.from(v, (x) => x * factor(j)))], (time) => this.onSeek(time));
    this.keys = plan.joints.map((name, j) => {
      const key = el("button", { type: "button", class: "key", title: `Show or hide ${name}` },
                     el("i", { style: `background:${colors[j % colors.length]}` }), name, el("b", {}));
      key.classList.toggle("off", this.hidden.has(name));
      key.addEventListener("click", () => {
        if (!this.hidden.delete(name)) this.hidden.add(name);
        key.classList.toggle("off", this.hidden.has(name));
        for (const plot of [this.joints, this.speeds]) plot?.plot.setSeries(j + 1, { show: !this.hidden.has(name) });
      });
      return key;
    });
    byId("joint-keys").replaceChildren(...this.keys);
  }

  /// The mean speed of each joint from one waypoint to the next, drawn between them.
  private drawSpeeds(plan: Plan, steps: number[]): void {
    const colors = palette().series, angle = this.degrees ? "deg/s" : "rad/s";
    const unit = (j: number) => plan.prismatic[j] ? "m/s" : angle;
    const series: uPlot.Series[] = [{}, ...plan.joints.map((name, j) => ({
      label: name, scale: unit(j), stroke: colors[j % colors.length], width: 1.5, pxAlign: 0, points: { show: false },
      show: !this.hidden.has(name), dash: j >= colors.length ? [6, 4] : undefined,
    }))];
    const axes = [this.scale.axis()];
    if (plan.prismatic.includes(false)) axes.push(axis({ scale: angle, label: angle }));
    if (plan.prismatic.includes(true)) axes.push(axis({ scale: "m/s", label: "m/s", ...(plan.prismatic.includes(false) ? { side: 1, grid: { show: false } } : {}) }));
    const speeds = this.values.map((v, j) => {
      const factor = (this.degrees && !plan.prismatic[j] ? kDegrees : 1) / plan.period;
      return Array.from(v, (x, i) => i === 0 ? 0 : (x - v[i - 1]) * factor);
    });
    this.speeds = new TimePlot(byId("speed-plot"), kHeight, this.scale, { series, axes, scales: { x: { time: false } } },
                               [steps, ...speeds], (time) => this.onSeek(time));
  }

  private drawClearance(steps: number[]): void {
    const colors = palette(), values = this.clearances;
    const known = Array.from(values, (c) => Number.isNaN(c) ? null : c);
    const least = known.reduce<number>((best, c, i) => c !== null && (best < 0 || c < known[best]!) ? i : best, -1);
    const zeroLine = (u: uPlot) => {
      const y = Math.round(u.valToPos(0, "m", true)), { left, top, width, height } = u.bbox, draw = u.ctx;
      draw.save();
      draw.fillStyle = colors.danger;
      draw.globalAlpha = 0.12;
      draw.fillRect(left, y, width, Math.max(0, top + height - y));
      draw.globalAlpha = 1;
      draw.fillRect(left, y - devicePixelRatio / 2, width, devicePixelRatio);
      if (least >= 0) {
        draw.beginPath();
        draw.arc(u.valToPos(this.scale.x(least), "x", true), u.valToPos(known[least]!, "m", true), 4 * devicePixelRatio, 0, 2 * Math.PI);
        draw.fillStyle = known[least]! < 0 ? colors.danger : colors.clearance;
        draw.fill();
      }
      draw.restore();
    };
    this.clearance = new TimePlot(byId("clearance-plot"), kHeight + kLabel, this.scale, {
      series: [{}, { label: "clearance", scale: "m", stroke: colors.clearance, width: 1.8, pxAlign: 0, points: { show: steps.length < 12 } }],
      axes: [this.scale.axis(this.scale.label), axis({ scale: "m", label: "m", size: 54 })],
      scales: { x: { time: false }, m: { range: (_u, low, high) => {
        const [from, to] = [Math.min(0, low ?? 0), Math.max(0, high ?? 0)], margin = 0.08 * Math.max(to - from, 1e-3);
        return [from - margin, to + margin];
      } } },
      hooks: { draw: [zeroLine], setCursor: [(u) => this.showClearance(u.cursor.idx ?? null)] },
    }, [steps, known], (time) => this.onSeek(time));
  }

  /// The values at the cursor while it is in a plot, else at the playhead.
  private showKeys(index: number | null): void {
    const at = index ?? Math.round(this.time);
    this.keys.forEach((key, j) => {
      const value = this.values[j]?.[at];
      if (value === undefined) return;
      const prismatic = this.plan!.prismatic[j], degrees = this.degrees && !prismatic;
      key.lastElementChild!.textContent = degrees ? `${(value * kDegrees).toFixed(1)}°` : value.toFixed(3);
    });
  }

  private showClearance(index: number | null): void {
    const value = this.clearances[index ?? Math.round(this.time)];
    byId("clearance-now").textContent = value === undefined || Number.isNaN(value) ? "not known" : metres(value);
    byId("clearance-now").classList.toggle("bad", value < 0);
  }

  showTime(time: number): void {
    this.time = time;
    for (const plot of [this.joints, this.speeds, this.clearance]) plot?.showTime(time);
    this.showKeys(null);
    this.showClearance(null);
  }
}
