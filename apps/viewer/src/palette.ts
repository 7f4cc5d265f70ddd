// The colours of states, parts and lines, for the page and for the 3D view.

export interface Palette {
  background: string; grid: string; gridStrong: string;
  occupiedLow: string; occupiedHigh: string;
  painted: string; seenFree: string; conflict: string;
  sensed: string;
  robot: string; critical: string; start: string; goal: string; tip: string;
  ink: string; muted: string; line: string; danger: string; clearance: string;
  truth: string;  // beside the clearance
  series: string[];
  ramp: string[];        // from low to high: distinct for colour-blind readers, too
  nearRamp: string[];    // from contact to far away
  unknown: string;       // of what has no value
  several: string;       // of what has more than one
  robots: string[];  // of a team, after the first
}

const light: Palette = {
  background: "#eef1f4", grid: "#d3d9df", gridStrong: "#b6c0ca",
  occupiedLow: "#9b8d80", occupiedHigh: "#ece5dc",
  painted: "#12a39a", seenFree: "#5f9fe0", conflict: "#d6263a",
  sensed: "#e8b923",
  robot: "#7287a0", critical: "#f0781e", start: "#2f9e44", goal: "#8a4fd0", tip: "#2749c9",
  ink: "#18212b", muted: "#56636f", line: "#dbe1e7", danger: "#c92a3c", clearance: "#0c8078",
  truth: "#b08900",
  series: ["#1c6fd1", "#d9480f", "#2b8a3e", "#a02bb5", "#b08900", "#0b8793", "#c2255c", "#5f6b77"],
  ramp: ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"],
  nearRamp: ["#b3122a", "#e0662b", "#e8b923", "#5aa85a", "#0c6f9e"], unknown: "#b4bcc4", several: "#18212b",
  robots: ["#8aa05f", "#9a78a8", "#5f9c9c", "#b59a62"],
};

const dark: Palette = {
  background: "#14191f", grid: "#28303a", gridStrong: "#3c4753",
  occupiedLow: "#6b6058", occupiedHigh: "#d3c8bb",
  painted: "#25c2b5", seenFree: "#6fb0f2", conflict: "#ff4d5e",
  sensed: "#f5d04e",
  robot: "#a9b8c7", critical: "#ff9440", start: "#51cf66", goal: "#b38af5", tip: "#ffd84d",
  ink: "#e7ecf1", muted: "#9aa7b4", line: "#2b343e", danger: "#ff6b78", clearance: "#35cfc2",
  truth: "#e9c548",
  series: ["#5ea7ff", "#ff8a4c", "#5fd37a", "#dd8bf0", "#e9c548", "#4fd0dc", "#ff7fae", "#a9b4bf"],
  ramp: ["#5b2a7a", "#4a66b0", "#2aa79f", "#6fd873", "#fde725"],
  nearRamp: ["#ff4d5e", "#ff8a4c", "#f5d04e", "#6fce78", "#58b7ee"], unknown: "#5d6873", several: "#ffffff",
  robots: ["#b9cf8c", "#c9a6d8", "#8ccbcb", "#dcc48c"],
};

export function isDark(): boolean { return document.documentElement.dataset.theme === "dark"; }

export function palette(): Palette { return isDark() ? dark : light; }

/// The colour at `share` (0 to 1) of a ramp, as three numbers from 0 to 1.
export function rampAt(ramp: string[], share: number): [number, number, number] {
  const at = Math.min(1, Math.max(0, share)) * (ramp.length - 1), first = Math.min(Math.floor(at), ramp.length - 2);
  const [a, b] = [rgb(ramp[first]), rgb(ramp[first + 1])];
  return [0, 1, 2].map((k) => a[k] + (at - first) * (b[k] - a[k])) as [number, number, number];
}

/// The same for a style.
export const cssColor = (color: number[]) => `rgb(${color.map((c) => Math.round(255 * c)).join(" ")})`;

/// "#rrggbb" as three numbers from 0 to 1, in sRGB as written.
export function rgb(hex: string): [number, number, number] {
  const value = parseInt(hex.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}
