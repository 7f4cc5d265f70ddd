// Measures how smoothly a page turns in headless Chromium with software rendering (SwiftShader).
//   node frames.mjs PAGE.html['#options'] [SECONDS]
// Drags the pointer through the 3D view for SECONDS (5), shows the layer `seen_free` for the first time where there is
// one, and turns again. Prints frames per second, the longest time without a frame, the CPU time of a frame (which does
// not depend on what else the machine does), how long the page answered nobody when all was drawn again once the view
// stood still, and load averages.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join, resolve } from "node:path";

const [place, seconds = "5"] = process.argv.slice(2);
const [file, options = ""] = (place ?? "").split("#");
if (!file) throw new Error("expected a page, as in: node frames.mjs report.html");
const profile = mkdtempSync(join(tmpdir(), "frames-"));
const browser = spawn("chromium", ["--headless", "--no-sandbox", "--remote-debugging-pipe", "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader", "--no-first-run", "--disable-background-networking", `--user-data-dir=${profile}`, "--window-size=1280,800"],
  { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });

// The DevTools protocol over a pipe: JSON messages that end in a zero byte.
const waiting = new Map();
let last = 0, rest = "";
browser.stdio[4].on("data", (bytes) => {
  const messages = (rest + bytes).split("\0");
  rest = messages.pop();
  for (const message of messages.map((text) => JSON.parse(text))) waiting.get(message.id)?.(message);
});
function send(method, params = {}, sessionId = undefined) {
  const id = ++last;
  browser.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
  return new Promise((done, failed) => waiting.set(id, (answer) => answer.error ? failed(new Error(answer.error.message)) : done(answer.result)));
}

const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const { targetId } = await send("Target.createTarget", { url: `file://${resolve(file)}${options ? `#${options}` : ""}` });
const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
const ask = async (expression) => (await send("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true }, sessionId)).result.value;
const mouse = (type, x, y, buttons) => send("Input.dispatchMouseEvent", { type, x, y, button: "left", buttons, clickCount: 1 }, sessionId);

/// Of all processes of the browser, s.
const cpu = async () => (await send("SystemInfo.getProcessInfo")).processInfo.reduce((sum, { cpuTime }) => sum + cpuTime, 0);

/// Frames per second while the view turns, the longest pause between two, ms, and the CPU time of a frame, ms.
async function turn() {
  const before = await cpu();
  await ask(`window.shown = []; window.watch = new MutationObserver(() => shown.push(performance.now()));
    watch.observe(document.body, { attributes: true, attributeFilter: ["data-frames"] }); 0`);
  await mouse("mousePressed", 500, 400, 1);
  const end = Date.now() + 1000 * Number(seconds);
  for (let step = 0; Date.now() < end; ++step) {
    await mouse("mouseMoved", 500 + 200 * Math.sin(step / 20), 400 + 60 * Math.sin(step / 33), 1);
    await wait(10);
  }
  await mouse("mouseReleased", 500, 400, 0);
  const times = await ask("watch.disconnect(); shown");
  const spent = await cpu() - before;
  const pauses = times.slice(1).map((time, i) => time - times[i]);
  return { frames: times.length, cpu_ms_a_frame: Math.round(1000 * spent / times.length), frames_per_s: Number((1000 * pauses.length / (times.at(-1) - times[0])).toFixed(1)), longest_ms: Math.round(Math.max(...pauses)) };
}

/// Until nothing has been drawn for two seconds.
async function still() {
  for (let frames = "", next = await ask("document.body.dataset.frames"); frames !== next; next = await ask("document.body.dataset.frames")) {
    frames = next;
    await wait(2000);
  }
}

/// The longest time, ms, that the page's own clock stands until nothing is drawn any more.
async function stall() {
  await ask(`window.stood = 0; window.beat = performance.now(); window.pulse = setInterval(() => {
    const now = performance.now(); stood = Math.max(stood, now - beat); beat = now; }, 10); 0`);
  await still();
  return Math.round(await ask("clearInterval(pulse); stood"));
}

const start = Date.now();
while (await ask("document.body?.dataset.ready ?? ''") !== "1") {
  if (Date.now() - start > 120000) throw new Error("the page was not ready after two minutes");
  await wait(100);
}
const ready = Date.now() - start;
await still();
const result = { page: place, ready_ms: ready, faces: await ask("document.body.dataset.faces"), turning: await turn() };
const seconds_to_show = `(async () => { const box = document.querySelector("[data-layer=seen_free]"); if (!box || box.checked) return null;
  const before = document.body.dataset.frames, start = performance.now(); box.click();
  while (document.body.dataset.frames === before) await new Promise(requestAnimationFrame); return Math.round(performance.now() - start); })()`;
result.all_drawn_stall_ms = await stall();
result.seen_free_shown_ms = await ask(seconds_to_show);
if (result.seen_free_shown_ms !== null) {
  result.seen_free_stall_ms = await stall();
  result.turning_with_seen_free = await turn();
  result.seen_free_drawn_stall_ms = await stall();
}
result.load = loadavg().map((load) => Number(load.toFixed(1)));
console.log(JSON.stringify(result, null, 1));
await send("Browser.close").catch(() => {});
await new Promise((done) => browser.once("exit", done));
rmSync(profile, { recursive: true, force: true });
process.exit(0);
