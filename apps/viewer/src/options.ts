// What the address after '#' asks for, so that a script can choose what a picture shows:
//   #plan=1&t=0.5&dark=1&view=iso&cut=z:0.3&layers=painted,occupied,robot&opacity=0.4&picture

import { strangeWords } from "./address";

const kKnown = ["plan", "t", "dark", "view", "cut", "layers", "opacity", "fit", "picture", "color", "path", "recording", "nowebgl"];

export interface Cut { axis: 0 | 1 | 2; at: number; flipped: boolean }

export interface Options {
  plan: number | null;              // index of the plan shown first
  time: number;              // where along it, 0 to 1
  dark: boolean | null;      // null: as the system prefers
  view: string;              // iso, front, side, top or "azimuth,elevation[,zoom]" in degrees
  cuts: Cut[];
  saysCuts: boolean;         // also that there are none: cut=none
  layers: Set<string> | null;  // the layers shown; null: the usual ones
  opacity: number | null;    // of painted voxels
  fit: string;               // "work" or "all"
  picture: boolean;          // only the 3D view, full window
  webgl: boolean;
  color: string;             // of voxels: state, height, age, volume
  path: string;              // of the tip's path: plain, clearance, phase, step
  recording: number | null;  // where in the recording, 0 to 1; null: not shown
  strange: string;           // a sentence about words that mean nothing here; else empty
}

function parseCuts(text: string | null): Cut[] {
  const matches = (text ?? "").split(",").map((part) => /^(-?)([xyz]):(-?[\d.]+(?:e-?\d+)?)$/.exec(part));
  return matches.filter((match) => match !== null)
    .map((match) => ({ axis: "xyz".indexOf(match[2]) as 0 | 1 | 2, at: Number(match[3]), flipped: match[1] === "-" }));
}

function numberOr<T>(text: string | null, otherwise: T): number | T {
  const value = Number(text);
  return text !== null && text !== "" && Number.isFinite(value) ? value : otherwise;
}

/// @param usual what the page itself asks for, in the same words; the address goes first
export function readOptions(usual: string): Options {
  const hash = new URLSearchParams(usual);
  for (const [key, value] of new URLSearchParams(location.hash.slice(1))) hash.set(key, value);
  const query = new URLSearchParams(location.search);
  const layers = hash.get("layers");
  const dark = hash.get("dark");
  return {
    plan: hash.has("plan") ? Math.max(0, Math.floor(numberOr(hash.get("plan"), 0))) : null,
    time: Math.min(1, Math.max(0, numberOr(hash.get("t"), 0))),
    dark: dark === null ? null : dark !== "0",
    view: hash.get("view") ?? "iso",
    cuts: parseCuts(hash.get("cut")),
    saysCuts: hash.has("cut"),
    layers: layers === null ? null : new Set(layers.split(",")),
    opacity: numberOr(hash.get("opacity"), null),
    fit: hash.get("fit") ?? "work",
    picture: hash.has("picture"),
    color: hash.get("color") ?? "state",
    path: hash.get("path") ?? "plain",
    recording: hash.has("recording") ? Math.min(1, Math.max(0, numberOr(hash.get("recording"), 0))) : null,
    strange: strangeWords(kKnown, ["nowebgl"]),
    webgl: !(query.has("nowebgl") || hash.has("nowebgl")),
  };
}
