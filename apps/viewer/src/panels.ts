// The parts of the page that are text: names, warnings, plans, figures and tables.

import type { Arrays, Figure, Page, Picture, Plan, Table } from "./data";
import { byId, el } from "./dom";

const statusWords: Record<string, string> = {
  solved: "solved", start_invalid: "start invalid", goal_invalid: "goal invalid", no_path: "no path", timed_out: "timed out",
};
const statusText = (plan: Plan) => statusWords[plan.status] ?? plan.status.replaceAll("_", " ");
const isSolved = (plan: Plan) => plan.status === "solved";

function badge(plan: Plan): HTMLElement {
  return el("span", { class: `badge ${isSolved(plan) ? "good" : "bad"}` }, `${isSolved(plan) ? "✓" : "✕"} ${statusText(plan)}`);
}

function figureList(figures: Figure[]): HTMLElement {
  return el("dl", { class: "figure-list" },
            ...figures.map(([name, value]) => el("div", value.length > 28 ? { class: "wide" } : {}, el("dt", {}, name), el("dd", {}, value))));
}

export function showNames(page: Page): void {
  byId("title").textContent = page.title;
  byId("subtitle").textContent = page.subtitle;
  byId("subtitle").hidden = page.subtitle === "";
}

export function showWarnings(warnings: string[]): void {
  if (warnings.length === 0) return;
  const box = byId("warnings");
  box.hidden = false;
  const list = el("ul", {}, ...warnings.map((warning) => el("li", {}, warning)));
  if (warnings.length <= 3) return box.append(list);
  box.append(el("details", {}, el("summary", {}, `${warnings.length} warnings`), list));
}

/// A row for each plan, its status always in sight; `choose` is called with its index.
export function showPlanList(plans: Plan[], choose: (index: number) => void): void {
  byId("plans").hidden = plans.length === 0;
  const rows = plans.map((plan, i) => {
    const row = el("button", { type: "button", class: "plan-row", role: "radio", "aria-checked": "false" },
      el("span", { class: "plan-name" }, plan.name),
      el("span", { class: "plan-planner" }, plan.planner === plan.name ? "" : plan.planner), badge(plan));
    row.addEventListener("click", () => choose(i));
    return row;
  });
  byId("plan-list").replaceChildren(...rows);
  const failed = plans.filter((plan) => !isSolved(plan)).length;
  if (failed > 0) byId("plans").querySelector("h2")!.append(el("small", {}, `${failed} of ${plans.length} without a valid path`));
}

export function showPlan(plan: Plan, index: number): void {
  byId("plan-list").childNodes.forEach((row, i) => (row as HTMLElement).setAttribute("aria-checked", String(i === index)));
  const card = byId("plan");
  card.hidden = false;
  card.replaceChildren();
  if (plan.explanation !== "" || !isSolved(plan))
    card.append(el("p", { class: isSolved(plan) ? "explanation" : "explanation failed" },
                   plan.explanation !== "" ? plan.explanation : "The planner gave no explanation."));
  if (!isSolved(plan) && plan.waypoints > 0)
    card.append(el("p", { class: "explanation" }, "What is played and plotted is no valid plan."));
  if (plan.waypoints === 0) card.append(el("p", { class: "explanation" }, "There is no path to play or to plot."));
  if (plan.figures.length > 0) card.append(figureList(plan.figures));
}

export function showFigures(figures: Figure[]): void {
  if (figures.length === 0) return;
  const box = byId("figures");
  box.hidden = false;
  box.append(el("h2", {}, "Figures"), figureList(figures));
}

const isNumber = (text: string) => /^[-+−]?[\d.,]+(e[-+]?\d+)?\s*(%|[a-zµ°²³/]{0,4})$/i.test(text.trim()) || text.trim() === "–" || text === "";

function tableOf(table: Table): HTMLElement {
  const numeric = table.header.map((_, c) => table.rows.length > 0 && table.rows.every((row) => isNumber(row[c] ?? "")));
  const cell = (tag: "td" | "th", text: string, c: number) =>
    el(tag, { ...(numeric[c] ? { class: "number" } : {}), ...(tag === "th" ? { scope: "col" } : {}) }, text);
  return el("div", { class: "table-box", tabindex: "0", role: "region", "aria-label": table.name },
    el("table", {},
       el("thead", {}, el("tr", {}, ...table.header.map((name, c) => cell("th", name, c)))),
       el("tbody", {}, ...table.rows.map((row) => el("tr", {}, ...row.map((text, c) => cell("td", text, c)))))));
}

export function showTables(tables: Table[]): void {
  byId("tables").hidden = tables.length === 0;
  for (const table of tables) byId("tables").append(el("h2", {}, table.name), tableOf(table));
}

/// What a camera saw, with what was drawn into it.
export function showPictures(pictures: Picture[], arrays: Arrays): void {
  byId("pictures").hidden = pictures.length === 0;
  if (pictures.length === 0) return;
  byId("pictures").append(el("h2", {}, "in the camera's image"), el("div", { class: "pictures" },
    ...pictures.map(({ caption, jpeg }) => el("figure", {},
      el("img", { src: URL.createObjectURL(new Blob([arrays.u8(jpeg)], { type: "image/jpeg" })), alt: caption }),
      el("figcaption", {}, caption)))));
}
