//! The page in headless Chromium: buttons and keys as somebody would use them, and what the machine does then.
//!
//! Chromium is driven over a pair of pipes. `cargo xtask page --check` runs this; without Chromium it fails. What a page
//! writes to the console as an error or a warning fails its test, but for what the test expects.

mod cut;
mod gone;
mod hour;
mod keys;
mod levels;
mod long;
mod lost;
mod picture;
mod retract;
mod shown;
mod start;
mod tables;
mod touch;
mod turn;
mod typed;
mod waits;

use std::fs::{File, OpenOptions};
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::Page;
use crate::{LIMIT, LONG, User, good};

struct Browser {
    child: Child,
    input: File,
    output: BufReader<File>,
    number: u64,
    /// What pages wrote to the console.
    complaints: Vec<String>,
    /// Parts of what they may write.
    expected: Vec<&'static str>,
    is_killed: bool,
}

/// What the browser's own protocol tells of the console that nobody wants to see there.
fn complaint(event: &Value) -> Option<String> {
    let params = &event["params"];
    let is_bad = |level: &Value| matches!(level.as_str(), Some("error" | "warning" | "assert"));
    let told = match event["method"].as_str()? {
        "Runtime.exceptionThrown" => &params["exceptionDetails"],
        "Runtime.consoleAPICalled" if is_bad(&params["type"]) => &params["args"],
        "Log.entryAdded" if is_bad(&params["entry"]["level"]) => &params["entry"],
        _ => return None,
    };
    Some(told.to_string())
}

impl Browser {
    fn start(user: &User) -> Self {
        Self::with(user, "")
    }

    /// The same with an option of its own.
    fn with(user: &User, more: &str) -> Self {
        let [input, output] = ["in", "out"].map(|name| user.0.join(name));
        let made = Command::new("mkfifo").args([&input, &output]).status();
        assert!(made.unwrap().success());
        let log = File::create(user.0.join("chromium.log")).unwrap();
        let child = Command::new("sh")
            .arg("-c")
            .arg(format!("exec chromium --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --no-first-run \
                --disable-background-networking --lang=en --remote-debugging-pipe --user-data-dir=profile {more} 3<in 4>out"))
            .current_dir(&user.0)
            .stdout(log.try_clone().unwrap())
            .stderr(log)
            .spawn()
            .unwrap();
        Self {
            child,
            input: OpenOptions::new().write(true).open(input).unwrap(),
            output: BufReader::new(File::open(output).unwrap()),
            number: 0,
            complaints: Vec::new(),
            // An order that is refused, which the page itself tells.
            expected: vec!["the server responded with a status of 409 (Conflict)"],
            is_killed: false,
        }
    }

    /// What was written to the console up to now and is not expected.
    fn complained(&mut self) -> Vec<&String> {
        self.asks(None, "Browser.getVersion", json!({}));
        let expected = |one: &&String| self.expected.iter().any(|part| one.contains(part));
        let all = self.complaints.iter();
        all.filter(|one| !expected(one)).collect()
    }

    /// Ends it as a loss of power would.
    fn killed(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
        self.is_killed = true;
    }

    /// Waits until it tells this.
    fn hears(&mut self, event: &str) {
        loop {
            let told = self.next();
            if told["method"] == event {
                return;
            }
            self.complaints.extend(complaint(&told));
        }
    }

    /// What it says next.
    fn next(&mut self) -> Value {
        let mut answer = Vec::new();
        self.output.read_until(0, &mut answer).unwrap();
        assert_eq!(answer.pop(), Some(0), "Chromium has ended");
        serde_json::from_slice(&answer).unwrap()
    }

    /// Gives a command, and waits for no answer.
    fn sends(&mut self, session: Option<&str>, method: &str, params: Value) {
        self.number += 1;
        let mut message = json!({"id": self.number, "method": method, "params": params});
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        write!(self.input, "{message}\0").unwrap();
    }

