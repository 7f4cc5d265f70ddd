// Errors are shown at the end of the page and counted on the body, where a test can read them.

import { byId } from "./dom";

class Failures {
  private count = 0;
  add(text: string): void {
    document.body.dataset.errors = String(++this.count);
    byId("errors").hidden = false;
    byId("errors").append(`${text}\n`);
  }
}
export const failures = new Failures();
document.body.dataset.errors = "0";

addEventListener("error", (event) => failures.add(event.message));
addEventListener("unhandledrejection", (event) => failures.add(String(event.reason)));
addEventListener("securitypolicyviolation", (event) => failures.add(`blocked request: ${event.blockedURI} (${event.violatedDirective})`));
const consoleError = console.error;
console.error = (...values: unknown[]) => { failures.add(values.map(String).join(" ")); consoleError(...values); };
