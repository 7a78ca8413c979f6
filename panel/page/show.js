// Puts what the machine says into the page. It must not know how it came, and orders nothing.

import { isChinese, word } from "./words.js";

const at = (id) => document.getElementById(id);
const fixed = (value, places) => (value === null ? "" : value.toFixed(places));
const both = (pair) => pair[isChinese() ? 1 : 0];

// Text is set where it differs, so that nothing is laid out or read aloud again for nothing.
function put(id, text) {
  const place = at(id);
  if (place.textContent !== text) place.textContent = text;
}

export function hello({ bus, node }) {
  put("whose", `${node} @ ${bus}`);
}

export function state(s) {
  put("state", word(`state_${s.state}`) + (s.number === null ? "" : ` ${String(s.number).padStart(4, "0")}`));
  document.body.dataset.state = s.state;
  put("mode", s.mode === null ? "" : word(`mode_${s.mode}`));
  put("tool", s.tool === null ? "" : `T${String(s.tool).padStart(2, "0")}`);
  const flags = [s.hold && word("held"), s.single && word("single"), s.dry && word("dry")];
  put("flags", flags.filter(Boolean).join(" · "));
  put("zero", s.zero === null ? "" : s.zero);
  for (const name of ["wx", "wz", "mx", "mz", "mc"]) put(name, fixed(s[name], 4));
  for (const one of document.querySelectorAll("[data-mode]")) one.setAttribute("aria-pressed", one.dataset.mode === s.mode);
  at("single").setAttribute("aria-pressed", s.single);
  for (const axis of ["X", "Z", "C"]) {
    const known = s.referenced.includes(axis) ? word("referenced") : "";
    put(`ref${axis.toLowerCase()}`, s.unreferenced.includes(axis) ? word("unreferenced") : known);
  }
  put("rpm", fixed(s.rpm, 0));
  put("commanded", fixed(s.commanded, 0));
  put("feed", fixed(s.feed, 0));
  put("rapid", fixed(s.rapid, 0));
  put("turn", fixed(s.turn, 0));
  put("by_hand_rpm", s.by_hand_rpm === null ? "–" : `${s.by_hand_rpm} rpm × ${fixed(s.turn, 0)} %`);
  put("line", s.line === null ? word("no_line") : `N ${s.line} · ${s.move}`);
  put("modal", s.modal === null ? word("not_said") : s.modal);
  put("sync", s.sync_um === null ? "–" : `${fixed(s.sync_um, 3)} µm`);
  put("late", fixed(s.late, 0));
  at("left").hidden = s.left === null;
  put("left", s.left === null ? "" : told_left(s));
  const alarm = at("alarm");
  alarm.hidden = s.alarm === null;
  if (s.alarm) put("alarm", `▲ ${both(s.alarm.text)} — ${word("remedy")}: ${both(s.alarm.help)}`);
}

// Where a held program was left, and what RESUME does then.
function told_left({ left, mx, mz }) {
  const there = left.mx === mx && left.mz === mz;
  const place = `${word("left_at")} X ${fixed(left.mx, 4)}  Z ${fixed(left.mz, 4)}`;
  return `${place} — ${there ? word("left_on") : word("left_back")}`;
}

// The way to the end of the move that is under way: X as a diameter, Z; null where that is not known.
export function to_go(way) {
  const told = document.body.dataset.state === "idle" ? "" : "–";
  ["gx", "gz"].forEach((id, n) => put(id, way ? `→ ${fixed(way[n], 3)}` : told));
}

// Inputs and outputs: number, whether it is on, name, what it is for.
export function contacts(io) {
  for (const side of ["inputs", "outputs"]) {
    const rows = io[side].map(({ number, on, name, uses }) => {
      const row = document.createElement("li");
      row.dataset.on = String(on);
      const level = on === null ? `? ${word("unknown")}` : on ? `● ${word("on")}` : `○ ${word("off")}`;
      row.textContent = [`${number}`, level, name, uses].filter(Boolean).join(" · ");
      return row;
    });
    if (!rows.length) {
      rows.push(document.createElement("li"));
      rows[0].textContent = word("no_contacts");
    }
    at(side).replaceChildren(...rows);
  }
  document.querySelector("#io .note").textContent = io.note.length ? both(io.note) : "";
}

export function log(entries) {
  at("log").replaceChildren(...entries.toReversed().map((entry) => {
    const row = document.createElement("li");
    row.dataset.tone = entry.tone;
    const sign = { bad: "▲ ", care: "! " }[entry.tone] ?? "";
    row.textContent = sign + both(entry.text);
    const help = both(entry.help);
    if (help) {
      const below = document.createElement("small");
      below.textContent = `${word("remedy")}: ${help}`;
      row.append(below);
    }
    return row;
  }));
}

// Who operates: "own", "other" or "nobody"; a link that lets its owner look only; the seconds until somebody else does.
export function lease(who, looks, notice) {
  document.body.classList.toggle("operates", who === "own");
  document.body.classList.toggle("looks", looks);
  at("take").hidden = looks;
  // A button that would be refused is none, HOLD and STOP above all. Whether a text may be saved is no matter of the lease alone.
  for (const one of document.querySelectorAll("nav button, main button:not(#save), main input, #touch select")) {
    one.disabled = looks && !["fit", "nearer", "farther", "reload", "search", "differ"].includes(one.id);
  }
  put("take", who === "own" ? word("give") : word("take"));
  const text = looks ? word("looks") : word(`who_${who}`);
  put("operator", notice === null ? text : `${text} · ${word("notice")} ${notice} s`);
}

// What became of an order: nothing to say where it was done.
export function answer(told) {
  put("answer", told ? both([told.en, told.zh]) : "");
}

export function step(increment) {
  for (const one of document.querySelectorAll("[data-by]")) one.setAttribute("aria-pressed", one.dataset.by === increment);
}

// Since when the board is not heard, and what is wrong.
export function lost({ since_ms, en, zh }) {
  const since = `${word("since")} ${new Date(since_ms).toLocaleTimeString()}`;
  return `▲ ${word("lost")} · ${since} · ${word("no_orders")} · ${both([en, zh])}`;
}

// How old the values are, in milliseconds, and what else the banner has to say.
export function age(ms, told) {
  const old = ms > 250;
  document.body.classList.toggle("old", old);
  put("age", old && Number.isFinite(ms) ? `${(ms / 1000).toFixed(1)} ${word("old")}` : "");
  banner(told ?? (ms > 2000 ? word("lost") : ""));
}

function banner(text) {
  put("banner", text);
  at("banner").hidden = text === "";
}