    /// The result of a command of the browser's own protocol.
    #[track_caller]
    fn asks(&mut self, session: Option<&str>, method: &str, params: Value) -> Value {
        let mut answer = self.answer(session, method, params);
        assert!(answer["error"].is_null(), "{answer}");
        answer["result"].take()
    }

    /// The same with what may be wrong with it.
    fn answer(&mut self, session: Option<&str>, method: &str, params: Value) -> Value {
        self.sends(session, method, params);
        loop {
            let answer = self.next();
            if answer["id"] == self.number {
                return answer;
            }
            self.complaints.extend(complaint(&answer));
        }
    }

    /// A tab at this address, with the page at the machine in it.
    fn tab(&mut self, address: &str) -> Tab<'_> {
        let mut tab = self.opens(address);
        tab.wait("document.getElementById('mx')?.textContent > ''");
        tab
    }

    /// A tab at this address.
    fn opens(&mut self, address: &str) -> Tab<'_> {
        let target = self.asks(None, "Target.createTarget", json!({"url": address}));
        let target = target["targetId"].as_str().unwrap().to_owned();
        let params = json!({"targetId": target, "flatten": true});
        let session = self.asks(None, "Target.attachToTarget", params);
        let session = session["sessionId"].as_str().unwrap().to_owned();
        let mut tab = Tab {
            browser: self,
            session,
            target,
        };
        // Each tells what was written before, too.
        for domain in ["Runtime.enable", "Log.enable"] {
            tab.asks(domain, json!({}));
        }
        tab
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        if !self.is_killed && !std::thread::panicking() {
            let complained = self.complained();
            assert!(complained.is_empty(), "the console: {complained:#?}");
        }
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

struct Tab<'a> {
    browser: &'a mut Browser,
    session: String,
    target: String,
}

/// What was found in the program that is open has this part.
fn found(part: &str) -> String {
    format!("document.getElementById('found').textContent.includes('{part}')")
}

