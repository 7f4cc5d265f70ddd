// The material of voxel faces and balls: flat light from above, height shading, voxel lines, the cut.

import { DoubleSide, FrontSide, GLSL3, LessEqualDepth, RawShaderMaterial, Vector3, Vector4, type IUniform } from "three";

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

const fragment = (isVoxel: boolean) => `
precision highp float;
in vec3 world;
in vec3 normal_;
${isVoxel ? "in vec2 cell;" : "in vec3 color_;"}
uniform vec4 cut[3];
uniform vec3 low, high;
uniform vec2 heights;
uniform float opacity, lines, shine;
out vec4 color;
void main() {
  for (int k = 0; k < 3; ++k) if (dot(cut[k].xyz, world) > cut[k].w) discard;
  vec3 n = normalize(normal_) * (gl_FrontFacing ? 1.0 : -1.0);
  float light = 0.76 + 0.24 * n.z + 0.13 * n.x - 0.06 * n.y;
  light *= gl_FrontFacing ? 1.0 : 0.62;
  ${isVoxel
    ? `vec3 base = mix(low, high, clamp((world.z - heights.x) / (heights.y - heights.x), 0.0, 1.0));
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

/// Back faces are seen only through a cut; without one, leaving them out halves the work.
export function showBackFaces(shown: boolean): void {
  for (const material of voxelMaterials) material.side = shown ? DoubleSide : FrontSide;
}

/// `pass`: "opaque" draws once; a translucent surface is drawn twice, "depth" first and then "blend", so that
/// only the part nearest to the eye is blended and overlapping faces do not add up.
export function surfaceMaterial(kind: "voxels" | "balls", pass: "opaque" | "depth" | "blend",
                                uniforms: SurfaceUniforms): RawShaderMaterial {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3, uniforms,
    vertexShader: vertexHead + (kind === "voxels" ? voxelVertex : ballVertex),
    fragmentShader: fragment(kind === "voxels"),
    side: FrontSide,
    transparent: pass !== "opaque",
    colorWrite: pass !== "depth",
    depthWrite: pass !== "blend",
    depthFunc: LessEqualDepth,
  });
  if (kind === "voxels") voxelMaterials.push(material);
  return material;
}
