// Carries what the machine says to the page, and what the page orders to the machine, over HTTP. It must not know what either
// means. Another transport with the same functions may take its place.

const HEADERS = { "Content-Type": "application/json", "X-Leadscrew": "1" };
// A page has a name of its own: after a reload it is another one, and orders nothing that was sent before.
const c = Array.from(crypto.getRandomValues(new Uint32Array(4)), (part) => part.toString(16).padStart(8, "0")).join("");
let n = 0;
// Answers are waited for so many ms: of a frame of a press, of what is read, of a text that is written.
const FRAME = 2000;
const READ = 10000;
const WRITTEN = 60000;

// Makes a cookie of the token in the link, once; the address then shows none.
export async function login() {
  const token = location.hash.slice(1);
  if (!token) return;
  history.replaceState(null, "", location.pathname);
  const answer = await fetch("login", { method: "POST", headers: HEADERS, body: JSON.stringify({ token }) });
  if (!answer.ok) throw await answer.json();
}

// A request that waits without end keeps one of the browser's six connections, and an order would act whenever it gets out.
const within = (ms) => ({ signal: AbortSignal.timeout(ms) });

async function post(path, body, more = {}) {
  const answer = await fetch(path, { method: "POST", headers: HEADERS, body: JSON.stringify({ c, ...body }), ...more });
  return answer.json();
}

// Gives an order, and answers with what has become of it: `ok`, or `en` and `zh`. An order whose answer is lost is sent again
// under its number: it acts once. After so many ms it is given up, and neither waits in the browser nor is sent again.
export async function order(op, args, echo, patience) {
  n += 1;
  const body = { n, op, args, echo };
  const more = within(patience);
  try {
    return await post("order", body, more);
  } catch {
    return post("order", body, more);
  }
}

// Sends one frame of a press; nothing sends it again.
export const jog = (frame) => post("jog", frame, within(FRAME));

const tag_of = (answer) => answer.headers.get("ETag")?.replaceAll('"', "");

// The programs of the panel's folder.
export const programs = async () => (await fetch("programs", within(READ))).json();

// The text of one, with the tag that it goes by; or why there is none.
export async function program(name, signal) {
  const answer = await fetch(`programs/${encodeURIComponent(name)}`, { signal });
  return answer.ok ? { bytes: await answer.arrayBuffer(), tag: tag_of(answer) } : answer.json();
}

// What the panel says of one: "check" or "path".
export async function view(name, what, zh, signal) {
  const headers = { "Accept-Language": zh ? "zh" : "en" };
  return (await fetch(`programs/${encodeURIComponent(name)}/${what}`, { headers, signal })).json();
}

// Writes one in place of the text of this tag; null: there is none of its name yet.
export async function write(name, text, tag) {
  const headers = { ...HEADERS, "Content-Type": "application/octet-stream" };
  if (tag === null) headers["If-None-Match"] = "*";
  else headers["If-Match"] = `"${tag}"`;
  const answer = await fetch(`programs/${encodeURIComponent(name)}`, { method: "PUT", headers, body: text, ...within(WRITTEN) });
  const told = await answer.json();
  return answer.ok ? { tag: tag_of(answer) } : told;
}

// What is in a table of the board: "tools" or "params".
export async function sheet(name, zh) {
  return (await fetch(name, { headers: { "Accept-Language": zh ? "zh" : "en" }, ...within(READ) })).json();
}

// Says that the page operates ("keep"), wants to ("take") or does not any more ("give").
export const lease = (what, patience, more) => post("lease", { do: what }, { ...within(patience), ...more });

// A stream that is not there any more tells nothing of it: the panel says something each second.
const SILENT = 3000;

// Calls `on[kind](message)` for each message, and `refused(why)` where the panel gives no connection. One that is lost, refused
// or silent is made again. A page that is not seen has none: a browser has six for all of its pages, and a hold needs one.
export function watch(on, refused) {
  let source = null;
  let heard = 0;
  // Whoever is refused is not told why.
  const why = async () => {
    const own = source;
    try {
      const answer = await fetch("state", within(FRAME));
      if (answer.ok) await answer.body.cancel();
      else {
        const told = await answer.json();
        if (own === source) refused(told);
      }
    } catch {
      // It says nothing: the values grow old.
    }
  };
  const open = () => {
    source = new EventSource("state");
    heard = performance.now();
    for (const [kind, take] of Object.entries({ alive: () => {}, ...on })) {
      source.addEventListener(kind, ({ data }) => { heard = performance.now(); take(JSON.parse(data)); });
    }
    source.onerror = () => { if (source?.readyState === EventSource.CLOSED) why(); };
  };
  const close = () => { source?.close(); source = null; };
  document.addEventListener("visibilitychange", () => {
    if (document.hidden) close();
    else if (!source) open();
  });
  setInterval(() => {
    if (!source || performance.now() - heard < SILENT) return;
    close();
    open();
  }, 500);
  open();
}
