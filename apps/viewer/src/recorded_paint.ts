// Balls and conflicts as they came in the recording, in the 3D view.

import { BoxGeometry, Group, InstancedMesh, Matrix4, MeshPhongMaterial, type InstancedBufferGeometry, type Mesh } from "three";
import type { Arrays, Page, Timeline } from "./data";
import { ballLayer, type Layer } from "./map_layers";
import { palette } from "./palette";

export class RecordedPaint {
  readonly group = new Group();
  private readonly layer: Layer | null;
  private readonly ballTimes: number[] = [];
  private readonly conflictTimes: number[] = [];
  private readonly conflicts: InstancedMesh | null;
  private readonly material = new MeshPhongMaterial({ shininess: 20, specular: 0x222222 });

  constructor(page: Page, arrays: Arrays, timeline: Timeline) {
    const events = arrays.f32(timeline.balls), painted: number[] = [];
    for (let i = 0; i < events.length; i += 6) {
      if (events[i + 4] < 0) continue;  // an eraser
      painted.push(...events.subarray(i, i + 5));
      this.ballTimes.push(events[i + 5]);
    }
    this.layer = painted.length > 0 ? ballLayer(new Float32Array(painted)) : null;
    if (this.layer) this.group.add(this.layer.group);
    this.conflicts = this.makeConflicts(page, arrays, timeline);
    this.group.visible = false;
    this.recolor();
  }

  private makeConflicts(page: Page, arrays: Arrays, { conflicts }: Timeline): InstancedMesh | null {
    const times = arrays.f32(conflicts.times), cells = arrays.u16(conflicts.cells);
    if (times.length === 0 || page.resolution <= 0) return null;
    const order = Array.from(times.keys()).sort((a, b) => times[a] - times[b]), size = page.resolution;
    const mesh = new InstancedMesh(new BoxGeometry(size, size, size), this.material, times.length), matrix = new Matrix4();
    order.forEach((k, i) => {
      const [x, y, z] = [0, 1, 2].map((a) => (cells[3 * k + a] - page.origin + 0.5) * size);
      mesh.setMatrixAt(i, matrix.makeTranslation(x, y, z));
      this.conflictTimes.push(times[k]);
    });
    mesh.frustumCulled = false;
    this.group.add(mesh);
    return mesh;
  }

  /// Shows what there was at `time`, s; null: nothing.
  showTime(time: number | null): void {
    this.group.visible = time !== null;
    if (time === null) return;
    const until = (times: number[]) => times.filter((t) => t <= time + 1e-3).length;
    const count = until(this.ballTimes);
    for (const mesh of (this.layer?.group.children ?? []) as Mesh<InstancedBufferGeometry>[]) mesh.geometry.instanceCount = count;
    if (this.conflicts) this.conflicts.count = until(this.conflictTimes);
  }

  recolor(): void {
    this.layer?.recolor();
    this.material.color.set(palette().conflict);
  }
}
