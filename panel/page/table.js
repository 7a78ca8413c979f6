// A table of the board: read when it is opened and where the board has other values, changed as a whole against what was read.
// A reading that fails is done again. What differs is found on the panel's side, looked at, and written as one transaction. What was typed stays until it is
// written or given up. It must not know what the table is about.

import { sheet } from "./transport.js";
import { isChinese, said, word } from "./words.js";

// Between two readings, where the first has failed.
const AGAIN = 1000;

// A line of what is told.
export function item(tone, text) {
  const one = document.createElement("li");
  one.dataset.tone = tone;
  one.textContent = text;
  return one;
}

export class Table {
  // `draw(answer, cell)` fills it: `cell(key, text)` makes an input for a value. `order(args)` gives what has become of it.
  constructor(section, { path, order, draw }) {
    Object.assign(this, { section, path, order, draw, read: new Map(), typed: new Map(), cells: new Map() });
    Object.assign(this, { seen: null, now: null, asked: null, turn: 0, sure: false, written: null });
    this.details = section.querySelector("details");
    this.details.append(document.getElementById("review").content.cloneNode(true));
    this.list = section.querySelector("ol");
    this.details.addEventListener("toggle", () => { if (this.details.open) this.load(); });
    section.addEventListener("input", ({ target }) => { if (target.dataset.key) this.#type(target); });
    section.addEventListener("keydown", (event) => this.#below(event));
    this.#button("check").onclick = () => this.#check();
    this.#button("write").onclick = () => this.#write();
    this.#button("drop").onclick = () => { this.typed.clear(); this.written = null; this.#fill(); this.#disarm(); };
    this.#disarm();
  }

  // What the board has now is named so; null where that is not known.
  at(by) {
    this.now = by;
    if (this.details.open && by && by !== this.asked) this.load();
  }

  // Words have changed.
  again() {
    if (this.details.open) this.load();
  }

  async load() {
    this.turn += 1;
    const own = this.turn;
    this.asked = this.now;
    let answer = null;
    try {
      answer = await sheet(this.path, isChinese());
    } catch {
      answer = { error: word("no_panel") };
    }
    if (own !== this.turn) return;
    if (answer.error || answer.refused) {
      this.failed = true;
      setTimeout(() => { if (own === this.turn) this.asked = null; }, AGAIN);
      return this.#note(answer.error ?? said(answer));
    }
    if (this.failed) this.#count();
    this.failed = false;
    // The other table has changed: a review of this one stays.
    if (answer.seen === this.seen && this.zh === isChinese()) return;
    this.zh = isChinese();
    const changed = this.seen !== null && this.seen !== answer.seen && this.typed.size > 0;
    this.seen = answer.seen;
    const focus = this.section.contains(document.activeElement) ? document.activeElement : null;
    const { key } = focus?.dataset ?? {};
    const caret = key ? focus.selectionStart : 0;
    this.read.clear();
    this.cells.clear();
    this.draw(answer, (name, text) => this.#cell(name, text));
    for (const name of this.typed.keys()) if (!this.cells.has(name)) this.typed.delete(name);
    this.#fill();
    this.#disarm();
    if (key) {
      this.cells.get(key)?.focus();
      this.cells.get(key)?.setSelectionRange(caret, caret);
    }
    if (changed) this.list.replaceChildren(item("care", `! ${word("values_new")}`));
  }

  #button(name) {
    return this.section.querySelector(`[data-do=${name}]`);
  }

  // A button that goes does not take the keys with it.
  #hide(name, hidden) {
    const button = this.#button(name);
    if (hidden && button === document.activeElement) this.details.querySelector("summary").focus();
    button.hidden = hidden;
  }

  #cell(key, text) {
    const input = document.createElement("input");
    input.dataset.key = key;
    input.setAttribute("aria-label", key);
    input.spellcheck = false;
    input.autocomplete = "off";
    input.maxLength = 64;
    input.disabled = document.body.classList.contains("looks");
    this.read.set(key, text);
    this.cells.set(key, input);
    return input;
  }

  // Each cell has what was typed, or what was read.
  #fill() {
    for (const [key, input] of this.cells) {
      input.value = this.typed.get(key) ?? this.read.get(key);
      this.#mark(input);
    }
  }

