// How far the slide is from where the spindle's angle demands it, in micrometres, over Z: all passes one upon the other.

import { COLOURS, View, colour } from "./view.js";

const MOST = 60_000;
// A picture is not lower than this many nanometres.
const LEAST = 200;

export class Phase {
  constructor(canvas) {
    this.view = new View(canvas, { equal: false, draw: (...all) => this.#draw(...all) });
    this.clear();
  }

  clear() {
    this.samples = [];
    this.box = [Infinity, -Infinity, Infinity, -Infinity];
    this.view.show([0, 1, -1000, 1000]);
  }

  add(samples) {
    if (!samples.length) return;
    for (const sample of samples) {
      this.box[0] = Math.min(this.box[0], sample.z);
      this.box[1] = Math.max(this.box[1], sample.z);
      this.box[2] = Math.min(this.box[2], sample.error);
      this.box[3] = Math.max(this.box[3], sample.error);
      this.samples.push(sample);
    }
    // Every second one goes when there are too many for a frame.
    if (this.samples.length > MOST) this.samples = this.samples.filter((_, n) => n % 2);
    const [left, right, low, high] = this.box;
    const more = Math.max(LEAST - (high - low), 0) / 2;
    this.view.show([left, right, low - more, high + more]);
  }

  #draw(context, at, size) {
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = colour("quiet");
    context.strokeStyle = colour("grid");
    const [, , low, high] = this.view.box;
    const apart = (value) => Math.abs(value) * size.up > 16;
    const values = low < 0 && high > 0 ? [0, ...[low, high].filter(apart)] : [low, high];
    for (const value of values) {
      const [, y] = at(0, value);
      context.beginPath();
      context.moveTo(0, y);
      context.lineTo(size.width, y);
      context.stroke();
      context.fillText(`${(value / 1000).toFixed(2)} µm`, 3, y - 3);
    }
    for (const sample of this.samples) {
      const [x, y] = at(sample.z, sample.error);
      context.fillStyle = COLOURS[sample.step % COLOURS.length];
      context.fillRect(x - 1, y - 1, 2, 2);
    }
  }
}
