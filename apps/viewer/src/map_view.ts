// The 3D view with its controls: layers, cut plane, views. It shows what it is told of the robot.

import { Box3, CatmullRomCurve3, CurvePath, Group, LineCurve3, Mesh, MeshBasicMaterial, TubeGeometry, Vector3 } from "three";
import { cutControls } from "./cut_controls";
import type { Arrays, Page, Place, Plan } from "./data";
import { byId, el, grouped, millimetres } from "./dom";
import { unpackFaces } from "./faces";
import { ballLayer, Slice, unpackAll, voxelLayer, type Layer } from "./map_layers";
import type { Options } from "./options";
import { palette } from "./palette";
import { pick, type Hit } from "./pick";
import { posesAt, RobotView } from "./robot";
import { SeenVoxels } from "./seen_voxels";
import { Stage, viewNames } from "./stage";
import { cutUniform } from "./surface_material";

interface LayerRow { name: string; label: string; count: string; swatches: string[]; shown: boolean; layer?: Layer; group: Group; counter?: HTMLElement }

const stateLabels: Record<string, string> = { painted: "painted", occupied: "occupied", conflict: "conflict", seen_free: "seen free" };
const labelOf = (page: Page, state: string) => page.stateLabels.find(([name]) => name === state)?.[1] ?? stateLabels[state];
const shownFirst = new Set(["painted", "occupied", "conflict", "robot", "tip", "ghosts", "advice", "seen"]);

export class MapView {
  private readonly stage: Stage;
  private readonly rows: LayerRow[] = [];
  private readonly robot: RobotView;
  private readonly seen: SeenVoxels;
  private readonly tips = new Group();
  private readonly otherTips = new Group();  // a mesh a plan
  private readonly advice = new Group();  // balls to paint, a layer a plan
  private readonly adviceLayers: (Layer | null)[] = [];
  private readonly tipMaterial = new MeshBasicMaterial({ toneMapped: false });
  private readonly workBox = new Box3();   // what the report is about: painted space, robot, path
  private readonly wholeBox = new Box3();  // the whole map
  private plan: Plan | null = null;
  private poses: Float32Array = new Float32Array();

  /// Throws when the browser offers no WebGL 2.
  constructor(private readonly page: Page, private readonly arrays: Arrays, options: Options, onLost: () => void) {
    this.stage = new Stage(byId("canvas-box"), onLost);
    this.stage.isoAzimuth = page.isoAzimuth;
    const faces = unpackAll(page, arrays);
    this.robot = new RobotView(page, arrays);
    this.seen = new SeenVoxels(page, arrays);
    this.addMap(faces);
    this.addRobot();
    this.measure();
    const slices = [0, 1, 2].map(() => new Slice(faces, page));
    this.stage.scene.add(...slices.map((slice) => slice.mesh));
    if (options.layers) for (const row of this.rows) row.shown = options.layers.has(row.name);
    const cut = faces.length === 0 ? null : cutControls(this.wholeBox, page.resolution, slices, options.cuts,
      (state) => this.row(state)?.shown ?? false, () => this.stage.invalidate());
    this.addRows(options.opacity, () => cut?.refresh());
    cut?.refresh();
    this.addViews();
    this.stage.onClick((from, direction) => this.tellVoxel(pick(faces.filter((f) => this.row(f.state)?.shown), from, direction,
      cutUniform.value, page.resolution, page.origin)));
    this.stage.onView = () => this.drawTriad();
    this.stage.onMoving = (moving) => { for (const row of this.rows) row.layer?.setMoving?.(moving); };
    this.recolor();
    this.stage.drawGrid(this.workBox);
    this.tellVoxel(null);
    this.stage.look(options.view, options.fit === "all" ? this.wholeBox : this.workBox);
    document.body.dataset.quads = String(faces.reduce((sum, f) => sum + f.quadCount, 0));
    document.body.dataset.faces = String(faces.reduce((sum, f) => sum + f.faceCount, 0));
  }

  private row(name: string): LayerRow | undefined { return this.rows.find((row) => row.name === name); }

