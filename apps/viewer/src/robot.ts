// The robot's bodies and their poses along a plan.

import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry, Group, Material, Matrix4,
         Mesh, MeshPhongMaterial, Quaternion, SphereGeometry, Vector3 } from "three";
import type { Arrays, Page, Shape } from "./data";
import { palette } from "./palette";

const kPose = 7;  // x y z qx qy qz qw

/// Capsules and cylinders of three.js lie along y, ours along z.
function geometryOf(shape: Shape, arrays: Arrays): BufferGeometry {
  const [a, b, c] = shape.size;
  switch (shape.kind) {
    case "sphere": return new SphereGeometry(a, 32, 20);
    case "capsule": return new CapsuleGeometry(a, b, 10, 28).rotateX(Math.PI / 2);
    case "cylinder": return new CylinderGeometry(a, a, b, 36).rotateX(Math.PI / 2);
    case "box": return new BoxGeometry(a, b, c);
    case "mesh": {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new BufferAttribute(arrays.f32(shape.vertices!), 3));
      geometry.setIndex(new BufferAttribute(arrays.u32(shape.triangles!), 1));
      const flat = geometry.toNonIndexed();
      flat.computeVertexNormals();
      return flat;
    }
  }
}

function matrixOf(pose: Float32Array, at: number, out: Matrix4): Matrix4 {
  return out.compose(new Vector3(pose[at], pose[at + 1], pose[at + 2]),
                     new Quaternion(pose[at + 3], pose[at + 4], pose[at + 5], pose[at + 6]), new Vector3(1, 1, 1));
}

/// One drawing of the robot: solid, or a ghost in one colour.
class Body {
  readonly group = new Group();
  private readonly links: Group[] = [];

  constructor(shapes: Shape[], geometries: BufferGeometry[], arrays: Arrays,
              passes: { material: (shape: Shape) => Material; order: number }[]) {
    this.group.visible = false;
    shapes.forEach((shape, i) => {
      while (this.links.length <= shape.link) {
        const link = new Group();
        link.matrixAutoUpdate = false;
        this.links.push(link);
        this.group.add(link);
      }
      for (const { material, order } of passes) {
        const mesh = new Mesh(geometries[i], material(shape));
        mesh.matrixAutoUpdate = false;
        matrixOf(arrays.f32(shape.pose), 0, mesh.matrix);
        mesh.renderOrder = order;
        this.links[shape.link].add(mesh);
      }
    });
  }

  pose(poses: Float32Array | null): void {
    this.group.visible = poses !== null && poses.length > 0;
    if (poses === null) return;
    this.links.forEach((link, i) => {
      if ((i + 1) * kPose > poses.length) return;
      matrixOf(poses, i * kPose, link.matrix);
      link.matrixWorldNeedsUpdate = true;
    });
  }
}

export class RobotView {
  readonly robot = new Group();
  readonly ghosts = new Group();
  private readonly solid: Body;
  private readonly start: Body;
  private readonly goal: Body;
  private readonly plain = new MeshPhongMaterial({ shininess: 40, specular: 0x222222 });
  private readonly critical = new MeshPhongMaterial({ shininess: 40, specular: 0x222222 });
  private readonly obstacle = new MeshPhongMaterial({ shininess: 40, specular: 0x222222 });
  private readonly unknown = new MeshPhongMaterial({ transparent: true, opacity: 0.45, depthWrite: false });  // but for the map
  private readonly others: MeshPhongMaterial[] = [];  // robots after the first, in a colour each
  private readonly ghostColors: MeshPhongMaterial[] = [];

  constructor(page: Page, arrays: Arrays) {
    const geometries = page.robot.map((shape) => geometryOf(shape, arrays));
    const last = Math.max(0, ...page.robot.map((shape) => shape.group));
    while (this.others.length < last) this.others.push(new MeshPhongMaterial({ shininess: 40, specular: 0x222222 }));
    const material = (shape: Shape) => shape.group < -1 ? this.unknown : shape.group < 0 ? this.obstacle : shape.critical ? this.critical
      : shape.group > 0 ? this.others[shape.group - 1] : this.plain;
    this.solid = new Body(page.robot, geometries, arrays, [{ material, order: 0 }]);
    this.start = this.ghost(page, geometries, arrays, 20);
    this.goal = this.ghost(page, geometries, arrays, 22);
    this.robot.add(this.solid.group);
    this.ghosts.add(this.start.group, this.goal.group);
    this.recolor();
  }

  /// Depth first and blended second, as the map's translucent layers; a little behind the solid robot.
  private ghost(page: Page, geometries: BufferGeometry[], arrays: Arrays, order: number): Body {
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2, transparent: true };
    const depth = new MeshPhongMaterial({ ...behind, colorWrite: false });
    const color = new MeshPhongMaterial({ ...behind, opacity: 0.36, depthWrite: false });
    this.ghostColors.push(color);
    const robots = page.robot.filter((shape) => shape.group >= 0);
    return new Body(robots, geometries.filter((_, i) => page.robot[i].group >= 0), arrays,
                    [{ material: () => depth, order }, { material: () => color, order: order + 1 }]);
  }

  recolor(): void {
    this.plain.color.set(palette().robot);
    this.critical.color.set(palette().critical);
    this.obstacle.color.set(palette().conflict);
    this.unknown.color.set(palette().conflict);
    this.others.forEach((other, i) => other.color.set(palette().robots[i % palette().robots.length]));
    this.ghostColors[0].color.set(palette().start);
    this.ghostColors[1].color.set(palette().goal);
  }

  showAt(poses: Float32Array | null): void { this.solid.pose(poses); }

  showEnds(start: Float32Array | null, goal: Float32Array | null): void {
    this.start.pose(start);
    this.goal.pose(goal);
  }
}

/// The poses of all links at `time` (waypoints, fractional): positions linearly, rotations by slerp.
export function posesAt(poses: Float32Array, links: number, waypoints: number, time: number): Float32Array {
  const size = links * kPose;
  const first = Math.min(Math.max(Math.floor(time), 0), waypoints - 1);
  const second = Math.min(first + 1, waypoints - 1), share = time - first;
  const out = new Float32Array(size);
  for (let at = 0; at < size; at += kPose) {
    const a = first * size + at, b = second * size + at;
    for (let k = 0; k < 3; ++k) out[at + k] = poses[a + k] + share * (poses[b + k] - poses[a + k]);
    Quaternion.slerpFlat(out as unknown as number[], at + 3, poses as unknown as number[], a + 3,
                         poses as unknown as number[], b + 3, share);
  }
  return out;
}
