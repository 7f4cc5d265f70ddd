// The menu that colours voxels by state, height, age or painted volume, and its legend.

import type { Page, StateName } from "./data";
import { el, millimetres } from "./dom";
import type { EvidenceGrid } from "./evidence";
import { cssColor, palette, rampAt, rgb } from "./palette";
import { setGrid, showGridColors } from "./surface_material";

export type ColorMode = "state" | "height" | "age" | "volume";

const kSeveral = 255;
const seconds = (value: number) => value < 120 ? `${Number(value.toPrecision(3))} s` : value < 7200 ? `${(value / 60).toFixed(1)} min` : `${(value / 3600).toFixed(1)} h`;

const tall = (metres: number) => `${(Math.round(100 * metres) / 100 || 0).toFixed(2)} m`;  // never -0.00

export class VoxelColors {
  mode: ColorMode = "state";
  private readonly menu = el("select", { id: "voxel-color", "aria-label": "Colour voxels by" });
  private readonly legend = el("div", { class: "legend" });

  /// @param heights between which colours change, m @param changed is called when the colours are others
  constructor(private readonly page: Page, private readonly grid: EvidenceGrid, private readonly heights: [number, number],
              first: string, changed: () => void) {
    const modes: [ColorMode, string][] = [["state", "state"], ["height", "height"]];
    if (grid.hasLooks) modes.push(["age", "age"]);
    if (grid.hasVolumes) modes.push(["volume", "volume"]);
    this.menu.append(...modes.map(([mode, name]) => el("option", { value: mode }, name)));
    this.mode = modes.find(([mode]) => mode === first)?.[0] ?? "state";
    this.menu.value = this.mode;
    this.menu.addEventListener("change", () => {
      this.mode = this.menu.value as ColorMode;
      this.recolor();
      changed();
    });
  }

  /// The rows of the panel.
  elements(): HTMLElement[] {
    return [el("label", { class: "layer-slider" }, el("span", {}, "voxels by"), this.menu), this.legend];
  }

  recolor(): void {
    const colors = palette(), { about } = this.grid;
    document.body.dataset.color = this.mode;
    if (this.mode === "age" || this.mode === "volume") setGrid(this.grid.texture(), about, this.page);
    showGridColors({ mode: this.mode, heights: this.heights, ramp: colors.ramp.map(rgb), unknown: rgb(colors.unknown),
                     several: rgb(colors.several), volumes: this.volumeColors() });
    const coarse = about.cell > 1 && this.mode !== "height" ? `, in cubes of ${millimetres(about.cell * this.page.resolution)}` : "";
    if (this.mode === "height") this.showRamp(tall(this.heights[0]), tall(this.heights[1]), "height", null);
    else if (this.mode === "age")
      this.showRamp(seconds(about.times[1] - about.times[0]), "0 s", `since last seen${coarse}`, "never seen by a timed scan");
    else if (this.mode === "volume") this.showVolumes(coarse);
    else this.legend.replaceChildren();
  }

  private showRamp(low: string, high: string, what: string, unknown: string | null): void {
    this.legend.replaceChildren(
      el("i", { class: "legend-bar", style: `background:linear-gradient(90deg, ${palette().ramp.join(", ")})` }),
      el("span", { class: "legend-ends" }, el("span", {}, low), el("span", {}, what), el("span", {}, high)),
      ...(unknown ? [this.swatch(palette().unknown, unknown)] : []));
  }

  private showVolumes(coarse: string): void {
    const colors = this.volumeColors();
    this.legend.replaceChildren(
      ...this.page.volumes.map((name, i) => this.swatch(cssColor(colors[i]), name)),
      ...(this.page.volumes.length > 1 ? [this.swatch(palette().several, `several${coarse}`)] : []),
      this.swatch(palette().unknown, "in no volume"));
  }

  private swatch(color: string, text: string): HTMLElement {
    return el("span", { class: "legend-entry" }, el("i", { style: `background:${color}` }), text);
  }

  private volumeColors(): number[][] {
    const colors = [palette().painted, ...palette().series];
    return this.page.volumes.map((_, i) => rgb(colors[i % colors.length]));
  }

  /// Red, green and blue (0 to 255) of a voxel in a slice; null: as its state has it.
  of(_state: StateName, voxel: number[]): number[] | null {
    if (this.mode === "state") return null;
    const colors = palette(), bytes = (color: number[]) => color.map((c) => Math.round(255 * c));
    if (this.mode === "height") {
      const z = (voxel[2] + 0.5 - this.page.origin) * this.page.resolution;
      return bytes(rampAt(colors.ramp, (z - this.heights[0]) / Math.max(1e-9, this.heights[1] - this.heights[0])));
    }
    const [look, volume] = this.grid.bytes(this.grid.index(voxel, this.page.origin));
    if (this.mode === "age") return bytes(look > 0 ? rampAt(colors.ramp, (look - 1) / 254) : rgb(colors.unknown));
    if (volume === 0) return bytes(rgb(colors.unknown));
    return bytes(volume === kSeveral ? rgb(palette().several) : this.volumeColors()[volume - 1]);
  }
}
