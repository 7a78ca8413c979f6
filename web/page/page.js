// Puts the parts of the page together: editor, machine, pictures and settings.

import { Editor } from "./editor.js";
import { Measured } from "./measured.js";
import { Phase } from "./phase.js";
import { Plot } from "./plot.js";
import { Runner } from "./runner.js";
import { open } from "./transport.js";
import { isChinese, refusal, use, word } from "./words.js";
import * as link from "./link.js";

const CHECK_AFTER_MS = 200;
const COUNTS = ["", 100, 500, 1024, 2048, 3600];
const FAULTS = ["estop", "spindle_stalls", "spindle_slow", "encoder_slips", "drive_hot", "drive_silent", "axis_blocked",
  "bus_unplugged"];
const SETTINGS = ["ripple", "hertz", "counts", "kv", "speed"];

const of = (id) => document.getElementById(id);
const machine = open();
const editor = new Editor({ text: of("text"), numbers: of("numbers"), marks: of("marks"), changed: later });
const plot = new Plot(of("plot"));
const phase = new Phase(of("phase"));
const measured = new Measured({ list: of("threads"), canvas: of("profile") });
const runner = new Runner({ ask: machine.ask, speed, seen, failed });
let examples = [];
let folder = "";
let timer = 0;
let started = 0;
let held = false;
let running = false;

function speed() {
  return Math.round(10 ** Number(of("speed").value));
}

function job(what) {
  const [ripple, hertz, kv] = ["ripple", "hertz", "kv"].map((id) => Number(of(id).value));
  const counts = of("counts").value;
  return {
    do: what,
    text: editor.value,
    folder,
    zh: isChinese(),
    ripple: ripple ? [ripple, hertz] : null,
    counts: counts ? Number(counts) : null,
    kv: kv || null,
    measure: of("measure").checked,
  };
}

function later() {
  clearTimeout(timer);
  timer = setTimeout(check, CHECK_AFTER_MS);
}

async function check() {
  if (running) return;
  const said = await machine.ask(job("check")).catch((failure) => ({ failure }));
  if (said.failure || said.refused) return failed(said);
  of("alarm").textContent = "";
  found(said);
  plot.show(said.path);
}

function found(said) {
  editor.show(said.found);
  const rows = said.found.map((one) => row(one));
  if (said.too_long) rows.push(plain(word("too_long"), "alarm"));
  of("found").replaceChildren(...(rows.length ? rows : [plain(word("good"), "good")]));
}

function plain(text, kind) {
  const item = document.createElement("li");
  item.className = kind;
  item.textContent = text;
  return item;
}

function words(one) {
  const number = String(one.number).padStart(4, "0");
  return `${one.warning ? "△" : "✖"} ${one.line}:${one.column}  ${number} ${one.message}. ${word("remedy")}: ${one.help}`;
}

function row(one) {
  const item = plain(words(one), one.warning ? "warning" : "alarm");
  item.addEventListener("click", () => editor.go(one.line));
  return item;
}

async function run() {
  runner.stop();
  clearTimeout(timer);
  of("alarm").textContent = "";
  clear();
  const said = await machine.ask(job("load")).catch((failure) => ({ failure }));
  if (said.failure || said.refused) return failed(said);
  found(said);
  plot.show(said.path);
  of("hash").textContent = "–";
  of("factor").textContent = "";
  if (!said.good) return buttons(false);
  started = performance.now();
  held = false;
  buttons(true);
  runner.start();
}

function clear() {
  phase.clear();
  measured.clear();
  of("measured").hidden = true;
}

function buttons(now) {
  running = now;
  of("inject").disabled = !running;
  of("hold").disabled = !running || held;
  of("resume").disabled = !running || !held;
}

function seen({ state, samples, threads, told }) {
  const millimetres = (nm) => (nm / 1e6).toFixed(4);
  const [x, z] = plot.at(state.x, state.z, state.line);
  of("x").textContent = millimetres(2 * x);
  of("z").textContent = millimetres(z);
  of("rpm").textContent = state.rpm;
  of("mode").textContent = state.doing;
  of("line").textContent = state.line;
  of("time").textContent = `${(state.time_ms / 1000).toFixed(1)} s`;
  of("worst").textContent = `${(state.worst_nm / 1000).toFixed(2)} µm`;
  editor.here(state.line);
  // M00 holds it, too.
  held = state.doing === "hold";
  buttons(running);
  phase.add(samples);
  if (threads.length) {
    of("measured").hidden = false;
    measured.add(threads);
  }
  if (told.length) of("alarm").textContent = told.map(words).join("\n");
  if (!state.over) return;
  const factor = state.time_ms / Math.max(performance.now() - started, 1);
  of("factor").textContent = `×${factor.toFixed(0)} ${word("real")}`;
  of("hash").textContent = state.setpoint_hash;
  buttons(false);
}

