// Colours along the tip's path: by clearance, by what the planner did there, or by when its search came there.

import { BufferAttribute, type CatmullRomCurve3, type TubeGeometry } from "three";
import type { Arrays, Plan } from "./data";
import { el, metres } from "./dom";
import { cssColor, palette, rampAt, rgb } from "./palette";

export type PathMode = "plain" | "clearance" | "phase" | "step";

/// What one plan has to be coloured by.
export class PathValues {
  readonly clearance: Float32Array;
  readonly phases: Uint32Array;
  readonly steps: Uint32Array;
  readonly lastStep: number;
  private readonly near: [number, number];

  constructor(readonly plan: Plan, arrays: Arrays) {
    this.clearance = arrays.f32(plan.clearance);
    this.phases = arrays.u32(plan.phases);
    this.steps = arrays.u32(plan.searchSteps);
    this.lastStep = this.steps.reduce((most, step) => Math.max(most, step), 0);
    const known = Array.from(this.clearance).filter((c) => !Number.isNaN(c));
    this.near = known.length > 0 ? [Math.min(0, ...known), Math.max(1e-6, ...known)] : [0, 1];
  }

  modes(): PathMode[] {
    return ["plain", ...(this.clearance.length > 0 ? ["clearance"] as const : []), ...(this.phases.length > 0 ? ["phase"] as const : []),
            ...(this.lastStep > 0 ? ["step"] as const : [])];
  }

  /// At waypoint `i`; null: not coloured.
  color(mode: PathMode, i: number): [number, number, number] | null {
    const colors = palette();
    if (mode === "clearance") {
      const c = this.clearance[i];
      return c === undefined || Number.isNaN(c) ? rgb(colors.unknown) : rampAt(colors.nearRamp, (c - this.near[0]) / (this.near[1] - this.near[0]));
    }
    if (mode === "phase") return rgb(phaseColor(this.plan, this.phases[i] ?? 0));
    if (mode === "step") return this.steps[i] > 0 ? rampAt(colors.ramp, (this.steps[i] - 1) / Math.max(1, this.lastStep - 1)) : rgb(colors.unknown);
    return null;
  }

  legend(mode: PathMode): HTMLElement[] {
    const bar = (ramp: string[], low: string, what: string, high: string) => [
      el("i", { class: "legend-bar", style: `background:linear-gradient(90deg, ${ramp.join(", ")})` }),
      el("span", { class: "legend-ends" }, el("span", {}, low), el("span", {}, what), el("span", {}, high))];
    if (mode === "clearance") return bar(palette().nearRamp, metres(this.near[0]), "separation", metres(this.near[1]));
    if (mode === "step") {
      const unknown = this.steps.some((step) => step === 0);
      return [...bar(palette().ramp, "1", "search step", String(this.lastStep)),
              ...(unknown ? [entry(palette().unknown, "made after the search")] : [])];
    }
    if (mode === "phase") return this.plan.phaseNames.map((name, i) => entry(phaseColor(this.plan, i), name));
    return [];
  }

  /// Stretches of waypoints of one colour: from, to (both in waypoints) and the colour.
  stretches(mode: PathMode): { from: number; to: number; color: string }[] {
    const out: { from: number; to: number; color: string }[] = [];
    for (let i = 0; i < this.plan.waypoints; ++i) {
      const color = this.color(mode, i);
      if (!color) return [];
      const css = cssColor(color), last = out[out.length - 1];
      if (last?.color === css) last.to = i;
      else out.push({ from: Math.max(0, i - 1), to: i, color: css });
    }
    return out;
  }

  /// Colours the rings of a tube through `waypoints` (those of the path that the curve passes).
  paint(tube: TubeGeometry, curve: CatmullRomCurve3 | null, waypoints: number[], mode: PathMode): void {
    const rings = tube.parameters.tubularSegments + 1, around = tube.parameters.radialSegments + 1;
    const colors = new Float32Array(3 * rings * around);
    for (let ring = 0; ring < rings; ++ring) {
      const u = ring / (rings - 1), t = curve ? curve.getUtoTmapping(u, 0) : u;
      const at = waypoints[Math.min(waypoints.length - 1, Math.ceil(t * (waypoints.length - 1) - 1e-6))];
      const color = this.color(mode, at) ?? [1, 1, 1];
      for (let k = 0; k < around; ++k) colors.set(color.map(linear), 3 * (ring * around + k));
    }
    tube.setAttribute("color", new BufferAttribute(colors, 3));
  }
}

/// Three.js takes vertices' colours as linear light.
const linear = (c: number) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;

function entry(color: string, text: string): HTMLElement {
  return el("span", { class: "legend-entry" }, el("i", { style: `background:${color}` }), text);
}

/// Free motion is calm; each boundary that is followed has a colour of its own.
export function phaseColor(plan: Plan, phase: number): string {
  const colors = palette(), name = plan.phaseNames[phase] ?? "";
  if (name === "not known" || name === "shortcut") return colors.unknown;
  if (name === "free motion") return colors.clearance;
  const others = plan.phaseNames.filter((other) => !["not known", "shortcut", "free motion"].includes(other));
  const chosen = [colors.series[1], colors.series[3], colors.series[0], colors.series[4], colors.series[6], colors.series[5], colors.series[2], colors.series[7]];
  return chosen[others.indexOf(name) % chosen.length];
}
