// The cuts with which a page opens where walls and ceilings hide what it is about.

import { Box3, Vector3, Vector4 } from "three";
import type { Faces } from "./faces";
import { keptSide } from "./cut_controls";
import type { Cut } from "./options";
import { pick } from "./pick";

const enough = 0.3;  // of the points: seen so far, a view shows what it is about
const most = 40;     // points that are looked at

/// Cuts above `points` (metres), then before them, then beside them, until enough of them are seen from `eye`; none
/// where they are, or where nothing helps.
export function openingCuts(points: Vector3[], eye: Vector3, walls: Faces[], whole: Box3, size: number, origin: number): Cut[] {
  if (points.length === 0 || walls.length === 0) return [];
  const step = Math.max(1, Math.floor(points.length / most));
  const looked = points.filter((_, i) => i % step === 0);
  const box = new Box3().setFromPoints(points).expandByScalar(2 * size);
  const center = box.getCenter(new Vector3());
  const seen = (cuts: Vector4[]) => looked.filter((point) => {
    const way = point.clone().sub(eye), distance = way.length();
    const hit = pick(walls, eye, way.normalize(), cuts, size, origin);
    return hit === null || hit.distance >= distance - 2 * size;
  }).length / looked.length;
  if (seen([]) >= enough) return [];
  const cuts: Cut[] = [], planes: Vector4[] = [];
  for (const axis of [2, 1, 0] as const) {
    const sign = eye.getComponent(axis) > center.getComponent(axis) ? 1 : -1;
    const at = (sign > 0 ? box.max : box.min).getComponent(axis);
    if (at <= whole.min.getComponent(axis) || at >= whole.max.getComponent(axis)) continue;
    cuts.push({ axis, at, flipped: sign !== keptSide[axis] });
    planes.push(new Vector4(0, 0, 0, sign * at).setComponent(axis, sign));
    if (seen(planes) >= enough) return cuts;
  }
  return [];
}