impl Tab<'_> {
    #[track_caller]
    fn asks(&mut self, method: &str, params: Value) -> Value {
        let session = self.session.clone();
        self.browser.asks(Some(&session), method, params)
    }

    fn sends(&mut self, method: &str, params: Value) {
        let session = self.session.clone();
        self.browser.sends(Some(&session), method, params);
    }

    /// What an expression is; nothing while the page is being loaded.
    fn says(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "returnByValue": true});
        let session = self.session.clone();
        let mut answer = self
            .browser
            .answer(Some(&session), "Runtime.evaluate", params);
        answer["result"]["result"]["value"].take()
    }

    /// What a promise comes to.
    fn awaits(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        self.asks("Runtime.evaluate", params)["result"]["value"].take()
    }

    #[track_caller]
    fn wait(&mut self, expression: &str) {
        let end = Instant::now() + LIMIT;
        while self.says(expression) != true {
            assert!(Instant::now() < end, "{expression}");
        }
    }

    /// The mouse button goes down or up over what is chosen so.
    #[track_caller]
    fn mouse(&mut self, which: &str, kind: &str) {
        let place = self.says(&format!(
            "(() => {{ const one = document.querySelector('{which}'); one.scrollIntoView({{block: 'center'}}); \
             const at = one.getBoundingClientRect(); return [at.x + at.width / 2, at.y + at.height / 2]; }})()"
        ));
        let params =
            json!({"type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1});
        self.asks("Input.dispatchMouseEvent", params);
    }

    #[track_caller]
    fn click(&mut self, which: &str) {
        self.mouse(which, "mousePressed");
        self.mouse(which, "mouseReleased");
    }

    /// Does it again each second until this is so: on a busy computer what is shown may be too old to order by.
    #[track_caller]
    fn until(&mut self, expression: &str, mut act: impl FnMut(&mut Self)) {
        let end = Instant::now() + LIMIT;
        while self.says(expression) != true {
            act(self);
            let again = Instant::now() + Duration::from_secs(1);
            while self.says(expression) != true && Instant::now() < again {}
            assert!(Instant::now() < end, "{expression}");
        }
    }

    /// Orders it once: again only where the page says that nothing has come of it, for what it shows was too old, the order
    /// before was still on its way, its lease has lapsed, or the board was asked in vain.
    #[track_caller]
    fn once(&mut self, so: &str, mut act: impl FnMut(&mut Self)) {
        let end = Instant::now() + LIMIT;
        let answer = "document.getElementById('answer').textContent";
        loop {
            self.says(&format!("{answer} = ''"));
            act(self);
            let told = loop {
                self.wait(&format!("{so} || {answer} !== ''"));
                if self.says(so) == true {
                    return;
                }
                let told = self.says(answer);
                let told = told.as_str().unwrap_or_default();
                if !told.is_empty() {
                    break told.to_owned();
                }
            };
            if told.contains("does not operate") {
                self.operate();
            } else {
                // A machine on a busy computer may not answer a reading in time.
                let again = [" old", "give it again", "reading object"];
                let may_again = again.iter().any(|part| told.contains(part));
                assert!(may_again, "{so}: {told}");
            }
            assert!(Instant::now() < end, "{so}: {told}");
        }
    }

    #[track_caller]
    fn click_once(&mut self, which: &str, so: &str) {
        self.once(so, |tab| tab.click(which));
    }

    /// Chooses a program of the list.
    #[track_caller]
    fn choose(&mut self, name: &str) {
        self.says(&format!(
            "(() => {{ const list = document.getElementById('programs'); list.value = '{name}'; \
             list.dispatchEvent(new Event('change')); return true; }})()"
        ));
    }

    #[track_caller]
    fn mode(&mut self, mode: &str) {
        let which = format!("[data-mode=\"{mode}\"]");
        let so = format!("document.querySelector('{which}').ariaPressed === 'true'");
        self.click_once(&which, &so);
    }

    /// A key goes down and up.
    fn key(&mut self, key: &str, number: u32, text: &str) {
        let mut params =
            json!({"type": "keyDown", "key": key, "code": key, "windowsVirtualKeyCode": number});
        if !text.is_empty() {
            params["text"] = text.into();
        }
        self.asks("Input.dispatchKeyEvent", params.clone());
        params["type"] = "keyUp".into();
        self.asks("Input.dispatchKeyEvent", params);
    }

    fn enter(&mut self) {
        self.key("Enter", 13, "\r");
    }

    /// To what has the keys next.
    fn next(&mut self) {
        self.key("Tab", 9, "");
    }

    /// In place of what stands in the field that has the keys.
    fn types(&mut self, text: &str) {
        self.says("document.activeElement.select()");
        self.asks("Input.insertText", json!({"text": text}));
    }

    fn operate(&mut self) {
        self.click("#take");
        // Where a lease of before has not lapsed, it changes hands after a notice.
        self.wait("document.body.classList.contains('operates')");
    }

    /// Stops the machine: again where the page has given its order up for want of an answer.
    #[track_caller]
    fn stops(&mut self) {
        self.until("document.body.dataset.state === 'alarm'", |tab| {
            tab.click("#stop");
        });
    }

    /// Operates again where its lease has lapsed meanwhile.
    fn still_operates(&mut self) {
        if self.says("document.body.classList.contains('operates')") != true {
            self.operate();
        }
    }

    fn close(self) {
        let params = json!({"targetId": self.target});
        self.browser.asks(None, "Target.closeTarget", params);
    }
}

impl Page {
    /// What somebody opens to operate.
    fn link(&self) -> String {
        let token = self.token.as_deref().unwrap();
        format!("http://{}/#{token}", self.address)
    }
}

/// Sends the panel a signal.
fn signal(page: &Page, name: &str) {
    let pid = page.child.id().to_string();
    let sent = Command::new("kill").args([name, &pid]).status().unwrap();
    assert!(sent.success());
}

fn z(user: &User) -> f64 {
    user.json(&["status"])["mz"].as_f64().unwrap()
}

/// Moves Z while the button is down, until the axis has gone so far. On a busy computer a press may end for want of frames;
/// then it is pressed anew.
fn press(user: &User, tab: &mut Tab<'_>, far: f64) {
    let (end, mut from) = (Instant::now() + LIMIT, z(user));
    let goal = from - far;
    tab.mouse("[data-jog=\"Z-\"]", "mousePressed");
    while from > goal {
        let now = z(user);
        if now == from {
            tab.mouse("[data-jog=\"Z-\"]", "mouseReleased");
            tab.mouse("[data-jog=\"Z-\"]", "mousePressed");
        }
        from = now;
        assert!(Instant::now() < end, "{now}");
    }
}

#[test]
fn whatever_a_page_complains_of_on_the_console_is_found() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.says("console.log('fine'); console.warn('bad-1'); console.error('bad-2'); setTimeout(() => { throw 'bad-3'; }); 1");
    tab.awaits("fetch('nothing-4').then(() => new Promise((told) => setTimeout(told, 100)))");
    let complained = browser.complained();
    for (one, part) in complained
        .iter()
        .zip(["bad-1", "bad-2", "bad-3", "nothing-4"])
    {
        assert!(one.contains(part), "{complained:#?}");
    }
    assert_eq!(complained.len(), 4, "{complained:#?}");
    browser.expected = vec!["bad-", "nothing-4"];
}

