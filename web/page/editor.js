// The text with its line numbers, and the places of what was found marked under the letters.

export class Editor {
  constructor({ text, numbers, marks, changed }) {
    Object.assign(this, { text, numbers, marks, found: [] });
    text.addEventListener("input", () => {
      this.show([]);
      changed();
    });
    text.addEventListener("scroll", () => this.#follow());
  }

  get value() {
    return this.text.value;
  }

  set value(text) {
    this.text.value = text;
    this.text.scrollTop = 0;
    this.show([]);
  }

  // Marks what was found. Columns count bytes from 1.
  show(found, at = 0) {
    this.found = found;
    const lines = this.value.split("\n");
    this.numbers.replaceChildren(...lines.map((_, n) => {
      const number = document.createElement("span");
      number.textContent = `${n + 1}\n`;
      number.className = n + 1 === at ? "here" : "";
      return number;
    }));
    this.marks.replaceChildren(...lines.flatMap((line, n) => marked(line, found.find((one) => one.line === n + 1))));
    this.#follow();
  }

  here(line) {
    this.numbers.querySelector(".here")?.classList.remove("here");
    this.numbers.children[line - 1]?.classList.add("here");
  }

  go(line) {
    const lines = this.value.split("\n");
    const start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    this.text.focus();
    this.text.setSelectionRange(start, start + (lines[line - 1] ?? "").length);
  }

  #follow() {
    this.numbers.scrollTop = this.text.scrollTop;
    this.marks.scrollTop = this.text.scrollTop;
    this.marks.scrollLeft = this.text.scrollLeft;
  }
}

function marked(line, one) {
  if (!one) return [`${line}\n`];
  const bytes = new TextEncoder().encode(line);
  const part = (from, to) => new TextDecoder().decode(bytes.slice(from, to));
  const from = Math.min(Math.max(one.column - 1, 0), bytes.length);
  const to = Math.min(Math.max(one.end - 1, from + 1), Math.max(bytes.length, from + 1));
  const mark = document.createElement("mark");
  mark.className = one.warning ? "warning" : "alarm";
  mark.textContent = part(from, to) || " ";
  return [part(0, from), mark, `${part(to, bytes.length)}\n`];
}
