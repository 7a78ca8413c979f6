// The path of the open program, in the plane Z-X, and the tool where it is. It must not know how either has come.
//
// The path goes to a picture of its own once for each view; a frame is that picture, what was cut since, and the tool.

import { View, colour, grid, tip } from "./view.js";

// A millimetre, in the units of the path.
const UNIT = 10000;
const KINDS = [["r", "rapid", 1, [5, 4]], ["f", "feed", 1.6, []], ["t", "thread", 1.6, []], ["p", "tap", 2.4, []]];
// Pieces of a path that are shorter on the screen are not drawn one by one.
const SHORT = 0.5;

// Sums up differences.
function sums(list, Kind) {
  const all = new Kind(list.length);
  let sum = 0;
  for (let n = 0; n < list.length; n += 1) {
    sum += list[n];
    all[n] = sum;
  }
  return all;
}

export class Path {
  constructor(canvas) {
    this.view = new View(canvas, { equal: true, draw: (...all) => this.#draw(...all) });
    this.layers = [0, 1].map(() => ({ canvas: document.createElement("canvas"), key: "" }));
    this.drawn = 0;
    this.count = 0;
    this.tool = null;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#forget());
    this.show(null);
  }

  // What the panel says of a program; null for none.
  show(told) {
    const path = told ?? { kinds: "", lines: [], numbers: [], z: [], x: [], zeros: [], zones: [], limits: null, stock: null };
    this.path = {
      ...path,
      kinds: new TextEncoder().encode(path.kinds),
      numbers: sums(path.numbers, Uint32Array),
      z: sums(path.z, Int32Array),
      x: sums(path.x, Int32Array),
    };
    this.under_way = false;
    this.done = 0;
    this.view.show(this.#box());
    this.#forget();
  }

  get length() {
    return this.path.kinds.length;
  }

  // Where the tool is by the machine's zero in millimetres, X as a radius; the number of the move that is under way, or null.
  at(x, z, move) {
    const { numbers } = this.path;
    this.under_way = move !== null && this.length > 0;
    this.move = move;
    const [from, to] = this.under_way ? [first(numbers, move), first(numbers, move + 1)] : [0, 0];
    const zero = this.#zero(this.under_way ? Math.min(from, this.length - 1) : this.#cut());
    this.zero = zero;
    this.tool = [(z - (zero?.z ?? 0)) * UNIT, (x - (zero?.x ?? 0)) * UNIT];
    // Of an arc that is under way, the pieces before the one that the tool is next to.
    let [done, least] = [from, Infinity];
    for (let n = from; n < to; n += 1) {
      const apart = Math.hypot(this.path.z[n] - this.tool[0], this.path.x[n] - this.tool[1]);
      if (to - from > 1 && apart < least) [done, least] = [n, apart];
    }
    this.done = done;
    this.view.redraw();
  }

  // The way to the end of the move that is under way, in millimetres: X as a diameter, Z; null where the move has no piece.
  get to_go() {
    const { numbers, z, x } = this.path;
    const last = first(numbers, this.move + 1) - 1;
    if (!this.under_way || last < 0 || numbers[last] !== this.move) return null;
    return [2 * (x[last] - this.tool[1]) / UNIT, (z[last] - this.tool[0]) / UNIT];
  }

  #forget() {
    for (const layer of this.layers) layer.key = "";
    this.view.redraw();
  }

  // The first piece that cuts.
  #cut() {
    const cuts = this.path.kinds.findIndex((kind) => kind !== 114 && kind !== 109);
    return Math.max(cuts, 0);
  }

  #zero(at) {
    return this.path.zeros.findLast((zero) => zero.from <= at) ?? null;
  }

