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
  robots: ["#b9cf8c", "#c9a6d8", "#8ccbcb", "#dcc48c"],
};

export function isDark(): boolean { return document.documentElement.dataset.theme === "dark"; }

export function palette(): Palette { return isDark() ? dark : light; }

/// "#rrggbb" as three numbers from 0 to 1, in sRGB as written.
export function rgb(hex: string): [number, number, number] {
  const value = parseInt(hex.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}
