// A table whose rows are sorted by a click on a column's name; once more turns them round.

import { el } from "../dom";

/// By numbers where the cells have them (`data-value`), rows without one last; else by their text.
function compare(a: HTMLElement, b: HTMLElement): number {
  const x = a.dataset.value, y = b.dataset.value;
  if (x !== undefined && y !== undefined) return Number(x) - Number(y);
  if (x !== undefined || y !== undefined) return x === undefined ? Infinity : -Infinity;
  return a.textContent!.localeCompare(b.textContent!, "en", { numeric: true });
}

/// @param numeric columns that are aligned to the right
export function sortable(head: string[], numeric: Set<number>, rows: HTMLElement[]): HTMLElement {
  const body = el("tbody", {}, ...rows);
  let column = -1, turned = false;
  const names = head.map((name, i) => {
    const button = el("button", { type: "button", class: "sort", title: "sort" }, name);
    const cell = el("th", numeric.has(i) ? { class: "number", scope: "col" } : { scope: "col" }, button);
    button.addEventListener("click", () => {
      turned = column === i && !turned;
      column = i;
      const order = (a: HTMLElement, b: HTMLElement) => {
        const by = compare(a.children[i] as HTMLElement, b.children[i] as HTMLElement);
        return Number.isFinite(by) && turned ? -by : by;
      };
      body.append(...[...rows].sort(order));
      names.forEach((each) => each.removeAttribute("aria-sort"));
      cell.setAttribute("aria-sort", turned ? "descending" : "ascending");
    });
    return cell;
  });
  return el("table", {}, el("thead", {}, el("tr", {}, ...names)), body);
}