  private addMap(faces: ReturnType<typeof unpackAll>): void {
    const occupied = faces.find((f) => f.state === "occupied");
    const z = (cell: number) => (cell - this.page.origin) * this.page.resolution;
    const heights: [number, number] = occupied ? [z(occupied.low[2]), z(occupied.high[2])] : [0, 1];
    for (const state of ["painted", "occupied", "conflict", "seen_free"]) {
      const set = faces.find((f) => f.state === state);
      if (!set) continue;
      const turned = this.page.voxels.find((v) => v.state === state)?.turned;
      const layer = voxelLayer(set, turned ? unpackFaces(turned, this.arrays) : null, this.page, heights);
      layer.setOpacity?.(state === "painted" ? 0.42 : 0.14);
      const drawn = set.cell > 1 ? `, ${millimetres(set.cell * this.page.resolution)} cubes` : "";
      this.addRow(state, labelOf(this.page, state) + drawn, grouped(set.voxelCount), [state], layer.group, layer);
    }
    if (this.page.balls.count > 0) {
      const layer = ballLayer(this.arrays.f32(this.page.balls));
      this.addRow("balls", "exact balls", grouped(this.page.balls.count / 5), ["balls"], layer.group, layer);
    }
  }

  private addRobot(): void {
    const critical = [...new Set(this.page.robot.filter((s) => s.critical).map((s) => s.part))];
    if (this.page.robot.length > 0) {
      const label = critical.length > 0 ? `robot, critical: ${critical.join(", ")}` : "robot";
      this.addRow("robot", label, "", critical.length > 0 ? ["robot", "critical"] : ["robot"], this.robot.robot);
      this.addRow("ghosts", "start, goal", "", ["start", "goal"], this.robot.ghosts);
      this.robot.showAt(this.page.home.count > 0 ? this.arrays.f32(this.page.home) : null);
    }
    if (this.page.plans.some((plan) => plan.seen.times.count > 0)) this.addRow("seen", "seen anew", "0", ["sensed"], this.seen.group);
    for (const plan of this.page.plans) {
      const layer = plan.paint.count > 0 ? ballLayer(this.arrays.f32(plan.paint)) : null;
      this.adviceLayers.push(layer);
      if (layer) this.advice.add(layer.group);
    }
    if (this.advice.children.length > 0) this.addRow("advice", "where to paint more", "", ["advice"], this.advice);
    const paths = this.page.plans.filter((plan) => plan.tip.count > 3).length;
    if (paths > 0) this.addRow("tip", "tip path", "", ["tip"], this.tips);
    if (paths > 1) this.addRow("others", "tip paths of the other plans", "", ["others"], this.otherTips);
  }

  private addRow(name: string, label: string, count: string, swatches: string[], group: Group, layer?: Layer): void {
    this.stage.scene.add(group);
    this.rows.push({ name, label, count, swatches, shown: shownFirst.has(name), group, layer });
  }

  /// The work box holds the painted space, the paths of all links and of the tip; else the occupied voxels.
  private measure(): void {
    const shown = new Box3();
    for (const row of this.rows) {
      if (!row.layer) continue;
      this.wholeBox.union(row.layer.bounds);
      if (row.shown) shown.union(row.layer.bounds);
      if (row.name === "painted" || row.name === "balls") this.workBox.union(row.layer.bounds);
    }
    const addPoints = (place: Place, stride: number) => {
      const values = this.arrays.f32(place);
      for (let i = 0; i + 2 < values.length; i += stride) this.workBox.expandByPoint(new Vector3(values[i], values[i + 1], values[i + 2]));
    };
    for (const plan of this.page.plans) {
      addPoints(plan.tip, 3);
      if (this.page.robot.length > 0) for (const place of [plan.poses, plan.start, plan.goal]) addPoints(place, 7);
    }
    if (this.page.robot.length > 0) addPoints(this.page.home, 7);
    if (this.workBox.isEmpty()) this.workBox.copy(this.row("occupied")?.layer?.bounds ?? this.wholeBox);
    else {
      this.workBox.expandByScalar(0.06 * this.workBox.getSize(new Vector3()).length());
      const around = this.workBox.clone().expandByScalar(0.5 * this.workBox.getSize(new Vector3()).length());
      if (!shown.isEmpty()) this.workBox.union(shown.intersect(around));
    }
    if (this.workBox.isEmpty()) this.workBox.set(new Vector3(-1, -1, 0), new Vector3(1, 1, 1));
    this.wholeBox.union(this.workBox);
  }

