// The path in the plane Z-X, in the coordinates of the program: rapids dashed, passes in turn in the colours, and the tool.
// X is shown as a diameter elsewhere.

import { COLOURS, View, colour, grid, tip } from "./view.js";

const MILLIMETRE = 1e6;

export class Plot {
  constructor(canvas) {
    this.path = [];
    this.tool = null;
    this.view = new View(canvas, { equal: true, draw: (...all) => this.#draw(...all) });
    this.show([]);
  }

  show(path) {
    const of = ([x, z], [ox, oz]) => [x - ox, z - oz];
    this.path = path.map((piece) => ({ ...piece, from: of(piece.from, piece.origin), to: of(piece.to, piece.origin) }));
    this.origins = new Map(path.map((piece) => [piece.line, piece.origin]));
    this.origin = path[0]?.origin ?? [0, 0];
    path = this.path;
    this.tool = null;
    const cuts = path.filter((piece) => piece.kind !== "rapid");
    const ends = (cuts.length ? cuts : path).flatMap((piece) => [piece.from, piece.to]);
    const box = [Infinity, -Infinity, Infinity, -Infinity];
    for (const [x, z] of ends) {
      box[0] = Math.min(box[0], z);
      box[1] = Math.max(box[1], z);
      box[2] = Math.min(box[2], x);
      box[3] = Math.max(box[3], x);
    }
    this.view.show(ends.length ? box : [-MILLIMETRE, MILLIMETRE, -MILLIMETRE, MILLIMETRE]);
  }

  // The place of a machine position in the program's coordinates, while a line runs.
  at(x, z, line) {
    this.origin = this.origins.get(line) ?? this.origin;
    this.tool = [x - this.origin[0], z - this.origin[1]];
    this.view.redraw();
    return this.tool;
  }

  #draw(context, at, size) {
    grid(context, at, size, MILLIMETRE);
    for (const piece of this.path) {
      const rapid = piece.kind === "rapid";
      context.setLineDash(rapid ? [5, 4] : []);
      context.lineWidth = rapid ? 1 : 1.6;
      context.strokeStyle = rapid ? colour("rapid") : COLOURS[piece.pass % COLOURS.length];
      context.beginPath();
      trace(context, at, piece, size);
      context.stroke();
    }
    context.setLineDash([]);
    if (!this.tool) return;
    tip(context, ...at(this.tool[1], this.tool[0]));
  }
}

function trace(context, at, piece, size) {
  const [fx, fz] = piece.from;
  const [tx, tz] = piece.to;
  if (!piece.arc) {
    context.moveTo(...at(fz, fx));
    context.lineTo(...at(tz, tx));
    return;
  }
  // X is up and Z to the right, so that G02 goes with the clock in this picture too.
  const [i, k, with_clock] = piece.arc;
  const [cx, cz] = [fx + i, fz + k];
  const radius = Math.hypot(i, k) * size.across;
  const start = Math.atan2(fx - cx, fz - cz);
  const end = Math.atan2(tx - cx, tz - cz);
  context.arc(...at(cz, cx), radius, -start, -end, with_clock === 0);
}
