// What the page knows of a voxel that was clicked, and the command that prints the rest.

import type { Arrays, Page } from "./data";
import { byId, el, grouped, millimetres, toStep } from "./dom";
import type { EvidenceGrid } from "./evidence";
import type { Hit } from "./pick";

const three = (value: number) => Number(value.toPrecision(3)).toString();
const probability = (odds: number) => (1 - 1 / (1 + Math.exp(odds))).toFixed(2);

/// For a shell.
const quoted = (text: string) => /^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;

export class VoxelAnswer {
  private readonly box = byId("voxel-answer");
  private readonly balls: Float32Array;

  constructor(private readonly page: Page, private readonly arrays: Arrays, private readonly grid: EvidenceGrid,
              private readonly labelOf: (state: string) => string) {
    this.balls = arrays.f32(page.balls);
  }

  /// Null hides it.
  show(hit: Hit | null): void {
    this.box.hidden = hit === null;
    if (!hit) return;
    const inMap = (c: number) => (c - this.page.origin) * this.page.resolution;
    const center = hit.voxel.map((c) => inMap(c + 0.5));
    const place = center.map((c) => Number(c.toFixed(6)).toString());
    const cell = this.page.voxels.find((set) => set.state === hit.state)!.cell;
    const about = cell > 1 ? hit.voxel.map((c) => toStep(inMap((Math.floor(c / cell) + 0.5) * cell), 0.5 * cell * this.page.resolution)) : place;
    const rows: [string, string][] = [
      [cell > 1 ? "drawn cube" : "voxel", `${about.join(", ")} m (${millimetres(cell * this.page.resolution)})`],
      ["state", this.labelOf(hit.state)],
      ["inside exact balls of", this.ballsAround(center)], ...this.paintedInto(center), ...this.conflict(hit)];
    const list = (entries: [string, string][]) => el("dl", {}, ...entries.filter(([, text]) => text !== "")
      .flatMap(([name, text]) => [el("dt", {}, name), el("dd", {}, text)]));
    const evidence = this.evidence(hit), { cell: cubes } = this.grid.about;
    if (cubes <= 1) rows.push(...evidence.splice(0));
    const close = el("button", { type: "button", class: "small", "aria-label": "Close", title: "Close" }, "✕");
    close.addEventListener("click", () => this.show(null));
    this.box.replaceChildren(close, list(rows),
      ...(evidence.length > 0 ? [el("p", {}, `In the cube of ${millimetres(cubes * this.page.resolution)} that holds it:`), list(evidence)] : []),
      ...this.command(place.join(",")));
  }

  private evidence(hit: Hit): [string, string][] {
    if (this.grid.cells === 0) return [];
    const { times, odds } = this.grid.about, known = this.grid.at(hit.voxel, this.page.origin);
    const step = (range: number[]) => (range[1] - range[0]) / 254 || 1;  // a byte says no more
    const rows: [string, string][] = [];
    if (known.odds) {
      const [low, high] = known.odds.map((value) => toStep(value, step(odds)));
      rows.push(["sensors", low !== high ? `log-odds ${low} … ${high}` : `log-odds ≈ ${high}, probability ${probability(known.odds[1])}`]);
    } else rows.push(["sensors", `never observed`]);
    if (known.look !== null)
      rows.push(["last seen", `≈ ${toStep(times[1] - known.look, step(times))} s before the newest look`]);
    else if (known.odds) rows.push(["last seen", "at a time that the map does not know"]);
    if (known.volume !== null)
      rows.push(["painted by", known.volume === "several" ? "several volumes" : this.page.volumes[known.volume]]);
    return rows;
  }

  /// Which volumes' exact balls hold the centre.
  private ballsAround(center: number[]): string {
    const found = new Set<number>();
    for (let i = 0; i < this.balls.length; i += 5) if (holds(this.balls, i, center, 0)) found.add(this.balls[i + 4]);
    return found.size > 0 ? [...found].map((volume) => this.page.volumes[volume]).join(", ") : this.balls.length > 0 ? "none" : "";
  }

  /// Which balls, and when, cover the voxel: wholly, as painting asks.
  private paintedInto(center: number[]): [string, string][] {
    const events = this.page.timeline ? this.arrays.f32(this.page.timeline.balls) : new Float32Array();
    const times = new Map<number, number[]>();
    for (let i = 0; i < events.length; i += 6)
      if (events[i + 4] >= 0 && holds(events, i, center, 0.5 * this.page.resolution))
        times.set(events[i + 4], [...times.get(events[i + 4]) ?? [], events[i + 5]]);
    return [...times].map(([volume, at]) => ["painted into", `${this.page.volumes[volume]}: ${grouped(at.length)} ${at.length === 1 ? "ball" : "balls"}, `
      + `${three(Math.min(...at))} to ${three(Math.max(...at))} s`]);
  }

  /// When the voxel became a conflict, and by what.
  private conflict(hit: Hit): [string, string][] {
    const conflicts = this.page.timeline?.conflicts;
    if (!conflicts) return [];
    const cells = this.arrays.u16(conflicts.cells), times = this.arrays.f32(conflicts.times), seconds = this.arrays.u32(conflicts.seconds);
    const rows: [string, string][] = [];
    for (let i = 0; i < times.length && rows.length < 3; ++i)
      if (hit.voxel.every((v, a) => v === cells[3 * i + a]))
        rows.push(["became a conflict", `at ${three(times[i])} s, by ${whatCameSecond(seconds[i], conflicts.strokes)}`]);
    return rows;
  }

  private command(place: string): HTMLElement[] {
    const map = this.page.mapPlace === "" ? ownFolder() : this.page.mapPlace;
    if (map === null) return [];
    const line = `clearway inspect ${quoted(map)} --at=${place}`;
    const copy = el("button", { type: "button", class: "small", title: "Copy the command that prints exact evidence, clearances and which scans hit or passed it" }, "copy");
    copy.addEventListener("click", () => { void navigator.clipboard?.writeText(line).then(() => { copy.textContent = "copied"; }); });
    return [el("p", {}, "Exactly, with clearances, strokes and scans:"), el("div", { class: "command" }, el("code", {}, line), copy)];
  }
}

/// Whether the ball at `i` (x y z radius ...) holds a cube about a point.
function holds(balls: Float32Array, i: number, point: number[], half: number): boolean {
  return Math.hypot(...point.map((p, a) => Math.abs(balls[i + a] - p) + half)) <= balls[i + 3];
}

/// See Timeline.conflicts.
export function whatCameSecond(second: number, strokes: string[]): string {
  if (second === 0) return "paint";
  return second % 2 === 1 ? `scan ${(second - 3) / 2}` : `paint of ${strokes[(second - 2) / 2] ?? "a stroke"}`;
}

/// The folder in which the page lies; MAP where it was opened from elsewhere.
function ownFolder(): string {
  if (location.protocol !== "file:") return "MAP";
  return decodeURIComponent(location.pathname).replace(/\/[^/]*$/, "") || "/";
}
