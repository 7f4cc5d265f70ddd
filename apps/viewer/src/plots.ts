// The plots along a plan: joint values, separation, and of a plan with time joint speeds, accelerations, jerk and
// torques: one time axis, one playhead.

import type uPlot from "uplot";
import type { Arrays, Place, Plan } from "./data";
import { byId, el, metres } from "./dom";
import { palette } from "./palette";
import { PathValues, type PathMode } from "./path_colors";
import { RatePlot, type Rates, type RateUnit } from "./rate_plot";
import { TimePlot, TimeScale, axis, limitLine } from "./time_plot";

const kDegrees = 180 / Math.PI;
const kHeight = 132, kLabel = 16;  // pixels

export class Plots {
  onSeek: (time: number) => void = () => {};
  private joints: TimePlot | null = null;
  private clearance: TimePlot | null = null;
  private rates: RatePlot[] = [];
  private scale = new TimeScale(0, 0, 0);
  private keys: HTMLElement[] = [];
  private values: Float32Array[] = [];
  private clearances: Float32Array = new Float32Array();
  private truth: Float32Array = new Float32Array();  // separation from what robots know from the map alone
  private bodies: Float32Array = new Float32Array(); // between the robot's own bodies
  private ages: Float32Array = new Float32Array();   // of that map
  private plan: Plan | null = null;
  private time = 0;
  private degrees = false;
  private shares = true;  // speeds and accelerations as shares of their limits
  private hidden = new Set<string>();
  private path: PathValues | null = null;
  private pathMode: PathMode = "plain";

  constructor(private readonly arrays: Arrays) {
    const unit = byId<HTMLButtonElement>("angle-unit");
    unit.addEventListener("click", () => {
      this.degrees = !this.degrees;
      unit.textContent = this.degrees ? "radians" : "degrees";
      this.redraw();
    });
    byId("rate-unit").addEventListener("click", () => {
      this.shares = !this.shares;
      this.redraw();
    });
  }

  show(plan: Plan): void {
    this.plan = plan;
    this.hidden.clear();
    this.values = this.jointsOf(plan, plan.values);
    this.clearances = this.arrays.f32(plan.clearance);
    this.truth = this.arrays.f32(plan.trueSeparation);
    this.bodies = this.arrays.f32(plan.betweenBodies);
    this.ages = this.arrays.f32(plan.mapAge);
    byId("map-age").hidden = this.ages.length === 0;
    this.path = new PathValues(plan, this.arrays);
    this.redraw();
  }

  /// Colours the strip under the curves as the tip's path is coloured.
  showPathMode(mode: PathMode): void {
    if (mode === this.pathMode) return;
    this.pathMode = mode;
    if (this.plan) this.redraw();
  }

  /// Along the bottom of a plot: what the planner did there, where it says so.
  private drawStrip(u: uPlot): void {
    const known = this.path?.modes() ?? [], mode = known.includes(this.pathMode) && this.pathMode !== "plain" ? this.pathMode : known.includes("phase") ? "phase" : "plain";
    const { left, top, width, height } = u.bbox, draw = u.ctx, thick = 5 * devicePixelRatio;
    const x = (waypoint: number) => Math.min(left + width, Math.max(left, u.valToPos(this.scale.x(waypoint), "x", true)));
    draw.save();
    for (const { from, to, color } of this.path?.stretches(mode) ?? []) {
      draw.fillStyle = color;
      const first = Math.floor(x(from));  // whole pixels, or the seams would show
      draw.fillRect(first, top + height - thick, Math.ceil(x(to)) - first, thick);
    }
    draw.restore();
    document.body.dataset.strip = mode;
    byId("strip-legend").replaceChildren(...this.path?.legend(mode) ?? []);
  }

  private jointsOf(plan: Plan, place: Place): Float32Array[] {
    const all = this.arrays.f32(place);
    return plan.joints.map((_, j) => all.subarray(j * plan.waypoints, (j + 1) * plan.waypoints));
  }

