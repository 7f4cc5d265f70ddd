// The 3D view itself: renderer, camera, lights, floor grid, axes; drawn only when something changed.

import { AmbientLight, Box3, BufferAttribute, BufferGeometry, Color, DirectionalLight, HemisphereLight, LineBasicMaterial,
         LineSegments, PerspectiveCamera, Scene, Vector2, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { palette } from "./palette";

const kSmooth = 60;         // ms a frame may take while the view moves
const kStill = 300;         // ms without a change after which all is drawn
const kMovingPixels = [0.4, 0.25];  // of the usual pixels, along an edge, where drawing is slow; in software
const kTooSlow = 1000;      // ms that all of it may take where the view is still, twice in a row

/// Azimuth and elevation of the eye, degrees; azimuth 0 looks along +y, from the front.
const namedViews: Record<string, [number, number]> = {
  iso: [35, 28], front: [0, 0], side: [90, 0], top: [0, 89.9],
};
export const viewNames = Object.keys(namedViews);

/// 1, 2 or 5 times a power of ten, at least `length`.
function roundUp(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * ([1, 2, 5].find((factor) => factor * power >= length * 0.999) ?? 10);
}

/// Whether the browser draws without a graphics card; false where it does not say. Throws when it offers no WebGL 2.
function drawsInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) throw new Error("no WebGL 2 context");
  const about = gl.getExtension("WEBGL_debug_renderer_info");
  const name = about ? String(gl.getParameter(about.UNMASKED_RENDERER_WEBGL)) : "";
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class Stage {
  readonly scene = new Scene();
  onView: () => void = () => {};
  onMoving: (moving: boolean) => void = () => {};  // draw less, because the view moves and drawing all is slow
  onCoarse: (coarse: boolean) => void = () => {};  // whether less is drawn even when the view is still
  gridStep = 0;
  isoAzimuth = namedViews.iso[0];  // degrees; the report knows from which side the sensors looked
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(38, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private grid: LineSegments | null = null;
  private gridBox = new Box3();
  private pending = false;
  private drawn = false;
  private slow = false;    // drawing all takes longer than a frame of a smooth view
  private moving = false;
  private held = false;    // the pointer turns or shifts the view
  private settling = false;
  private tooSlow = 0;     // draws of all in a row that took too long
  private drawsAll: boolean;  // however long that takes
  private readonly movingPixels: number;
  private stillAt = 0;     // when the view counts as still, by the clock, ms
  private readonly box: HTMLElement;
  private framed: (() => void) | null = null;  // the view asked for, until the user moves the camera

  /// Throws when the browser offers no WebGL 2. @param exact all is drawn with smooth edges, however slow that is
  constructor(box: HTMLElement, exact: boolean, onLost: () => void) {
    this.box = box;
    const software = drawsInSoftware();
    this.drawsAll = exact;
    this.movingPixels = kMovingPixels[software ? 1 : 0];
    this.renderer = new WebGLRenderer({ antialias: exact || !software });
    this.renderer.localClippingEnabled = true;
    const canvas = this.renderer.domElement;
    canvas.setAttribute("aria-label", "The map in 3D");
    box.prepend(canvas);
    canvas.addEventListener("webglcontextlost", onLost);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.18;
    this.controls.zoomToCursor = true;
    this.controls.addEventListener("change", () => this.invalidate());
    this.controls.addEventListener("start", () => { this.framed = null; this.held = true; });
    this.controls.addEventListener("end", () => { this.held = false; });
    const sun = new DirectionalLight(0xffffff, 1.5);
    sun.position.set(0.5, -0.8, 1.2);
    this.scene.add(new HemisphereLight(0xffffff, 0x8a8f98, 1.7), new AmbientLight(0xffffff, 0.35), sun);
    new ResizeObserver(() => this.resize()).observe(box);
    this.resize();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.box;
    const size = this.renderer.getSize(new Vector2());
    if (width === 0 || height === 0 || (size.x === width && size.y === height)) return;
    this.renderer.setPixelRatio((this.moving ? this.movingPixels : 1) * Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.framed?.();
    if (this.drawn) this.render();
  }

  /// The picture is out of date. Where drawing is slow less is drawn until nothing changes any more.
  invalidate(): void {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      if (!this.pending) return;
      if (this.slow) this.setMoving(true);
      this.render();
      this.stillAt = performance.now() + kStill;
      if (this.moving && !this.settling) this.settle();
    });
  }

  private settle(): void {
    this.settling = true;
    setTimeout(() => {
      if (this.held || this.pending || performance.now() < this.stillAt) return this.settle();
      this.settling = false;
      this.setMoving(false);
      this.render();
    }, kStill / 2);
  }

  private setMoving(moving: boolean): void {
    if (moving === this.moving) return;
    this.moving = moving;
    this.onMoving(moving || this.isCoarse());
    const ratio = Math.min(devicePixelRatio, 2);
    this.renderer.setPixelRatio(moving ? this.movingPixels * ratio : ratio);
  }

  render(): void {
    this.pending = false;
    this.drawn = true;
    this.controls.update();
    const start = performance.now();
    this.renderer.render(this.scene, this.camera);
    if (!this.moving) this.judgeWhenDrawn(start);
    document.body.dataset.frames = String(this.renderer.info.render.frame);
    this.onView();
  }

  private isCoarse(): boolean { return !this.drawsAll && this.tooSlow >= 2; }

  /// What follows from a draw of all, or of the coarse, that took so long, ms.
  private judge(took: number): void {
    if (this.isCoarse()) return;
    this.slow = took > kSmooth;
    this.tooSlow = took > kTooSlow ? this.tooSlow + 1 : 0;
    if (!this.isCoarse()) return;
    this.onMoving(true);
    this.onCoarse(true);
    this.invalidate();
  }

  /// From now on all is drawn when the view is still, however long that takes.
  drawAll(): void {
    this.drawsAll = true;
    this.onCoarse(false);
    this.onMoving(false);
    this.invalidate();
  }

  /// Once all is drawn: nobody waits for it, so that the page answers all the while.
  private judgeWhenDrawn(start: number): void {
    const gl = this.renderer.getContext() as WebGL2RenderingContext, sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!sync) return;
    gl.flush();
    const look = () => {
      if (gl.isContextLost()) return;
      if (gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) { setTimeout(look, 5); return; }
      gl.deleteSync(sync);
      if (!this.moving) this.judge(performance.now() - start);
    };
    setTimeout(look, 0);
  }

  recolor(): void {
    this.scene.background = new Color(palette().background);
    this.drawGrid(this.gridBox);
    this.invalidate();
  }

  /// `name`: a named view, or "azimuth,elevation[,zoom]". The whole box is seen at zoom 1.
  look(name: string, box: Box3): void {
    const numbers = name.split(",").map(Number);
    const given = numbers.length >= 2 && numbers.every(Number.isFinite);
    const [azimuth, elevation] = (given ? numbers : this.named(name)).slice(0, 2)
      .map((degrees) => degrees * Math.PI / 180);
    const zoom = given && numbers[2] > 0 ? numbers[2] : 1;
    const direction = new Vector3(Math.sin(azimuth) * Math.cos(elevation), -Math.cos(azimuth) * Math.cos(elevation), Math.sin(elevation));
    this.framed = () => this.frame(box, direction, zoom);
    this.framed();
  }

  /// Where the camera is, metres, map frame.
  eye(): Vector3 { return this.camera.position.clone(); }

  private named(name: string): [number, number] {
    const view = namedViews[name] ?? namedViews.iso;
    return view === namedViews.iso ? [this.isoAzimuth, view[1]] : view;
  }

  /// Moves back along `direction` until every corner of the box is inside the picture.
  private frame(box: Box3, direction: Vector3, zoom: number): void {
    const center = box.getCenter(new Vector3());
    const right = new Vector3().crossVectors(this.camera.up, direction).normalize();
    const up = new Vector3().crossVectors(direction, right);
    const tanUp = Math.tan(this.camera.fov * Math.PI / 360) * 0.92, tanRight = tanUp * this.camera.aspect;
    let distance = 0.05;
    for (let k = 0; k < 8; ++k) {
      const corner = new Vector3(k & 1 ? box.max.x : box.min.x, k & 2 ? box.max.y : box.min.y, k & 4 ? box.max.z : box.min.z).sub(center);
      const toward = corner.dot(direction);
      distance = Math.max(distance, toward + Math.abs(corner.dot(right)) / tanRight, toward + Math.abs(corner.dot(up)) / tanUp);
    }
    distance /= zoom;
    const reach = box.getSize(new Vector3()).length();
    this.camera.near = Math.max(reach, distance) / 500;
    this.camera.far = Math.max(reach, distance) * 60;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(direction, distance);
    this.controls.update();
    this.invalidate();
  }

  /// Lines on the floor of the box, a round number of metres apart.
  drawGrid(box: Box3): void {
    this.gridBox = box;
    if (this.grid) { this.scene.remove(this.grid); this.grid.geometry.dispose(); }
    if (box.isEmpty()) return;
    const size = box.getSize(new Vector3()), side = Math.max(size.x, size.y, 1e-3);
    const step = this.gridStep = roundUp(side / 14);
    const snap = (value: number, by: number) => Math.floor(value / step + by) * step;
    const [x0, x1] = [snap(box.min.x, -1), snap(box.max.x, 2)], [y0, y1] = [snap(box.min.y, -1), snap(box.max.y, 2)];
    const z = box.min.z - 1e-3 * side;
    const points: number[] = [], colors: number[] = [];
    const line = (a: number[], b: number[], strong: boolean) => {
      points.push(...a, z, ...b, z);
      const color = new Color(strong ? palette().gridStrong : palette().grid);
      for (let k = 0; k < 2; ++k) colors.push(color.r, color.g, color.b);
    };
    const strong = (value: number) => Math.abs(Math.round(value / step)) % 5 === 0;
    for (let x = x0; x <= x1 + step / 2; x += step) line([x, y0], [x, y1], strong(x));
    for (let y = y0; y <= y1 + step / 2; y += step) line([x0, y], [x1, y], strong(y));
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(colors), 3));
    this.grid = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
    this.grid.frustumCulled = false;
    this.scene.add(this.grid);
  }

  /// Calls `use` with the ray under the pointer at each press that does not become a drag.
  onClick(use: (from: Vector3, direction: Vector3) => void): void {
    const canvas = this.renderer.domElement;
    let pressed: PointerEvent | null = null;
    canvas.addEventListener("pointerdown", (event) => { pressed = event.isPrimary && event.button === 0 ? event : null; });
    canvas.addEventListener("pointerup", (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > 4) return;
      const box = canvas.getBoundingClientRect();
      const point = new Vector3(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height, 0.5);
      point.unproject(this.camera);
      use(this.camera.position.clone(), point.sub(this.camera.position).normalize());
    });
  }

  /// The map's axes as the eye sees them: x to the right, y up, the third toward the eye.
  axes(): Vector3[] {
    const view = this.camera.matrixWorldInverse;
    return [0, 1, 2].map((a) => new Vector3().setComponent(a, 1).transformDirection(view));
  }
}
