// What the page knows of a voxel that was clicked, and the command that tells the rest.

import type { Arrays, Page } from "./data";
import { byId, el, grouped, millimetres } from "./dom";
import type { EvidenceGrid } from "./evidence";
import type { Hit } from "./pick";

const three = (value: number) => Number(value.toPrecision(3)).toString();
const probability = (odds: number) => three(1 - 1 / (1 + Math.exp(odds)));

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
    const digits = this.page.resolution < 0.01 ? 4 : 3;
    const center = hit.voxel.map((c) => (c + 0.5 - this.page.origin) * this.page.resolution);
    const place = center.map((c) => c.toFixed(digits));
    const cell = this.page.voxels.find((set) => set.state === hit.state)!.cell;
    const rows: [string, string][] = [
      [cell > 1 ? "drawn cube" : "voxel", `${place.join(", ")} m (${millimetres(cell * this.page.resolution)})`],
      ["state", this.labelOf(hit.state)],
      ...this.evidence(hit), ["inside exact balls of", this.ballsAround(center)], ...this.conflict(hit)];
    const close = el("button", { type: "button", class: "small", "aria-label": "Close", title: "Close" }, "✕");
    close.addEventListener("click", () => this.show(null));
    this.box.replaceChildren(close, el("dl", {}, ...rows.filter(([, text]) => text !== "")
      .flatMap(([name, text]) => [el("dt", {}, name), el("dd", {}, text)])), ...this.command(place.join(",")));
  }

  private evidence(hit: Hit): [string, string][] {
    if (this.grid.cells === 0) return [];
    const { cell, times } = this.grid.about, size = millimetres(cell * this.page.resolution);
    const known = this.grid.at(hit.voxel, this.page.origin);
    const within = cell > 1 ? ` (of the ${size} cube)` : "";
    const rows: [string, string][] = [];
    if (known.odds) {
      const [low, high] = known.odds, both = three(low) !== three(high);
      rows.push(["sensors", both ? `log-odds ${three(low)} … ${three(high)}${within}` : `log-odds ≈ ${three(high)}, probability ${probability(high)}${within}`]);
    } else rows.push(["sensors", `never observed${within}`]);
    if (known.look !== null)
      rows.push(["last seen", `≈ ${three(times[1] - known.look)} s before the newest look${within}`]);
    else if (known.odds) rows.push(["last seen", "at a time that the map does not know"]);
    if (known.volume !== null)
      rows.push(["painted by", (known.volume === "several" ? "several volumes" : this.page.volumes[known.volume]) + within]);
    return rows;
  }

  /// Which volumes' exact balls hold the centre, and when they were painted.
  private ballsAround(center: number[]): string {
    const found = new Set<number>();
    for (let i = 0; i < this.balls.length; i += 5) if (holds(this.balls, i, center)) found.add(this.balls[i + 4]);
    const names = [...found].map((volume) => this.page.volumes[volume]).join(", ");
    const events = this.page.timeline ? this.arrays.f32(this.page.timeline.balls) : new Float32Array();
    const times: number[] = [];
    for (let i = 0; i < events.length; i += 6) if (events[i + 4] >= 0 && holds(events, i, center)) times.push(events[i + 5]);
    if (names === "" || times.length === 0) return names === "" && this.balls.length > 0 ? "none" : names;
    const [first, last] = [Math.min(...times), Math.max(...times)];
    return `${names}: ${grouped(times.length)} ${times.length === 1 ? "ball" : "balls"}, ${three(first)} to ${three(last)} s`;
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
    const copy = el("button", { type: "button", class: "small", title: "Copy the command that tells exact evidence, clearances and which scans hit or passed it" }, "copy");
    copy.addEventListener("click", () => { void navigator.clipboard?.writeText(line).then(() => { copy.textContent = "copied"; }); });
    return [el("p", {}, "Exactly, with clearances, strokes and scans:"), el("div", { class: "command" }, el("code", {}, line), copy)];
  }
}

/// Whether the ball at `i` (x y z radius ...) holds a point.
function holds(balls: Float32Array, i: number, point: number[]): boolean {
  return Math.hypot(balls[i] - point[0], balls[i + 1] - point[1], balls[i + 2] - point[2]) <= balls[i + 3];
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
