// Axes and the spindle moved by hand: one press at a time, while a finger or a key is down, by frames that this page alone
// sends. It must not know what the page looks like.
//
// A frame carries the newest beat that this page has; the board moves until that is older than its dead man. So a page that
// stands still, is hidden or has gone ends the motion without a word.

import { jog } from "./transport.js";

const RENEWAL = 25;
// A browser has six connections, and a hold needs one.
const UNDER_WAY = 2;

let press = null;
let beat = null;
let last = null;

// Takes what the machine says of this panel's last press.
export function hear(s) {
  beat = s.beat;
  if (s.press !== null) last = s.press;
}

export const isDown = () => press !== null;

const LET_GO = { axes: [0, 0], spindle: 0 };

// Begins a press: which `way` is axes as [X, Z] and the spindle, each -1, 0 or 1. `told` gets what is wrong with it.
export function down(way, rapid, told) {
  if (press || beat === null) return;
  const number = ((last ?? 0) + 1) % 256;
  last = number;
  press = { number, way, rapid, told, waiting: 0, timer: setInterval(send, RENEWAL) };
  send();
}

// Ends it. What is sent is the release; where it is lost, the board ends the press by itself.
export function up() {
  if (!press) return;
  const { number, rapid, timer } = press;
  clearInterval(timer);
  press = null;
  jog({ press: number, ...LET_GO, rapid, speed: 0, echo: beat }).catch(() => {});
}

async function send() {
  const own = press;
  if (own.waiting >= UNDER_WAY) return;
  own.waiting += 1;
  try {
    const answer = await jog({ press: own.number, ...own.way, rapid: own.rapid, speed: 0, echo: beat });
    if (typeof answer.beat === "number") beat = answer.beat;
    const over = answer.press === own.number && ["ended", "limit", "refused"].includes(answer.pressed);
    if (press === own && (over || answer.ok !== true)) {
      up();
      own.told(answer);
    }
  } catch {
    if (press === own) {
      up();
      own.told(null);
    }
  } finally {
    own.waiting -= 1;
  }
}
