// What is held: keys, the stick for thumbs, a gamepad. Each tells the steering what it wants.

import { byId } from "./dom.js";

const kKeys = {
  KeyW: [1, 0], ArrowUp: [1, 0], KeyS: [-1, 0], ArrowDown: [-1, 0],
  KeyA: [0, 1], ArrowLeft: [0, 1], KeyD: [0, -1], ArrowRight: [0, -1],
};
const kDeadZone = 0.15;
const kLook_ms = 20;
const kSilence_ms = 2000; // as cargobay-gamepad has it
const kStopButton = 1; // B on most
const kTextFields = "input:not([type=range]), textarea, select, [contenteditable]";
const kPressable = "button, a, summary, [role=button]";

export class Keys {
  constructor(steering) {
    this.steering = steering;
    this.down = new Set();
    addEventListener("keydown", (event) => this.#press(event));
    addEventListener("keyup", (event) => this.#release(event));
    // Menus, and what is dragged, keep the end of a key to themselves.
    for (const taker of ["contextmenu", "dragstart"]) addEventListener(taker, () => this.#letGo());
    steering.link.addEventListener("let-go", () => this.down.clear());
  }

  #press(event) {
    if (event.key === "Escape" || this.#isStop(event)) {
      event.preventDefault();
      if (!event.repeat) this.steering.stop();
      return;
    }
    // So do browsers and desktops with what is pressed together with these.
    if (event.metaKey || event.ctrlKey || event.altKey) this.#letGo();
    if (!this.#drives(event)) return;
    event.preventDefault();
    // A key that was down when the robot was stopped has to be pressed again.
    if (event.repeat) return;
    this.down.add(event.code);
    this.#tell();
  }

  #release(event) {
    if (!this.down.delete(event.code)) return;
    this.#tell();
  }

  #letGo() {
    if (this.down.size === 0) return;
    this.down.clear();
    this.#tell();
  }

  // Space types, and presses buttons; while this page steers it presses only the stop.
  #isStop({ code, target }) {
    if (code !== "Space" || target.matches?.(kTextFields)) return false;
    return this.steering.holding || !target.matches?.(kPressable);
  }

  #drives({ code, target, ctrlKey, altKey, metaKey, shiftKey }) {
    if (ctrlKey || altKey || metaKey || shiftKey || !(code in kKeys)) return false;
    return this.steering.holding && !target.matches?.(`${kTextFields}, input`);
  }

  #tell() {
    let [forward, turn] = [0, 0];
    for (const code of this.down) {
      forward += kKeys[code][0];
      turn += kKeys[code][1];
    }
    this.steering.want("keys", this.down.size > 0 ? { forward, turn } : null);
  }
}

export class Stick {
  constructor(steering) {
    this.steering = steering;
    this.stick = byId("stick");
    this.pointer = null;
    this.stick.addEventListener("pointerdown", (event) => this.#down(event));
    this.stick.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      this.stick.addEventListener(end, (event) => this.#up(event));
    }
    this.stick.addEventListener("contextmenu", (event) => event.preventDefault());
    steering.link.addEventListener("let-go", () => this.#rest());
  }

  #down(event) {
    if (this.pointer !== null || !this.steering.holding) return;
    this.pointer = event.pointerId;
    this.box = this.stick.getBoundingClientRect(); // it keeps its middle, whatever the page does
    this.stick.setPointerCapture(event.pointerId);
    this.#move(event);
  }

  #move(event) {
    if (event.pointerId !== this.pointer) return;
    const radius = this.box.width / 2;
    let x = (event.clientX - this.box.left - radius) / (0.7 * radius);
    let y = (event.clientY - this.box.top - radius) / (0.7 * radius);
    const far = Math.max(Math.hypot(x, y), 1);
    [x, y] = [x / far, y / far];
    byId("knob").style.translate = `${x * 0.7 * radius}px ${y * 0.7 * radius}px`;
    this.steering.want("stick", { forward: -withDeadZone(y), turn: -withDeadZone(x) });
  }

  #up(event) {
    if (event.pointerId !== this.pointer) return;
    this.#rest();
    this.steering.want("stick", null);
  }

  #rest() {
    this.pointer = null;
    byId("knob").style.translate = "";
  }
}

// The browser says only that a gamepad is there; what it does has to be asked for.
export class Gamepads {
  constructor(steering) {
    this.steering = steering;
    this.timer = null;
    this.free = true; // since the last stop, the sticks have been at rest
    addEventListener("gamepadconnected", () => this.#look());
    addEventListener("gamepaddisconnected", () => steering.want("gamepad", null));
    steering.link.addEventListener("let-go", () => (this.free = false));
  }

  // By a timer, as setpoints are sent: frames on the screen may cease while those go on.
  #look() {
    this.timer ??= setInterval(() => {
      const pad = navigator.getGamepads().find((each) => each?.connected);
      if (pad) {
        this.#read(pad);
        return;
      }
      clearInterval(this.timer);
      this.timer = null;
      this.steering.want("gamepad", null);
    }, kLook_ms);
  }

  #read(pad) {
    const pressed = pad.buttons[kStopButton]?.pressed ?? false;
    if (pressed && !this.pressed) this.steering.stop();
    this.pressed = pressed;
    const forward = -withDeadZone(pad.axes[1] ?? 0);
    const turn = -withDeadZone(pad.axes[0] ?? 0);
    const rests = forward === 0 && turn === 0;
    if (rests) this.free = true;
    else if (this.#isSilent(pad)) this.free = false;
    if (rests && !this.steering.held.has("gamepad")) return;
    this.steering.want("gamepad", rests || !this.free ? null : { forward, turn });
  }
  // One whose radio link is lost stays as it was, and so does a stick that is held against its end.
  #isSilent({ timestamp }) {
    const now = performance.now();
    if (timestamp === undefined || timestamp !== this.heard?.timestamp)
      this.heard = { timestamp, at: now };
    return now - this.heard.at >= kSilence_ms;
  }
}

// From the zone's edge to 1, without a step.
function withDeadZone(value) {
  const beyond = Math.max(Math.abs(value) - kDeadZone, 0) / (1 - kDeadZone);
  return Math.sign(value) * Math.min(beyond, 1) || 0;
}