#[test]
fn somebody_operates_the_machine_with_mouse_and_keys() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    // Nothing is ordered by a page that does not operate, and it says so.
    let says =
        |part: &str| format!("document.getElementById('answer').textContent.includes('{part}')");
    tab.until(&says("does not operate"), |tab| {
        tab.click("[data-level=\"feed\"]");
    });
    tab.operate();
    press(&user, &mut tab, 0.5);
    tab.mouse("[data-jog=\"Z-\"]", "mouseReleased");
    let at = user.wait_for("idle")["mz"].clone();
    assert_eq!(user.wait_for("idle")["mz"], at);
    tab.until(
        "Number(document.getElementById('rpm').textContent) > 40",
        |tab| {
            tab.mouse("[data-jog=\"S+\"]", "mouseReleased");
            tab.mouse("[data-jog=\"S+\"]", "mousePressed");
        },
    );
    tab.mouse("[data-jog=\"S+\"]", "mouseReleased");
    tab.wait("Number(document.getElementById('rpm').textContent) === 0");
    // A start that is not held is none; one that is held is told that nothing waits.
    tab.until(
        "document.querySelector('[data-mode=\"automatic\"]').ariaPressed === 'true'",
        |tab| {
            tab.click("[data-mode=\"automatic\"]");
        },
    );
    tab.click("#start");
    tab.until(&says("4334"), |tab| {
        tab.mouse("#start", "mouseReleased");
        tab.mouse("#start", "mousePressed");
    });
    tab.mouse("#start", "mouseReleased");
    // Space is a hold wherever the focus is, and a reload orders nothing.
    let mut run = user.run(LONG);
    tab.wait("document.body.dataset.state === 'run'");
    // A hold that has no answer in time is given up, and told as that.
    tab.until("document.body.dataset.state === 'hold'", |tab| {
        tab.key(" ", 32, " ");
    });
    tab.asks("Page.reload", json!({}));
    tab.wait(
        "document.body?.dataset.state === 'hold' && !document.body.classList.contains('operates')",
    );
    assert_eq!(user.json(&["status"])["state"], "hold");
    tab.stops();
    let _ = run.wait().unwrap();
    good(&user.does(&["reset"]));
    good(&user.does(&["mode", "manual"]));
    // A page that is closed in the middle of a press.
    tab.wait("document.querySelector('[data-mode=\"manual\"]').ariaPressed === 'true'");
    tab.operate();
    press(&user, &mut tab, 0.5);
    tab.close();
    let at = user.wait_for("idle")["mz"].clone();
    assert_eq!(user.wait_for("idle")["mz"], at);
}

