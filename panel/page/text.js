// A text with its line numbers: the line that is carried out, and lines with something wrong, are marked. Numbers are drawn
// for the lines that are seen alone. Of a long text a part is shown, which goes along with what is looked at: a browser takes
// seconds to lay out all of one. It must not know where the text comes from.

// The height of a line, as in the style sheet.
const HIGH = 22;
// Lines that are shown at a time; a text with more is not changed here.
const SHOWN = 5000;
// Whoever scrolls looks at what he wants for so long.
const LOOKS = 4000;

// A carriage return that ends no line: the machine refuses it, and a field would end a line there.
const RETURN = "␍";

// The lines of a text as the machine counts them: its first line end tells which one all of it has. They end with line feeds
// here, and a carriage return that is left has its sign; and that line end, and whether the text had the sign itself.
export function unified(text) {
  const end = text.match(/\r\n|\n\r|\r|\n/)?.[0] ?? "\n";
  const ends = { "\r": /\r\n?/g, "\n\r": /\n\r?/g }[end] ?? /\r*\n/g;
  return { text: text.replace(ends, "\n").replaceAll("\r", RETURN), end, signed: text.includes(RETURN) };
}

// The same text with its own line ends, as it is written.
export const ended = (text, end) => text.replaceAll("\n", end).replaceAll(RETURN, "\r");

export class Text {
  constructor({ area, numbers, bar, changed }) {
    Object.assign(this, { area, numbers, bar, found: new Map(), line: null, scrolled: -Infinity, lines: [""], base: 0 });
    // It came longer than what can be changed here. What is typed may be, and is whole in the field.
    this.is_long = false;
    area.addEventListener("input", () => {
      this.#measure();
      changed();
    });
    area.addEventListener("scroll", () => this.#follow());
    for (const kind of ["wheel", "touchmove", "pointerdown", "keydown"]) {
      area.addEventListener(kind, () => { this.scrolled = performance.now(); }, { passive: true });
    }
    new ResizeObserver(() => this.#follow()).observe(area);
  }

  get value() {
    return this.is_long ? this.lines.join("\n") : this.area.value;
  }

  set value(text) {
    this.lines = text.split("\n");
    this.is_long = this.lines.length > SHOWN;
    this.line = null;
    this.found = new Map();
    this.#part(0);
    this.area.scrollTop = 0;
    this.#follow();
  }

  #part(first) {
    this.base = Math.max(Math.min(first, this.lines.length - SHOWN), 0);
    this.area.value = this.lines.slice(this.base, this.base + SHOWN).join("\n");
  }

  // The line of the cursor.
  get cursor() {
    return this.base + this.area.value.slice(0, this.area.selectionStart).split("\n").length;
  }

  // Lines with what is wrong: "bad" or "care".
  mark(list) {
    this.found = new Map(list);
    this.#follow();
  }

  // The line that is carried out, or null.
  here(line) {
    if (line === this.line) return;
    this.line = line;
    if (line !== null && performance.now() - this.scrolled > LOOKS) this.#show(line);
    this.#follow();
  }

  // Puts the cursor to a line.
  go(line) {
    this.#show(line);
    const before = this.lines.slice(this.base, line - 1);
    const start = before.join("\n").length + (before.length ? 1 : 0);
    this.area.focus();
    this.area.setSelectionRange(start, start + (this.lines[line - 1] ?? "").length);
  }

  #show(line) {
    if (this.is_long && (line <= this.base || line > this.base + SHOWN)) this.#part(line - SHOWN / 2);
    const [top, room] = [(line - 1 - this.base) * HIGH, this.area.clientHeight];
    const { scrollTop } = this.area;
    if (top < scrollTop + HIGH || top > scrollTop + room - 3 * HIGH) this.area.scrollTop = Math.max(top - room / 3, 0);
  }

  #measure() {
    this.lines = this.area.value.split("\n");
    this.#follow();
  }

  // At the end of a part the next one begins.
  #go_on() {
    if (!this.is_long) return;
    const { scrollTop, scrollHeight, clientHeight } = this.area;
    const line = this.base + Math.floor(scrollTop / HIGH);
    const over = scrollTop + clientHeight >= scrollHeight - HIGH && this.base + SHOWN < this.lines.length;
    if (!over && !(scrollTop < HIGH && this.base > 0)) return;
    this.#part(line - SHOWN / 2);
    this.area.scrollTop = (line - this.base) * HIGH;
  }

  #follow() {
    if (this.is_long) this.#go_on();
    const { scrollTop, clientHeight } = this.area;
    const first = this.base + Math.floor(scrollTop / HIGH) + 1;
    const end = Math.min(this.base + SHOWN, this.lines.length);
    const last = Math.min(first + Math.ceil(clientHeight / HIGH), this.is_long ? end : this.lines.length);
    const rows = [];
    for (let n = first; n <= last; n += 1) {
      const row = document.createElement("span");
      row.textContent = n;
      const tone = this.found.get(n);
      if (tone) row.dataset.tone = tone;
      if (n === this.line) row.className = "here";
      rows.push(row);
    }
    this.numbers.replaceChildren(...rows);
    this.numbers.style.transform = `translateY(${(first - 1 - this.base) * HIGH - scrollTop}px)`;
    this.bar.hidden = this.line === null;
    if (this.line !== null) this.bar.style.transform = `translateY(${(this.line - 1 - this.base) * HIGH - scrollTop}px)`;
  }
}
