"use strict";
// The page of a picture: the tool path in Z and X, the program beside it, and the way of the tool over time. All figures
// are in `data`, made by `plot`; nothing is loaded.
const data = JSON.parse(document.getElementById("data").textContent);
const canvas = document.getElementById("path");
const ink = canvas.getContext("2d");
const told = document.getElementById("told");
const time = document.getElementById("time");
const clock = document.getElementById("clock");
const play = document.getElementById("play");
const list = document.getElementById("program");
const warnings = document.getElementById("warnings");
const run = data.run;

// Millimetres at the middle of the canvas, pixels a millimetre along Z, and how much more X is drawn.
const view = { z: 0, x: 0, scale: 1, stretch: 1 };
let chosen = 0;
let now = 0;
let plays = 0;

const size = () => [canvas.clientWidth, canvas.clientHeight];
const toPixel = (z, x) => {
  const [w, h] = size();
  return [w / 2 + (z - view.z) * view.scale, h / 2 - (x - view.x) * view.scale * view.stretch];
};
const toPlace = (px, py) => {
  const [w, h] = size();
  return [view.z + (px - w / 2) / view.scale, view.x - (py - h / 2) / view.scale / view.stretch];
};
const colour = (name) => getComputedStyle(document.body).getPropertyValue("--" + name);

function fit(strokes) {
  let [z0, z1, x0, x1] = [Infinity, -Infinity, Infinity, -Infinity];
  for (const { p } of strokes) {
    for (let n = 0; n < p.length; n += 2) {
      [z0, z1] = [Math.min(z0, p[n]), Math.max(z1, p[n])];
      [x0, x1] = [Math.min(x0, p[n + 1]), Math.max(x1, p[n + 1])];
    }
  }
  if (data.stock) {
    const [back, bore, face, outside] = data.stock;
    [z0, z1, x0, x1] = [Math.min(z0, back), Math.max(z1, face), Math.min(x0, bore), Math.max(x1, outside)];
  }
  if (z0 > z1) [z0, z1, x0, x1] = [-1, 1, -1, 1];
  const [w, h] = size();
  view.z = (z0 + z1) / 2;
  view.x = (x0 + x1) / 2;
  view.scale = 0.9 * Math.min(w / Math.max(z1 - z0, 0.01), h / Math.max((x1 - x0) * view.stretch, 0.01));
  draw();
}
const whole = () => fit(data.strokes);
const part = () => {
  const cuts = data.strokes.filter((stroke) => stroke.k !== "rapid");
  fit(cuts.length ? cuts : data.strokes);
};

// The smallest of 1, 2, 5 · 10ⁿ that is not below `least`.
function step(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((n) => n * power).find((n) => n >= least * 0.999999);
}
const shown = (value, by) => value.toFixed(Math.max(0, Math.ceil(-Math.log10(by) - 1e-9)));

function grid() {
  const [w, h] = size();
  const [z0, x1] = toPlace(0, 0);
  const [z1, x0] = toPlace(w, h);
  ink.lineWidth = 1;
  ink.strokeStyle = colour("grid");
  ink.fillStyle = colour("text");
  ink.beginPath();
  const z = step(90 / view.scale);
  for (let n = Math.ceil(z0 / z); n * z <= z1; n += 1) {
    const [px] = toPixel(n * z, 0);
    ink.moveTo(px, 0);
    ink.lineTo(px, h);
    ink.fillText(shown(n * z, z), px + 3, h - 5);
  }
  // Labels are diameters, drawn radii.
  const x = step((2 * 50) / view.scale / view.stretch);
  for (let n = Math.ceil((2 * x0) / x); n * x <= 2 * x1; n += 1) {
    const [, py] = toPixel(0, (n * x) / 2);
    ink.moveTo(0, py);
    ink.lineTo(w, py);
    ink.fillText(shown(n * x, x), 4, py - 3);
  }
  ink.stroke();
  ink.strokeStyle = colour("rapid");
  ink.setLineDash([18, 4, 3, 4]);
  ink.beginPath();
  const [, centre] = toPixel(0, 0);
  ink.moveTo(0, centre);
  ink.lineTo(w, centre);
  ink.stroke();
  ink.setLineDash([]);
}

