// A canvas with a view on a plane in nanometres: fits, zooms, pans. Z goes to the right. Knows nothing of what is drawn.

export const COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"];

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export class View {
  constructor(canvas, { equal, draw }) {
    this.canvas = canvas;
    this.equal = equal;
    this.draw = draw;
    this.box = [-1, 1, -1, 1];
    this.fit();
    this.asked = false;
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener("pointermove", (event) => this.#pan(event));
    canvas.addEventListener("dblclick", () => this.fit());
    new ResizeObserver(() => this.redraw()).observe(canvas);
  }

  // The box is [least across, greatest across, least up, greatest up].
  show(box) {
    this.box = box;
    this.redraw();
  }

  fit() {
    this.zoom = 1;
    this.shift = [0, 0];
    this.redraw();
  }

  redraw() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => {
      this.asked = false;
      this.#paint();
    });
  }

  #scale() {
    const [left, right, low, high] = this.box;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const margin = 28;
    let across = (width - 2 * margin) / Math.max(right - left, 1);
    let up = (height - 2 * margin) / Math.max(high - low, 1);
    if (this.equal) across = up = Math.min(across, up);
    return { width, height, across: across * this.zoom, up: up * this.zoom };
  }

  #paint() {
    const { width, height, across, up } = this.#scale();
    const ratio = devicePixelRatio;
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    const context = this.canvas.getContext("2d");
    context.scale(ratio, ratio);
    const [left, right, low, high] = this.box;
    const at = (x, y) => [
      width / 2 + (x - (left + right) / 2) * across + this.shift[0],
      height / 2 - (y - (low + high) / 2) * up + this.shift[1],
    ];
    this.draw(context, at, { width, height, across, up });
  }

  #wheel(event) {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY / 400);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const from = [event.offsetX - width / 2, event.offsetY - height / 2];
    this.zoom = Math.min(1e4, Math.max(0.2, this.zoom * factor));
    this.shift = this.shift.map((shift, n) => from[n] - (from[n] - shift) * factor);
    this.redraw();
  }

  #pan(event) {
    if (!event.buttons) return;
    this.shift = [this.shift[0] + event.movementX, this.shift[1] + event.movementY];
    this.redraw();
  }
}