#[test]
fn the_link_that_looks_opened_beside_it_leaves_a_page_its_hold() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let mut browser = Browser::start(&user);
    let mut tab = browser.tab(&page.link());
    tab.operate();
    let (session, target) = (tab.session, tab.target);
    browser.tab(&format!("http://{}/#{}", page.address, page.look));
    let front = json!({"targetId": target});
    browser.asks(None, "Target.activateTarget", front);
    let mut tab = Tab {
        browser: &mut browser,
        session,
        target,
    };
    let mut run = user.run(LONG);
    tab.wait("!document.hidden && document.body.dataset.state === 'run'");
    tab.until("document.body.dataset.state === 'hold'", |tab| {
        tab.click("#hold");
    });
    tab.stops();
    let _ = run.wait().unwrap();
}

#[test]
fn somebody_opens_a_program_changes_it_and_sees_it_run() {
    let user = User::with_machine();
    let folder = user.0.join("parts");
    std::fs::create_dir_all(&folder).unwrap();
    // Long on its third line.
    let text = "(A)\nG98 G1 X-2 Z-1 F3000\nG1 Z-30 F1\nM30\n";
    std::fs::write(folder.join("a.nc"), text).unwrap();
    std::fs::write(folder.join("wrong.nc"), "G98 G1 X1 F100\nG1 Q\nM30\n").unwrap();
    let page = Page::with(&user, &["--programs", folder.to_str().unwrap()]);
    let mut browser = Browser::start(&user);
    // This test reads the picture, the page does not.
    browser.expected.push("getImageData");
    let mut tab = browser.tab(&page.link());
    tab.wait("document.querySelectorAll('#programs option').length === 3");
    // What is wrong is said with its line, and the line is marked.
    tab.until(&found("▲ 2: "), |tab| {
        tab.choose("wrong.nc");
    });
    tab.wait("document.querySelector('#numbers [data-tone=bad]')?.textContent === '2'");
    // It feeds with the spindle standing, which is a warning.
    tab.until(&found("! 2: "), |tab| {
        tab.choose("a.nc");
    });
    // What is typed is written by `Save`, and a key in the text moves nothing.
    tab.says("document.getElementById('source').focus()");
    let key = json!({"type": "keyDown", "key": "ArrowUp", "code": "ArrowUp"});
    tab.asks("Input.dispatchKeyEvent", key);
    tab.asks("Input.insertText", json!({"text": "(B)\n"}));
    tab.wait("document.getElementById('text_note').textContent.includes('not saved')");
    tab.until(
        "!document.getElementById('text_note').textContent.includes('not saved')",
        |tab| tab.click("#save"),
    );
    let written = std::fs::read_to_string(folder.join("a.nc")).unwrap();
    assert!(
        written.contains("(B)\n") && written.len() == text.len() + 4,
        "{written}"
    );
    let line = 1 + written
        .lines()
        .position(|line| line == "G1 Z-30 F1")
        .unwrap();
    // The path is drawn: feed, in its colour.
    let blue = "(() => { const canvas = document.getElementById('plot'); \
        const all = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data; let count = 0; \
        for (let n = 0; n < all.length; n += 4) if (all[n + 2] > all[n] + 60) count += 1; return count > 20; })()";
    tab.wait(blue);
    tab.operate();
    tab.until(
        "document.querySelector('[data-mode=\"automatic\"]').ariaPressed === 'true'",
        |tab| {
            tab.click("[data-mode=\"automatic\"]");
        },
    );
    tab.until("document.body.dataset.state === 'run'", |tab| {
        tab.still_operates();
        tab.mouse("#run", "mouseReleased");
        tab.mouse("#run", "mousePressed");
    });
    tab.mouse("#run", "mouseReleased");
    tab.wait(&format!(
        "document.querySelector('#numbers .here')?.textContent === '{line}' && !document.getElementById('here').hidden"
    ));
    tab.wait(blue);
    // To the end of the line it is what is left of it.
    tab.wait("/^→ -2[0-9][.][0-9]{3}$/.test(document.getElementById('gz').textContent)");
    tab.wait("/^→ -?0[.]000$/.test(document.getElementById('gx').textContent)");
    tab.stops();
    tab.wait("document.getElementById('answer').textContent.includes('a.nc: 4300')");
    tab.wait("document.getElementById('here').hidden");
}
