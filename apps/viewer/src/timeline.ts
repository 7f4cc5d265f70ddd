// The recording in time: its images, the tags found, scans, balls as they come, refusals and conflicts; one slider.

import type { Arrays, Timeline } from "./data";
import { byId, el, grouped } from "./dom";
import { palette } from "./palette";

const kLanes = ["tags", "scans", "painted", "refused", "conflicts"] as const;
const kLane = 17, kLabel = 62;  // pixels

/// How many of ascending times are not after `time`.
function countUntil(times: Float32Array, time: number): number {
  let low = 0, high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1; else high = middle;
  }
  return low;
}

export class RecordingTimeline {
  /// Is called with the time, s; null: the recording is not shown (any more).
  onTime: (time: number | null) => void = () => {};
  private readonly box = byId<HTMLDetailsElement>("recording");
  private readonly slider = el("input", { type: "range", min: "0", step: "any", "aria-label": "Time in the recording" });
  private readonly canvas = el("canvas", { class: "lanes", role: "img", "aria-label": `The recording in time: ${kLanes.join(", ")}` });
  private readonly picture = el("img", { alt: "" });
  private readonly text = el("p", { class: "recording-text", "aria-live": "polite" });
  private readonly images: Float32Array;
  private readonly tags: Uint8Array;
  private readonly accepted: Uint8Array;
  private readonly scans: Float32Array;
  private readonly balls: Float32Array;  // times
  private readonly conflicts: Float32Array;
  private readonly urls: string[];
  private time = 0;

  /// @param share where in the recording it opens, 0 to 1; null: closed
  constructor(private readonly about: Timeline, arrays: Arrays, share: number | null) {
    this.images = arrays.f32(about.images);
    this.tags = arrays.u8(about.tags);
    this.accepted = arrays.u8(about.accepted);
    this.scans = arrays.f32(about.scans);
    this.balls = arrays.f32(about.balls).filter((_, i) => i % 6 === 5);
    this.conflicts = arrays.f32(about.conflicts.times);
    this.urls = about.pictures.map(({ jpeg }) => URL.createObjectURL(new Blob([arrays.u8(jpeg)], { type: "image/jpeg" })));
    this.slider.max = String(about.duration);
    const has = [[this.images.length, "image"], [this.scans.length, "scan"], [about.ballCount, "ball"]] as const;
    this.box.hidden = false;
    this.box.append(
      el("summary", {}, `Recording, ${about.duration.toFixed(1)} s: ${has.filter(([count]) => count > 0).map(([count, name]) => `${grouped(count)} ${name}${count === 1 ? "" : "s"}`).join(", ")}`),
      el("div", { class: "recording-body" }, ...(this.urls.length > 0 ? [this.picture] : []),
         el("div", { class: "recording-lanes" }, this.canvas, this.slider, this.text)));
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    this.canvas.addEventListener("pointerdown", (event) => { this.canvas.setPointerCapture(event.pointerId); this.seekAt(event); });
    this.canvas.addEventListener("pointermove", (event) => { if (event.buttons & 1) this.seekAt(event); });
    this.box.addEventListener("toggle", () => this.toggled());
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.time = (share ?? 1) * about.duration;
    this.slider.value = String(this.time);
    this.box.open = share !== null;  // the event comes later
  }

  private toggled(): void {
    if (this.box.open) this.seek(this.time); else this.onTime(null);
  }

  private seekAt(event: PointerEvent): void {
    const box = this.canvas.getBoundingClientRect();
    this.seek((event.clientX - box.left - kLabel) / Math.max(1, box.width - kLabel) * this.about.duration);
  }

  seek(time: number): void {
    this.time = Math.min(this.about.duration, Math.max(0, time));
    this.slider.value = String(this.time);
    this.showTime();
    this.draw();
    this.onTime(this.time);
  }

