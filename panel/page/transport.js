// Carries what the machine says to the page, over HTTP. It must not know what it means. Another transport with the same
// `watch` may take its place.

// Makes a cookie of the token in the link, once; the address then shows none.
export async function login() {
  const token = location.hash.slice(1);
  if (!token) return;
  history.replaceState(null, "", location.pathname);
  const headers = { "Content-Type": "application/json", "X-Leadscrew": "1" };
  const answer = await fetch("login", { method: "POST", headers, body: JSON.stringify({ token }) });
  if (!answer.ok) throw await answer.json();
}

// Calls `on[kind](message)` for each message. A connection that is lost is made again by the browser; one that was refused
// is not, and is told.
export function watch(on, refused) {
  const source = new EventSource("state");
  for (const [kind, take] of Object.entries(on)) source.addEventListener(kind, ({ data }) => take(JSON.parse(data)));
  source.onerror = () => { if (source.readyState === EventSource.CLOSED) refused(); };
}
