// The page at the machine: joins the transport, what is shown, and the buttons and keys that order. A reload orders nothing.

import * as press from "./press.js";
import * as programs from "./programs.js";
import * as retract from "./retract.js";
import * as sheets from "./sheets.js";
import * as show from "./show.js";
import * as threads from "./threads.js";
import * as touch from "./touch.js";
import { lease, login, order, watch } from "./transport.js";
import { isChinese, use, word } from "./words.js";

// Values older than this order nothing but hold, stop and reset.
const OLD = 250;
// START has to be held so long.
const HELD = 300;
// The lease lasts five seconds; it is renewed each second.
const KEEP = 1000;
// How long an answer is waited for: that the lease is renewed, that it is taken, and an order. Whoever holds or stops hears soon that
// it has not come; a table takes its time; of all else the panel has given up before.
const RENEWED = 2000;
const TAKEN = 5000;
const PATIENCE = { hold: 5000, stop: 5000, reset: 5000, tools: 60000, params: 60000, touch: 60000, other: 12000 };
const ALWAYS = ["hold", "stop", "reset"];
const LEVELS = { feed: ["feed", 0, 150], rapid: ["rapid", 0, 100], spindle: ["turn", 50, 120] };
const ARROWS = { ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowRight: [0, 1], ArrowLeft: [0, -1] };
const STEPS = { 1: "0.001", 2: "0.01", 3: "0.1", 4: "1" };

const at = (id) => document.getElementById(id);
let last = null;
let entries = null;
let contacts = null;
let heard = performance.now();
let refused = null;
// Since when the board is not heard, and why; null: it is heard.
let lost = null;
// The lease: that of this page, that which counts, whether this link looks only, whether this page is taking it.
const holds = { own: null, now: null, notice: null, looks: false, takes: false };
// What was told before this page has watched is over.
let fresh = false;
// How often something was said.
let said = 0;
let step = "0.1";
let rapid = false;

function again() {
  if (last) show.state(last);
  if (entries) show.log(entries);
  programs.again();
  sheets.again();
  touch.again();
  retract.again();
  threads.again();
  if (contacts) show.contacts(contacts);
  whose();
}

function languages(zh) {
  use(zh);
  const button = at("language");
  button.textContent = zh ? "English" : "中文";
  button.lang = zh ? "en" : "zh";
  for (const one of document.querySelectorAll("[data-level]")) {
    one.setAttribute("aria-label", `${word(`ov_${one.dataset.level}`)}: ${Number(one.dataset.add) < 0 ? word("less") : word("more")}`);
  }
  again();
}

const age = () => performance.now() - heard + (last ? last.age_ms : Infinity);

// Values have an age when they come, and grow older here.
function grow() {
  if (press.isDown() && age() > OLD) press.up();
  show.age(last ? age() : performance.now() - heard, refused?.() ?? (lost && show.lost(lost)));
}

const owns = () => holds.own !== null && holds.own === holds.now;

function whose() {
  const who = owns() ? "own" : holds.now === null ? "nobody" : "other";
  show.lease(who, holds.looks, who === "own" || holds.takes ? holds.notice : null);
  programs.note();
}

function say(what) {
  said += 1;
  show.answer(what);
}

// Says what an order has come to, and takes back what was said before.
const tell = (answer) => say(answer?.ok ? null : answer ?? words("no_answer"));

function words(key) {
  const text = word(key);
  return { en: text, zh: text };
}

async function give(op, args = {}) {
  if (!ALWAYS.includes(op) && age() > OLD) return tell(words("stale"));
  if (op !== "hold" && op !== "stop" && press.isDown()) press.up();
  const before = said;
  try {
    const answer = await order(op, args, last?.beat, PATIENCE[op] ?? PATIENCE.other);
    // What was said meanwhile is news: the end of a line comes by another connection than the answer that it has begun.
    if (!answer.ok || said === before) tell(answer);
    return answer;
  } catch {
    return tell(op === "hold" || op === "stop" ? words("no_halt") : null);
  }
}

async function ask(what, patience = TAKEN) {
  try {
    const answer = await lease(what, patience);
    holds.looks = answer.refused === "looks";
    holds.own = answer.yours ?? null;
    if (holds.own !== null) holds.now = holds.own;
    holds.takes = what === "take" && answer.notice_ms !== undefined;
    if (answer.refused && what === "take") tell(answer);
  } catch {
    // The lease lapses by itself.
  }
  whose();
}

