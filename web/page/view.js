// A canvas with a view on a plane: fits, zooms, pans, by wheel, mouse, one finger or two. Z goes to the right. Knows nothing
// of what is drawn, but for the lines that show where it is, and the mark of a tool. Both pages draw with it.

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
    this.fingers = new Map();
    this.fit();
    this.asked = false;
    canvas.addEventListener("wheel", (event) => this.#wheel(event), { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, [event.offsetX, event.offsetY]);
    });
    canvas.addEventListener("pointermove", (event) => this.#pan(event));
    for (const kind of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(kind, (event) => this.fingers.delete(event.pointerId));
    }
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

  // Larger by a factor, about a place from the middle of the canvas.
  magnify(factor, from = [0, 0]) {
    const zoom = Math.min(1e4, Math.max(0.2, this.zoom * factor));
    const by = zoom / this.zoom;
    this.zoom = zoom;
    this.shift = this.shift.map((shift, n) => from[n] - (from[n] - shift) * by);
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
    const { canvas } = this;
    const [wide, tall] = [Math.round(width * ratio), Math.round(height * ratio)];
    // Not laid out yet: it is painted again when it has a size.
    if (!wide || !tall) return;
    if (canvas.width !== wide || canvas.height !== tall) [canvas.width, canvas.height] = [wide, tall];
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    const [left, right, low, high] = this.box;
    const at = (x, y) => [
      width / 2 + (x - (left + right) / 2) * across + this.shift[0],
      height / 2 - (y - (low + high) / 2) * up + this.shift[1],
    ];
    this.draw(context, at, { width, height, across, up, ratio });
  }

  #middle(x, y) {
    return [x - this.canvas.clientWidth / 2, y - this.canvas.clientHeight / 2];
  }

  #wheel(event) {
    event.preventDefault();
    this.magnify(Math.exp(-event.deltaY / 400), this.#middle(event.offsetX, event.offsetY));
  }

  #pan(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const now = [event.offsetX, event.offsetY];
    this.fingers.set(event.pointerId, now);
    const moved = [now[0] - before[0], now[1] - before[1]];
    const other = [...this.fingers].find(([id]) => id !== event.pointerId)?.[1];
    const share = other ? 0.5 : 1;
    this.shift = this.shift.map((shift, n) => shift + moved[n] * share);
    if (other) {
      const apart = ([x, y]) => Math.max(Math.hypot(x - other[0], y - other[1]), 1);
      this.magnify(apart(now) / apart(before), this.#middle((now[0] + other[0]) / 2, (now[1] + other[1]) / 2));
    }
    this.redraw();
  }
}

// Lines and figures at round distances, about 90 pixels apart. `unit` is a millimetre; up is a radius, told as a diameter.
export function grid(context, at, size, unit) {
  const wanted = 90 / size.across;
  const decade = 10 ** Math.floor(Math.log10(wanted));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((one) => one >= wanted);
  const [zx, zy] = at(0, 0);
  context.fillStyle = colour("quiet");
  context.strokeStyle = colour("grid");
  context.lineWidth = 1;
  context.font = "11px system-ui, sans-serif";
  const said = (value) => String(+(value / unit).toPrecision(6));
  for (let n = Math.ceil(-zx / (step * size.across)); zx + n * step * size.across < size.width; n += 1) {
    const x = zx + n * step * size.across;
    line(context, x, 0, x, size.height);
    context.fillText(said(n * step), x + 3, size.height - 4);
  }
  for (let n = Math.ceil((zy - size.height) / (step * size.up)); zy - n * step * size.up > 0; n += 1) {
    const y = zy - n * step * size.up;
    line(context, 0, y, size.width, y);
    context.fillText(`⌀${said(2 * n * step)}`, 3, y - 3);
  }
}

function line(context, ...[fx, fy, tx, ty]) {
  context.beginPath();
  context.moveTo(fx, fy);
  context.lineTo(tx, ty);
  context.stroke();
}

// The tip of a tool.
export function tip(context, x, y) {
  context.strokeStyle = colour("tool");
  context.lineWidth = 2;
  context.beginPath();
  context.arc(x, y, 5, 0, 2 * Math.PI);
  context.moveTo(x - 10, y);
  context.lineTo(x + 10, y);
  context.moveTo(x, y - 10);
  context.lineTo(x, y + 10);
  context.stroke();
}
