// The cut plane: which axis, where, which side, and the slice drawn on it.

import type { Box3 } from "three";
import type { StateName } from "./data";
import { byId, el } from "./dom";
import type { Slice } from "./map_layers";
import type { Options } from "./options";
import { cutUniform, showBackFaces } from "./surface_material";

/// The side that stays, so that the usual view from the front, right and above looks into the cut.
const kept = [1, -1, 1];

export function cutControls(box: Box3, resolution: number, slice: Slice, first: Options["cut"],
                            shown: (state: StateName) => boolean, changed: () => void): { refresh(): void } {
  const axisSelect = el("select", { "aria-label": "Cut across" },
    el("option", { value: "" }, "no cut"), ...["x", "y", "z"].map((name, a) => el("option", { value: String(a) }, `cut ${name}`)));
  const slider = el("input", { type: "range", step: "any", "aria-label": "Cut position" });
  const value = el("output", {});
  const flip = el("button", { type: "button", class: "small", title: "Show the other side" }, "flip");
  const withSlice = el("input", { type: "checkbox" });
  withSlice.checked = true;
  const sliceLabel = el("label", { class: "cut-slice", title: "Colour the voxels that the plane passes through" }, withSlice, "slice");
  const details = el("div", { class: "cut-details" }, slider, el("div", { class: "cut-row" }, value, sliceLabel, flip));
  byId("cut").append(axisSelect, details);
  let flipped = first?.flipped ?? false;

  const range = (a: 0 | 1 | 2, at?: number) => {
    const [low, high] = [box.min.getComponent(a), box.max.getComponent(a)];
    slider.min = String(low);
    slider.max = String(high);
    slider.value = String(at ?? (low + high) / 2);
  };
  const refresh = () => {
    details.hidden = axisSelect.value === "";
    showBackFaces(axisSelect.value !== "");
    if (axisSelect.value === "") {
      cutUniform.value.set(0, 0, 0, 1);
      slice.hide();
    } else {
      const a = Number(axisSelect.value) as 0 | 1 | 2, at = Number(slider.value), sign = flipped ? -kept[a] : kept[a];
      // A little past the plane, so that faces which lie in it stay whole.
      cutUniform.value.set(0, 0, 0, sign * at + 1e-3 * resolution).setComponent(a, sign);
      value.textContent = `${"xyz"[a]} = ${at.toFixed(resolution < 0.01 ? 3 : 2)} m`;
      if (withSlice.checked) document.body.dataset.slice = String(slice.update(a, at, sign < 0, shown));
      else slice.hide();
    }
    changed();
  };
  if (first) { axisSelect.value = String(first.axis); range(first.axis, first.at); }
  axisSelect.addEventListener("change", () => {
    if (axisSelect.value !== "") range(Number(axisSelect.value) as 0 | 1 | 2);
    refresh();
  });
  slider.addEventListener("input", refresh);
  withSlice.addEventListener("change", refresh);
  flip.addEventListener("click", () => { flipped = !flipped; refresh(); });
  return { refresh };
}
