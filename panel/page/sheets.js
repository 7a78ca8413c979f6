// Tools, work offsets and parameters of the board as tables. It must not know how they are changed.

import { Table } from "./table.js";
import { word } from "./words.js";

const at = (id) => document.getElementById(id);
const AXES = ["X", "Z"];
const FIELDS = ["X", "Z", "wear.X", "wear.Z", "radius", "tip", "station", "measured"];
let give = async () => null;
// Which work offset and tool positions are shown by.
let zero = "";

function part(kind, text, more = {}) {
  const one = document.createElement(kind);
  one.textContent = text;
  return Object.assign(one, more);
}

// A table with a row for each name and a column for each field.
function grid(table, heads, names, fields, values, cell) {
  const head = document.createElement("tr");
  head.append(...heads.map((text) => part("th", text, { scope: "col" })));
  const rows = names.map((name) => {
    const row = document.createElement("tr");
    row.dataset.name = name;
    const cells = fields.map((field) => {
      const place = document.createElement("td");
      const input = cell(`${name}.${field}`, values[`${name}.${field}`]);
      input.inputMode = field === "measured" ? "text" : "decimal";
      place.append(input);
      return place;
    });
    row.append(part("th", name, { scope: "row" }), ...cells);
    return row;
  });
  table.replaceChildren(head, ...rows);
}

function draw_tools({ values }, cell) {
  const names = (axis) => [...new Set(Object.keys(values).filter((key) => key.endsWith(axis)).map((key) => key.split(".")[0]))];
  const all = names(".X");
  const [x, z] = ["X ⌀", "Z"];
  grid(at("work"), ["", x, z], all.filter((name) => !name.startsWith("T")), AXES, values, cell);
  const heads = ["", x, z, `${word("wear")} ${x}`, `${word("wear")} ${z}`, word("radius"), word("tip"), word("station"), word("touched")];
  grid(at("tool_rows"), heads, all.filter((name) => name.startsWith("T")), FIELDS, values, cell);
  mark();
}

// The row that positions are shown by has a sign, not a colour alone.
function mark() {
  const [system, tool] = zero.split(" ");
  const names = [system, tool && `T${Number(tool.slice(1))}`];
  for (const row of document.querySelectorAll("#tools tr[data-name]")) {
    const is = names.includes(row.dataset.name);
    if (is) row.setAttribute("aria-current", "true");
    else row.removeAttribute("aria-current");
    row.firstChild.textContent = is ? `▶ ${row.dataset.name}` : row.dataset.name;
  }
}

const text = (value) => (value === null ? "none" : String(value));

function draw_params({ params }, cell) {
  at("param_rows").replaceChildren(...params.map((one) => {
    const row = document.createElement("tr");
    row.dataset.differs = one.value !== one.default;
    row.dataset.text = [one.key, one.alias ?? "", one.name, one.meaning].join(" ").toLowerCase();
    const unit = one.diameter ? `${one.unit} ⌀` : one.unit;
    const value = document.createElement("td");
    value.append(cell(one.key, text(one.value)), part("span", ` ${unit}`), part("small", "", { className: "told" }));
    const what = document.createElement("td");
    const range = `${word("range")} ${text(one.min)} … ${text(one.max)}${one.none_allowed ? `, ${text(null)}` : ""}`;
    const more = [range, `${word("default")} ${text(one.default)}`, one.alias && `${word("alias")} ${one.alias}`];
    what.append(part("strong", one.axis ? `${one.name}.${one.axis}` : one.name), ` ${one.meaning}`,
      part("small", more.filter(Boolean).join(" · ")));
    row.append(part("th", row.dataset.differs === "true" ? `${one.key} ≠` : one.key, { scope: "row" }), value, what);
    return row;
  }));
  filter();
}

function filter() {
  const wanted = at("search").value.trim().toLowerCase();
  const differ = at("differ").getAttribute("aria-pressed") === "true";
  const rows = [...at("param_rows").children];
  for (const row of rows) row.hidden = !row.dataset.text.includes(wanted) || (differ && row.dataset.differs !== "true");
  at("shown").textContent = `${rows.filter((row) => !row.hidden).length} / ${rows.length}`;
}

const tables = [
  new Table(at("tools"), { path: "tools", order: (args) => give("tools", args), draw: draw_tools }),
  new Table(at("params"), { path: "params", order: (args) => give("params", args), draw: draw_params }),
];
at("search").oninput = filter;
at("differ").onclick = () => {
  at("differ").setAttribute("aria-pressed", at("differ").getAttribute("aria-pressed") !== "true");
  filter();
};

// What an order has to do: it gives what has become of it.
export function begin(order) {
  give = order;
}

// Words have changed.
export function again() {
  for (const table of tables) table.again();
}

export function state(s) {
  if (s.zero !== zero) {
    zero = s.zero ?? "";
    mark();
  }
  for (const table of tables) table.at(s.by);
}
