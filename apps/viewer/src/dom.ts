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
