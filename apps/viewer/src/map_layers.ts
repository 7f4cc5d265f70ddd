// The map in 3D: voxel surfaces by state, the exact balls, and the slice at the cut.

import { BufferAttribute, BufferGeometry, Box3, DataTexture, DoubleSide, Group, IcosahedronGeometry,
         InstancedBufferAttribute, InstancedBufferGeometry, Mesh, MeshBasicMaterial, NearestFilter, Plane, PlaneGeometry,
         SRGBColorSpace, Vector3 } from "three";
import type { Arrays, Page, StateName } from "./data";
import { quadVertices, sliceMask, unpackFaces, type Faces } from "./faces";
import { palette, rgb, type Palette } from "./palette";
import { surfaceMaterial, surfaceUniforms, type SurfaceUniforms } from "./surface_material";

export interface Layer {
  group: Group;
  bounds: Box3;
  recolor(): void;
  build?(): void;                     // to be called before it is shown
  setMoving?(moving: boolean): void;  // what is drawn: less while the view moves, or all
  setOpacity?(opacity: number): void;
}

/// About a tenth of a pixel: neighbouring quads of different sizes share no corners, so that rounding would leave
/// pinholes between them. Blended faces are not grown: their overlap would show.
const kGrow = 1e-4;

/// Translucent layers are blended from the inside of a map outwards: painted and balls, then seen free.
const blendOrder: Record<string, number> = { painted: 30, balls: 32, seen_free: 40 };

export function stateColors(state: StateName, colors: Palette): [string, string] {
  switch (state) {
    case "occupied": return [colors.occupiedLow, colors.occupiedHigh];
    case "painted": return [colors.painted, colors.painted];
    case "conflict": return [colors.conflict, colors.conflict];
    case "seen_free": return [colors.seenFree, colors.seenFree];
  }
}

function surfaceGroup(kind: "voxels" | "balls", name: string, geometry: BufferGeometry,
                      uniforms: SurfaceUniforms, isQuick = false): Group {
  const group = new Group();
  const order = blendOrder[name];
  for (const pass of order === undefined ? ["opaque"] as const : isQuick ? ["quick"] as const : ["depth", "blend"] as const) {
    const mesh = new Mesh(geometry, surfaceMaterial(kind, pass, uniforms));
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    mesh.renderOrder = pass === "opaque" ? 0 : pass === "blend" ? order + 1 : order;
    group.add(mesh);
  }
  return group;
}

const corner = (cells: number[], page: Page) =>
  new Vector3(...(cells.map((c) => (c - page.origin) * page.resolution) as [number, number, number]));

export function facesBounds(faces: Faces, page: Page): Box3 {
  return new Box3(corner(faces.low, page), corner(faces.high, page));
}

function voxelUniforms(faces: Faces, page: Page, heights: [number, number]): SurfaceUniforms {
  const uniforms = surfaceUniforms();
  uniforms.origin.value.copy(corner(faces.low, page));
  uniforms.voxel.value = page.resolution;
  uniforms.heights.value = heights;
  if (faces.state === "seen_free") uniforms.lines.value = 0.3;
  if (!(faces.state in blendOrder)) uniforms.grow.value = kGrow;
  return uniforms;
}

function voxelGroup(faces: Faces, uniforms: SurfaceUniforms, isQuick: boolean): Group {
  const { corners, triangles } = quadVertices(faces);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(corners, 4));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  return surfaceGroup("voxels", faces.state, geometry, uniforms, isQuick);
}

/// Its vertices are made when it is first shown. `turned`: the same, coarser.
export function voxelLayer(faces: Faces, turned: Faces | null, page: Page, heights: [number, number]): Layer {
  const all = voxelUniforms(faces, page, heights), few = turned ? voxelUniforms(turned, page, heights) : null;
  const both = few ? [all, few] : [all];
  const group = new Group();
  let isMoving = false;
  const layer: Layer = {
    group, bounds: facesBounds(faces, page),
    build() {
      if (group.children.length > 0) return;
      group.add(voxelGroup(faces, all, false));
      if (!turned || !few) return;
      group.add(voxelGroup(turned, few, true));
      layer.setMoving?.(isMoving);
    },
    setMoving(moving) {
      isMoving = moving;
      if (group.children.length < 2) return;
      group.children[0].visible = !moving;
      group.children[1].visible = moving;
    },
    recolor() {
      const [low, high] = stateColors(faces.state, palette());
      for (const uniforms of both) {
        uniforms.low.value.set(...rgb(low));
        uniforms.high.value.set(...rgb(high));
      }
    },
  };
  if (faces.state in blendOrder) layer.setOpacity = (opacity) => { for (const uniforms of both) uniforms.opacity.value = opacity; };
  layer.recolor();
  return layer;
}

/// Balls as instances of one sphere, coarser the more there are.
export function ballLayer(values: Float32Array): Layer {
  const count = values.length / 5;
  const sphere = new IcosahedronGeometry(1, count > 4000 ? 2 : count > 800 ? 4 : 8);
  const geometry = new InstancedBufferGeometry();
  geometry.setAttribute("position", sphere.getAttribute("position"));
  geometry.instanceCount = count;
  const balls = new Float32Array(count * 4), tints = new Float32Array(count * 3);
  const bounds = new Box3();
  for (let i = 0; i < count; ++i) {
    balls.set(values.subarray(i * 5, i * 5 + 4), i * 4);
    const center = new Vector3(balls[i * 4], balls[i * 4 + 1], balls[i * 4 + 2]), radius = balls[i * 4 + 3];
    bounds.expandByPoint(center.clone().addScalar(radius)).expandByPoint(center.subScalar(radius));
  }
  const tint = new InstancedBufferAttribute(tints, 3);
  geometry.setAttribute("ball", new InstancedBufferAttribute(balls, 4));
  geometry.setAttribute("tint", tint);
  const uniforms = surfaceUniforms();
  uniforms.opacity.value = 0.55;
  const layer: Layer = {
    group: surfaceGroup("balls", "balls", geometry, uniforms), bounds,
    recolor() {
      const colors = [palette().painted, ...palette().series];
      for (let i = 0; i < count; ++i) tints.set(rgb(colors[values[i * 5 + 4] % colors.length]), i * 3);
      tint.needsUpdate = true;
    },
    setOpacity(opacity) { uniforms.opacity.value = opacity; },
  };
  layer.recolor();
  return layer;
}

