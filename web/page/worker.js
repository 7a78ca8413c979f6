// Holds the machine. Gives each message to the WebAssembly module and posts its answer.

const bytes = fetch(new URL("leadscrew.wasm", import.meta.url)).then((response) => {
  if (!response.ok) throw new Error(`leadscrew.wasm: ${response.status}`);
  return response.arrayBuffer();
});
const machine = bytes.then((read) => WebAssembly.instantiate(read)).then(({ instance }) => instance.exports);

function text(exports, from) {
  return new TextDecoder().decode(new Uint8Array(exports.memory.buffer, from, exports.leadscrew_length()));
}

function ask(exports, message) {
  const said = new TextEncoder().encode(JSON.stringify(message));
  const room = exports.leadscrew_room(said.length);
  new Uint8Array(exports.memory.buffer, room, said.length).set(said);
  try {
    return JSON.parse(text(exports, exports.leadscrew_answer()));
  } catch (trap) {
    throw new Error(`${trap}: ${text(exports, exports.leadscrew_panic())}`);
  }
}

let turn = Promise.resolve();
self.onmessage = ({ data }) => {
  turn = turn.then(async () => {
    try {
      self.postMessage({ answer: ask(await machine, data) });
    } catch (failure) {
      self.postMessage({ failed: String(failure.message ?? failure) });
    }
  });
};
