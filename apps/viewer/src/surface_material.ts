// The material of voxel faces and balls: flat light from above, height shading, voxel lines, the cut.

import { Data3DTexture, DoubleSide, FrontSide, GLSL3, LessEqualDepth, RawShaderMaterial, Vector3, Vector4, type IUniform } from "three";
import type { Evidence, Page } from "./data";

/// The cuts across x, y and z are one object that all materials share: fragments with normal . position > offset
/// of any are not drawn.
export const cutUniform: IUniform<Vector4[]> = { value: [0, 1, 2].map(() => new Vector4(0, 0, 0, 1)) };

const voxelVertex = `
in vec4 position;
uniform vec3 origin;
uniform float voxel, grow;
out vec3 normal_;
out vec2 cell;
void main() {
  int code = int(position.w + 0.5), direction = code % 8, corner = code / 8, axis = direction / 2;
  normal_ = vec3(0.0);
  normal_[axis] = direction % 2 == 1 ? 1.0 : -1.0;
  cell = vec2(position[(axis + 1) % 3], position[(axis + 2) % 3]);
  world = origin + position.xyz * voxel;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
  vec3 outward = vec3(0.0);
  outward[(axis + 1) % 3] = corner == 1 || corner == 2 ? 1.0 : -1.0;
  outward[(axis + 2) % 3] = corner >= 2 ? 1.0 : -1.0;
  gl_Position = projectionMatrix * viewMatrix * vec4(world + outward * grow * gl_Position.w, 1.0);
}`;

const ballVertex = `
in vec3 position;
in vec4 ball;
in vec3 tint;
out vec3 normal_;
out vec3 color_;
void main() {
  normal_ = position;
  color_ = tint;
  world = ball.xyz + position * ball.w;
  gl_Position = projectionMatrix * viewMatrix * vec4(world, 1.0);
}`;

const vertexHead = `
precision highp float;
precision highp int;
uniform mat4 viewMatrix, projectionMatrix;
out vec3 world;
invariant gl_Position;
`;

/// Colours that say something else than the state: BY 1 height, 2 age, 3 volume. The voxel is the one behind the face.
const gridColor = `
#ifdef BY
precision highp sampler3D;
uniform sampler3D grid;
uniform vec3 gridLow, gridSize, ramp[5], unknown, several, volumes[16];
uniform vec2 span;
uniform float gridVoxel, gridCell;
vec3 on_ramp(float share) {
  float at = clamp(share, 0.0, 1.0) * 4.0;
  int first = min(int(at), 3);
  return mix(ramp[first], ramp[first + 1], at - float(first));
}
vec3 by_grid() {
#if BY == 1
  return on_ramp((world.z - span.x) / max(span.y - span.x, 1e-9));
#else
  vec3 cube = floor((floor((world - 0.5 * gridVoxel * normal_) / gridVoxel) - gridLow) / gridCell);
  if (any(lessThan(cube, vec3(0.0))) || any(greaterThanEqual(cube, gridSize))) return unknown;
  vec2 known = floor(texelFetch(grid, ivec3(cube), 0).rg * 255.0 + 0.5);
#if BY == 2
  return known.r < 0.5 ? unknown : on_ramp((known.r - 1.0) / 254.0);
#else
  return known.g < 0.5 ? unknown : known.g > 254.5 ? several : volumes[min(int(known.g) - 1, 15)];
#endif
#endif
}
#endif`;

const fragment = (isVoxel: boolean) => `
precision highp float;
in vec3 world;
in vec3 normal_;
${isVoxel ? "in vec2 cell;" : "in vec3 color_;"}
uniform vec4 cut[3];
uniform vec3 low, high;
uniform vec2 heights;
uniform float opacity, lines, shine;
${isVoxel ? gridColor : ""}
out vec4 color;
void main() {
  for (int k = 0; k < 3; ++k) if (dot(cut[k].xyz, world) > cut[k].w) discard;
  vec3 n = normalize(normal_) * (gl_FrontFacing ? 1.0 : -1.0);
  float light = 0.76 + 0.24 * n.z + 0.13 * n.x - 0.06 * n.y;
  light *= gl_FrontFacing ? 1.0 : 0.62;
  ${isVoxel
    ? `vec3 base = mix(low, high, clamp((world.z - heights.x) / (heights.y - heights.x), 0.0, 1.0));
#ifdef BY
  base = by_grid();
