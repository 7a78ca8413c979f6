// The threads that were cut, as an inspector measures them: a sheet for each, and the profile of the one that is chosen.

import { COLOURS, View, colour, grid } from "./view.js";
import { word } from "./words.js";

const MILLIMETRE = 1e6;

export class Measured {
  constructor({ list, canvas }) {
    this.list = list;
    this.view = new View(canvas, { equal: true, draw: (...all) => this.#draw(...all) });
    this.clear();
  }

  clear() {
    this.threads = [];
    this.chosen = null;
    this.say();
  }

  add(threads) {
    if (!threads.length) return;
    this.threads.push(...threads);
    this.say();
    this.#choose(this.threads.at(-1));
  }

  // Everything in the language that is in force.
  say() {
    this.list.replaceChildren(...this.threads.map((thread) => this.#sheet(thread)));
  }

  #choose(thread) {
    this.chosen = thread;
    const along = (place) => thread.profile.map((point) => point[place]);
    const [z, x] = [along(0), along(1)];
    if (z.length) this.view.show([Math.min(...z), Math.max(...z), Math.min(...x), Math.max(...x)]);
    this.view.fit();
  }

  #sheet(thread) {
    const sheet = element("details");
    const verdict = thread.measured ? { true: "within", false: "out" }[thread.good] ?? "unjudged" : "none";
    const name = thread.name || `${thread.major.toFixed(3)} × ${thread.pitch.toFixed(3)}, ${word("no_norm")}`;
    const title = element("summary", `${word("line")} ${thread.line}: ${name} · ${word(verdict)}`);
    title.className = thread.good === false ? "out" : "";
    title.addEventListener("click", () => this.#choose(thread));
    sheet.append(title);
    if (thread.measured) sheet.append(diameters(thread.measured.rows), element("p", details(thread.measured)));
    if (thread.cut_in) sheet.append(element("p", `${word("cut_in")}: ${word(thread.cut_in)}`));
    if (thread.chips.length) sheet.append(chips(thread.chips));
    sheet.open = thread === this.threads.at(-1);
    return sheet;
  }

  #draw(context, at, size) {
    grid(context, at, size, MILLIMETRE);
    if (!this.chosen) return;
    context.strokeStyle = COLOURS[0];
    context.lineWidth = 1.6;
    context.beginPath();
    for (const [z, x] of this.chosen.profile) context.lineTo(...at(z, x));
    context.stroke();
    context.fillStyle = colour("quiet");
    context.fillText(this.chosen.name, 8, 14);
  }
}

function element(kind, text) {
  const made = document.createElement(kind);
  if (text !== undefined) made.textContent = text;
  return made;
}

function table(heads, rows) {
  const made = element("table");
  const line = (kind, cells) => {
    const row = element("tr");
    row.append(...cells.map((cell) => element(kind, cell)));
    return row;
  };
  made.append(line("th", heads), ...rows.map((cells) => line("td", cells)));
  return made;
}

function diameters(rows) {
  const mm = (value) => (value === null ? "–" : value.toFixed(4));
  const judged = (good) => ({ true: "✓", false: "✖" })[good] ?? "–";
  const cells = rows.map((row) => [word(row.feature), mm(row.low), mm(row.high), mm(row.found), judged(row.good)]);
  return table([word("diameter"), word("lowest"), word("highest"), word("found"), ""], cells);
}

function details({ flanks, lead, sway, turns, gauges }) {
  const told = [
    `${word("flanks")} ${flanks.map((angle) => `${angle.toFixed(2)}°`).join(", ")}`,
    `${word("lead")} ${lead.toFixed(1)} µm`,
    `${word("sway")} ${sway.toFixed(1)} µm`,
    `${turns.toFixed(1)} ${word("turns")}`,
  ];
  if (gauges) told.push(word(gauges[0] ? "go" : "go_not"), word(gauges[1] ? "no_go" : "no_go_in"));
  return told.join(" · ");
}

// What each pass takes off, on both sides of the tool's middle: what cut-in modes are for.
function chips(chips) {
  const mm3 = (value) => value.toFixed(1);
  const box = element("div");
  box.className = "chips";
  const cells = chips.map(([pass, minus, plus]) => [String(pass), mm3(minus), mm3(plus)]);
  box.append(table([word("pass"), "−Z mm³", "+Z mm³"], cells));
  return box;
}