  #box() {
    const box = [Infinity, -Infinity, Infinity, -Infinity];
    const add = (z, x) => {
      box[0] = Math.min(box[0], z);
      box[1] = Math.max(box[1], z);
      box[2] = Math.min(box[2], x);
      box[3] = Math.max(box[3], x);
    };
    const { kinds, z, x, stock } = this.path;
    const has_cuts = kinds.some((kind) => kind !== 114 && kind !== 109);
    for (let n = 1; n < kinds.length; n += 1) {
      if (kinds[n] === 109 || (has_cuts && kinds[n] === 114)) continue;
      add(z[n - 1], x[n - 1]);
      add(z[n], x[n]);
    }
    if (stock) {
      add(stock.z0 * UNIT, 0);
      add(stock.z1 * UNIT, stock.x1 * UNIT);
    }
    return box[0] <= box[1] ? box : [-50 * UNIT, 10 * UNIT, 0, 30 * UNIT];
  }

  #draw(context, at, size) {
    const zero = this.zero ?? this.#zero(this.#cut());
    const key = [size.width, size.height, size.ratio, ...at(0, 0), size.across, zero?.from, this.under_way].join();
    const [all, cut] = this.layers;
    if (all.key !== key) {
      const ink = this.#begin(all, size, key);
      this.#around(ink, at, size, zero);
      ink.globalAlpha = this.under_way ? 0.45 : 1;
      this.#trace(ink, at, size, 1, this.length);
    }
    if (cut.key !== key || this.done < this.drawn) {
      this.#begin(cut, size, key);
      this.drawn = 1;
    }
    if (this.under_way && this.done > this.drawn) {
      this.#trace(cut.canvas.getContext("2d"), at, size, this.drawn, this.done);
      this.drawn = this.done;
    }
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(all.canvas, 0, 0);
    if (this.under_way) context.drawImage(cut.canvas, 0, 0);
    context.restore();
    if (!this.tool) return;
    const [x, y] = at(...this.tool);
    if (this.under_way && this.done > 0 && this.done < this.length) {
      const kind = KINDS.find(([code]) => code.charCodeAt(0) === this.path.kinds[this.done]);
      if (kind) {
        this.#pen(context, kind);
        context.beginPath();
        context.moveTo(...at(this.path.z[this.done - 1], this.path.x[this.done - 1]));
        context.lineTo(x, y);
        context.stroke();
        context.setLineDash([]);
      }
    }
    tip(context, x, y);
  }

  #begin(layer, size, key) {
    layer.key = key;
    layer.canvas.width = Math.round(size.width * size.ratio);
    layer.canvas.height = Math.round(size.height * size.ratio);
    const ink = layer.canvas.getContext("2d");
    ink.setTransform(size.ratio, 0, 0, size.ratio, 0, 0);
    return ink;
  }

  #pen(ink, [, name, width, dash]) {
    ink.strokeStyle = colour(name);
    ink.lineWidth = width;
    ink.setLineDash(dash);
  }

  // The pieces from one to another: those that are seen, and those that are long enough to be told apart.
  #trace(ink, at, size, from, to) {
    const { kinds, z, x } = this.path;
    const [left, top] = at(0, 0);
    const across = (n) => left + z[n] * size.across;
    const up = (n) => top - x[n] * size.up;
    const out = (a, b, most) => (a < 0 && b < 0) || (a > most && b > most);
    for (const kind of KINDS) {
      const code = kind[0].charCodeAt(0);
      this.#pen(ink, kind);
      ink.beginPath();
      let pen = -1;
      let [px, py] = [0, 0];
      for (let n = Math.max(from, 1); n < to; n += 1) {
        if (kinds[n] !== code) { pen = -1; continue; }
        const [tx, ty] = [across(n), up(n)];
        if (pen !== n - 1) {
          [px, py] = [across(n - 1), up(n - 1)];
          ink.moveTo(px, py);
        }
        const ends = n + 1 === to || kinds[n + 1] !== code;
        if (out(px, tx, size.width) || out(py, ty, size.height)) {
          pen = n;
          [px, py] = [tx, ty];
          ink.moveTo(px, py);
        } else if (ends || Math.abs(tx - px) + Math.abs(ty - py) >= SHORT) {
          ink.lineTo(tx, ty);
          pen = n;
          [px, py] = [tx, ty];
        } else {
          // The pen stays; the next piece begins where it is.
          pen = n;
        }
      }
      ink.stroke();
    }
    ink.setLineDash([]);
  }

  // Zones of the spindle, limits of the machine, the stock of the work.
  #around(ink, at, size, zero) {
    const corners = (area, dx, dz) => {
      // A zone may be without an end.
      const far = (value, most) => Math.min(Math.max(value, -most), most);
      const [x0, y0] = at((area.z0 - dz) * UNIT, (area.x1 - dx) * UNIT);
      const [x1, y1] = at((area.z1 - dz) * UNIT, (area.x0 - dx) * UNIT);
      const [l, t, r, b] = [far(x0, 1e4), far(y0, 1e4), far(x1, 1e4), far(y1, 1e4)];
      return [l, t, r - l, b - t];
    };
    const { stock, zones, limits } = this.path;
    if (stock) {
      ink.fillStyle = colour("stock");
      ink.fillRect(...corners(stock, 0, 0));
    }
    for (const zone of zones) {
      const area = corners(zone, zero?.work_x ?? 0, zero?.work_z ?? 0);
      ink.globalAlpha = 0.18;
      ink.fillStyle = colour("alarm");
      ink.fillRect(...area);
      ink.globalAlpha = 1;
      ink.strokeStyle = colour("alarm");
      ink.lineWidth = 1;
      ink.strokeRect(...area);
    }
    grid(ink, at, size, UNIT);
    const [, middle] = at(0, 0);
    ink.strokeStyle = colour("quiet");
    ink.setLineDash([18, 4, 3, 4]);
    ink.beginPath();
    ink.moveTo(0, middle);
    ink.lineTo(size.width, middle);
    ink.stroke();
    if (limits && zero) {
      ink.strokeStyle = colour("alarm");
      ink.setLineDash([2, 4]);
      ink.strokeRect(...corners(limits, zero.x, zero.z));
    }
    ink.setLineDash([]);
  }
}

// The first place in a list that rises whose value is not below `value`.
function first(list, value) {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}
