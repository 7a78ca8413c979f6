// Carries messages to the machine and answers back, in order. Another transport with the same `ask` may take its place.

export function open() {
  const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
  const waiting = [];
  const lost = new Promise((_, fail) => { worker.onerror = (event) => fail(new Error(event.message || "worker")); });
  lost.catch(() => {});
  worker.onmessage = ({ data }) => {
    const { resolve, reject } = waiting.shift();
    if (data.failed) reject(new Error(data.failed));
    else resolve(data.answer);
  };
  const ask = (message) => {
    const answered = new Promise((resolve, reject) => {
      waiting.push({ resolve, reject });
      worker.postMessage(message);
    });
    return Promise.race([answered, lost]);
  };
  return { ask, close: () => worker.terminate() };
}
