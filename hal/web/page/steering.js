// Who steers, and with what setpoint. A setpoint is sent only while something is held: a key, the
// stick, the gamepad. Letting go, looking away or losing the connection stops the robot.

import { byId, fixed, setAttribute, setText } from "./dom.js";
import { warn } from "./status.js";

const kEvery_ms = 100; // before the setpoint lapses

const kStand = { do: "drive", velocity_mm_s: 0, turn_rate_rad_s: 0 };

export class Steering {
  constructor(link) {
    this.link = link;
    this.hello = null;
    this.holding = false;
    this.losses = 0; // of the lease, or of the wish to have it
    this.holder = null;
    this.lease = null; // the number of ours
    this.held = new Map(); // what is held, by its source: {forward, turn}, each -1 to 1
    this.timer = null;
    byId("name").value = storedName();
    this.#listenToLink();
    this.#listenToButtons();
    this.#stopWhenUnseen();
    this.#show();
  }

  // Called by a key, the stick or the gamepad: what it wants now, or null when it was let go.
  want(source, wish) {
    const before = this.held.size;
    if (wish && this.holding) this.held.set(source, wish);
    else this.held.delete(source);
    if (this.held.size === 0 && before > 0) this.#rest();
    if (this.held.size > 0 && before === 0) {
      this.timer = setInterval(() => this.#send(), kEvery_ms);
      this.#send();
    }
    this.#showWish();
  }

  // From anybody, and whoever steers.
  async stop() {
    const answered = this.#answerTo({ do: "stop" });
    this.#lostLease();
    const answer = await answered;
    warn(answer.ok ? "Stopped." : `This page could not stop the robot: ${answer.error}`);
  }

  // What all that is held asks for together.
  wish() {
    let [forward, turn] = [0, 0];
    for (const each of this.held.values()) {
      forward += each.forward;
      turn += each.turn;
    }
    const clamp = (value) => Math.min(Math.max(value, -1), 1);
    return {
      velocity_mm_s: clamp(forward) * Number(byId("speed").value),
      turn_rate_rad_s: (clamp(turn) * Number(byId("turn").value) * Math.PI) / 180,
    };
  }

  #listenToLink() {
    this.link.addEventListener("hello", ({ detail }) => {
      this.hello = detail;
      if (detail.max_speed_mm_s) byId("speed").max = detail.max_speed_mm_s;
      this.#show();
    });
    this.link.addEventListener("holder", ({ detail }) => {
      this.holder = detail.name ?? null;
      if (this.holding && detail.lease !== this.lease) this.#deprived();
      this.#show();
    });
    this.link.addEventListener("down", () => {
      this.holder = null;
      this.#lostLease();
    });
    this.link.addEventListener("status", ({ detail }) => {
      byId("rearm").hidden = detail.stage !== "driving";
    });
  }