function trace(strokes, kind, width) {
  ink.strokeStyle = colour(kind);
  ink.lineWidth = width;
  ink.setLineDash(kind === "rapid" ? [5, 4] : []);
  ink.beginPath();
  for (const { p } of strokes) {
    for (let n = 0; n < p.length; n += 2) {
      const [px, py] = toPixel(p[n], p[n + 1]);
      if (n) ink.lineTo(px, py);
      else ink.moveTo(px, py);
    }
  }
  ink.stroke();
  ink.setLineDash([]);
}

function stock() {
  if (!data.stock) return;
  const [back, bore, face, outside] = data.stock;
  const [left, upper] = toPixel(back, outside);
  const [right, lower] = toPixel(face, bore);
  ink.fillStyle = ink.strokeStyle = colour("rapid");
  ink.globalAlpha = 0.12;
  ink.fillRect(left, upper, right - left, lower - upper);
  ink.globalAlpha = 1;
  ink.lineWidth = 1;
  ink.setLineDash([8, 3]);
  ink.strokeRect(left, upper, right - left, lower - upper);
  ink.setLineDash([]);
}

// Rapids through the material, and where each warning is, with its line.
function warn() {
  ink.save();
  trace(data.marks.filter((mark) => mark.p), "warn", 4);
  ink.strokeStyle = ink.fillStyle = colour("warn");
  ink.lineWidth = 1.6;
  const spots = data.marks.map((mark) => [...toPixel(...mark.at), mark]);
  ink.beginPath();
  for (const [px, py] of spots) {
    ink.moveTo(px + 5, py);
    ink.arc(px, py, 5, 0, 2 * Math.PI);
  }
  ink.stroke();
  ink.font = `600 ${ink.font}`;
  // Upon a line they are read by their edge.
  [ink.strokeStyle, ink.lineWidth, ink.lineJoin] = [colour("panel"), 4, "round"];
  const taken = [];
  for (const [px, py, { line }] of spots) {
    // One upon the other they cannot be read.
    if (taken.some(([x, y]) => Math.abs(x - px) < 44 && Math.abs(y - py) < 14)) continue;
    taken.push([px, py]);
    ink.strokeText(`⚠ ${line}`, px + 7, py - 5);
    ink.fillText(`⚠ ${line}`, px + 7, py - 5);
  }
  ink.restore();
}

function draw() {
  const [w, h] = size();
  const ratio = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  ink.setTransform(ratio, 0, 0, ratio, 0, 0);
  ink.font = "12px system-ui, sans-serif";
  ink.clearRect(0, 0, w, h);
  grid();
  stock();
  for (const [kind, width] of [["rapid", 1], ["feed", 1.6], ["thread", 1.2], ["tap", 2.4]]) {
    trace(data.strokes.filter((stroke) => stroke.k === kind), kind, width);
  }
  if (chosen) {
    trace(data.strokes.filter((stroke) => stroke.l === chosen), "chosen", 3.5);
  }
  warn();
  if (run) {
    const [px, py] = toPixel(run.z[now], run.x[now]);
    ink.fillStyle = colour("chosen");
    ink.beginPath();
    ink.arc(px, py, 5, 0, 2 * Math.PI);
    ink.fill();
  }
}

function choose(line) {
  if (line === chosen) return;
  chosen = line;
  for (const item of list.querySelectorAll(".chosen")) item.classList.remove("chosen");
  const item = list.children[line - 1];
  if (item) {
    item.classList.add("chosen");
    item.scrollIntoView({ block: "nearest" });
  }
  draw();
}

// The square of the distance of a point from the way between two others.
function apart(ax, ay, bx, by, px, py) {
  const [dx, dy] = [bx - ax, by - ay];
  const along = dx || dy ? Math.min(1, Math.max(0, ((px - ax) * dx + (py - ay) * dy) / (dx * dx + dy * dy))) : 0;
  return (ax + along * dx - px) ** 2 + (ay + along * dy - py) ** 2;
}

// The text of a block, where it is one of the program's own file.
const block = (line) => (data.program[line - 1] ?? "").trim();