// Calls `act` once a button has been held long enough, by finger, mouse or key.
function held(button, act) {
  let timer = null;
  const begin = () => {
    button.classList.add("pressed");
    timer ??= setTimeout(() => { end(); act(); }, HELD);
  };
  const end = () => {
    clearTimeout(timer);
    timer = null;
    button.classList.remove("pressed");
  };
  button.addEventListener("pointerdown", (event) => { button.setPointerCapture(event.pointerId); begin(); });
  for (const kind of ["pointerup", "pointercancel", "lostpointercapture", "blur", "keyup"]) button.addEventListener(kind, end);
  button.addEventListener("keydown", (event) => { if (event.key === "Enter" && !event.repeat) begin(); });
  return { begin, end };
}

// A key that moves an axis, or a button that moves an axis or turns the spindle.
function move(way, fast) {
  if (age() > OLD) return tell(words("stale"));
  if (last.mode === "step" && !way.spindle) {
    const [x, z] = way.axes;
    const axis = x ? `X${x > 0 ? "+" : "-"}` : `Z${z > 0 ? "+" : "-"}`;
    return give("step", { axis, by: step });
  }
  tell({ ok: true });
  // A spindle has one speed by hand, whatever the axes have.
  press.down(way, fast && !way.spindle, (answer) => {
    if (answer?.pressed === "limit") tell(words("limit"));
    else if (!answer || answer.en) tell(answer);
  });
}

const inField = (target) => target instanceof HTMLInputElement || target instanceof HTMLTextAreaElement
  || target instanceof HTMLSelectElement;

function keys(start) {
  addEventListener("keydown", (event) => {
    // Space is a hold wherever the focus is; in a field it is a space while nothing moves.
    if (event.key === " " && !(inField(event.target) && last?.state === "idle" && !press.isDown())) {
      event.preventDefault();
      if (!event.repeat) { press.up(); give("hold"); }
      return;
    }
    if (event.key === "Enter" && event.ctrlKey && !(event.target instanceof HTMLTextAreaElement)) {
      event.preventDefault();
      if (!event.repeat) start.begin();
      return;
    }
    if (event.repeat) {
      // A key that is kept down presses a button once: START AT LINE gives the keys to another one.
      if (event.key === "Enter" && event.target instanceof HTMLButtonElement) event.preventDefault();
      if (event.key in ARROWS && !inField(event.target)) event.preventDefault();
      return;
    }
    const pressed = press.isDown();
    // Any other key ends a press.
    press.up();
    if (pressed || inField(event.target) || event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key in ARROWS) {
      event.preventDefault();
      move({ axes: ARROWS[event.key], spindle: 0 }, event.shiftKey);
    } else if (event.key in STEPS) {
      step = STEPS[event.key];
      show.step(step);
    }
  });
  addEventListener("keyup", (event) => {
    if (event.key in ARROWS || event.key === "Shift") press.up();
    if (event.key === "Enter" || event.key === "Control") start.end();
  });
  // Space is no click of the button that has the focus.
  addEventListener("keyup", (event) => { if (event.key === " " && !inField(event.target)) event.preventDefault(); });
}

