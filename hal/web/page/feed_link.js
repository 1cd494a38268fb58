// The feed over a WebSocket (docs/feed.md). It connects again by itself, gives each message to who
// listens for its type, pairs requests with answers, and counts what this page could not see.

const kFirstWait_ms = 250;
const kLongestWait_ms = 4000;
const kSilence_ms = 3000; // statistics come each second: after that it asks
const kAnswer_ms = 2000;

const kTypes = ["state", "sensors", "statistics", "truth", "virtual_create", "world", "controls"];
const kEvery = 2; // of 67 a second: more than a screen of this size can show

// Events: each message as its `type`, with the message as `detail`; `up` and `down` of the link;
// `gap` when `missed` or `away` has changed.
export class FeedLink extends EventTarget {
  constructor(url) {
    super();
    this.url = url;
    this.up = false;
    this.missed = 0; // messages that the feed dropped because this page was slow
    this.away = { times: 0, seconds: 0 };
    this.answers = new Map();
    this.nextId = 1;
    this.wait_ms = kFirstWait_ms;
    this.heard = 0;
    this.downSince = null;
    this.timer = null; // of the next attempt
    this.asking = false;
    this.watch = setInterval(() => this.#checkSilence(), 1000);
    addEventListener("online", () => this.#hurry());
    addEventListener("visibilitychange", () => document.hidden || this.#hurry());
  }

  open() {
    this.timer = null;
    const socket = new WebSocket(this.url);
    this.socket = socket;
    socket.onmessage = ({ data }) => {
      if (socket !== this.socket) return; // given up, and too late
      for (const line of String(data).split("\n")) if (line) this.#take(line);
    };
    socket.onclose = () => socket === this.socket && this.#lost();
  }

  // Resolves to the answer, whether it is `ok` or not; rejects if none came.
  request(message) {
    return new Promise((resolve, reject) => {
      const id = this.nextId++;
      if (!this.send({ ...message, id })) {
        reject(new Error("not connected"));
        return;
      }
      const late = () => this.#end(id, () => reject(new Error("no answer")));
      this.answers.set(id, { resolve, reject, timer: setTimeout(late, kAnswer_ms) });
    });
  }

  // Without an answer. False if it could not be sent.
  send(message) {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  #take(line) {
    this.heard = performance.now();
    let message;
    try {
      message = JSON.parse(line);
    } catch {
      return; // half a line can only come from a server that is being killed
    }
    if (message.type === "hello") this.#greeted();
    if (message.type === "missed") {
      this.missed += message.messages;
      this.#tell("gap", this);
    }
    if (message.type === "answer" && message.id !== undefined) {
      this.#end(message.id, ({ resolve }) => resolve(message));
    }
    this.#tell(message.type, message);
  }

  #greeted() {
    this.send({ do: "subscribe", types: kTypes, every: kEvery });
    this.wait_ms = kFirstWait_ms;
    this.up = true;
    if (this.downSince !== null) {
      this.away.times += 1;
      this.away.seconds += (performance.now() - this.downSince) / 1000;
      this.downSince = null;
      this.#tell("gap", this);
    }
    this.#tell("up");
  }

  #lost() {
    const was = this.up;
    this.up = false;
    if (was) this.downSince = performance.now();
    for (const id of [...this.answers.keys()]) {
      this.#end(id, ({ reject }) => reject(new Error("the connection was lost")));
    }
    this.timer = setTimeout(() => this.open(), this.wait_ms);
    this.wait_ms = Math.min(2 * this.wait_ms, kLongestWait_ms);
    this.#tell("down");
  }

  // A network that was cut says nothing: only a question that stays without answer shows it.
  #checkSilence() {
    if (!this.up || this.asking || performance.now() - this.heard < kSilence_ms) return;
    this.asking = true;
    this.request({ do: "subscribe", types: kTypes, every: kEvery })
      .catch(() => this.up && this.#abandon())
      .finally(() => (this.asking = false));
  }
  #abandon() {
    const socket = this.socket;
    this.socket = null;
    socket.close();
    this.#lost();
  }

  #hurry() {
    if (this.timer === null) return;
    clearTimeout(this.timer);
    this.open();
  }

  #end(id, finish) {
    const answer = this.answers.get(id);
    if (!answer) return;
    clearTimeout(answer.timer);
    this.answers.delete(id);
    finish(answer);
  }
  #tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }
}