#endif
  vec2 width = fwidth(cell);
  vec2 near = abs(fract(cell - 0.5) - 0.5) / max(width, vec2(1e-6));
  float edge = 1.0 - min(min(near.x, near.y), 1.0);
  float visible = clamp(1.0 - 3.5 * max(width.x, width.y), 0.0, 1.0);
  light *= 1.0 - lines * edge * visible;`
    : "vec3 base = color_;"}
  color = vec4(base * light * shine, opacity);
}`;

export interface SurfaceUniforms {
  [name: string]: IUniform;
  cut: IUniform<Vector4[]>;
  low: IUniform<Vector3>; high: IUniform<Vector3>;
  heights: IUniform<[number, number]>;
  opacity: IUniform<number>; lines: IUniform<number>; shine: IUniform<number>;
  origin: IUniform<Vector3>; voxel: IUniform<number>;
  grow: IUniform<number>;  // quads grow by this times their distance: it hides pinholes between merged quads
}

export function surfaceUniforms(): SurfaceUniforms {
  return {
    cut: cutUniform,
    low: { value: new Vector3(1, 1, 1) }, high: { value: new Vector3(1, 1, 1) },
    heights: { value: [0, 1] },
    opacity: { value: 1 }, lines: { value: 0.16 }, shine: { value: 1 },
    origin: { value: new Vector3() }, voxel: { value: 1 }, grow: { value: 0 },
  };
}

const voxelMaterials: RawShaderMaterial[] = [];

/// What all materials of voxels share to be coloured by something else than their state.
const gridUniforms: Record<string, IUniform> = {
  grid: { value: null }, gridLow: { value: new Vector3() }, gridSize: { value: new Vector3(1, 1, 1) },
  gridVoxel: { value: 1 }, gridCell: { value: 1 }, span: { value: [0, 1] },
  ramp: { value: Array.from({ length: 5 }, () => new Vector3()) }, volumes: { value: Array.from({ length: 16 }, () => new Vector3()) },
  unknown: { value: new Vector3() }, several: { value: new Vector3() },
};
let by = 0;

export function setGrid(texture: Data3DTexture, about: Evidence, page: Page): void {
  gridUniforms.grid.value = texture;
  gridUniforms.gridLow.value.set(...about.low);
  gridUniforms.gridSize.value.set(...about.size);
  gridUniforms.gridVoxel.value = page.resolution;
  gridUniforms.gridCell.value = about.cell;
}

/// Colours all voxels by `mode`; volumes at most 16.
export function showGridColors(of: { mode: "state" | "height" | "age" | "volume"; heights: [number, number]; ramp: number[][];
                                     unknown: number[]; several: number[]; volumes: number[][] }): void {
  gridUniforms.span.value = of.heights;
  of.ramp.forEach((color, i) => gridUniforms.ramp.value[i].set(...color));
  of.volumes.slice(0, 16).forEach((color, i) => gridUniforms.volumes.value[i].set(...color));
  gridUniforms.unknown.value.set(...of.unknown);
  gridUniforms.several.value.set(...of.several);
  by = ["state", "height", "age", "volume"].indexOf(of.mode);
  for (const material of voxelMaterials) define(material);
}

function define(material: RawShaderMaterial): void {
  const wanted: { BY?: number } = by > 0 ? { BY: by } : {};
  if (material.defines?.BY === wanted.BY) return;
  material.defines = wanted;
  material.needsUpdate = true;
}

/// Back faces are seen only through a cut; without one, leaving them out halves the work.
export function showBackFaces(shown: boolean): void {
  for (const material of voxelMaterials) material.side = shown ? DoubleSide : FrontSide;
}

/// `pass`: "opaque" draws once; a translucent surface is drawn twice, "depth" first and then "blend", so that
/// only the part nearest to the eye is blended and overlapping faces do not add up. "quick": once all the same, so
/// that what is drawn before something nearer shows through it.
export function surfaceMaterial(kind: "voxels" | "balls", pass: "opaque" | "depth" | "blend" | "quick",
                                uniforms: SurfaceUniforms): RawShaderMaterial {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3, uniforms: kind === "voxels" ? { ...uniforms, ...gridUniforms } : uniforms,
    vertexShader: vertexHead + (kind === "voxels" ? voxelVertex : ballVertex),
    fragmentShader: fragment(kind === "voxels"),
    side: FrontSide,
    transparent: pass !== "opaque",
    colorWrite: pass !== "depth",
    depthWrite: pass !== "blend",
    depthFunc: LessEqualDepth,
  });
  if (kind === "voxels") {
    voxelMaterials.push(material);
    define(material);
  }
  return material;
}
