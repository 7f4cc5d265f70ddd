// What sensors saw anew while a plan was carried out: the voxels that robots had at each time.

import { BoxGeometry, Group, InstancedMesh, Matrix4, MeshPhongMaterial } from "three";
import type { Arrays, Page, Plan } from "./data";
import { palette } from "./palette";
import { TimeScale } from "./time_plot";

const kGap = 0.94;  // of a voxel's edge is drawn, so that voxels can be distinguished

export class SeenVoxels {
  readonly group = new Group();
  private readonly material = new MeshPhongMaterial({ shininess: 20, specular: 0x222222 });
  private mesh: InstancedMesh | null = null;
  private plan: Plan | null = null;
  private scale = new TimeScale(0, 0, 0);
  private times: Float32Array = new Float32Array();
  private counts: Uint32Array = new Uint32Array();
  private starts: number[] = [];
  private cells: Uint16Array = new Uint16Array();
  private shown = -1;

  constructor(private readonly page: Page, private readonly arrays: Arrays) { this.recolor(); }

  recolor(): void { this.material.color.set(palette().sensed); }

  show(plan: Plan): void {
    this.plan = plan;
    this.scale = TimeScale.of(plan);
    this.times = this.arrays.f32(plan.seen.times);
    this.counts = this.arrays.u32(plan.seen.counts);
    this.cells = this.arrays.u16(plan.seen.cells);
    this.starts = [];
    this.counts.reduce((start, count) => { this.starts.push(start); return start + 3 * count; }, 0);
    this.mesh?.dispose();
    this.mesh?.geometry.dispose();
    this.group.clear();
    this.mesh = null;
    this.shown = -1;
    const most = Math.max(0, ...this.counts);
    if (most === 0) return;
    const edge = kGap * plan.seen.voxel;
    this.mesh = new InstancedMesh(new BoxGeometry(edge, edge, edge), this.material, most);
    this.mesh.frustumCulled = false;
    this.group.add(this.mesh);
  }

  /// The voxels that robots had at `time`, in waypoints. Returns how many.
  showTime(time: number): number {
    if (!this.plan || !this.mesh) return 0;
    const seconds = this.scale.x(time) + 1e-6;
    let last = -1;
    while (last + 1 < this.times.length && this.times[last + 1] <= seconds) ++last;
    const count = last < 0 ? 0 : this.counts[last];
    if (last === this.shown) return count;
    this.shown = last;
    this.mesh.count = count;
    const matrix = new Matrix4(), edge = this.plan.seen.voxel, start = this.starts[last];
    const middle = (axis: number, i: number) => (this.cells[start + axis * count + i] - this.page.origin + 0.5) * edge;
    for (let i = 0; i < count; ++i) this.mesh.setMatrixAt(i, matrix.makeTranslation(middle(0, i), middle(1, i), middle(2, i)));
    this.mesh.instanceMatrix.needsUpdate = true;
    return count;
  }
}