  private showTime(): void {
    const image = countUntil(this.images, this.time) - 1, { pictures, refusals } = this.about;
    const picture = pictures.reduce((best, { time }, i) => Math.abs(time - this.time) < Math.abs(pictures[best].time - this.time) ? i : best, 0);
    if (pictures.length > 0) {
      if (this.picture.src !== this.urls[picture]) this.picture.src = this.urls[picture];
      this.picture.alt = this.picture.title = `image at ${pictures[picture].time.toFixed(2)} s`;
    }
    const parts = [`${this.time.toFixed(2)} s`];
    if (image >= 0) parts.push(`image ${grouped(image + 1)} of ${grouped(this.images.length)}: ${this.tags[image]} tags`);
    if (this.scans.length > 0) parts.push(`${grouped(countUntil(this.scans, this.time))} of ${grouped(this.scans.length)} scans`);
    if (this.about.ballCount > 0) {
      const shown = countUntil(this.balls, this.time);
      parts.push(`${grouped(Math.round(shown / this.balls.length * this.about.ballCount))} of ${grouped(this.about.ballCount)} balls`);
    }
    if (this.conflicts.length > 0) parts.push(`${grouped(this.countConflicts())} of ${grouped(this.conflicts.length + this.about.conflicts.notKept)} conflicts`);
    const at = image >= 0 ? this.images[image] : -1;
    const refused = at < 0 || this.accepted[image] === 1 ? undefined : refusals.find(({ from, to }) => from <= at + 1e-3 && at - 1e-3 <= to);
    const left = this.about.refusalsLeftOut > 0 ? ` (${grouped(this.about.refusalsLeftOut)} later refusals are not kept)` : "";
    this.text.replaceChildren(parts.join(" · "), ...(refused ? [el("span", { class: "refused" }, `Refused, ${refused.images} ${refused.images === 1 ? "image" : "images"}: ${refused.refusal.replaceAll("_", " ")} (${refused.reason})`)]
      : image >= 0 && this.accepted[image] === 1 ? [el("span", {}, "Accepted: a ball was painted.")] : []), left);
    document.body.dataset.recording = this.time.toFixed(2);
    document.body.dataset.painted = String(countUntil(this.balls, this.time));
  }

  private countConflicts(): number { return this.conflicts.reduce((count, time) => count + (time <= this.time ? 1 : 0), 0); }

  /// Lanes over time, and where the slider stands.
  draw(): void {
    const ratio = devicePixelRatio, width = this.canvas.clientWidth, height = kLane * kLanes.length;
    if (width < kLabel || !this.box.open) return;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const draw = this.canvas.getContext("2d")!, colors = palette();
    draw.scale(ratio, ratio);
    draw.font = "11px system-ui, sans-serif";
    draw.textBaseline = "middle";
    const x = (time: number) => kLabel + (width - kLabel - 1) * time / Math.max(1e-9, this.about.duration);
    kLanes.forEach((name, lane) => {
      draw.fillStyle = colors.muted;
      draw.fillText(name, 0, (lane + 0.5) * kLane);
      draw.fillStyle = colors.line;
      draw.fillRect(kLabel, (lane + 1) * kLane - 1, width - kLabel, 1);
    });
    const tick = (lane: number, time: number, share: number, color: string, until = time) => {
      const tall = Math.max(1, share * (kLane - 4));
      draw.fillStyle = color;
      draw.fillRect(x(time), (lane + 1) * kLane - 1 - tall, Math.max(1, x(until) - x(time)), tall);
    };
    const most = this.tags.reduce((a, b) => Math.max(a, b), 1);
    this.images.forEach((time, i) => { if (this.tags[i] > 0) tick(0, time, this.tags[i] / most, colors.series[0]); });
    this.scans.forEach((time) => tick(1, time, 0.6, colors.series[7]));
    this.drawGrowth(draw, x, colors.painted);
    for (const { from, to } of this.about.refusals) tick(3, from, 0.8, colors.danger, to);
    this.conflicts.forEach((time) => tick(4, time, 0.8, colors.conflict));
    draw.fillStyle = colors.ink;
    draw.fillRect(x(this.time) - 0.75, 0, 1.5, height);
  }

  /// The balls so far, as an area.
  private drawGrowth(draw: CanvasRenderingContext2D, x: (time: number) => number, color: string): void {
    const bottom = 3 * kLane - 1, count = this.balls.length;
    if (count === 0) return;
    draw.fillStyle = color;
    draw.beginPath();
    draw.moveTo(x(0), bottom);
    this.balls.forEach((time, i) => {
      draw.lineTo(x(time), bottom - i / count * (kLane - 4));
      draw.lineTo(x(time), bottom - (i + 1) / count * (kLane - 4));
    });
    draw.lineTo(x(this.about.duration), bottom - (kLane - 4));
    draw.lineTo(x(this.about.duration), bottom);
    draw.fill();
  }
}
