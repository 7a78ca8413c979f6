// A tool or a work offset touched off: what was measured is typed, what follows is shown, and then written. What is written is
// what was shown: the panel refuses it where the machine has another place, mark or table by then. It must not know how it is done.

import { item } from "./table.js";
import { isChinese, said, word } from "./words.js";

const at = (id) => document.getElementById(id);
let give = async () => null;
// What was looked at and may be written, what it has come to, and how often it was given up.
let shown = null;
let told = null;
let turn = 0;
// By which work offset and tool positions are shown; fields go by it until somebody chooses.
let zero = "";

function show() {
  at("touch_write").hidden = shown === null;
  const rows = told ? [item(told.ok ? "good" : "bad", `${told.ok ? told.done ? "✓ " : "" : "▲ "}${said(told)}`)] : [];
  for (const { key, old, new: next } of told?.changes ?? []) rows.push(item("plain", `${key}: ${old || "–"} → ${next || "–"}`));
  if (told?.changes?.length === 0 && told.seen) rows.push(item("plain", word("no_difference")));
  at("touch_told").replaceChildren(...rows);
}

function forget() {
  turn += 1;
  shown = null;
  told = null;
  show();
}

// Orders it, and shows what has become of it unless something else was typed meanwhile.
async function order(args, done) {
  forget();
  const own = turn;
  const answer = await give("touch", { ...args, axis: at("touch_axis").value, zh: isChinese() });
  if (own !== turn) return;
  if (answer) told = { ...answer, done };
  if (answer?.ok && !done) shown = { ...args, seen: answer.seen };
  // Nothing has come of it, as where what is shown is too old: what was looked at can be ordered again.
  if (!answer && args.seen) shown = args;
  show();
}

const typed = () => ({
  value: at("touch_value").value.trim(), tool: at("touch_tool").value.trim(), system: at("touch_system").value,
  work: at("touch_sets").value === "work", seen: null,
});

// What an order has to do: it gives what has become of it.
export function begin(act) {
  give = act;
  at("touch").onsubmit = (event) => {
    event.preventDefault();
    order(typed(), false);
  };
  // A key that is kept down reviews once, and writes nothing.
  at("touch").addEventListener("keydown", (event) => { if (event.key === "Enter" && event.repeat) event.preventDefault(); });
  for (const kind of ["input", "change"]) at("touch").addEventListener(kind, forget);
  for (const id of ["touch_tool", "touch_system"]) at(id).addEventListener("input", () => { at(id).dataset.own = "true"; });
  at("touch_mark").onclick = () => order({ mark: true }, true);
  at("touch_write").onclick = () => {
    // A button that goes takes the keys with it: in a field arrows move no axis.
    at("touch_value").focus();
    order(shown, true);
  };
}

export const again = show;

export function state(s) {
  if (s.zero === zero) return;
  zero = s.zero ?? "";
  const [system, tool] = zero.split(" T");
  for (const [id, value] of [["touch_system", system], ["touch_tool", tool && String(Number(tool) || "")]]) {
    if (value && !at(id).dataset.own) at(id).value = value;
  }
}
