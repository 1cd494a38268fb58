// Acting on a virtual Create: what its control socket takes, as the feed lists it. How a command is
// offered follows from its arguments: words to choose from are buttons, others are typed.

import { byId, make, setText, words } from "./dom.js";

const kElsewhere = ["fault", "state", "help"]; // the faults are listed below, the state is shown
const kMostButtons = 16;

export class VirtualCreate {
  constructor(link) {
    this.link = link;
    this.cells = new Map();
    link.addEventListener("hello", ({ detail }) => {
      byId("virtual").hidden = detail.robot !== "virtual Create";
    });
    link.addEventListener("controls", ({ detail }) => this.#offer(detail));
    link.addEventListener("virtual_create", ({ detail }) => this.#showState(detail.state));
  }

  #offer({ controls, faults }) {
    const listed = JSON.stringify([controls, faults]);
    if (listed === this.listed) return; // it comes again with each connection: keep what is typed
    this.listed = listed;
    byId("controls").replaceChildren(...controls
      .filter(({ name }) => !kElsewhere.includes(name))
      .map((control) => this.#row(control, control.name)));
    byId("faults").replaceChildren(
      ...faults.map((fault) => this.#row(fault, `fault ${fault.name}`)));
  }

  #row({ name, arguments: wanted, meaning }, command) {
    const group = make("fieldset", {}, make("legend", {}, words(name).replaceAll("-", " ")),
      make("p", {}, meaning));
    const choices = choose(wanted);
    group.append(choices ? this.#buttons(command, choices) : this.#form(command, wanted));
    return group;
  }

  // Those that end in the same pair of words, like on and off, are a line for each pair.
  #buttons(command, choices) {
    const lines = new Map();
    for (const choice of choices) {
      const head = choice.slice(0, -1).map(words).join(" ");
      if (!lines.has(head)) lines.set(head, []);
      lines.get(head).push(this.#button(command, choice));
    }
    const parts = [...lines].map(([head, buttons]) =>
      make("div", {}, ...(head === "" ? [] : [make("span", {}, head)]), ...buttons));
    return make("div", { className: "choices" }, ...parts);
  }

  #button(command, choice) {
    const line = [command, ...choice].join(" ");
    const label = words(choice.at(-1) ?? "do it");
    const name = `${[command, ...choice.slice(0, -1)].join(" ").replace(/[_-]/g, " ")}: ${label}`;
    return make("button", { type: "button", "aria-label": name, "data-line": line,
      onclick: () => this.#say(line) }, label);
  }

  #form(command, wanted) {
    const input = make("input", { placeholder: wanted, autocomplete: "off", spellcheck: false,
      "aria-label": `${command}: ${wanted}` });
    const send = (event) => {
      event.preventDefault();
      this.#say(`${command} ${input.value}`.trim());
    };
    return make("form", { onsubmit: send }, input, make("button", {}, "Do"));
  }

  async #say(line) {
    const answer = await this.link.request({ do: "control", line }).catch((error) => ({
      ok: false,
      error: error.message,
    }));
    const said = answer.ok ? answer.result ?? "done" : answer.error;
    setText(byId("control-answer"), `${line}: ${said}`);
    byId("control-answer").dataset.level = answer.ok ? "ok" : "bad";
  }

  #showState(state, prefix = "") {
    if (!byId("virtual-state").closest("details").open) return;
    for (const [key, value] of Object.entries(state)) {
      const name = `${prefix}${words(key)}`;
      if (value !== null && typeof value === "object" && !Array.isArray(value)) {
        this.#showState(value, `${name}: `);
        continue;
      }
      if (!this.cells.has(name)) {
        const cell = make("td");
        this.cells.set(name, cell);
        byId("virtual-state").tBodies[0].append(
          make("tr", {}, make("th", { scope: "row" }, name), cell));
      }
      setText(this.cells.get(name), String(value ?? "–"));
    }
  }
}

// All that can be said with these arguments, each a list of words; null if something is to be typed
// or they are too many. What may be left out, in brackets, is left out.
export function choose(wanted) {
  const tokens = wanted.replace(/\[[^\]]*\](\.\.\.)?/g, "").trim().split(/\s+/).filter(Boolean);
  if (tokens.length === 0 && /[A-Z]/.test(wanted) && /\[NAME|\[WORDS/.test(wanted)) return null;
  let lines = [[]];
  for (const token of tokens) {
    if (/[A-Z]/.test(token)) return null;
    lines = lines.flatMap((line) => token.split("|").map((word) => [...line, word]));
  }
  return lines.length <= kMostButtons ? lines : null;
}
