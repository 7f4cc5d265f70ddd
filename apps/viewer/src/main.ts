// The report page: reads what the program wrote into it, and shows it.

import "./errors";
import { readArrays, readPage, type Arrays } from "./data";
import { byId, download, el } from "./dom";
import { failures } from "./errors";
import { FlatSlices } from "./flat_slices";
import { MapView } from "./map_view";
import { readOptions } from "./options";
import { isDark } from "./palette";
import { showFigures, showNames, showPictures, showPlan, showPlanList, showTables, showWarnings } from "./panels";
import { Playback } from "./playback";
import { Plots } from "./plots";
import { RecordingTimeline } from "./timeline";

const page = readPage();
const options = readOptions(page.opens);
const systemDark = matchMedia("(prefers-color-scheme: dark)");

function setTheme(dark: boolean): void {
  document.documentElement.dataset.theme = dark ? "dark" : "light";
  byId("theme").textContent = dark ? "Light" : "Dark";
}

function sayInView(sentence: string): void {
  byId("view-message").replaceChildren(el("p", {}, sentence));
  byId("view-message").hidden = false;
  document.body.classList.add("no-view");
}

function openMap(arrays: Arrays): MapView | null {
  const lost = "The browser lost its 3D context (graphics memory or driver): reload the page. Tables and plots still work.";
  try {
    if (!options.webgl) throw new Error("WebGL switched off");
    return new MapView(page, arrays, options, () => sayInView(lost));
  } catch (error) {
    sayInView(`This browser offers no WebGL 2, so the map cannot be drawn in 3D. ${page.plans.length > 0 ? "Plans, plots, figures and tables" : "Figures"} are complete. `
      + `(${(error as Error).message})`);
    return null;
  }
}

async function show(): Promise<void> {
  setTheme(options.dark ?? systemDark.matches);
  document.body.classList.toggle("picture", options.picture);
  if (innerWidth < 760) byId<HTMLDetailsElement>("layers").open = false;
  document.body.classList.toggle("map-only", page.plans.length === 0);
  showNames(page);
  showWarnings(options.strange === "" ? page.warnings : [options.strange, ...page.warnings]);
  showFigures(page.figures);
  showTables(page.tables);
  const playback = new Playback();
  let choose = (index: number) => showPlan(page.plans[index], index);
  showPlanList(page.plans, (index) => choose(index));
  const solved = Math.max(0, page.plans.findIndex((plan) => plan.status === "solved"));
  const first = Math.min(options.plan ?? solved, page.plans.length - 1);
  if (first >= 0) playback.reset(page.plans[first], 0);  // so that the view gets its size at once

  const arrays = await readArrays().catch((error: Error) => { sayInView(error.message); return null; });
  const map = arrays && openMap(arrays);
  const plots = arrays && new Plots(arrays);
  byId("download").hidden = !arrays || page.report.count === 0;
  const flat = arrays && !map ? new FlatSlices(page, arrays) : null;
  if (arrays) showPictures(page.pictures, arrays);
  if (arrays) byId("download").addEventListener("click", () => download("report.json", "application/json", arrays.u8(page.report)));
  playback.onTime = (time) => { map?.showTime(time); plots?.showTime(time); };
  if (map) map.onPathMode = (mode) => plots?.showPathMode(mode);
  const recording = arrays && page.timeline ? new RecordingTimeline(page.timeline, arrays, options.recording) : null;
  if (recording) recording.onTime = (time) => map?.showRecording(time);
  if (plots) plots.onSeek = (time) => playback.seek(time);
  choose = (index) => {
    showPlan(page.plans[index], index);
    map?.showPlan(page.plans[index]);
    plots?.show(page.plans[index]);
    playback.reset(plots ? page.plans[index] : { ...page.plans[index], waypoints: 0 }, index === first ? options.time : 0);
  };
  if (first >= 0) choose(first);

  const recolor = (dark: boolean) => { setTheme(dark); map?.recolor(); flat?.draw(); plots?.redraw(); recording?.draw(); };
  byId("theme").addEventListener("click", () => recolor(!isDark()));
  if (options.dark === null) systemDark.addEventListener("change", (event) => recolor(event.matches));
  addEventListener("hashchange", () => location.reload());
  map?.render();
  Object.assign(document.body.dataset, {
    plans: page.plans.length, balls: page.balls.count / 5, view: map ? "3d" : "none",
    width: innerWidth, overflow: document.documentElement.scrollWidth - document.documentElement.clientWidth, ready: "1",
  });
}

show().catch((error: Error) => failures.add(`${error.message}\n${error.stack ?? ""}`));
