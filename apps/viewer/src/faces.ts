// Voxel surfaces as quads: unpacking, the vertices that draw them, and the slice through them.

import type { Arrays, StateName, VoxelSet } from "./data";

/// Quads sorted by direction, then layer. Coordinates in finest voxels from the corner of the octree's space.
export interface Faces {
  state: StateName;
  cell: number;  // what is drawn are cubes of so many voxels an edge
  voxelCount: number; faceCount: number; quadCount: number;
  start: number[];  // start[d] .. start[d + 1]: the quads that face direction d
  layer: Uint16Array; u: Uint16Array; v: Uint16Array;
  width: Uint32Array; height: Uint32Array;
  low: number[]; high: number[];  // bounds, in voxels; high is exclusive
}

function accumulate(differences: Uint16Array): Uint16Array {
  const out = new Uint16Array(differences.length);
  let last = 0;
  for (let i = 0; i < out.length; ++i) out[i] = last = (last + differences[i]) & 0xffff;
  return out;
}

export function unpackFaces(set: VoxelSet, arrays: Arrays): Faces {
  const [layer, u, v, width, height] = set.columns.map((place) => accumulate(arrays.u16(place)));
  const start = [0];
  for (const count of set.directions) start.push(start[start.length - 1] + count);
  const faces: Faces = {
    state: set.state, cell: set.cell, voxelCount: set.count, faceCount: set.faces, quadCount: layer.length, start,
    layer, u, v, width: Uint32Array.from(width, (w) => w + 1), height: Uint32Array.from(height, (h) => h + 1),
    low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity],
  };
  for (let direction = 0; direction < 6; ++direction) {
    const a = direction >> 1;
    for (let i = start[direction]; i < start[direction + 1]; ++i) {
      faces.low[a] = Math.min(faces.low[a], layer[i]);
      faces.high[a] = Math.max(faces.high[a], layer[i] + 1);
    }
  }
  return faces;
}

/// Four corners a quad: x, y, z from `low` in voxels, and direction + 8 * corner; two triangles a quad, outward.
export function quadVertices(faces: Faces): { corners: Uint16Array | Float32Array; triangles: Uint32Array } {
  const extent = Math.max(...faces.high.map((h, a) => h - faces.low[a]));
  const size = faces.quadCount * 16;
  const corners = extent > 0xffff ? new Float32Array(size) : new Uint16Array(size);
  const triangles = new Uint32Array(faces.quadCount * 6);
  for (let direction = 0; direction < 6; ++direction) {
    const a = direction >> 1, b = (a + 1) % 3, c = (a + 2) % 3, positive = direction & 1;
    for (let i = faces.start[direction]; i < faces.start[direction + 1]; ++i) {
      const plane = faces.layer[i] + positive - faces.low[a];
      for (let k = 0; k < 4; ++k) {
        const at = i * 16 + k * 4;
        corners[at + a] = plane;
        corners[at + b] = faces.u[i] - faces.low[b] + (k === 1 || k === 2 ? faces.width[i] : 0);
        corners[at + c] = faces.v[i] - faces.low[c] + (k >= 2 ? faces.height[i] : 0);
        corners[at + 3] = direction + 8 * k;
      }
      const first = i * 4, [second, third] = positive ? [1, 3] : [3, 1];
      triangles.set([first, first + second, first + 2, first, first + 2, first + third], i * 6);
    }
  }
  return { corners, triangles };
}

/// Which voxels of layer `layer` along `axis` belong to the set, as a width x height mask from (lowU, lowV).
/// Along the axis a voxel is inside when one more face opened below it than closed: the quads' signs, summed over
/// their rectangles (a two-dimensional prefix sum), say so without the voxels themselves.
export function sliceMask(faces: Faces, axis: number, layer: number, lowU: number, lowV: number,
                          width: number, height: number): Uint8Array {
  const stride = width + 1;
  const sum = new Int32Array(stride * (height + 1));
  for (const positive of [0, 1]) {
    const sign = positive ? -1 : 1, direction = axis * 2 + positive;
    for (let i = faces.start[direction]; i < faces.start[direction + 1]; ++i) {
      if (faces.layer[i] + positive > layer) break;
      const u = faces.u[i] - lowU, v = faces.v[i] - lowV;
      const right = u + faces.width[i], top = (v + faces.height[i]) * stride;
      sum[v * stride + u] += sign;
      sum[v * stride + right] -= sign;
      sum[top + u] -= sign;
      sum[top + right] += sign;
    }
  }
  const mask = new Uint8Array(width * height);
  for (let v = 0; v < height; ++v) {
    let row = 0;
    for (let u = 0; u < width; ++u) {
      const at = v * stride + u;
      row += sum[at];
      const inside = row + (v > 0 ? sum[at - stride] : 0);
      sum[at] = inside;
      mask[v * width + u] = inside > 0 ? 1 : 0;
    }
  }
  return mask;
}
