// Slices of the map as pictures, for browsers that cannot draw it in 3D.

import type { Arrays, Page } from "./data";
import { byId, el, exactMetres } from "./dom";
import { sliceMask, type Faces } from "./faces";
import { labelOf, sliceColor, sliceOrder, unpackAll } from "./map_layers";

export class FlatSlices {
  private readonly sets: Faces[];
  private readonly low: number[];
  private readonly high: number[];
  private readonly canvas = el("canvas", { class: "flat-slice", role: "img" });
  private readonly axis = el("select", { "aria-label": "Slice across" });
  private readonly slider = el("input", { type: "range", step: "1", "aria-label": "Slice position" });
  private readonly value = el("output", {});
  private readonly caption = el("p", { class: "flat-caption" });

  constructor(private readonly page: Page, arrays: Arrays) {
    const all = unpackAll(page, arrays);
    this.sets = sliceOrder.flatMap((state) => all.filter((faces) => faces.state === state && faces.quadCount > 0));
    this.low = [0, 1, 2].map((a) => Math.min(...this.sets.map((faces) => faces.low[a])));
    this.high = [0, 1, 2].map((a) => Math.max(...this.sets.map((faces) => faces.high[a])));
    if (this.sets.length === 0) return;
    this.axis.append(...["z", "y", "x"].map((name) => el("option", { value: String("xyz".indexOf(name)) }, `slice ${name}`)));
    this.axis.addEventListener("change", () => this.choose());
    this.slider.addEventListener("input", () => this.draw());
    byId("view-message").append(el("div", { class: "flat-controls" }, this.axis, this.slider, this.value), this.canvas,
      this.caption, this.legend());
    this.choose();
  }

  private legend(): HTMLElement {
    const states = [...new Set(this.sets.map((faces) => faces.state))];
    return el("div", { class: "flat-legend" }, ...states.map((state) => el("span", {}, el("i", { class: `swatch swatch-${state}` }),
      labelOf(this.page, state))));
  }

  /// Through the middle of what is painted, or newly blocked, where anything is.
  private choose(): void {
    const a = Number(this.axis.value);
    const first = this.page.stateLabels.length > 0 ? "conflict" : "painted";  // of a difference: what is newly blocked
    const painted = this.sets.filter((faces) => faces.state === first);
    const shown = painted.length > 0 ? painted : this.sets;
    const low = Math.min(...shown.map((faces) => faces.low[a])), high = Math.max(...shown.map((faces) => faces.high[a]));
    this.slider.min = String(this.low[a]);
    this.slider.max = String(this.high[a] - 1);
    this.slider.value = String(Math.floor((low + high) / 2));
    this.draw();
  }

  private metres(cell: number): string {
    return exactMetres((cell - this.page.origin) * this.page.resolution);
  }

  /// Right and up are the map's axes that `inspect --slice` takes.
  draw(): void {
    if (this.sets.length === 0) return;
    const a = Number(this.axis.value), u = (a + 1) % 3, v = (a + 2) % 3, layer = Number(this.slider.value);
    const [width, height] = [this.high[u] - this.low[u], this.high[v] - this.low[v]];
    if (width > 4096 || height > 4096) {
      this.canvas.hidden = true;
      this.caption.textContent = "";
      this.value.textContent = "too large for a picture here: `clearway inspect --slice` draws it";
      return;
    }
    this.canvas.hidden = false;
    const turned = a === 1;  // its u is z, which goes up
    this.canvas.width = turned ? height : width;
    this.canvas.height = turned ? width : height;
    const image = new ImageData(this.canvas.width, this.canvas.height);
    let voxels = 0;
    for (const faces of this.sets) {
      const mask = sliceMask(faces, a, layer, this.low[u], this.low[v], width, height);
      const color = sliceColor(faces.state);
      for (let i = 0; i < mask.length; ++i) {
        if (!mask[i]) continue;
        const [first, second] = [i % width, Math.floor(i / width)];
        const [column, row] = turned ? [second, first] : [first, second];
        image.data.set([...color, 255], 4 * ((this.canvas.height - 1 - row) * this.canvas.width + column));
        ++voxels;
      }
    }
    this.canvas.getContext("2d")!.putImageData(image, 0, 0);
    const [across, upwards] = turned ? [v, u] : [u, v];
    this.caption.textContent = `${"xyz"[across]} from ${this.metres(this.low[across])} at the left to ${this.metres(this.high[across])}, `
      + `${"xyz"[upwards]} from ${this.metres(this.low[upwards])} at the bottom to ${this.metres(this.high[upwards])}`;
    this.value.textContent = `${"xyz"[a]} = ${this.metres(layer + 0.5)}`;
    this.canvas.setAttribute("aria-label", `Slice of the map at ${this.value.textContent}: ${this.caption.textContent}`);
    document.body.dataset.slice = String(voxels);
  }
}
