// The page at the machine: joins the transport and what is shown. It orders nothing.

import * as show from "./show.js";
import { login, watch } from "./transport.js";
import { isChinese, use, word } from "./words.js";

let last = null;
let entries = null;
let heard = performance.now();
let refused = null;

function again() {
  if (last) show.state(last);
  if (entries) show.log(entries);
}

function languages(zh) {
  use(zh);
  const button = document.getElementById("language");
  button.textContent = zh ? "English" : "中文";
  button.lang = zh ? "en" : "zh";
  again();
}

// Values have an age when they come, and grow older here.
function grow() {
  if (refused) show.banner(refused());
  else show.age(performance.now() - heard + (last ? last.age_ms : 0));
}

document.getElementById("language").onclick = () => languages(!isChinese());
languages(navigator.language.startsWith("zh"));
setInterval(grow, 100);

try {
  await login();
  watch({
    hello: show.hello,
    s: (s) => { last = s; heard = performance.now(); show.state(s); grow(); },
    log: (list) => { entries = list; show.log(list); },
  }, () => { refused = () => word("login"); grow(); });
} catch (error) {
  refused = () => (error.refused ? error[isChinese() ? "zh" : "en"] : word("lost"));
  grow();
}
