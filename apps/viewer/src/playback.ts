// Time along a plan, in waypoints: the slider, play and pause, the keyboard.

import type { Plan } from "./data";
import { byId } from "./dom";
import { TimeScale } from "./time_plot";

/// A whole plan without time takes this long at speed 1, seconds.
const duration = (waypoints: number) => Math.min(12, Math.max(3, 0.06 * waypoints));

export class Playback {
  onTime: (time: number) => void = () => {};
  private readonly bar = byId("playback");
  private readonly slider = byId<HTMLInputElement>("time");
  private readonly button = byId<HTMLButtonElement>("play");
  private last = 0;     // waypoints - 1
  private scale = new TimeScale(0, 0, 0);
  private hasTime = false;
  private time = 0;
  private playing = false;
  private before = 0;   // time stamp of the frame before

  constructor() {
    this.button.addEventListener("click", () => this.toggle());
    this.slider.addEventListener("input", () => { this.pause(); this.seek(Number(this.slider.value)); });
    document.addEventListener("keydown", (event) => {
      const taken = "input, select, textarea, [role=radio]" + (event.key === " " ? ", button, summary, a[href]" : "");
      const inField = event.target instanceof HTMLElement && event.target !== this.slider && event.target.closest(taken) !== null;
      if (inField || event.ctrlKey || event.metaKey || event.altKey || this.bar.hidden) return;
      if (event.key === " ") this.toggle();
      else if (event.key === "ArrowRight") { this.pause(); this.seek(Math.floor(this.time + 1 + 1e-6)); }
      else if (event.key === "ArrowLeft") { this.pause(); this.seek(Math.ceil(this.time - 1 - 1e-6)); }
      else return;
      event.preventDefault();
    });
    document.addEventListener("visibilitychange", () => { this.before = 0; });
    this.pause();
  }

  /// Starts over with a plan, at `share` (0 to 1) of it; of a plan with time, of its time.
  reset(plan: Plan, share: number): void {
    this.pause();
    this.scale = TimeScale.of(plan);
    this.hasTime = plan.period > 0;
    this.last = Math.max(0, plan.waypoints - 1);
    this.bar.hidden = plan.waypoints < 2;
    this.slider.max = String(this.last);
    this.seek(this.hasTime ? this.scale.time(share * plan.duration) : share * this.last);
  }

  seek(time: number): void {
    this.time = Math.min(this.last, Math.max(0, time));
    this.slider.value = String(this.time);
    this.slider.style.setProperty("--share", `${this.last > 0 ? 100 * this.time / this.last : 0}%`);
    byId("time-text").textContent = this.hasTime ? `${this.scale.x(this.time).toFixed(2)} / ${this.scale.x(this.last).toFixed(2)} s`
      : `${(this.time + 1).toFixed(1)} / ${this.last + 1}`;
    this.onTime(this.time);
  }

  private toggle(): void {
    if (this.playing) return this.pause();
    if (this.time >= this.last) this.seek(0);
    this.playing = true;
    this.before = 0;
    this.button.classList.add("playing");
    this.button.setAttribute("aria-label", "Pause");
    requestAnimationFrame(() => this.step(performance.now()));
  }

  private pause(): void {
    this.playing = false;
    this.button.classList.remove("playing");
    this.button.setAttribute("aria-label", "Play");
  }

  private step(now: number): void {
    if (!this.playing) return;
    // By the clock, however few frames there are; but what passed while the page was hidden is not played.
    const elapsed = this.before > 0 ? Math.max(0, now - this.before) / 1000 : 0;
    this.before = now;
    const speed = Number(byId<HTMLSelectElement>("speed").value);
    const passed = speed * elapsed;  // s; with time the robot moves as fast as it would
    this.seek(this.hasTime ? this.scale.time(this.scale.x(this.time) + passed) : this.time + passed * this.last / duration(this.last + 1));
    if (this.time >= this.last) return this.pause();
    requestAnimationFrame(() => this.step(performance.now()));
  }
}
