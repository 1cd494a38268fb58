// What happened, the newest first.

import { byId, make, setText, words } from "./dom.js";

const kMost = 200;
const kSay_ms = 1500; // a screen reader that is told each of a hundred says nothing of use

export class Events {
  constructor(link) {
    this.list = byId("events");
    this.unsaid = [];
    byId("clear-events").onclick = () => this.list.replaceChildren();
    link.addEventListener("hello", ({ detail }) => this.#meet(detail));
    link.addEventListener("event", ({ detail }) => this.#take(detail));
    link.addEventListener("status", ({ detail }) => this.#addStage(detail));
    link.addEventListener("down", () => this.#add("link", null, "this page lost its connection"));
  }

  // The newest event comes again with each connection.
  #meet({ pid }) {
    if (pid !== this.pid) this.last = -1;
    this.pid = pid;
  }
  #take({ sequence, what, robot_time_s, text }) {
    if (sequence !== undefined && sequence <= this.last) return;
    this.last = sequence ?? this.last;
    this.#add(what, robot_time_s, text);
  }
  #addStage({ stage, text }) {
    if (stage === this.stage) return;
    this.stage = stage;
    this.#add(stage, null, text || words(stage));
  }

  #add(what, time_s, text) {
    const when = time_s === null || time_s === undefined ? "" : `${time_s.toFixed(1)} s`;
    this.list.prepend(make("li", { "data-what": what }, make("span", { className: "when" }, when),
      make("code", {}, what), make("span", {}, text)));
    while (this.list.childElementCount > kMost) this.list.lastElementChild.remove();
    this.unsaid.push(text);
    this.timer ??= setTimeout(() => this.#say(), kSay_ms);
  }
  #say() {
    this.timer = null;
    const more = this.unsaid.length - 3;
    const said = this.unsaid.slice(-3).join(". ");
    setText(byId("said"), more > 0 ? `${more} events and then: ${said}` : said);
    this.unsaid = [];
  }
}
