// Set, estimated and true speed of each wheel over time, by dygraphs.

import { byId, fixed, onColours, setText, style } from "./dom.js";

const kWindow_s = 20;
const kMostRows = 1500;
const kShare = 0.15; // of the processor's time, at most, goes into drawing these
const kFastest_ms = 100;

export class SpeedCharts {
  constructor(link) {
    this.link = link;
    this.sides = ["left", "right"];
    this.rows = { left: [], right: [] };
    this.truth = null;
    this.hasTruth = false;
    this.charts = {};
    this.next_ms = 0;
    this.cost_ms = 0;
    link.addEventListener("hello", ({ detail }) => this.#meet(detail));
    link.addEventListener("truth", ({ detail }) => (this.truth = detail.wheel_mm_s));
    link.addEventListener("state", ({ detail }) => this.#take(detail));
    const draw = (now) => {
      this.#drawIfDue(now);
      requestAnimationFrame(draw);
    };
    requestAnimationFrame(draw);
    onColours(() => this.#begin());
  }

  #meet(hello) {
    this.hasTruth = hello.robot === "virtual Create";
    this.truth = null;
    byId("truth-key").hidden = !this.hasTruth;
    this.#gap();
  }

  // A hole in the lines, where this page saw nothing.
  #gap() {
    for (const side of this.sides) {
      const last = this.rows[side].at(-1);
      if (last) this.rows[side].push([last[0], null, null, null]);
    }
  }

  #take(state) {
    const last = this.rows.left.at(-1);
    const now_s = state.robot_time_s;
    if (last && now_s < last[0]) for (const side of this.sides) this.rows[side].length = 0;
    for (const side of this.sides) {
      const rows = this.rows[side];
      const row = [now_s, value(state.set_mm_s, side), value(state.estimate_mm_s, side),
        value(this.truth, side)];
      rows.push(row);
      while (rows.length > kMostRows || rows[0][0] < now_s - kWindow_s) rows.shift();
    }
    this.fresh = true;
    this.state = state;
  }

  // As often as it costs no more than its share, on whatever machine this runs.
  #drawIfDue(now) {
    if (!this.fresh || now < this.next_ms || typeof Dygraph === "undefined") return;
    this.fresh = false;
    const began = performance.now();
    for (const side of this.sides) this.#draw(side);
    this.#describe();
    this.cost_ms = 0.8 * this.cost_ms + 0.2 * (performance.now() - began);
    this.next_ms = now + Math.max(kFastest_ms, this.cost_ms / kShare);
  }

  #draw(side) {
    const rows = this.rows[side];
    if (rows.length === 0 || byId(`chart-${side}`).clientWidth === 0) return;
    const end = Math.max(rows.at(-1)[0], kWindow_s);
    const changes = { file: rows, dateWindow: [end - kWindow_s, end], valueRange: range(rows) };
    if (this.charts[side]) this.charts[side].updateOptions(changes);
    else {
      withoutLegend();
      this.charts[side] = new Dygraph(byId(`chart-${side}`), rows, this.#options(changes));
    }
  }

  #options(changes) {
    const muted = style("--muted");
    return {
      ...changes,
      labels: ["s", "set", "estimated", "true"],
      colors: [style("--muted"), style("--estimate"), style("--truth")],
      series: {
        set: { strokePattern: [6, 4], stepPlot: true },
        true: { strokePattern: [3, 3] },
      },
      strokeWidth: 1.6,
      interactionModel: {},
      highlightCircleSize: 0,
      axisLabelColor: muted,
      axisLineColor: style("--grid"),
      gridLineColor: style("--grid"),
      axes: {
        x: { axisLabelFormatter: (seconds) => `${seconds.toFixed(0)} s`, pixelsPerLabel: 60 },
        y: { axisLabelWidth: 36, pixelsPerLabel: 24 },
      },
    };
  }

  // The colours are options of a chart: others need another one.
  #begin() {
    for (const side of this.sides) {
      this.charts[side]?.destroy();
      delete this.charts[side];
    }
    this.fresh = this.rows.left.length > 0;
  }

  #describe() {
    const say = (side) => {
      const [, set, estimate, truth] = this.rows[side].at(-1);
      const known = [["set", set], ["estimated", estimate], ["true", truth]].filter(
        ([, speed]) => speed !== null);
      return `${side}: ${known.map(([name, speed]) => `${name} ${fixed(speed)}`).join(", ")}`;
    };
    setText(byId("speeds-now"), this.sides.map(say).join(" · "));
  }
}

// Its legend writes style attributes, which the page's policy forbids; this page has its own.
function withoutLegend() {
  Dygraph.PLUGINS = Dygraph.PLUGINS.filter((plugin) => plugin !== Dygraph.Plugins.Legend);
}

const value = (speeds, side) => speeds?.[side] ?? null;

// All of it, and never so little that noise looks like driving.
function range(rows) {
  let [low, high] = [-60, 60];
  for (const row of rows) {
    for (let i = 1; i < row.length; i += 1) {
      low = Math.min(low, (row[i] ?? 0) - 20);
      high = Math.max(high, (row[i] ?? 0) + 20);
    }
  }
  return [low, high];
}