  private addRows(opacity: number | null, onToggle: () => void): void {
    for (const row of this.rows) {
      const box = el("input", { type: "checkbox", "data-layer": row.name });
      box.checked = row.group.visible = row.shown;
      if (row.shown) row.layer?.build?.();
      box.addEventListener("change", () => {
        if (box.checked) row.layer?.build?.();
        row.group.visible = row.shown = box.checked;
        onToggle();
        this.stage.invalidate();
      });
      const swatches = row.swatches.map((name) => el("i", { class: `swatch swatch-${name}` }));
      row.counter = el("span", { class: "count" }, row.count);
      byId("layer-rows").append(el("label", { class: "layer" }, box, ...swatches, el("span", { class: "layer-name" }, row.label), row.counter));
      if (row.name === "painted") this.addOpacity(row.layer!, opacity ?? 0.42);
    }
  }

  private addOpacity(layer: Layer, value: number): void {
    const slider = el("input", { type: "range", min: "0.05", max: "1", step: "0.01", value: String(value), "aria-label": "Opacity of painted voxels" });
    const apply = () => { layer.setOpacity?.(Number(slider.value)); this.stage.invalidate(); };
    slider.addEventListener("input", apply);
    byId("layer-rows").append(el("label", { class: "layer-slider" }, el("span", {}, "opacity"), slider));
    apply();
  }

  private addViews(): void {
    const button = (label: string, title: string, action: () => void) => {
      const b = el("button", { type: "button", title }, label);
      b.addEventListener("click", action);
      byId("views").append(b);
    };
    let box = this.workBox, view = "iso";
    const look = () => this.stage.look(view, box);
    for (const name of viewNames) button(name, `Look from the ${name}`, () => { view = name; look(); });
    button("fit", "Fit the painted space, the robot and the path", () => { box = this.workBox; look(); });
    button("all", "Fit the whole map", () => { box = this.wholeBox; look(); });
  }

  /// What the pointer met, beside the grid's step.
  private tellVoxel(hit: Hit | null): void {
    const digits = this.page.resolution < 0.01 ? 4 : 3;
    const grid = this.stage.gridStep > 0 ? `grid ${Number(this.stage.gridStep.toPrecision(2))} m` : "";
    const center = hit?.voxel.map((c) => ((c + 0.5 - this.page.origin) * this.page.resolution).toFixed(digits));
    if (!hit || !center) { byId("scale").textContent = grid; return; }
    const cell = this.page.voxels.find((set) => set.state === hit.state)!.cell;
    const about = [`${labelOf(this.page, hit.state)} ${cell > 1 ? "cube" : "voxel"} at ${center.join(", ")} m`, ...this.ballsAround(hit), grid];
    const copy = el("button", { type: "button", class: "small", title: "Copy the flag that makes `clearway inspect` tell all of this place" }, "copy --at");
    copy.addEventListener("click", () => { void navigator.clipboard?.writeText(`--at=${center.join(",")}`).then(() => { copy.textContent = "copied"; }); });
    byId("scale").replaceChildren(about.filter((text) => text !== "").join(" · "), " ", copy);
  }

  /// Which volumes' exact balls hold the centre of a voxel.
  private ballsAround(hit: Hit): string[] {
    const center = hit.voxel.map((c) => (c + 0.5 - this.page.origin) * this.page.resolution);
    const balls = this.arrays.f32(this.page.balls), found = new Set<number>();
    for (let i = 0; i < balls.length; i += 5)
      if (Math.hypot(balls[i] - center[0], balls[i + 1] - center[1], balls[i + 2] - center[2]) <= balls[i + 3]) found.add(balls[i + 4]);
    return found.size > 0 ? [`in balls of ${[...found].map((volume) => this.page.volumes[volume]).join(", ")}`] : [];
  }