  #mark(input, complaint) {
    const { key } = input.dataset;
    input.classList.toggle("changed", this.typed.has(key));
    input.toggleAttribute("aria-invalid", false);
    if (complaint?.bad) input.setAttribute("aria-invalid", "true");
    const told = input.closest("tr").querySelector(".told");
    if (told && (complaint || told.dataset.of === key)) {
      told.dataset.of = complaint ? key : "";
      told.textContent = complaint ? `${complaint.bad ? "▲" : "!"} ${said(complaint)}` : "";
    }
  }

  #type(input) {
    const { key } = input.dataset;
    const text = input.value.trim();
    if (text === this.read.get(key)) this.typed.delete(key);
    else this.typed.set(key, text);
    this.written = null;
    this.#mark(input);
    this.#disarm();
  }

  // Enter goes to the same value of the next row.
  #below(event) {
    const { key } = event.target.dataset;
    if (event.key !== "Enter" || event.ctrlKey || !key) return;
    const column = [...event.target.closest("tr").children].indexOf(event.target.closest("td"));
    let row = event.target.closest("tr").nextElementSibling;
    while (row?.hidden) row = row.nextElementSibling;
    const next = row?.children[column]?.querySelector("input");
    next?.focus();
    next?.select();
  }

  #note(text) {
    this.section.querySelector(".note").textContent = text;
  }

  // What was reviewed is not what would be written any more. That something was written stays until somebody types again:
  // the board's new values are read right after it.
  #disarm() {
    this.list.replaceChildren(...(this.written ?? []).map((note) => item("care", `! ${said(note)}`)));
    this.#hide("write", true);
    for (const name of ["check", "drop"]) this.#hide(name, this.typed.size === 0);
    this.#count();
  }

  #count() {
    this.#note(this.typed.size ? `${this.typed.size} ${word("changed_values")}` : this.written ? `✓ ${word("written")}` : "");
  }

  #order(check) {
    return this.order({ seen: this.seen, set: Object.fromEntries(this.typed), check, sure: this.sure, zh: isChinese() });
  }

  // What a review is of: another text once something else was typed, or read.
  #subject() {
    return JSON.stringify([this.seen, ...this.typed]);
  }

  async #check() {
    const subject = this.#subject();
    this.sure = false;
    const answer = await this.#order(true);
    if (subject !== this.#subject()) return;
    if (!this.#show(answer)) return;
    if (!answer.changes.length) {
      this.typed.clear();
      this.#fill();
      this.#disarm();
      return this.#note(word("no_difference"));
    }
    this.sure = answer.complaints.length > 0;
    this.#button("write").hidden = false;
  }

  async #write() {
    const subject = this.#subject();
    const sent = new Map(this.typed);
    this.#hide("write", true);
    const answer = await this.#order(false);
    // Nothing has come of it, as where what is shown is too old: what was reviewed can be ordered again.
    if (!answer && subject === this.#subject()) this.#button("write").hidden = false;
    if (!this.#show(answer)) return;
    for (const [key, text] of sent) {
      this.read.set(key, text);
      if (this.typed.get(key) === text) this.typed.delete(key);
    }
    this.written = answer.notes;
    this.#fill();
    this.#disarm();
  }

  // Shows what would change and what is wrong with it. True where nothing is.
  #show(answer) {
    if (!answer) return false;
    for (const input of this.cells.values()) this.#mark(input);
    const complaints = new Map();
    for (const one of answer.complaints ?? []) {
      const input = this.cells.get(one.key);
      if (input) this.#mark(input, one);
      complaints.set(one, input);
    }
    const rows = (answer.changes ?? []).map(({ key, old, new: next }) => item("plain", `${key}: ${old || "–"} → ${next || "–"}`));
    for (const [one, input] of complaints) {
      const row = item(one.bad ? "bad" : "care", "");
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = `${one.bad ? "▲" : "!"} ${said(one)}`;
      button.onclick = () => {
        if (!input) return;
        input.closest("tr").hidden = false;
        input.focus();
      };
      row.append(button);
      rows.push(row);
    }
    if (!answer.ok) rows.unshift(item("bad", `▲ ${said(answer)}`));
    this.list.replaceChildren(...rows);
    // Another table than the one that was read: what is new is shown, what was typed stays.
    if (!answer.ok && answer.changes?.length === 0 && complaints.size === 0) this.#anew(rows);
    return answer.ok;
  }

  async #anew(rows) {
    await this.load();
    this.list.replaceChildren(...rows);
  }
}
