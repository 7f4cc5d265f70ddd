// Speeds, accelerations, jerk or torques of all joints in time, against their limits.

import type uPlot from "uplot";
import { byId } from "./dom";
import { palette } from "./palette";
import { TimePlot, TimeScale, axis, limitLine } from "./time_plot";

export type RateUnit = "share" | "rad" | "deg";

/// What one plot shows; values and limits in rad and m, per second, second² or second³, or in N m and N.
export interface Rates {
  id: "speed" | "acceleration" | "jerk" | "torque";
  per: "/s" | "/s²" | "/s³" | "";
  isLast: boolean;  // of the plots: it names the time axis
  joints: string[]; prismatic: boolean[];
  values: Float32Array[]; limits: number[];
}

const kDegrees = 180 / Math.PI;
/// In which unit a joint is shown, and how many of it are one rad, m, N m or N.
function unitOf(rates: Rates, joint: number, unit: RateUnit): [string, number] {
  const slides = rates.prismatic[joint];
  if (rates.id === "torque") return [slides ? "N" : "N m", 1];
  if (slides) return ["m" + rates.per, 1];
  return unit === "deg" ? ["deg" + rates.per, kDegrees] : ["rad" + rates.per, 1];
}

const three = (value: number) => Number(value.toPrecision(3)).toString();

export class RatePlot {
  private readonly plot: TimePlot;

  constructor(private readonly rates: Rates, private readonly unit: RateUnit, scale: TimeScale, steps: number[], height: number,
              hidden: Set<string>, seek: (time: number) => void) {
    const colors = palette(), { joints, values, limits } = rates;
    const scaleOf = (j: number) => unit === "share" ? "%" : unitOf(rates, j, unit)[0];
    const factor = (j: number) => unit === "share" ? 100 / limits[j] : unitOf(rates, j, unit)[1];
    const color = (j: number) => colors.series[j % colors.series.length];
    const series: uPlot.Series[] = [{}, ...joints.map((name, j) => ({
      label: name, scale: scaleOf(j), stroke: color(j), width: 1.5, pxAlign: 0, points: { show: false },
      show: !hidden.has(name), dash: j >= colors.series.length ? [6, 4] : undefined,
    }))];
    const scales = [...new Set(joints.map((_, j) => scaleOf(j)))];
    const range = (_u: uPlot, low: number | null, high: number | null): [number, number] => {
      const most = Math.max(Math.abs(low ?? 0), Math.abs(high ?? 0), unit === "share" ? 100 : 1e-6);
      return [-1.12 * most, 1.12 * most];
    };
    const limitLines = (u: uPlot) => {
      if (unit === "share") {
        limitLine(u, "%", 100, colors.danger, 1);
        limitLine(u, "%", -100, colors.danger, -1);
        return;
      }
      joints.forEach((name, j) => {
        if (hidden.has(name)) return;
        if (!Number.isFinite(limits[j])) return;
        for (const sign of [1, -1]) limitLine(u, scaleOf(j), sign * limits[j] * factor(j), color(j), 0, [3, 5]);
      });
    };
    const axes = [scale.axis(rates.isLast ? "s" : undefined), ...scales.map((name, i) => axis({
      scale: name, label: name === "%" ? "% of limit" : name, ...(i > 0 ? { side: 1 as const, grid: { show: false } } : {}),
    }))];
    this.plot = new TimePlot(byId(`${rates.id}-plot`), height, scale, {
      series, axes, scales: { x: { time: false }, ...Object.fromEntries(scales.map((name) => [name, { range }])) },
      hooks: { draw: [limitLines], setCursor: [(u) => this.showValues(u.cursor.idx ?? null)] },
    }, [steps, ...values.map((v, j) => Array.from(v, (x) => x * factor(j)))], seek);
  }

  private time = 0;

  showTime(time: number): void {
    this.time = time;
    this.plot.showTime(time);
    this.showValues(null);
  }

  setShown(joint: number, show: boolean): void { this.plot.plot.setSeries(joint + 1, { show }); }

  destroy(): void { this.plot.destroy(); }

  /// The joint that is nearest to its limit, at the cursor while it is in a plot, else at the playhead.
  private showValues(index: number | null): void {
    const { id, joints, values, limits } = this.rates, at = index ?? Math.round(this.time);
    const share = (j: number) => Math.abs(values[j]?.[at] ?? 0) / limits[j];
    const most = joints.reduce((best, _, j) => share(j) > share(best) ? j : best, 0);
    const value = values[most]?.[at] ?? 0, [unit, factor] = unitOf(this.rates, most, this.unit);
    const now = byId(`${id}-now`);
    now.textContent = share(most) < 5e-4 ? "at rest"
      : `${joints[most]} ${three(value * factor)} ${unit}, ${three(100 * share(most))} %`;
    if (id !== "speed" && share(most) < 5e-4) now.textContent = "0";
    now.classList.toggle("bad", share(most) > 1.0005);
  }
}