const stateLabels: Record<string, string> = { painted: "painted", occupied: "occupied", conflict: "conflict", seen_free: "seen free" };
/** What a page calls a state. */
export const labelOf = (page: Page, state: string) => page.stateLabels.find(([name]) => name === state)?.[1] ?? stateLabels[state];

/// The cells that the cut plane passes through, as a picture on the plane.
/// What blocks is drawn over the rest: where it is drawn coarser, it reaches into that.
export const sliceOrder: StateName[] = ["seen_free", "painted", "occupied", "conflict"];

/// Red, green and blue (0 to 255) of a state in a slice.
export function sliceColor(state: StateName): number[] {
  const [first, second] = stateColors(state, palette());
  if (state === "seen_free") return rgb(first).map((c, k) => Math.round(255 * (0.45 * c + 0.55 * rgb(palette().background)[k])));
  return rgb(first).map((c, k) => Math.round(127.5 * (c + rgb(second)[k]) * (state === "occupied" ? 0.8 : 1)));
}

/// Another colour (0 to 255) than a state's for a voxel, counted from the corner of the octree's space; null: the state's.
export type VoxelColor = (state: StateName, voxel: number[]) => number[] | null;

export class Slice {
  colorOf: VoxelColor | null = null;
  readonly mesh: Mesh<PlaneGeometry, MeshBasicMaterial>;

  constructor(private readonly sets: Faces[], private readonly page: Page) {
    const material = new MeshBasicMaterial({
      side: DoubleSide, alphaTest: 0.5, toneMapped: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1,
    });
    this.mesh = new Mesh(new PlaneGeometry(1, 1), material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  /// Only what the cuts across other axes leave is shown.
  clip(planes: Plane[]): void {
    this.mesh.material.clippingPlanes = planes;
    this.mesh.material.needsUpdate = true;
  }

  /// Shows the layer of voxels just inside the cut at `at` metres along `axis`, for the states in `shown`.
  /// Returns how many voxels it shows; none when the picture would be too large to draw.
  update(axis: 0 | 1 | 2, at: number, keepsAbove: boolean, shown: (state: StateName) => boolean): number {
    const sets = sliceOrder.flatMap((state) => this.sets.filter((faces) => faces.state === state && faces.quadCount > 0 && shown(state)));
    const u = (axis + 1) % 3, v = (axis + 2) % 3;
    const low = [u, v].map((a) => Math.min(...sets.map((faces) => faces.low[a])));
    const [width, height] = [u, v].map((a, k) => Math.max(...sets.map((faces) => faces.high[a])) - low[k]);
    this.mesh.visible = sets.length > 0 && width <= 4096 && height <= 4096;
    if (!this.mesh.visible) return 0;
    const cell = at / this.page.resolution + this.page.origin;
    const layer = keepsAbove ? Math.floor(cell + 1e-4) : Math.ceil(cell - 1e-4) - 1;
    const pixels = new Uint8Array(width * height * 4);
    let count = 0;
    for (const faces of sets) {
      const mask = sliceMask(faces, axis, layer, low[0], low[1], width, height);
      const color = sliceColor(faces.state), voxel = [0, 0, 0];
      voxel[axis] = layer;
      for (let i = 0; i < mask.length; ++i) {
        if (!mask[i]) continue;
        voxel[u] = low[0] + i % width;
        voxel[v] = low[1] + Math.floor(i / width);
        pixels.set([...this.colorOf?.(faces.state, voxel) ?? color, 255], i * 4);
        ++count;
      }
    }
    this.place(axis, at, low, width, height, pixels);
    return count;
  }

  hide(): void { this.mesh.visible = false; }

  private place(axis: number, at: number, low: number[], width: number, height: number, pixels: Uint8Array): void {
    const texture = new DataTexture(pixels, width, height);
    texture.magFilter = texture.minFilter = NearestFilter;
    texture.colorSpace = SRGBColorSpace;
    texture.needsUpdate = true;
    this.mesh.material.map?.dispose();
    this.mesh.material.map = texture;
    this.mesh.material.needsUpdate = true;
    const metres = this.page.resolution;
    const ends = low.map((l, k) => (l + (k === 0 ? width : height) / 2 - this.page.origin) * metres);
    const center = new Vector3().setComponent(axis, at).setComponent((axis + 1) % 3, ends[0]).setComponent((axis + 2) % 3, ends[1]);
    // The plane's own x and y become the slice's u and v.
    const unit = (a: number) => new Vector3().setComponent(a % 3, 1);
    this.mesh.matrixAutoUpdate = false;
    this.mesh.matrix.makeBasis(unit(axis + 1).multiplyScalar(width * metres), unit(axis + 2).multiplyScalar(height * metres), unit(axis))
      .setPosition(center);
    this.mesh.matrixWorldNeedsUpdate = true;
  }
}

export function unpackAll(page: Page, arrays: Arrays): Faces[] {
  return page.voxels.map((set) => unpackFaces(set, arrays));
}
