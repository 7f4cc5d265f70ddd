// What render_report_page (apps/pages/report_page.cpp) writes into the page, and how to read it.

export interface Place { type: "f32" | "u32" | "u16" | "u8"; offset: number; count: number }

export type StateName = "painted" | "occupied" | "conflict" | "seen_free";

export interface VoxelSet {
  state: StateName;
  count: number;         // finest voxels
  cell: number;          // what is drawn are cubes of so many voxels an edge
  faces: number;         // exposed voxel faces, before merging
  directions: number[];  // merged quads per direction: -x +x -y +y -z +z
  columns: Place[];      // layer, u, v, width - 1, height - 1, each as differences modulo 2^16
  turned?: VoxelSet;     // coarser: for turning where the others draw too slowly
}

export interface Shape {
  kind: "sphere" | "capsule" | "cylinder" | "box" | "mesh";
  size: [number, number, number];
  link: number; part: string; critical: boolean;
  group: number;         // which of several robots; -1: an obstacle that moves; -2: one known from the map alone
  pose: Place;
  vertices?: Place; triangles?: Place;
}

export type Figure = [string, string];

/// Voxels that a changing map has and did not have before: times, how many, then x of all, y of all, z of all.
export interface Seen { voxel: number; times: Place; counts: Place; cells: Place }

export interface Plan {
  name: string; planner: string; status: string; explanation: string;
  joints: string[]; prismatic: boolean[];
  waypoints: number; links: number;
  period: number;    // s between waypoints, less before the last one; 0: the plan has no time
  duration: number;  // s
  values: Place;     // joint by joint
  speeds: Place; accelerations: Place;  // of a plan with time, as values; rad/s (m/s), rad/s² (m/s²)
  maxSpeed: number[]; maxAcceleration: number[];  // of each joint
  jerks: Place; maxJerk: number[];  // the same where jerk is known, else empty; rad/s³ (m/s³)
  torques: Place; maxTorque: (number | null)[];  // the same of torques; N m (N); null: a joint without a limit
  security: number;  // m, to be kept from obstacles; 0: nothing was said
  poses: Place;      // waypoint by waypoint, link by link: x y z qx qy qz qw
  clearance: Place;  // metres, NaN = not known
  betweenBodies: Place;  // metres, of the robot's own bodies, which `clearance` counts, too; NaN or empty = not known
  trueSeparation: Place;  // metres, from what is known from the map alone; empty when nothing is
  mapAge: Place;     // s, at each waypoint; empty when the map does not change
  seen: Seen;
  phaseNames: string[];           // how the planner got to waypoints, in words; empty when it does not say
  phases: Place; searchSteps: Place;  // of each waypoint: index into phaseNames; when the search made the edge, 0: not known
  figures: Figure[];
  tip: Place; start: Place; goal: Place;
  paint: Place;      // balls to paint for a plan that found no path: x y z radius colour
}

export interface Table { name: string; header: string[]; rows: string[][] }

export interface Picture { caption: string; jpeg: Place }

/// What the map knows of its voxels beside their states, in a grid of cubes; a byte a cube, x fastest, 0: nothing known.
export interface Evidence {
  cell: number;      // voxels along a cube's edge
  low: number[];     // lowest voxel of the grid, from the map's origin
  size: number[];    // cubes along each axis
  times: number[];   // s, of looks 1 and 255
  odds: number[];    // log-odds 1 and 255
  look: Place; volume: Place;         // newest look; 1 + volume, 255: several
  lowOdds: Place; highOdds: Place;    // least and greatest log-odds of the observed voxels
}

export interface Refusal { from: number; to: number; images: number; refusal: string; reason: string }

/// What happened when in the recording; times are s since its first frame.
export interface Timeline {
  duration: number;
  images: Place; tags: Place; accepted: Place;  // of each image: time, tags found, whether its sample painted
  scans: Place;
  refusals: Refusal[]; refusalsLeftOut: number;
  pictures: { time: number; jpeg: Place }[];
  balls: Place; ballCount: number;  // x y z radius volume time; a volume v below 0: erased from -1 - v
  // Conflicts as they appeared; seconds: what came second, 2 n + 3: scan n, 2 n + 2: stroke n, 0: paint outside a stroke.
  conflicts: { times: Place; cells: Place; seconds: Place; strokes: string[]; notKept: number };
}

export interface Page {
  title: string; subtitle: string; figures: Figure[];
  resolution: number; origin: number;
  opens: string;       // what is asked for where the address says nothing of it, as after '#'
  isoAzimuth: number;  // degrees
  firstLook: [number[], number[]] | null;  // corners of the map's main part, m, where some lies far outside
  occupiedBeyond: number;                  // voxels outside of that
  stateLabels: [StateName, string][];  // of states that mean something else than usual
  voxels: VoxelSet[]; balls: Place; volumes: string[];
  evidence: Evidence; timeline: Timeline | null;
  mapPlace: string | null;  // MAP of `clearway inspect`; "": the folder of this page; null: in no file
  robot: Shape[]; home: Place; plans: Plan[];
  tables: Table[]; pictures: Picture[]; warnings: string[]; report: Place;
}

/// The page's binary arrays, unpacked.
export class Arrays {
  constructor(private readonly bytes: ArrayBuffer) {}
  f32(at: Place): Float32Array { return new Float32Array(this.bytes, at.offset, at.count); }
  u32(at: Place): Uint32Array { return new Uint32Array(this.bytes, at.offset, at.count); }
  u16(at: Place): Uint16Array { return new Uint16Array(this.bytes, at.offset, at.count); }
  u8(at: Place): Uint8Array<ArrayBuffer> { return new Uint8Array(this.bytes, at.offset, at.count); }
}

export function readPage(): Page {
  return JSON.parse(document.getElementById("page")!.textContent!) as Page;
}

function fromBase64(text: string): Uint8Array<ArrayBuffer> {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/// Unpacks the arrays and drops their text from the document.
/// Throws an Error with a sentence for the reader when the browser cannot.
export async function readArrays(): Promise<Arrays> {
  if (typeof DecompressionStream === "undefined")
    throw new Error("This browser is too old to unpack the map and the plans (it has no DecompressionStream): "
      + "use Chrome 80, Firefox 113, Safari 16.4 or later. The figures and tables are complete.");
  const element = document.getElementById("arrays")!;
  const packed = fromBase64(element.textContent!);
  element.remove();
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Arrays(await new Response(stream).arrayBuffer());
}
