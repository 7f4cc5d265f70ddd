// Small steps for building the page's elements.

export const byId = <T extends HTMLElement = HTMLElement>(id: string) => document.getElementById(id) as T;

/// An element with attributes (`class`, `title`, ...) and children; strings become text, never markup.
export function el<K extends keyof HTMLElementTagNameMap>(
  tag: K, attributes: Record<string, string> = {}, ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

/// What a reader of the screen says of a plot, which is a picture to it.
export function nameCanvas(plot: { ctx: CanvasRenderingContext2D }, name: string): void {
  plot.ctx.canvas.setAttribute("role", "img");
  plot.ctx.canvas.setAttribute("aria-label", name);
}

/// With the digits that are known: so many that the last one is not much finer than `step`.
export const toStep = (value: number, step: number) => Number(value.toFixed(Math.min(9, Math.max(0, Math.round(-Math.log10(step)))))).toString();

/// Of a place that is exact: no digits that say nothing.
export const exactMetres = (value: number) => `${Number(value.toFixed(6))} m`;

export const grouped = (count: number) => count.toLocaleString("en-US");

/// Three digits at most.
export const millimetres = (metres: number) => `${Number((1000 * metres).toPrecision(3))} mm`;

/// Metres with the precision of a tenth of a millimetre below 1 m.
export function metres(value: number): string {
  return `${value.toFixed(Math.abs(value) < 1 ? 4 : 3)} m`;
}

export function download(name: string, type: string, bytes: BlobPart): void {
  const link = el("a", { href: URL.createObjectURL(new Blob([bytes], { type })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