// The stroke next to a pixel, within ten of them.
function nearest(px, py) {
  let [least, found] = [100, null];
  for (const stroke of data.strokes) {
    const p = stroke.p;
    for (let n = 0; n + 3 < p.length; n += 2) {
      const [ax, ay] = toPixel(p[n], p[n + 1]);
      const [bx, by] = toPixel(p[n + 2], p[n + 3]);
      const far = apart(ax, ay, bx, by, px, py);
      // Cuts before rapids where both are there.
      if (far < least - (stroke.k === "rapid" ? 4 : 0)) [least, found] = [far, stroke];
    }
  }
  return found;
}

// What is wrong with a stroke, or at a pixel.
function wrong(stroke, px, py) {
  const isIt = ({ p, at }) => {
    const [x, y] = toPixel(...at);
    return Math.hypot(x - px, y - py) < 10 || (p && stroke && p.join() === stroke.p.join());
  };
  const mark = data.marks.find(isIt);
  return mark ? `⚠ ${mark.line}: ${mark.words} · ` : "";
}

let drag = null;
canvas.addEventListener("pointerdown", (event) => {
  drag = [event.offsetX, event.offsetY];
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointerup", () => {
  drag = null;
});
canvas.addEventListener("pointermove", (event) => {
  const [px, py] = [event.offsetX, event.offsetY];
  if (drag) {
    view.z -= (px - drag[0]) / view.scale;
    view.x += (py - drag[1]) / view.scale / view.stretch;
    drag = [px, py];
    draw();
    return;
  }
  const [z, x] = toPlace(px, py);
  const stroke = nearest(px, py);
  const of = stroke
    ? `${data.words[stroke.k]}${stroke.l ? data.words.line.replace("{}", stroke.l) + block(stroke.l) : ""} · `
    : "";
  told.textContent = `${wrong(stroke, px, py)}${of}X ${(2 * x).toFixed(3)} · Z ${z.toFixed(3)}`;
  choose(stroke ? stroke.l : 0);
});
canvas.addEventListener(
  "wheel",
  (event) => {
    event.preventDefault();
    const [z, x] = toPlace(event.offsetX, event.offsetY);
    const by = Math.exp(-event.deltaY / 400);
    view.scale = Math.min(1e6, Math.max(0.01, view.scale * by));
    const [z2, x2] = toPlace(event.offsetX, event.offsetY);
    view.z += z - z2;
    view.x += x - x2;
    draw();
  },
  { passive: false },
);
canvas.addEventListener("dblclick", part);
document.getElementById("part").addEventListener("click", part);
document.getElementById("whole").addEventListener("click", whole);
document.getElementById("stretch").addEventListener("change", (event) => {
  view.stretch = Number(event.target.value);
  part();
});

function at(index) {
  now = Math.min(run.z.length - 1, Math.max(0, Math.round(index)));
  time.value = now;
  clock.textContent = `${(now * run.every).toFixed(2)} s`;
  if (run.l[now] && plays) choose(run.l[now]);
  draw();
}
if (run) {
  time.max = run.z.length - 1;
  time.addEventListener("input", () => at(Number(time.value)));
  let [started, from] = [0, 0];
  const tick = (instant) => {
    if (!plays) return;
    const speed = Number(document.getElementById("speed").value);
    at(from + (((instant - started) / 1000) * speed) / run.every);
    if (now >= run.z.length - 1) {
      plays = 0;
      play.textContent = "▶";
      return;
    }
    requestAnimationFrame(tick);
  };
  play.addEventListener("click", () => {
    plays = plays ? 0 : 1;
    play.textContent = plays ? "❚❚" : "▶";
    [started, from] = [performance.now(), now >= run.z.length - 1 ? 0 : now];
    requestAnimationFrame(tick);
  });
  document.getElementById("speed").addEventListener("change", () => {
    [started, from] = [performance.now(), now];
  });
} else {
  for (const part of document.querySelectorAll(".run")) part.hidden = true;
}

