// Moving the map by mouse, fingers and keys, and moving a virtual Create on it.

import { byId, setAttribute } from "./dom.js";
import { toDegrees } from "./frames.js";

const kZoom = 1.4;
const kPan_px = 60;
const kPlaces_ms = 100; // between two places on the way, so that the server is not flooded

export class MapHands {
  constructor(map, link) {
    this.map = map;
    this.link = link;
    this.pointers = new Map();
    this.carrying = null;
    this.dragging = false;
    this.#listenToButtons();
    this.#listenToPointers();
    map.canvas.addEventListener("keydown", (event) => this.#key(event));
    link.addEventListener("hello", ({ detail }) => {
      byId("drag").hidden = detail.robot !== "virtual Create";
      if (byId("drag").hidden) this.#setDragging(false);
    });
  }

  #listenToButtons() {
    const zoom = (factor) => () => {
      this.map.view.zoom(factor);
      this.map.draw();
    };
    byId("zoom-in").onclick = zoom(kZoom);
    byId("zoom-out").onclick = zoom(1 / kZoom);
    byId("fit").onclick = () => this.map.fit();
    byId("follow").onclick = () => this.#setFollowing(!this.map.following);
    byId("drag").onclick = () => this.#setDragging(!this.dragging);
  }

  #setFollowing(on) {
    this.map.following = on;
    setAttribute(byId("follow"), "aria-pressed", String(on));
    this.map.draw();
  }
  #setDragging(on) {
    this.dragging = on;
    setAttribute(byId("drag"), "aria-pressed", String(on));
    this.map.canvas.classList.toggle("dragging", on);
  }

  #listenToPointers() {
    const { canvas } = this.map;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, this.#at(event));
      if (this.dragging) this.#carry(event);
    });
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => {
        if (this.carrying && end === "pointerup") this.#put();
        this.carrying = null;
        this.pointers.delete(event.pointerId);
      });
    }
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.map.view.zoom(Math.exp(-event.deltaY / 400), ...this.#at(event));
      this.map.draw();
    }, { passive: false });
  }

  #at(event) {
    const box = this.map.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // One pointer moves the floor, two zoom it; with `Move robot`, the robot is carried.
  #move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = this.#at(event);
    if (this.carrying) {
      this.#carry(event);
      return;
    }
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    const { view } = this.map;
    if (other) {
      const apart = ([x, y]) => Math.max(Math.hypot(x - other[0], y - other[1]), 1);
      view.zoom(apart(now) / apart(before), ...other);
    } else {
      view.pan(now[0] - before[0], now[1] - before[1]);
      if (Math.hypot(now[0] - before[0], now[1] - before[1]) > 2) this.#setFollowing(false);
    }
    this.pointers.set(event.pointerId, now);
    this.map.draw();
  }

  #carry(event) {
    this.carrying = this.map.view.floor(...this.#at(event));
    const now = performance.now();
    if (now - (this.put_ms ?? -kPlaces_ms) < kPlaces_ms) return;
    this.put_ms = now;
    this.#put();
  }
  #put() {
    const { x_mm, y_mm } = this.carrying;
    const heading = toDegrees(this.map.truth?.heading_rad ?? 0);
    const place = [x_mm, y_mm, heading].map((value) => value.toFixed(1)).join(" ");
    this.link.send({ do: "control", line: `place ${place}` });
  }

  // The arrows and letters are the steering's: here only + - and Shift with the arrows.
  #key(event) {
    const pan = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const { view } = this.map;
    if (event.key === "+" || event.key === "=") view.zoom(kZoom);
    else if (event.key === "-") view.zoom(1 / kZoom);
    else if (event.shiftKey && pan[event.key]) {
      view.pan(...pan[event.key].map((way) => way * kPan_px));
      this.#setFollowing(false);
    } else return;
    event.preventDefault();
    event.stopPropagation();
    this.map.draw();
  }
}
