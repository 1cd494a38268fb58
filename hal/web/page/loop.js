// How the loop does: its latencies, and what it counts.

import { byId, fitCanvas, make, onColours, oncePerFrame, setText, style, words } from "./dom.js";

const kTimes = [["frame_to_command_ns", "latency", "frame to command"],
  ["period_ns", "period", "period"]];
const kColumns = ["min", "p50", "p99", "p999", "max"];
const kCounters = ["unsent", "withheld", "refused", "clients", "missed"];

export class Loop {
  constructor(link) {
    this.rows = kTimes.map(([, , label]) => {
      const cells = kColumns.map(() => make("td", {}, "–"));
      byId("latency-table").tBodies[0].append(
        make("tr", {}, make("th", { scope: "row" }, label), ...cells));
      return cells;
    });
    this.counters = new Map();
    this.draw = oncePerFrame(() => this.#draw());
    link.addEventListener("statistics", ({ detail }) => {
      this.statistics = detail;
      this.draw();
    });
    for (const [, id] of kTimes) new ResizeObserver(() => this.draw()).observe(byId(id));
    onColours(() => this.draw());
  }

  #draw() {
    const { statistics } = this;
    if (!statistics) return;
    kTimes.forEach(([key, id], i) => {
      const times = statistics[key] ?? {};
      kColumns.forEach((column, at) => setText(this.rows[i][at], microseconds(times[column])));
      drawHistogram(byId(id), times.histogram ?? []);
    });
    this.#count("frames", statistics.frames);
    this.#count("overruns", statistics.overruns);
    for (const name of kCounters) this.#set(name, statistics[name]);
  }

  #count(group, counts) {
    for (const [name, value] of Object.entries(counts ?? {})) this.#set(`${group} ${name}`, value);
  }
  #set(name, value) {
    if (value === undefined) return;
    if (!this.counters.has(name)) {
      const cell = make("dd");
      this.counters.set(name, cell);
      byId("counters").append(make("div", {}, make("dt", {}, words(name)), cell));
    }
    setText(this.counters.get(name), String(value));
  }
}

const microseconds = (ns) => (ns === undefined || ns === null ? "–"
  : (ns / 1000).toFixed(ns < 100000 ? 1 : 0));

// Both axes by powers: a single late cycle among millions is still seen. [upper end in ns, count]
function drawHistogram(canvas, buckets) {
  const { width, height } = fitCanvas(canvas);
  const c = canvas.getContext("2d");
  c.clearRect(0, 0, width, height);
  const filled = buckets.filter(([end, count]) => count > 0 && end > 0);
  if (filled.length === 0) return;
  const low = Math.floor(Math.log10(filled[0][0]) * 4 - 1) / 4;
  const high = Math.max(Math.ceil(Math.log10(filled.at(-1)[0]) * 4 + 1) / 4, low + 1);
  const most = Math.log10(Math.max(...filled.map(([, count]) => count)) + 1);
  const foot = height - 16;
  const x = (ns) => ((Math.log10(ns) - low) / (high - low)) * width;
  drawDecades(c, x, low, high, foot, width);
  c.fillStyle = style("--estimate");
  for (const [end, count] of filled) {
    const tall = Math.max((Math.log10(count + 1) / most) * (foot - 4), 2);
    c.fillRect(x(end) - 2, foot - tall, 4, tall);
  }
}

function drawDecades(c, x, low, high, foot, width) {
  c.strokeStyle = style("--grid");
  c.fillStyle = style("--muted");
  c.font = "12px system-ui, sans-serif";
  c.lineWidth = 1;
  for (let decade = Math.ceil(low); decade <= high; decade += 1) {
    const at = Math.min(Math.max(x(10 ** decade), 0.5), width - 0.5);
    c.beginPath();
    c.moveTo(at, 0);
    c.lineTo(at, foot);
    c.stroke();
    const us = 10 ** (decade - 3);
    const label = us >= 1000 ? `${us / 1000} ms` : `${us} µs`;
    c.fillText(label, Math.min(at + 3, width - c.measureText(label).width), foot + 13);
  }
  c.beginPath();
  c.moveTo(0, foot + 0.5);
  c.lineTo(width, foot + 0.5);
  c.stroke();
}