function failed({ refused, figure, failure }) {
  of("alarm").textContent = failure ? `${word("lost")}: ${failure.message}` : refusal({ refused, figure });
  buttons(false);
}

// What a message brings back is shown with what time brings.
async function sayTo(message) {
  const said = await machine.ask(message).catch((failure) => ({ failure }));
  if (said.failure || said.refused) return failed(said);
  seen(said);
}

async function order(what) {
  await sayTo({ do: what });
  held = what === "hold";
  buttons(running);
}

async function reset() {
  runner.stop();
  await machine.ask({ do: "reset" });
  clear();
  for (const id of ["x", "z", "rpm", "mode", "line", "time", "worst", "hash"]) of(id).textContent = "–";
  of("factor").textContent = "";
  buttons(false);
  await check();
}

function choose(n) {
  folder = examples[n].folder;
  editor.value = examples[n].text;
  return reset();
}

function say() {
  of("speed-said").textContent = `×${speed()}`;
  const ripple = Number(of("ripple").value);
  of("ripple-said").textContent = `${(ripple / 1000).toFixed(2)} %`;
  of("hertz-said").textContent = `${(Number(of("hertz").value) / 1000).toFixed(1)} Hz`;
  const kv = Number(of("kv").value);
  of("kv-said").textContent = kv ? `${kv} 1/s` : word("ideal");
}

function language(zh) {
  use(zh);
  of("language").textContent = zh ? "English" : "中文";
  of("text").setAttribute("aria-label", word("text"));
  of("counts").options[0].textContent = word("own");
  for (const option of of("fault").options) option.textContent = word(option.value);
  measured.say();
  say();
}

async function share() {
  const settings = { text: editor.value, folder };
  for (const id of SETTINGS) settings[id] = of(id).value;
  settings.measure = of("measure").checked;
  history.replaceState(null, "", `#${link.write(settings)}`);
  const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
  of("share").textContent = word(copied ? "shared" : "address");
  setTimeout(() => { of("share").textContent = word("share"); }, 2000);
}

async function start() {
  for (const count of COUNTS) of("counts").add(new Option(String(count), String(count)));
  for (const fault of FAULTS) of("fault").add(new Option(fault, fault));
  language(navigator.language.startsWith("zh"));
  examples = await machine.ask({ do: "examples" });
  for (const [n, one] of examples.entries()) {
    of("example").add(new Option(one.folder ? `${one.folder}/${one.name}` : one.name, String(n)));
  }
  const first = examples.findIndex((one) => one.name === "shaft.nc");
  of("example").value = String(Math.max(first, 0));
  const linked = link.read(location.hash);
  if (linked) {
    for (const id of SETTINGS) if (linked[id] !== undefined) of(id).value = linked[id];
    of("measure").checked = linked.measure !== false;
    folder = linked.folder;
    editor.value = linked.text;
    of("example").selectedIndex = -1;
    say();
    await reset();
  } else {
    await choose(Math.max(first, 0));
  }
  document.body.dataset.ready = String(Math.round(performance.now()));
}

of("example").addEventListener("change", (event) => choose(Number(event.target.value)));
of("run").addEventListener("click", run);
of("hold").addEventListener("click", () => order("hold"));
of("resume").addEventListener("click", () => order("resume"));
of("reset").addEventListener("click", reset);
of("inject").addEventListener("click", () => sayTo({ do: "fault", what: of("fault").value }));
of("fit").addEventListener("click", () => plot.view.fit());
of("share").addEventListener("click", share);
of("language").addEventListener("click", () => {
  language(!isChinese());
  if (!running) check();
});
for (const id of ["speed", "ripple", "hertz", "kv"]) of(id).addEventListener("input", say);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => [plot, phase, measured].forEach((one) => one.view.redraw()));
buttons(false);
start().catch((failure) => failed({ failure }));
