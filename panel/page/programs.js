// The programs of the panel's folder: opened, changed, checked, drawn, and begun. It must not know how the machine is told.

import { Path } from "./path.js";
import { ended, Text, unified } from "./text.js";
import { program, programs, view, write } from "./transport.js";
import { isChinese, word } from "./words.js";

const at = (id) => document.getElementById(id);
const text = new Text({ area: at("source"), numbers: at("numbers"), bar: at("here"), changed });
const path = new Path(at("plot"));
// The open program: name, tag, line end, whether it would come back as another, whether it was changed, by what it was looked at.
let open = null;
// The one that the machine runs from here.
let runs = null;
// Programs that are opened one after the other: only the last one counts.
let turn = 0;
// What is opened, looked at and shown of a start: one request each, in whose place the next one comes. A browser has six
// connections, and a hold needs one.
let opening = new AbortController();
let looking = new AbortController();
let starting = new AbortController();
// A change that is not saved is given up by asking twice.
let doomed = null;
// A text is on its way to the folder.
let saving = false;
let tell = () => {};
// The start at a line that was shown, and may be ordered.
let start = null;

// What the panel knows of the board, by which it looks at programs; null where it knows nothing.
let known = null;

// A program follows the handwheel.
const by_wheel = () => at("by_wheel").getAttribute("aria-pressed") === "true";
const both = (key) => ({ en: word(key), zh: word(key) });
// What is drawn begins where the program has begun, by the same tables.
const fits = (one) => path.path.by === one.by && path.path.from === one.from;
const is_open = (one) => open !== null && one !== null && open.name === one.name && open.tag === one.tag;

function changed() {
  drop();
  if (open) open.changed = true;
  doomed = null;
  text.mark([]);
  note();
}

// What is open, and whether it may be changed and written.
export function note() {
  const parts = [open?.name, open?.changed && word("unsaved"), open?.bare && word("other_letters"),
    open && text.is_long && word("too_long")];
  if (runs) parts.push(`▶ ${runs.name}`);
  at("text_note").textContent = parts.filter(Boolean).join(" · ");
  at("save").disabled = open?.bare || text.is_long || document.body.classList.contains("looks");
  at("source").readOnly = open?.bare || text.is_long || is_open(runs) || document.body.classList.contains("looks");
}

// What was answered: its refusal is told, and then there is nothing.
async function asked(what) {
  try {
    const answer = await what;
    if (!answer.refused && !answer.error) return answer;
    tell(answer.error ? { en: answer.error, zh: answer.error } : answer);
  } catch (error) {
    if (error.name !== "AbortError") tell(both("no_panel"));
  }
  return null;
}

async function list() {
  const answer = await asked(programs());
  if (!answer) return;
  const options = answer.programs.map(({ name, size }) => {
    const option = document.createElement("option");
    option.value = name;
    option.textContent = `${name} · ${size < 1000 ? `${size} B` : `${(size / 1000).toFixed(1)} kB`}`;
    return option;
  });
  const first = document.createElement("option");
  first.value = "";
  first.textContent = `${word("choose")} (${answer.programs.length + answer.further})`;
  at("programs").replaceChildren(first, ...options);
  at("programs").value = open?.name ?? "";
}

// Opens a program. Changes that are not saved are kept the first time.
async function show(name) {
  if (open?.changed && doomed !== name) {
    doomed = name;
    at("programs").value = open.name;
    tell(both("unsaved_stay"));
    return;
  }
  turn += 1;
  const own = turn;
  drop();
  at("path_note").textContent = "";
  opening.abort();
  looking.abort();
  opening = new AbortController();
  const answer = await asked(program(name, opening.signal));
  if (!answer || own !== turn) return;
  doomed = null;
  const decoded = read(answer.bytes);
  const lines = unified(decoded.text);
  open = { name, tag: answer.tag, end: lines.end, bare: decoded.bare || lines.signed, changed: false };
  text.value = lines.text;
  at("name").value = name;
  at("programs").value = name;
  path.show(null);
  note();
  await look();
}

// Letters that are not UTF-8 are shown, and not written: they would come back as others.
function read(bytes) {
  try {
    return { text: new TextDecoder("utf-8", { fatal: true }).decode(bytes), bare: false };
  } catch {
    return { text: new TextDecoder("gb18030").decode(bytes), bare: true };
  }
}

// What is wrong with the open program, and its path, by what the board has now.
async function look() {
  looking.abort();
  looking = new AbortController();
  const own = turn;
  const { signal } = looking;
  const { name } = open;
  open.by = known;
  put([row("plain", word("checking"))]);
  const check = await asked(view(name, "check", isChinese(), signal));
  if (own !== turn || signal.aborted) return;
  if (check) open.by = check.by;
  found(check);
  const way = await asked(view(name, "path", isChinese(), signal));
  if (own !== turn || signal.aborted) return;
  path.show(way);
  at("path_note").textContent = way ? said(way, check) : "";
}

function said(way, check) {
  const parts = [`${way.kinds.length - way.zeros.length} ${word("pieces")}`];
  if (!way.whole) parts.push(word("path_cut"));
  if (check && !check.ok) parts.push(word("path_alarm"));
  return parts.join(" · ");
}

