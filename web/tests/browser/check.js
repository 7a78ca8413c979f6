// Runs in the browser: every job on the machine of the page, then the page itself as a user would, and reports.

import { open } from "/transport.js";

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

async function run(ask, { folder, text }) {
  const settings = { text, folder, zh: false, ripple: null, counts: null, kv: null };
  const { good, found } = await ask({ do: "load", ...settings });
  if (!good) return { found };
  const told = [];
  for (;;) {
    const said = await ask({ do: "step", ticks: 10000 });
    told.push(...said.told);
    const { over, setpoint_hash: hash, hashed_ticks: ticks, time_ms } = said.state;
    if (over) return { result: { found, told, hash, ticks }, time_ms };
  }
}

async function jobs() {
  const { ask, close } = open();
  const wanted = await (await fetch("/jobs.json")).json();
  const results = [];
  let simulated = 0;
  const before = performance.now();
  for (const job of wanted) {
    const { result, found, time_ms = 0 } = await run(ask, job);
    results.push(result ?? { found });
    simulated += time_ms;
  }
  const factor = simulated / (performance.now() - before);
  close();
  return { results, factor };
}

async function page() {
  const frame = document.createElement("iframe");
  frame.width = 1280;
  frame.height = 800;
  const before = performance.now();
  frame.src = "/index.html";
  document.body.append(frame);
  await new Promise((resolve) => { frame.onload = resolve; });
  const of = (id) => frame.contentDocument.getElementById(id);
  while (!frame.contentDocument.body.dataset.ready) await pause(5);
  const ready_ms = performance.now() - before;
  of("speed").value = 3;
  of("run").click();
  while (of("hash").textContent === "–" || of("hold").disabled === false) await pause(20);
  const hash = of("hash").textContent;
  const result_ms = performance.now() - before;
  const alarm = of("alarm").textContent;
  const measured = of("threads").textContent;
  // The spindle is too slow for the thread: an alarm, and no thread.
  of("run").click();
  while (of("inject").disabled) await pause(5);
  of("fault").value = "spindle_slow";
  of("inject").click();
  while (!of("inject").disabled) await pause(20);
  const faulty = { alarm: of("alarm").textContent, hidden: of("measured").hidden };
  // A wrong word is marked, and told with its remedy.
  of("text").value = "G0 X10\nG1 Q\n";
  of("text").dispatchEvent(new Event("input"));
  while (!of("marks").querySelector("mark.alarm")) await pause(20);
  const found = of("found").textContent;
  of("language").click();
  while (of("found").textContent === found) await pause(20);
  return { hash, ready_ms, result_ms, alarm, measured, faulty, found, run: of("run").textContent };
}

const report = await jobs()
  .then(async (all) => ({ ...all, page: await page() }))
  .catch((failure) => ({ failure: String(failure.stack ?? failure) }));
await fetch("/report", { method: "POST", body: JSON.stringify(report) });
