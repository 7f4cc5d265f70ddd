// What the map knows of its voxels beside their states: looked up by voxel, and as a texture.

import { Data3DTexture, NearestFilter, RGFormat, UnsignedByteType } from "three";
import type { Arrays, Evidence, Page } from "./data";

/// What is known of the cube that holds a voxel.
export interface CubeEvidence {
  look: number | null;             // s, newest; null: never, or not known when
  volume: number | "several" | null;
  odds: [number, number] | null;   // least and greatest log-odds of observed voxels; null: never observed
}

const kSeveral = 255;

export class EvidenceGrid {
  readonly about: Evidence;
  readonly hasLooks: boolean;
  readonly hasVolumes: boolean;
  readonly hasOdds: boolean;
  private readonly look: Uint8Array;
  private readonly volume: Uint8Array;
  private readonly lowOdds: Uint8Array;
  private readonly highOdds: Uint8Array;
  private shared: Data3DTexture | null = null;

  constructor(page: Page, arrays: Arrays) {
    this.about = page.evidence;
    [this.look, this.volume, this.lowOdds, this.highOdds] =
      [this.about.look, this.about.volume, this.about.lowOdds, this.about.highOdds].map((place) => arrays.u8(place));
    this.hasLooks = this.look.length > 0;
    this.hasVolumes = this.volume.length > 0;
    this.hasOdds = this.highOdds.length > 0;
  }

  get cells(): number { return this.about.size.reduce((product, n) => product * n, 1); }

  /// `voxel` counts from the corner of the octree's space, as faces do. -1: outside.
  index(voxel: number[], origin: number): number {
    const { low, size, cell } = this.about;
    const at = voxel.map((v, a) => Math.floor((v - origin - low[a]) / cell));
    return at.some((v, a) => v < 0 || v >= size[a]) ? -1 : at[0] + size[0] * (at[1] + size[1] * at[2]);
  }

  /// Bytes of one cube: its look (0: none) and its volume.
  bytes(index: number): [number, number] { return [this.look[index] ?? 0, this.volume[index] ?? 0]; }

  at(voxel: number[], origin: number): CubeEvidence {
    const i = this.index(voxel, origin), { times, odds } = this.about;
    const between = (range: number[], step: number) => range[0] + (step - 1) / 254 * (range[1] - range[0]);
    const [look, volume, low] = [this.look[i] ?? 0, this.volume[i] ?? 0, this.lowOdds[i] ?? 0];
    return {
      look: look > 0 ? between(times, look) : null,
      volume: volume === 0 ? null : volume === kSeveral ? "several" : volume - 1,
      odds: low > 0 ? [between(odds, low), between(odds, this.highOdds[i])] : null,
    };
  }

  /// Look and volume of each cube.
  texture(): Data3DTexture {
    if (this.shared) return this.shared;
    const count = this.cells, pairs = new Uint8Array(2 * Math.max(1, count));
    for (let i = 0; i < count; ++i) pairs.set(this.bytes(i), 2 * i);
    const [width, height, depth] = count > 0 ? this.about.size : [1, 1, 1];
    this.shared = new Data3DTexture(pairs, width, height, depth);
    this.shared.format = RGFormat;
    this.shared.type = UnsignedByteType;
    this.shared.magFilter = this.shared.minFilter = NearestFilter;
    this.shared.unpackAlignment = 1;
    this.shared.needsUpdate = true;
    return this.shared;
  }
}
