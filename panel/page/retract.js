// The way out of a hole: what the board has written down of the tap is shown, and then it is brought out by a button that
// is held.

import { isChinese, said, word } from "./words.js";

const at = (id) => document.getElementById(id);
let told = null;

function show() {
  // A button that goes does not take the keys with it.
  if (!told?.ok && document.activeElement === at("retract_go")) at("retract_look").focus();
  at("retract_go").hidden = !told?.ok;
  at("retract_told").textContent = told ? `${told.ok ? "" : "▲ "}${said(told)}` : "";
}

// What an order has to do, how one is told, and how a button is held.
export function begin(give, tell, held) {
  at("retract_look").onclick = async () => {
    told = await give("retract", { look: true });
    show();
  };
  held(at("retract_go"), async () => {
    const typed = at("retract_speed").value.trim();
    const speed = typed === "" ? null : Number(typed);
    if (speed !== null && !(Number.isInteger(speed) && speed > 0 && speed < 100000)) {
      return tell({ en: word("retract_rpm"), zh: word("retract_rpm") });
    }
    const answer = await give("retract", { speed, zh: isChinese() });
    // Where nothing has come of it, it can be ordered again.
    if (answer?.ok) told = null;
    show();
  });
}

export const again = show;