  private drawTriad(): void {
    const colors = ["#e03131", "#2f9e44", "#3b82f6"];
    const axes = this.stage.axes().map((axis, i) => ({ axis, i })).sort((a, b) => a.axis.z - b.axis.z);
    byId("triad").innerHTML = axes.map(({ axis, i }) => {
      const x = (22 * axis.x).toFixed(1), y = (-22 * axis.y).toFixed(1);
      return `<line x2="${x}" y2="${y}" stroke="${colors[i]}" stroke-width="2.6" stroke-linecap="round"/>`
        + `<text x="${(28 * axis.x).toFixed(1)}" y="${(-28 * axis.y).toFixed(1)}" fill="${colors[i]}">${"xyz"[i]}</text>`;
    }).join("");
  }

  showPlan(plan: Plan): void {
    this.plan = plan;
    this.poses = this.arrays.f32(plan.poses);
    const size = plan.links * 7;
    const end = (place: Place, from: number) => place.count > 0 ? this.arrays.f32(place)
      : size > 0 && plan.waypoints > 0 ? this.poses.subarray(from, from + size) : null;
    this.robot.showEnds(end(plan.start, 0), end(plan.goal, (plan.waypoints - 1) * size));
    this.seen.show(plan);
    this.drawTip(this.arrays.f32(plan.tip));
    if (this.row("others")) this.drawOtherTips();
    this.adviceLayers.forEach((layer, i) => { if (layer) layer.group.visible = this.page.plans[i] === plan; });
    if (this.poses.length === 0) {
      const home = this.arrays.f32(this.page.home);
      this.robot.showAt(plan.start.count > 0 ? null : home.length > 0 ? home : null);
    }
    this.showTime(0);
  }

  showTime(time: number): void {
    if (this.plan && this.poses.length > 0)
      this.robot.showAt(posesAt(this.poses, this.plan.links, this.plan.waypoints, time));
    const counter = this.row("seen")?.counter;
    if (counter) counter.textContent = grouped(this.seen.showTime(time));
    this.stage.invalidate();
  }

  private drawTip(values: Float32Array): void {
    for (const mesh of this.tips.children as Mesh[]) mesh.geometry.dispose();
    this.tips.clear();
    const tube = this.tube(values, 1);
    if (tube) this.tips.add(new Mesh(tube, this.tipMaterial));
  }

  /// Of all plans but the one that is shown, in the colours of series.
  private drawOtherTips(): void {
    if (this.otherTips.children.length === 0)
      for (const plan of this.page.plans)
        this.otherTips.add(new Mesh(this.tube(this.arrays.f32(plan.tip), 0.6) ?? undefined, new MeshBasicMaterial({ toneMapped: false })));
    this.otherTips.children.forEach((mesh, i) => { mesh.visible = this.page.plans[i] !== this.plan && this.page.plans[i].tip.count > 3; });
    this.recolorOtherTips();
  }

  private recolorOtherTips(): void {
    const colors = palette().series;
    (this.otherTips.children as Mesh<TubeGeometry, MeshBasicMaterial>[]).forEach((mesh, i) => mesh.material.color.set(colors[i % colors.length]));
  }

  /// Null for fewer than two points.
  private tube(values: Float32Array, thickness: number): TubeGeometry | null {
    const radius = thickness * 0.0022 * this.workBox.getSize(new Vector3()).length();
    const points: Vector3[] = [];  // far enough apart that the curve through them does not overshoot
    for (let i = 0; i < values.length; i += 3) {
      const point = new Vector3(values[i], values[i + 1], values[i + 2]);
      if (points.length === 0 || points[points.length - 1].distanceTo(point) > 0.5 * radius) points.push(point);
    }
    if (points.length < 2) return null;
    const path = new CurvePath<Vector3>();
    for (let i = 1; i < points.length; ++i) path.add(new LineCurve3(points[i - 1], points[i]));
    const curve = points.length > 2 ? new CatmullRomCurve3(points, false, "centripetal") : path;
    return new TubeGeometry(curve, Math.min(2000, points.length * 4), radius, 8);
  }

  recolor(): void {
    for (const row of this.rows) row.layer?.recolor();
    for (const layer of this.adviceLayers) layer?.recolor();
    this.robot.recolor();
    this.seen.recolor();
    this.tipMaterial.color.set(palette().tip);
    this.recolorOtherTips();
    this.stage.recolor();
  }

  render(): void { this.stage.render(); }
}