  /// Builds the plots anew: for another plan, unit or theme.
  redraw(): void {
    for (const plot of [this.joints, this.clearance, ...this.rates]) plot?.destroy();
    this.joints = this.clearance = null;
    this.rates = [];
    const plan = this.plan, hasTime = plan !== null && plan.period > 0 && plan.waypoints > 2 && plan.joints.length > 0;
    byId("joint-card").hidden = !plan || plan.waypoints < 1 || plan.joints.length === 0;
    byId("clearance-card").hidden = !plan || this.clearances.length < 1;
    byId("speed-card").hidden = byId("acceleration-card").hidden = !hasTime;
    byId("jerk-card").hidden = !hasTime || !plan.maxJerk.length;
    byId("torque-card").hidden = !hasTime || !plan.maxTorque.length;
    if (!plan) return;
    this.scale = TimeScale.of(plan);
    byId("joint-name").textContent = plan.period > 0 ? "Joints" : "Joint profiles";
    byId("clearance-name").textContent = plan.period > 0 ? "Separation along the motion" : "Separation at the waypoints";
    const steps = Array.from({ length: plan.waypoints }, (_, i) => this.scale.x(i));
    if (!byId("joint-card").hidden) this.drawJoints(plan, steps);
    if (!byId("clearance-card").hidden) this.drawClearance(plan, steps);
    if (hasTime) this.drawRates(plan, steps);
    document.body.dataset.plots = String([this.joints, this.clearance, ...this.rates].filter((plot) => plot !== null).length);
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
      series, axes, scales: { x: { time: false } }, hooks: { draw: [(u) => this.drawStrip(u)], setCursor: [(u) => this.showKeys(u.cursor.idx ?? null)] },
    }, [steps, ...this.values.map((v, j) => Array.from(v, (x) => x * factor(j)))], (time) => this.onSeek(time));
    this.keys = plan.joints.map((name, j) => {
      const key = el("button", { type: "button", class: "key", title: `Show or hide ${name}` },
                     el("i", { style: `background:${colors[j % colors.length]}`, class: j >= colors.length ? "dashed" : "" }), name, el("b", {}));
      key.classList.toggle("off", this.hidden.has(name));
      key.addEventListener("click", () => {
        if (!this.hidden.delete(name)) this.hidden.add(name);
        key.classList.toggle("off", this.hidden.has(name));
        this.joints?.plot.setSeries(j + 1, { show: !this.hidden.has(name) });
        for (const plot of this.rates) plot.setShown(j, !this.hidden.has(name));
      });
      return key;
    });
    byId("joint-keys").replaceChildren(...this.keys);
  }

  private drawRates(plan: Plan, steps: number[]): void {
    const unit: RateUnit = this.shares ? "share" : this.degrees ? "deg" : "rad";
    byId("rate-unit").textContent = this.shares ? (plan.prismatic.includes(false) ? (this.degrees ? "deg/s" : "rad/s") : "m/s") : "% of limit";
    const of = { joints: plan.joints, prismatic: plan.prismatic, isLast: false };
    const all: Rates[] = [
      { ...of, id: "speed", per: "/s", values: this.jointsOf(plan, plan.speeds), limits: plan.maxSpeed },
      { ...of, id: "acceleration", per: "/s²", values: this.jointsOf(plan, plan.accelerations), limits: plan.maxAcceleration }];
    if (plan.maxJerk.length > 0) all.push({ ...of, id: "jerk", per: "/s³", values: this.jointsOf(plan, plan.jerks), limits: plan.maxJerk });
    if (plan.maxTorque.length > 0)
      all.push({ ...of, id: "torque", per: "", values: this.jointsOf(plan, plan.torques), limits: plan.maxTorque.map((limit) => limit ?? Infinity) });
    all[all.length - 1].isLast = true;
    this.rates = all.map((rates) => new RatePlot(rates, unit, this.scale, steps, kHeight, this.hidden, (time) => this.onSeek(time)));
  }

  private drawClearance(plan: Plan, steps: number[]): void {
    const colors = palette(), values = this.clearances;
    const known = Array.from(values, (c) => Number.isNaN(c) ? null : c);
    const least = known.reduce<number>((best, c, i) => c !== null && (best < 0 || c < known[best]!) ? i : best, -1);
    const second = this.truth.length > 0 ? this.truth : this.bodies, hasSecond = second.length > 0;
    const names = this.truth.length > 0 ? ["as robots know it, of all", "true, of what is sensed"] : ["to voxels, less the padding, and between links", "between links alone"];
    const key = (text: string, color: string) => el("span", { class: "key" }, el("i", { style: `background:${color}` }), text);
    byId("clearance-keys").replaceChildren(key(names[0], colors.clearance), ...(hasSecond ? [key(names[1], colors.truth)] : []));
    byId("clearance-key").hidden = plan.security <= 0;
    byId("clearance-key").textContent = `┄ d_s ${metres(plan.security)}`;
    const lines = (u: uPlot) => {
      limitLine(u, "m", 0, colors.danger, -1);
      if (plan.security > 0) limitLine(u, "m", plan.security, colors.muted, 0, [5, 4]);
      if (least < 0) return;
      const draw = u.ctx;
      draw.save();
      draw.beginPath();
      draw.arc(u.valToPos(this.scale.x(least), "x", true), u.valToPos(known[least]!, "m", true), 4 * devicePixelRatio, 0, 2 * Math.PI);
      draw.fillStyle = known[least]! < 0 ? colors.danger : colors.clearance;
      draw.fill();
      draw.restore();
    };
    this.clearance = new TimePlot(byId("clearance-plot"), kHeight + (plan.period > 0 ? 0 : kLabel), this.scale, {
      series: [{}, { label: "clearance", scale: "m", stroke: colors.clearance, width: 1.8, pxAlign: 0, points: { show: steps.length < 12 } },
               ...(hasSecond ? [{ label: names[1], scale: "m", stroke: colors.truth, width: 1.4, pxAlign: 0, points: { show: false } }] : [])],
      axes: [this.scale.axis(plan.period > 0 ? undefined : this.scale.label), axis({ scale: "m", label: "m", size: 54 })],
      scales: { x: { time: false }, m: { range: (_u, low, high) => {
        const [from, to] = [Math.min(0, low ?? 0), Math.max(0, high ?? 0)], margin = 0.08 * Math.max(to - from, 1e-3);
        return [from - margin, to + margin];
      } } },
      hooks: { draw: [lines, (u) => this.drawStrip(u)], setCursor: [(u) => this.showClearance(u.cursor.idx ?? null)] },
    }, [steps, known, ...(hasSecond ? [Array.from(second, (c) => Number.isNaN(c) ? null : c)] : [])], (time) => this.onSeek(time));
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
    for (const plot of [this.joints, this.clearance, ...this.rates]) plot?.showTime(time);
    this.showKeys(null);
    this.showClearance(null);
    const age = this.ages[Math.min(this.ages.length - 1, Math.round(time))];
    if (age !== undefined) byId("map-age").textContent = `map ${Math.round(1000 * age)} ms old`;
  }
}
