// The threads that were cut, pass by pass: where the groove of each lies beside where it should, in micrometres, with the
// uncertainty. Each thing that can be known has a shape of its own. It must not know how the figures have come.

import { isChinese, word } from "./words.js";

const at = (id) => document.getElementById(id);
const SPACE = "http://www.w3.org/2000/svg";
const WIDE = 24;
const GAP = 20;
const HIGH = 180;
// The chart above and below the figures.
const [TOP, LOW] = [12, 34];
// A chart is not lower than this many micrometres to either side.
const LEAST = 0.5;

const KINDS = { thread: () => word("legend_thread"), rigid_tap: () => word("rigid_tap"), floating_tap: () => word("floating_tap") };
const STATES = { under_way: () => word("under_way"), finished: () => "", cut_short: () => word("cut_short") };

let told = [];

const figure = (um) => (Math.abs(um) < 0.005 ? "0" : um.toFixed(2)).replace("-", "−");
// An uncertainty is rounded up.
const upwards = (um) => (Math.ceil(um * 10 - 1e-6) / 10).toFixed(1);

// A pass in words.
function said(pass) {
  if (!pass) return word("unknown");
  const { least, most, most_u } = pass;
  return `${least === most ? figure(most) : `${figure(least)} … ${figure(most)}`} ± ${upwards(most_u)}`;
}

function shape(name, attributes, text) {
  const made = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text) made.textContent = text;
  return made;
}

const line = (x0, y0, x1, y1, kind) => shape("line", { x1: x0, y1: y0, x2: x1, y2: y1, class: kind });

// How far the chart goes to either side of nothing, and the figures at its lines.
function scale(threads) {
  let most = LEAST;
  for (const { passes, apart_um_u: u } of threads) {
    for (const pass of passes) if (pass) most = Math.max(most, ...[pass.least, pass.most].map((um) => Math.abs(um) + (u ?? 0)));
  }
  const decade = 10 ** Math.floor(Math.log10(most / 2));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((one) => one * 2.5 >= most);
  const lines = [-2, -1, 0, 1, 2].map((n) => n * step);
  return { lines, y: (um) => TOP + (HIGH - TOP - LOW) * (0.5 - um / Math.max(most, 2 * step) / 2) };
}

// One pass, about the middle of its place.
function mark(pass, apart_u, x, y, name) {
  const group = shape("g", {});
  group.append(shape("title", {}, name));
  if (!pass) {
    group.append(shape("text", { x, y: y(0) + 5, class: "open" }, "?"));
    return group;
  }
  const { least, most, most_u } = pass;
  // What all passes have in common, such as an age that is not known, may lead out of the chart.
  const ends = (u) => [y(most + u), y(least - u)].map((at) => Math.min(Math.max(at, TOP), HIGH - LOW));
  const [top, low] = ends(most_u);
  group.append(line(x, top, x, low, "all"));
  if (apart_u !== undefined) {
    const [high, deep] = ends(apart_u);
    group.append(line(x, high, x, deep, "doubt"), line(x - 5, high, x + 5, high, "doubt"), line(x - 5, deep, x + 5, deep, "doubt"));
  }
  if (least === most) group.append(shape("circle", { cx: x, cy: y(most), r: 4.5, class: "own" }));
  else group.append(shape("rect", { x: x - 5, y: y(most), width: 10, height: Math.max(y(least) - y(most), 2), class: "between" }));
  return group;
}

function chart(threads) {
  const drawn = threads.filter(({ passes }) => passes.length);
  at("cuts").hidden = drawn.length === 0;
  if (!drawn.length) return;
  const { lines, y } = scale(drawn);
  const places = [];
  let right = GAP / 2;
  for (const thread of drawn) {
    places.push(right);
    right += thread.passes.length * WIDE + GAP;
  }
  const sheet = at("cuts_sheet");
  const room = sheet.parentElement;
  // Who has gone back is not taken along.
  const follows = room.scrollLeft + room.clientWidth >= room.scrollWidth - WIDE;
  const all = [];
  for (const um of lines) all.push(line(0, y(um), right, y(um), um === 0 ? "zero" : "grid"));
  drawn.forEach((thread, n) => {
    const left = places[n];
    if (n > 0) all.push(line(left - GAP / 2, TOP, left - GAP / 2, HIGH - LOW, "apart"));
    all.push(shape("text", { x: left, y: HIGH - 4, class: "line" }, `N ${thread.line}`));
    thread.passes.forEach((pass, k) => {
      const number = thread.before + k + 1;
      const x = left + (k + 0.5) * WIDE;
      all.push(mark(pass, thread.apart_um_u, x, y, `N ${thread.line} · ${word("pass")} ${number}: ${said(pass)} µm`));
      all.push(shape("text", { x, y: HIGH - LOW + 14, class: "pass" }, String(number)));
    });
  });
  sheet.setAttribute("width", right);
  sheet.setAttribute("height", HIGH);
  sheet.replaceChildren(...all);
  const axis = at("cuts_axis");
  axis.setAttribute("height", HIGH);
  axis.replaceChildren(...lines.map((um) => shape("text", { x: 46, y: y(um) + 4, class: "value" }, (um > 0 ? "+" : "") + String(+um.toPrecision(2)).replace("-", "−"))));
  if (follows) room.scrollLeft = room.scrollWidth;
}

function row(thread) {
  const item = document.createElement("li");
  // A figure whose age is not known is one to take care of.
  const doubts = thread.kind === "thread" && (thread.worst_um === null || !thread.age_known || thread.passes.includes(null));
  item.dataset.tone = doubts || thread.state === "cut_short" ? "care" : "plain";
  const parts = [`N ${thread.line}`, KINDS[thread.kind](), thread.kind === "thread" && `${thread.strokes} ${word("passes")}`,
    STATES[thread.state](), `${word("setpoint")} ${thread.setpoint_um.toFixed(3)} µm`];
  item.textContent = (item.dataset.tone === "care" ? "! " : "") + parts.filter(Boolean).join(" · ");
  const below = (text) => {
    const small = document.createElement("small");
    small.textContent = text;
    item.append(small);
  };
  const words = isChinese() ? thread.zh : thread.en;
  if (words) below(words);
  if (thread.passes.length) below(thread.passes.map((pass, n) => `${thread.before + n + 1}: ${said(pass)}`).join(" · "));
  return item;
}

// The threads, the oldest first.
export function show(threads) {
  told = threads;
  chart(threads);
  at("no_cuts").hidden = threads.length > 0;
  at("cut_list").replaceChildren(...threads.toReversed().map(row));
}

// Words have changed.
export const again = () => show(told);
