// The cut planes, one an axis: where, which side, and the slice drawn on it.

import { Plane, Vector3, type Box3 } from "three";
import type { StateName } from "./data";
import { byId, el } from "./dom";
import type { Slice } from "./map_layers";
import type { Cut } from "./options";
import { cutUniform, showBackFaces } from "./surface_material";

/// The side that stays, so that the usual view from the front, right and above looks into the cut.
export const keptSide = [1, -1, 1];

/// One axis: its box, slider, value and side.
class CutRow {
  readonly box = el("input", { type: "checkbox" });
  readonly flip = el("button", { type: "button", class: "small", title: "Show the other side" }, "flip");
  private readonly slider: HTMLInputElement;
  private readonly value = el("output", {});
  private flipped: boolean;

  constructor(readonly axis: 0 | 1 | 2, range: Box3, private readonly resolution: number, first: Cut | undefined, changed: () => void) {
    const name = "xyz"[axis], [low, high] = [range.min.getComponent(axis), range.max.getComponent(axis)];
    this.slider = el("input", { type: "range", step: "any", "aria-label": `Cut position along ${name}`,
                                min: String(low), max: String(high), value: String(first?.at ?? (low + high) / 2) });
    this.box.checked = first !== undefined;
    this.flipped = first?.flipped ?? false;
    for (const input of [this.box, this.slider]) input.addEventListener("input", changed);
    this.flip.addEventListener("click", () => { this.flipped = !this.flipped; changed(); });
    byId("cut").append(el("div", { class: "cut-axis" }, el("label", { class: "cut-name" }, this.box, `cut ${name}`), this.value, this.flip), this.slider);
  }

  get at(): number { return Number(this.slider.value); }
  get sign(): number { return this.flipped ? -keptSide[this.axis] : keptSide[this.axis]; }
  /// A little past the plane, so that faces which lie in it stay whole.
  get offset(): number { return this.sign * this.at + 1e-3 * this.resolution; }

  show(): void {
    this.slider.hidden = this.flip.hidden = !this.box.checked;
    this.value.textContent = this.box.checked ? `${this.at.toFixed(this.resolution < 0.01 ? 3 : 2)} m` : "";
    const cut = cutUniform.value[this.axis].set(0, 0, 0, 1);
    if (this.box.checked) cut.set(0, 0, 0, this.offset).setComponent(this.axis, this.sign);
  }

  /// What stays, for materials of three.js.
  plane(): Plane { return new Plane(new Vector3().setComponent(this.axis, -this.sign), this.offset); }
}

export function cutControls(range: Box3, resolution: number, slices: Slice[], first: Cut[],
                            shown: (state: StateName) => boolean, changed: () => void): { refresh(): void } {
  const withSlice = el("input", { type: "checkbox" });
  withSlice.checked = true;
  const refresh = () => {
    for (const row of rows) row.show();
    const cut = rows.filter((row) => row.box.checked);
    showBackFaces(cut.length > 0);
    sliceLabel.hidden = cut.length === 0;
    let voxels = 0;
    for (const row of rows) {
      const slice = slices[row.axis];
      slice.hide();
      if (!row.box.checked || !withSlice.checked) continue;
      slice.clip(cut.filter((other) => other !== row).map((other) => other.plane()));
      voxels += slice.update(row.axis, row.at, row.sign < 0, shown);
    }
    if (cut.length > 0) document.body.dataset.slice = String(voxels);
    changed();
  };
  const rows = ([0, 1, 2] as const).map((axis) => new CutRow(axis, range, resolution, first.find((cut) => cut.axis === axis), refresh));
  const sliceLabel = el("label", { class: "cut-slice", title: "Colour the voxels that the planes pass through" }, withSlice, "slices in colour");
  byId("cut").append(sliceLabel);
  withSlice.addEventListener("change", refresh);
  return { refresh };
}
