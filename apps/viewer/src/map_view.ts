// The 3D view with its controls: layers, cut plane, views. It shows the robot as the page sets it.

import { Box3, CatmullRomCurve3, Group, LineCurve3, Mesh, MeshBasicMaterial, TubeGeometry, Vector3 } from "three";
import { cutControls } from "./cut_controls";
import type { Arrays, Page, Place, Plan } from "./data";
import { byId, el, grouped, millimetres } from "./dom";
import { EvidenceGrid } from "./evidence";
import { unpackFaces, type Faces } from "./faces";
import { ballLayer, facesBounds, labelOf, Slice, unpackAll, voxelLayer, type Layer } from "./map_layers";
import { openingCuts } from "./opening_cuts";
import type { Options } from "./options";
import { palette } from "./palette";
import { PathValues, type PathMode } from "./path_colors";
import { pick } from "./pick";
import { RecordedPaint } from "./recorded_paint";
import { posesAt, RobotView } from "./robot";
import { SeenVoxels } from "./seen_voxels";
import { Stage, viewNames } from "./stage";
import { cutUniform } from "./surface_material";
import { VoxelAnswer } from "./voxel_answer";
import { VoxelColors } from "./voxel_colors";

interface LayerRow { name: string; label: string; count: string; swatches: string[]; shown: boolean; layer?: Layer; group: Group; counter?: HTMLElement }

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
  private readonly grid: EvidenceGrid;
  private readonly colors: VoxelColors | null;
  private readonly answer: VoxelAnswer;
  private readonly recorded: RecordedPaint | null;
  private readonly pathMenu = el("select", { id: "path-color", "aria-label": "Colour the tip's path by" });
  private readonly pathLegend = el("div", { class: "legend" });
  private path: PathValues | null = null;
  private pathMode: PathMode;
  onPathMode: (mode: PathMode) => void = () => {};
  private readonly workBox = new Box3();   // what the report is about: painted space, robot, path
  private readonly wholeBox = new Box3();  // the whole map
  private plan: Plan | null = null;
  private poses: Float32Array = new Float32Array();

  /// Throws when the browser offers no WebGL 2.
  constructor(private readonly page: Page, private readonly arrays: Arrays, options: Options, onLost: () => void) {
    this.stage = new Stage(byId("canvas-box"), options.picture, onLost);
    this.stage.isoAzimuth = page.isoAzimuth;
    const faces = unpackAll(page, arrays);
    this.grid = new EvidenceGrid(page, arrays);
    this.answer = new VoxelAnswer(page, arrays, this.grid, (state) => labelOf(page, state));
    this.recorded = page.timeline ? new RecordedPaint(page, arrays, page.timeline) : null;
    if (this.recorded) this.stage.scene.add(this.recorded.group);
    this.pathMode = options.path as PathMode;
    this.robot = new RobotView(page, arrays);
    this.seen = new SeenVoxels(page, arrays);
    this.addMap(faces);
    this.addRobot();
    this.measure();
    const slices = [0, 1, 2].map(() => new Slice(faces, page));
    this.stage.scene.add(...slices.map((slice) => slice.mesh));
    if (options.layers) for (const row of this.rows) row.shown = options.layers.has(row.name);
    this.stage.look(options.view, options.fit === "all" ? this.wholeBox : this.workBox);
    const cuts = options.saysCuts || options.picture || options.fit === "all" ? options.cuts
      : openingCuts(this.subject(faces), this.stage.eye(), faces.filter((f) => f.state !== "painted" && this.row(f.state)?.shown),
                    this.wholeBox, page.resolution, page.origin);
    const cut = faces.length === 0 ? null : cutControls(this.wholeBox, page.resolution, slices, cuts,
      (state) => this.row(state)?.shown ?? false, () => this.stage.invalidate());
    this.colors = faces.length === 0 ? null : new VoxelColors(page, this.grid, this.heights(), options.color, () => { cut?.refresh(); this.stage.invalidate(); });
    for (const slice of slices) slice.colorOf = (state, voxel) => this.colors?.of(state, voxel) ?? null;
    this.addRows(options.opacity, () => cut?.refresh());
    this.addColors();
    cut?.refresh();
    this.addViews();
    this.stage.onClick((from, direction) => this.answer.show(pick(faces.filter((f) => this.row(f.state)?.shown), from, direction,
      cutUniform.value, page.resolution, page.origin)));
    this.stage.onView = () => this.drawTriad();
    this.stage.onCoarse = (coarse) => this.reportGrid(coarse);
    this.stage.onMoving = (moving) => { for (const row of this.rows) row.layer?.setMoving?.(moving); };
    this.recolor();
    this.stage.drawGrid(this.workBox);
    this.reportGrid();
    document.body.dataset.quads = String(faces.reduce((sum, f) => sum + f.quadCount, 0));
    document.body.dataset.faces = String(faces.reduce((sum, f) => sum + f.faceCount, 0));
  }

  /// What the page is about: the tip's paths and the robot, or, of two maps, the voxels that differ.
  private subject(faces: Faces[]): Vector3[] {
    const points: Vector3[] = [];
    const add = (place: Place, stride: number) => {
      const values = this.arrays.f32(place);
      for (let i = 0; i + 2 < values.length; i += stride) points.push(new Vector3(values[i], values[i + 1], values[i + 2]));
    };
    for (const plan of this.page.plans) for (const [place, stride] of [[plan.tip, 3], [plan.start, 7], [plan.goal, 7]] as const) add(place, stride);
    if (this.page.stateLabels.length > 0) for (const set of faces.filter((f) => f.state === "conflict" || f.state === "painted"))
      for (let side = 0; side < 6; ++side) for (let i = set.start[side]; i < set.start[side + 1]; ++i) {
        const a = side >> 1, at = [0, 0, 0];
        at[a] = set.layer[i] + (side & 1);
        at[(a + 1) % 3] = set.u[i] + 0.5 * set.width[i];
        at[(a + 2) % 3] = set.v[i] + 0.5 * set.height[i];
        points.push(new Vector3(...at).subScalar(this.page.origin).multiplyScalar(this.page.resolution));
      }
    return points;
  }

  private row(name: string): LayerRow | undefined { return this.rows.find((row) => row.name === name); }

  private addMap(faces: ReturnType<typeof unpackAll>): void {
    const occupied = faces.find((f) => f.state === "occupied");
    const box = occupied ? this.nearBy(facesBounds(occupied, this.page)) : null;
    const heights: [number, number] = box ? [box.min.z, box.max.z] : [0, 1];
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
      if (this.page.plans.length > 0) this.addRow("ghosts", "start, goal", "", ["start", "goal"], this.robot.ghosts);
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
    if (this.page.plans.length === 0) this.workBox.union(new Box3().setFromObject(this.robot.robot));
    if (this.workBox.isEmpty()) this.workBox.copy(this.nearBy(this.row("occupied")?.layer?.bounds ?? this.wholeBox));
    else {
      const ground = this.workBox.min.z;
      this.workBox.expandByScalar(0.06 * this.workBox.getSize(new Vector3()).length());
      const around = this.workBox.clone().expandByScalar(0.5 * this.workBox.getSize(new Vector3()).length());
      if (!shown.isEmpty()) this.workBox.union(shown.intersect(around));
      else if (this.page.plans.length === 0) this.workBox.min.z = ground;  // a robot alone stands on the grid
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
        row.shown = box.checked;
        row.group.visible = this.isVisible(row);
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

  /// Beside the view; with a way out where less is drawn.
  private reportGrid(coarse = false): void {
    const grid = this.stage.gridStep > 0 ? `grid ${Number(this.stage.gridStep.toPrecision(2))} m` : "";
    const all = el("button", { type: "button", class: "small", title: "This browser draws slowly: larger cubes are shown" }, "draw all");
    all.addEventListener("click", () => this.stage.drawAll());
    const far = this.page.occupiedBeyond;
    const beyond = far > 0 ? [`${grouped(far)} occupied ${far === 1 ? "voxel" : "voxels"} far outside · `] : [];
    byId("scale").replaceChildren(...(coarse ? ["drawn coarser ", all, " · "] : []), ...beyond, grid);
  }

  /// Of the voxels in the map's main part, m.
  private heights(): [number, number] {
    const box = this.nearBy(this.rows.reduce((sum, row) => row.layer && row.name !== "balls" ? sum.union(row.layer.bounds) : sum, new Box3()));
    return [box.min.z, box.max.z];
  }

  /// What of a box is not far outside of the map's main part.
  private nearBy(box: Box3): Box3 {
    if (!this.page.firstLook) return box;
    const [low, high] = this.page.firstLook.map((corner) => new Vector3(...(corner as [number, number, number])));
    const near = box.clone().intersect(new Box3(low, high));
    return near.isEmpty() ? box : near;
  }

  /// The menus of colours, under the layers.
  private addColors(): void {
    if (this.colors) byId("layer-rows").append(...this.colors.elements());
    if (!this.row("tip")) return;
    this.pathMenu.addEventListener("change", () => { this.pathMode = this.pathMenu.value as PathMode; this.colorTip(); });
    byId("layer-rows").append(el("label", { class: "layer-slider" }, el("span", {}, "path by"), this.pathMenu), this.pathLegend);
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
    this.path = new PathValues(plan, this.arrays);
    this.offerPathModes();
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

  private offerPathModes(): void {
    const names: Record<PathMode, string> = { plain: "one colour", clearance: "separation", phase: "phase", step: "search step" };
    const modes = this.path!.modes();
    this.pathMenu.replaceChildren(...modes.map((mode) => el("option", { value: mode }, names[mode])));
    this.pathMenu.value = modes.includes(this.pathMode) ? this.pathMode : "plain";
  }

  private drawTip(values: Float32Array): void {
    for (const mesh of this.tips.children as Mesh[]) mesh.geometry.dispose();
    this.tips.clear();
    const tube = this.tube(values, 1);
    if (tube) this.tips.add(new Mesh(tube.geometry, this.tipMaterial));
    if (tube) tube.geometry.userData = tube;
    this.colorTip();
  }

  /// As the menu says; the plots' strip, too.
  private colorTip(): void {
    const mode = this.pathMenu.value as PathMode, [mesh] = this.tips.children as Mesh<TubeGeometry>[];
    if (mesh && this.path) {
      const { curve, waypoints } = mesh.geometry.userData;
      if (mode === "plain") mesh.geometry.deleteAttribute("color"); else this.path.paint(mesh.geometry, curve, waypoints, mode);
    }
    this.tipMaterial.vertexColors = mode !== "plain";
    this.tipMaterial.color.set(mode === "plain" ? palette().tip : "#ffffff");
    this.tipMaterial.needsUpdate = true;
    this.pathLegend.replaceChildren(...this.path?.legend(mode) ?? []);
    document.body.dataset.path = mode;
    this.onPathMode(mode);
    this.stage.invalidate();
  }

  /// Of all plans but the one that is shown, in the colours of series.
  private drawOtherTips(): void {
    if (this.otherTips.children.length === 0)
      for (const plan of this.page.plans)
        this.otherTips.add(new Mesh(this.tube(this.arrays.f32(plan.tip), 0.6)?.geometry, new MeshBasicMaterial({ toneMapped: false })));
    this.otherTips.children.forEach((mesh, i) => { mesh.visible = this.page.plans[i] !== this.plan && this.page.plans[i].tip.count > 3; });
    this.recolorOtherTips();
  }

  private recolorOtherTips(): void {
    const colors = palette().series;
    (this.otherTips.children as Mesh<TubeGeometry, MeshBasicMaterial>[]).forEach((mesh, i) => mesh.material.color.set(colors[i % colors.length]));
  }

  /// Null for fewer than two points. `waypoints`: those that the curve passes.
  private tube(values: Float32Array, thickness: number): { geometry: TubeGeometry; curve: CatmullRomCurve3 | null; waypoints: number[] } | null {
    const radius = thickness * 0.0022 * this.workBox.getSize(new Vector3()).length();
    const points: Vector3[] = [], waypoints: number[] = [];  // far enough apart that the curve through them does not overshoot
    for (let i = 0; i < values.length; i += 3) {
      const point = new Vector3(values[i], values[i + 1], values[i + 2]);
      if (points.length > 0 && points[points.length - 1].distanceTo(point) <= 0.5 * radius) continue;
      points.push(point);
      waypoints.push(i / 3);
    }
    if (points.length < 2) return null;
    const curve = points.length > 2 ? new CatmullRomCurve3(points, false, "centripetal") : null;
    const geometry = new TubeGeometry(curve ?? new LineCurve3(points[0], points[1]), Math.min(2000, points.length * 4), radius, 8);
    return { geometry, curve, waypoints };
  }

  /// What had been painted at `time` of the recording, s, in the place of all that is painted; null: all of it.
  showRecording(time: number | null): void {
    this.recorded?.showTime(time);
    for (const row of this.rows) row.group.visible = this.isVisible(row);
    this.stage.invalidate();
  }

  /// What is painted at last is not shown while the recording shows what had been painted by then.
  private isVisible(row: LayerRow): boolean {
    return row.shown && !(this.recorded?.group.visible && ["painted", "balls", "conflict"].includes(row.name));
  }

  recolor(): void {
    for (const row of this.rows) row.layer?.recolor();
    for (const layer of this.adviceLayers) layer?.recolor();
    this.robot.recolor();
    this.seen.recolor();
    this.colorTip();
    this.colors?.recolor();
    this.recorded?.recolor();
    this.recolorOtherTips();
    this.stage.recolor();
  }

  render(): void { this.stage.render(); }
}