function row(tone, told, line) {
  const item = document.createElement("li");
  item.dataset.tone = tone;
  if (!line) {
    item.textContent = told;
    return item;
  }
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = told;
  button.onclick = () => text.go(line);
  item.append(button);
  return item;
}

// A row that goes does not take the keys with it.
function put(rows) {
  if (at("found").contains(document.activeElement)) at("start_look").focus();
  at("found").replaceChildren(...rows);
}

function found(check) {
  if (!check) return put([]);
  const rows = [["alarms", "bad", "▲"], ["warnings", "care", "!"]].flatMap(([key, tone, sign]) => check[key].map((one) => {
    const number = String(one.no).padStart(4, "0");
    // A line of a subprogram is none of this text.
    const line = one.file ? 0 : one.line;
    return { tone, line, told: `${sign} ${one.file ? `${one.file}:` : ""}${one.line}: ${number} ${one.message} — ${word("remedy")}: ${one.help}` };
  }));
  const list = rows.map(({ tone, line, told }) => row(tone, told, line));
  if (check.more) list.push(row("care", check.more));
  if (!list.length) list.push(row("good", `✓ ${word("good")} · ${check.moves} ${word("moves")}`));
  put(list);
  text.mark(rows.toReversed().filter(({ line }) => line).map(({ line, tone }) => [line, tone]));
}

// An answer that comes late changes what it is about, and nothing else.
async function save() {
  if (open?.bare || text.is_long) return tell(both(open?.bare ? "other_letters" : "too_long"));
  if (saving) return;
  drop();
  const name = at("name").value.trim();
  const own = open?.name === name ? open : null;
  const end = own?.end ?? "\n";
  const [typed, before, was] = [text.value, turn, open];
  saving = true;
  const answer = await asked(write(name, ended(typed, end), own?.tag ?? null));
  saving = false;
  if (!answer) return;
  tell(both("saved"));
  const changed = () => text.value !== typed;
  if (before !== turn || open !== was) {
    // Another one is opened meanwhile. Until it is there, this one is.
    if (own && open === own) Object.assign(own, { tag: answer.tag, changed: changed() });
    return list();
  }
  turn += 1;
  const now = turn;
  open = { name, tag: answer.tag, end, bare: false, changed: changed() };
  await list();
  // What is found is of the text that is shown.
  if (now !== turn) return;
  note();
  if (!open.changed) await look();
}

// What would happen is shown before anything can be ordered: the order names it, and is refused where it is not so any more.
async function look_at_start() {
  drop();
  if (!open) return tell(both("none_open"));
  if (open.changed || saving) return tell(both("save_first"));
  const [own, one, line] = [turn, open, text.cursor];
  starting = new AbortController();
  const answer = await asked(view(one.name, `start/${line}`, isChinese(), starting.signal));
  if (!answer || own !== turn || one.changed) return;
  start = { line, by: answer.by, shown: answer.shown };
  at("start_told").textContent = answer.text;
  at("start_line").textContent = line;
  at("start_at").hidden = false;
}

// A button that goes does not take the keys with it. They are in no field then: there Space would be no hold.
function drop() {
  start = null;
  starting.abort();
  if (at("start_at").contains(document.activeElement)) at("start_look").focus();
  at("start_at").hidden = true;
}

// Ready: whether the panel has a folder; what an order has to do; how it is told.
export function begin({ order, said: told, held, has_folder }) {
  tell = told;
  at("store").hidden = !has_folder;
  at("no_store").hidden = has_folder;
  if (!has_folder || begin.done) return;
  begin.done = true;
  at("programs").onchange = (event) => { if (event.target.value) show(event.target.value); };
  at("reload").onclick = () => { list(); if (open) show(open.name); };
  at("save").onclick = save;
  held(at("run"), () => {
    if (!open) return tell(both("none_open"));
    if (open.changed || saving) return tell(both("save_first"));
    order("program", { name: open.name, tag: open.tag, wheel: by_wheel(), zh: isChinese() });
  });
  at("by_wheel").onclick = () => at("by_wheel").setAttribute("aria-pressed", !by_wheel());
  at("start_look").onclick = look_at_start;
  held(at("start_go"), () => {
    if (open && start) order("program", { name: open.name, tag: open.tag, start, wheel: by_wheel(), zh: isChinese() });
    drop();
  });
  list();
}

for (const [id, act] of [["fit", () => path.view.fit()], ["nearer", () => path.view.magnify(1.5)], ["farther", () => path.view.magnify(1 / 1.5)]]) {
  at(id).onclick = act;
}

// Words have changed.
export function again() {
  drop();
  note();
  if (begin.done) list();
  if (open && !open.changed) look();
}

// What runs from here, or has ended.
export function under_way(one) {
  runs = one.end ? null : one;
  note();
  if (runs && !open && begin.done) show(runs.name);
  else if (is_open(runs) && runs.start === null && !fits(runs)) look();
}

// Gives the way to go.
export function state(s) {
  known = s.by;
  if (start && s.by && s.by !== start.by) {
    drop();
    tell(both("start_gone"));
  }
  const own = is_open(runs) && s.line !== null;
  text.here(own ? Number(s.line) || null : null);
  // What was started at a line counts its moves from there on: none of them is a piece's.
  path.at(s.mx / 2, s.mz, own && runs.start === null ? s.move : null);
  if (open && !open.changed && known && known !== open.by) look();
  return own && fits(runs) ? path.to_go : null;
}