function buttons(start) {
  for (const id of ["hold", "stop"]) {
    // At the first touch, not at its end; a click without one is a key or a helper.
    at(id).addEventListener("pointerdown", () => { press.up(); give(id); });
    at(id).addEventListener("click", (event) => { if (event.detail === 0) { press.up(); give(id); } });
  }
  for (const id of ["resume", "reset", "home"]) at(id).onclick = () => give(id);
  at("single").onclick = () => give("single", { on: !last?.single });
  for (const one of document.querySelectorAll("[data-mode]")) one.onclick = () => give("mode", { mode: one.dataset.mode });
  for (const one of document.querySelectorAll("[data-level]")) {
    one.onclick = () => {
      const [shown, low, high] = LEVELS[one.dataset.level];
      if (!last) return;
      const percent = Math.min(high, Math.max(low, last[shown] + Number(one.dataset.add)));
      give(one.dataset.level, { percent });
    };
  }
  for (const one of document.querySelectorAll("[data-by]")) {
    one.onclick = () => { step = one.dataset.by; show.step(step); };
  }
  at("rapidly").onclick = () => {
    rapid = !rapid;
    at("rapidly").setAttribute("aria-pressed", rapid);
  };
  for (const one of document.querySelectorAll("[data-jog]")) {
    const [which, sign] = one.dataset.jog;
    const by = (name) => (which === name ? Number(`${sign}1`) : 0);
    const way = { axes: [by("X"), by("Z")], spindle: by("S") };
    one.addEventListener("pointerdown", (event) => {
      if (!event.isPrimary || event.button !== 0) return press.up();
      one.setPointerCapture(event.pointerId);
      move(way, rapid);
    });
    for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) one.addEventListener(kind, press.up);
    one.addEventListener("contextmenu", (event) => event.preventDefault());
    // By key it is held, too. The page would end the press, as any other key does.
    one.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" || event.repeat || event.ctrlKey || press.isDown()) return;
      event.stopPropagation();
      move(way, rapid);
    });
    one.addEventListener("keyup", (event) => { if (event.key === "Enter") press.up(); });
    one.addEventListener("blur", press.up);
  }
  const away = () => { press.up(); start.end(); };
  for (const kind of ["blur", "pagehide", "resize"]) addEventListener(kind, away);
  document.addEventListener("visibilitychange", away);
  // What was heard before is old when somebody looks again: the clock of the page stands still while a tablet sleeps.
  document.addEventListener("visibilitychange", () => { if (document.hidden) heard = -Infinity; });
  addEventListener("pagehide", () => { if (owns()) lease("give", TAKEN, { keepalive: true }).catch(() => {}); });
  at("mdi").onsubmit = (event) => {
    event.preventDefault();
    const line = at("typed").value.trim();
    if (line) give("mdi", { line, zh: isChinese() });
  };
  // The field would make one line of what is pasted, with another way.
  at("typed").addEventListener("beforeinput", (event) => {
    const { value, selectionStart: from, selectionEnd: to } = at("typed");
    const whole = value.slice(0, from) + (event.data ?? "") + value.slice(to);
    if (!/[\r\n]/.test(whole.trim())) return;
    event.preventDefault();
    tell(words("several"));
  });
  at("take").onclick = () => ask(owns() ? "give" : "take");
  at("language").onclick = () => languages(!isChinese());
}

sheets.begin(give);
touch.begin(give);
retract.begin(give, (answer) => tell(answer), held);
const start = held(at("start"), () => give("start"));
buttons(start);
keys(start);
show.step(step);
languages(navigator.language.startsWith("zh"));
setInterval(grow, 100);
// One at a time: in an outage they would take all connections.
let asks = false;
setInterval(async () => {
  if (asks) return;
  asks = true;
  if (owns()) await ask("keep", RENEWED);
  else if (holds.takes) await ask("take", RENEWED);
  asks = false;
}, KEEP);

try {
  await login();
  // It has no lease to keep yet; the answer says whether this link may have one.
  ask("keep");
  watch({
    hello: (told) => {
      fresh = false;
      refused = null;
      show.hello(told);
      programs.begin({ order: give, said: (answer) => tell(answer), held, has_folder: told.programs });
    },
    s: (s) => {
      last = s;
      fresh = true;
      heard = performance.now();
      press.hear(s);
      show.state(s);
      show.to_go(programs.state(s));
      sheets.state(s);
      touch.state(s);
      grow();
    },
    board: (told) => {
      lost = told.since_ms === null ? null : told;
      if (lost) {
        press.up();
        start.end();
        holds.takes = false;
      }
      grow();
    },
    log: (list) => { entries = list; show.log(list); },
    threads: (told) => threads.show(told.threads),
    io: (told) => { contacts = told; show.contacts(told); },
    lease: ({ number, notice_s }) => { holds.now = number; holds.notice = notice_s; whose(); },
    program: (one) => {
      programs.under_way(one);
      if (fresh) say(one.end ?? words("sending"));
    },
    line: (end) => { if (fresh) say(end.ok ? words("done") : end); },
    press: (why) => { if (fresh && owns()) say(why); },
  }, (why) => { refused = () => why[isChinese() ? "zh" : "en"]; grow(); });
} catch (error) {
  refused = () => (error.refused ? error[isChinese() ? "zh" : "en"] : word("lost"));
  grow();
}