  #listenToButtons() {
    byId("stop").onclick = () => this.stop();
    byId("hold").onclick = () => this.#hold();
    byId("release").onclick = () => this.#giveBack();
    byId("rearm").onclick = () => this.#ask({ do: "rearm" });
    byId("reset").onclick = () =>
      this.#ask({ do: "reset_odometry", x_mm: 0, y_mm: 0, heading_rad: 0 });
    for (const id of ["speed", "turn"]) byId(id).oninput = () => this.#show();
  }

  // A hidden tab's timers sleep, and who looks elsewhere does not see the robot.
  #stopWhenUnseen() {
    addEventListener("blur", () => this.#letGo());
    addEventListener("visibilitychange", () => document.hidden && this.#giveBack());
    addEventListener("pagehide", () => this.#giveBack());
  }

  // The button says from whom it takes, and only then does it take.
  async #hold() {
    const taken = this.holder;
    const { losses } = this;
    this.name = byId("name").value.trim() || storedName();
    store(this.name);
    const answer = await this.#ask({ do: "hold", name: this.name, ...(taken && { take: true }) });
    if (!answer.ok) return;
    this.holding = true;
    this.lease = answer.result?.lease;
    if (document.hidden || losses !== this.losses) {
      this.#giveBack(); // it was hidden, or stopped, while the answer was on its way
      return;
    }
    clearInterval(this.renewal);
    this.renewal = setInterval(() => this.#renew(), kEvery_ms);
    this.#show();
    warn("");
    byId("stick").focus({ preventScroll: true });
    if (matchMedia("(max-width: 60rem)").matches) byId("map").scrollIntoView();
  }

  // The lease lapses when its holder says nothing for a while. While nothing is held, this page
  // asks for standing still. It does not ask for the lease: that may just have ended with a stop.
  async #renew() {
    if (this.held.size > 0) return;
    const answer = await this.#answerTo(kStand);
    if (answer.unanswered && this.holding) this.#giveBack();
  }
  #stand() {
    if (this.holding) this.link.send(kStand);
  }

  // By somebody else, who may have the same name: so have two tabs of one browser.
  #deprived() {
    this.#lostLease();
    if (this.holder !== null) {
      warn(`${this.holder === this.name ? "Another " : ""}${this.holder} steers now.`);
    } else if (byId("alert").hidden) { // or it says why
      warn("You no longer steer: the robot was stopped.");
    }
  }

  #giveBack() {
    this.#letGo();
    if (this.holding) this.link.send({ do: "release" });
    this.#lostLease();
  }

  #letGo() {
    const before = this.held.size;
    this.held.clear();
    if (before > 0) this.#rest();
    this.link.dispatchEvent(new CustomEvent("let-go"));
    this.#showWish();
  }

  #lostLease() {
    this.holding = false;
    this.losses += 1;
    clearInterval(this.renewal);
    this.#letGo();
    this.#show();
  }

  // Nothing is held any longer.
  #rest() {
    clearInterval(this.timer);
    this.timer = null;
    this.#stand();
  }

  async #send() {
    const answer = await this.#answerTo({ do: "drive", ...this.wish() });
    if (answer.ok || this.held.size === 0) return;
    // What a network has swallowed it may deliver later: nothing that moves follows.
    if (answer.unanswered) this.#giveBack();
    else this.#letGo();
    warn(`Not driving: ${answer.error}`);
  }

  #answerTo(request) {
    return this.link.request(request).catch(({ message }) => (
      { ok: false, error: message, unanswered: true }));
  }
  async #ask(request) {
    const answer = await this.#answerTo(request);
    setText(byId("refusal"), answer.ok ? "" : answer.error);
    return answer;
  }

  #show() {
    const able = this.link.up && this.hello?.steerable !== false;
    const other = this.holder !== null && !this.holding;
    document.body.classList.toggle("steering", this.holding);
    byId("hold").hidden = this.holding;
    byId("hold").disabled = !able;
    setText(byId("hold"), other ? `Take it from ${this.holder}` : "Steer");
    byId("hold").classList.toggle("taking", other);
    byId("release").hidden = !this.holding;
    byId("name").disabled = this.holding;
    byId("rearm").disabled = byId("reset").disabled = !this.holding;
    setAttribute(byId("stick"), "aria-disabled", String(!this.holding));
    const nobody = able ? "nobody steers"
      : this.link.up ? "only cargobay serve can be steered" : "not connected";
    setText(byId("holder"), this.holding ? "you steer" : other ? `${this.holder} steers` : nobody);
    byId("holder").dataset.level = this.holding ? "ok" : other ? "warn" : "";
    setText(byId("speed-value"), `${byId("speed").value} mm/s`);
    setText(byId("turn-value"), `${byId("turn").value} °/s`);
    this.#showWish();
  }

  #showWish() {
    const { velocity_mm_s, turn_rate_rad_s } = this.wish();
    const degrees = (turn_rate_rad_s * 180) / Math.PI;
    setText(byId("wanted"), this.held.size === 0 ? "nothing is held"
      : `${fixed(velocity_mm_s)} mm/s, ${fixed(degrees)} °/s`);
  }
}

// A name by which people know this browser. One that keeps nothing makes another one each time.
function storedName() {
  const made = `browser ${crypto.getRandomValues(new Uint16Array(1))[0].toString(36)}`;
  try {
    return localStorage.getItem("name") || made;
  } catch {
    return made;
  }
}
function store(name) {
  try {
    localStorage.setItem("name", name);
  } catch {
    // It is asked for again.
  }
}
