// The line at the top: link, mode, battery, hazards; and what must not be missed.

import { byId, isNumber, setText, words } from "./dom.js";

const kAlert_ms = 12000;
const kLow_mv = 12500;
const kWorrying = ["mode_lost", "silence_began", "rearm_failed", "wheel_stuck", "battery_low",
  "counters_implausible"];

// Says it at once, also to screen readers, until something else or nothing is said.
let alertTimer = null;
export function warn(text) {
  setText(byId("alert"), text);
  byId("alert").hidden = text === "";
  clearTimeout(alertTimer);
  if (text !== "") alertTimer = setTimeout(() => warn(""), kAlert_ms);
}

export class Status {
  constructor(link) {
    this.link = link;
    this.stage = null;
    this.hello = null;
    link.addEventListener("up", () => this.#show());
    link.addEventListener("down", () => this.#show());
    link.addEventListener("hello", ({ detail }) => {
      this.hello = detail;
      this.stage = null;
      this.#show();
    });
    link.addEventListener("status", ({ detail }) => {
      this.stage = detail;
      this.#show();
    });
    link.addEventListener("state", ({ detail }) => this.#takeState(detail));
    link.addEventListener("event", ({ detail }) => {
      if (kWorrying.includes(detail.what)) warn(detail.text);
    });
    link.addEventListener("gap", () => this.#showGap());
  }

  #show() {
    const badge = byId("link");
    const stage = this.stage?.stage ?? "driving";
    const [level, text] = !this.link.up ? ["bad", "not connected, trying again"]
      : stage === "driving" ? ["ok", "connected"]
      : stage === "simulator" ? ["ok", "simulator"]
      : stage === "bring_up" ? ["warn", "bringing up"]
      : ["bad", stage === "lost" ? "robot lost" : "ended"];
    badge.dataset.level = level;
    setText(badge, text);
    badge.title = this.stage?.text ?? "";
    document.body.classList.toggle("stale", level === "bad");
    if (this.link.up && level !== "ok" && this.stage?.text) warn(this.stage.text);
    if (!this.hello) return;
    const { robot, port, program, cargobay } = this.hello;
    setText(byId("robot"), `${robot} on ${port}, ${program} ${cargobay}`);
    document.title = `${robot === "robot" ? port : robot} – Cargobay`;
  }

  #takeState({ mode, battery_mv, hazards }) {
    setText(byId("mode"), `mode ${words(mode ?? "–")}`);
    byId("mode").dataset.level = ["safe", "full"].includes(mode) ? "ok" : "warn";
    const battery = byId("battery");
    setText(battery, isNumber(battery_mv) ? `battery ${(battery_mv / 1000).toFixed(1)} V`
      : "battery –");
    battery.dataset.level = isNumber(battery_mv) && battery_mv < kLow_mv ? "warn" : "";
    const found = (hazards ?? []).map(words);
    setText(byId("hazards"), found.length > 0 ? found.join(", ") : "no hazards");
    byId("hazards").dataset.level = found.length > 0 ? "bad" : "";
  }

  #showGap() {
    const { missed, away } = this.link;
    const parts = [];
    if (missed > 0) parts.push(`missed ${missed} messages, because it was slow`);
    if (away.times > 0) {
      parts.push(`was not connected ${away.times === 1 ? "once" : `${away.times} times`}, ` +
        `for ${away.seconds.toFixed(1)} s`);
    }
    setText(byId("gap"), parts.length === 0 ? "This page has missed nothing."
      : `This page ${parts.join(" and ")}.`);
  }
}
