// What the robot feels: the packets of its newest frame.

import { byId, make, oncePerFrame, quantity, setText, words } from "./dom.js";

const kStrongest = 4095;
const kCliffs = ["cliff_left", "cliff_front_left", "cliff_front_right", "cliff_right"];

const list = (names) => (names?.length > 0 ? names.map(words).join(", ") : "none");
const yes = (value) => (value === undefined ? "–" : value ? "yes" : "no");

// Each line: what it is called, and what it says of a frame.
const kLines = [
  ["Bumper, wheel drops", (v) => list(v.bumps_and_wheel_drops_names)],
  ["Cliffs", (v) => list(kCliffs.filter((name) => v[name]))],
  ["Wall, virtual wall", (v) => `${yes(v.wall)}, ${yes(v.virtual_wall)}`],
  ["Infrared", (v) => (v.infrared_byte === undefined ? "–"
    : v.infrared_byte === 255 ? "none" : `${v.infrared_byte} ${words(v.infrared_byte_name)}`)],
  ["Buttons", (v) => list(v.buttons_names)],
  ["Overcurrents", (v) => list(v.overcurrents_names)],
  ["Voltage", (v) => quantity(v.voltage / 1000, "V", 1)],
  ["Current", (v) => quantity(v.current, "mA")],
  ["Charge", (v) => quantity(v.battery_charge, "mAh")],
  ["Capacity", (v) => quantity(v.battery_capacity, "mAh")],
  ["Charging", (v) => list([v.charging_state_name, ...(v.charging_sources_names ?? [])]
    .filter(Boolean))],
  ["Temperature", (v) => quantity(v.battery_temperature, "°C")],
];
const kSignals = ["wall_signal", ...kCliffs.map((name) => `${name}_signal`)];

export class Sensors {
  constructor(link) {
    this.lines = kLines.map(([label]) => make("dd", {}, "–"));
    this.facts = make("dl", { className: "facts" },
      ...kLines.map(([label], i) => make("div", {}, make("dt", {}, label), this.lines[i])));
    this.meters = new Map(kSignals.map((name) => [name, this.#meter(name)]));
    byId("sensors").append(this.facts, make("div", { className: "signals" },
      ...[...this.meters.values()].map(({ row }) => row)));
    this.cells = new Map();
    const draw = oncePerFrame(() => this.#show());
    link.addEventListener("sensors", ({ detail }) => {
      this.frame = detail;
      draw();
    });
  }

  #meter(name) {
    const label = words(name.replace("_signal", ""));
    const meter = make("meter", { min: 0, max: kStrongest, "aria-label": `${label} signal` });
    const number = make("span", {}, "–");
    return { meter, number, row: make("div", {}, make("span", {}, label), meter, number) };
  }

  #show() {
    kLines.forEach(([, say], i) => setText(this.lines[i], say(this.frame)));
    for (const [name, { row, meter, number }] of this.meters) {
      const value = this.frame[name];
      row.hidden = value === undefined; // not among the packets of this robot's frames
      setText(number, value === undefined ? "–" : String(value));
      if (value !== undefined && meter.value !== value) meter.value = value;
    }
    if (byId("packets").closest("details").open) this.#showPackets();
  }

  #showPackets() {
    const body = byId("packets").tBodies[0];
    for (const [key, value] of Object.entries(this.frame)) {
      if (["type", "seq"].includes(key)) continue;
      if (!this.cells.has(key)) {
        const cell = make("td");
        this.cells.set(key, cell);
        body.append(make("tr", {}, make("th", { scope: "row" }, words(key)), cell));
      }
      setText(this.cells.get(key), Array.isArray(value) ? list(value) : String(value ?? "–"));
    }
  }
}