// The views of the cut, one picture: a click brings one of them near. What is next to the pointer is told and chosen.
function views(svg) {
  const output = svg.parentElement.querySelector("output");
  const hint = output.textContent;
  const whole = svg.getAttribute("viewBox").split(/[\s,]+/).map(Number);
  const panes = [...svg.querySelectorAll("[data-pane]")].map((group) => {
    const [left, top, right, bottom, ...values] = group.dataset.pane.split(" ").map(Number);
    const names = group.dataset.names.split(" ");
    const lines = [...group.querySelectorAll("[data-told]")].map((path) => ({
      path,
      p: (path.getAttribute("d").match(/-?[\d.]+/g) ?? []).map(Number),
    }));
    return { left, top, right, bottom, values, names, lines };
  });
  let [box, drag, marked] = [whole, null, null];
  const show = (next) => {
    box = next;
    svg.setAttribute("viewBox", box.join(" "));
    svg.classList.toggle("near", box !== whole);
    // The picture keeps its place on the page.
    svg.style.height = box === whole ? "" : `${svg.clientHeight}px`;
  };
  const place = (event) => {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    return [at.x, at.y];
  };
  const paneAt = (x, y) => panes.find((one) => x >= one.left && x <= one.right && y >= one.top && y <= one.bottom);
  const mark = (path) => {
    if (path === marked) return;
    marked?.classList.remove("chosen");
    marked = path;
    marked?.classList.add("chosen");
    choose(marked ? Number(marked.dataset.line) : 0);
  };
  const tell = ([x, y]) => {
    const pane = paneAt(x, y);
    if (!pane) {
      mark(null);
      output.textContent = hint;
      return;
    }
    let [least, found] = [(10 / svg.getScreenCTM().a) ** 2, null];
    for (const { path, p } of pane.lines) {
      for (let n = 0; n + 3 < p.length; n += 2) {
        const far = apart(p[n], p[n + 1], p[n + 2], p[n + 3], x, y);
        if (far < least) [least, found] = [far, path];
      }
    }
    mark(found);
    const [a0, a1, b0, b1] = pane.values;
    const values = [
      [pane.names[0], a0 + ((x - pane.left) / (pane.right - pane.left)) * (a1 - a0)],
      [pane.names[1], b0 + ((pane.bottom - y) / (pane.bottom - pane.top)) * (b1 - b0)],
    ].sort();
    const text = found ? block(Number(found.dataset.line)) : "";
    const of = found ? `${found.dataset.told}${text && `: ${text}`} · ` : "";
    output.textContent = of + values.map(([name, value]) => `${name} ${value.toFixed(4)}`).join(" · ");
  };
  svg.addEventListener("click", (event) => {
    const pane = paneAt(...place(event));
    if (box !== whole || !pane) return;
    // With its labels.
    const [wide, high] = [pane.right - pane.left + 180, pane.bottom - pane.top + 70];
    show([pane.left - 70, pane.top - 30, wide, high]);
  });
  svg.addEventListener("dblclick", () => show(whole));
  svg.addEventListener("pointerdown", (event) => {
    if (box === whole) return;
    drag = place(event);
    svg.setPointerCapture(event.pointerId);
  });
  svg.addEventListener("pointerup", () => {
    drag = null;
  });
  svg.addEventListener("pointermove", (event) => {
    const [x, y] = place(event);
    if (drag) show([box[0] - (x - drag[0]), box[1] - (y - drag[1]), box[2], box[3]]);
    else tell([x, y]);
  });
  svg.addEventListener("pointerleave", () => {
    mark(null);
    output.textContent = hint;
  });
  svg.addEventListener(
    "wheel",
    (event) => {
      // The page is scrolled over pictures that are not near.
      if (box === whole && !event.ctrlKey) return;
      event.preventDefault();
      const [x, y] = place(event);
      const by = Math.max(Math.exp(event.deltaY / 400), 0.01 / box[2]);
      show([x - (x - box[0]) * by, y - (y - box[1]) * by, box[2] * by, box[3] * by]);
    },
    { passive: false },
  );
}
for (const svg of document.querySelectorAll(".cuts svg")) views(svg);

for (const line of data.program) {
  const item = document.createElement("li");
  item.textContent = line;
  list.append(item);
}
for (const { l } of data.marks) list.children[l - 1]?.classList.add("warned");
list.addEventListener("click", (event) => {
  const item = event.target.closest("li");
  if (item) choose([...list.children].indexOf(item) + 1);
});
warnings?.addEventListener("click", (event) => {
  const item = event.target.closest("li");
  if (item) choose(Number(item.dataset.line));
});
window.addEventListener("resize", draw);
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
part();
