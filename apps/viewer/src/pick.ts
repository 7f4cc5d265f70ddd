// Which voxel a ray meets first: the quads are few enough to ask each.

import type { Vector3, Vector4 } from "three";
import type { StateName } from "./data";
import type { Faces } from "./faces";

export interface Hit { state: StateName; distance: number; voxel: number[] }

/// The nearest face of the shown sets on the ray (metres, map frame) that the cuts leave, seen from outside.
/// `voxel` is the octree coordinate of the voxel behind the face.
export function pick(sets: Faces[], from: Vector3, direction: Vector3, cuts: Vector4[], size: number, origin: number): Hit | null {
  const start = from.toArray().map((x) => x / size + origin), slope = direction.toArray();
  let best: Hit | null = null;
  for (const faces of sets)
    for (let side = 0; side < 6; ++side) {
      const a = side >> 1, b = (a + 1) % 3, c = (a + 2) % 3, positive = side & 1;
      if (positive ? slope[a] >= 0 : slope[a] <= 0) continue;
      for (let i = faces.start[side]; i < faces.start[side + 1]; ++i) {
        const distance = (faces.layer[i] + positive - start[a]) / slope[a] * size;
        if (distance <= 0 || (best && distance >= best.distance)) continue;
        const u = start[b] + slope[b] * distance / size - faces.u[i];
        const v = start[c] + slope[c] * distance / size - faces.v[i];
        if (u < 0 || v < 0 || u >= faces.width[i] || v >= faces.height[i]) continue;
        const at = from.clone().addScaledVector(direction, distance);
        if (cuts.some((cut) => cut.x * at.x + cut.y * at.y + cut.z * at.z > cut.w)) continue;
        const voxel = [0, 0, 0];
        voxel[a] = faces.layer[i];
        voxel[b] = faces.u[i] + Math.floor(u);
        voxel[c] = faces.v[i] + Math.floor(v);
        best = { state: faces.state, distance, voxel };
      }
    }
  return best;
}
