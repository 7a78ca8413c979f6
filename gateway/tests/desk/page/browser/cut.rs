//! The network between browser and panel is cut, slow or half open in the middle of a press. It goes through a proxy of the
//! test, so the page and its address are what they always are.

use std::io::{Read as _, Write as _};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::{Arc, Condvar, Mutex};
use std::time::{Duration, Instant};

use super::super::jog::longest;
use super::super::{Page, chance};
use super::{Browser, Tab, z};
use crate::{LIMIT, User};

/// What becomes of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wire {
    /// They go through.
    Whole,
    /// Connections end at once, and no new one is made.
    Cut,
    /// They are held, and go through later.
    Slow,
    /// They are held and never go through: those who wait for them do not know that the other end has gone.
    HalfOpen,
}

#[derive(Debug)]
struct State {
    wire: Wire,
    /// Connections of before are dead.
    generation: u64,
    /// Those of before this one carry nothing any more, and neither end is told.
    silent: u64,
    open: Vec<TcpStream>,
    /// What went to the panel of presses: number and echo.
    frames: Vec<(u64, u64)>,
}

type Shared = Arc<(Mutex<State>, Condvar)>;

/// A SOCKS proxy.
struct Proxy {
    address: String,
    shared: Shared,
}

impl Proxy {
    fn start() -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap().to_string();
        let state = State {
            wire: Wire::Whole,
            generation: 0,
            silent: 0,
            open: Vec::new(),
            frames: Vec::new(),
        };
        let shared: Shared = Arc::new((Mutex::new(state), Condvar::new()));
        let all = Arc::clone(&shared);
        std::thread::spawn(move || {
            for client in listener.incoming().flatten() {
                let shared = Arc::clone(&all);
                // One that ends is the browser's to make anew.
                std::thread::spawn(move || connection(client, &shared));
            }
        });
        Self { address, shared }
    }

    fn set(&self, wire: Wire) {
        let (state, changed) = &*self.shared;
        let mut state = state.lock().unwrap();
        if wire == Wire::Cut || state.wire == Wire::HalfOpen {
            state.generation += 1;
            for stream in state.open.drain(..) {
                // It may have ended by itself.
                let _ = stream.shutdown(Shutdown::Both);
            }
        }
        state.wire = wire;
        changed.notify_all();
    }

    /// What is connected now carries nothing any more, and neither end is told; new connections are as ever.
    fn silence(&self) {
        let mut state = self.shared.0.lock().unwrap();
        state.generation += 1;
        state.silent = state.generation;
    }

    /// The frames since this was asked last.
    fn frames(&self) -> Vec<(u64, u64)> {
        std::mem::take(&mut self.shared.0.lock().unwrap().frames)
    }
}

/// Serves one connection; `None` where it ends early.
fn connection(mut client: TcpStream, shared: &Shared) -> Option<()> {
    let mut head = [0; 2];
    client.read_exact(&mut head).ok()?;
    let mut methods = vec![0; usize::from(head[1])];
    client.read_exact(&mut methods).ok()?;
    client.write_all(&[5, 0]).ok()?;
    // CONNECT to a name, as which the browser tells addresses too.
    let mut wanted = [0; 5];
    client.read_exact(&mut wanted).ok()?;
    assert_eq!(wanted[..4], [5, 1, 0, 3]);
    let mut name = vec![0; usize::from(wanted[4]) + 2];
    client.read_exact(&mut name).ok()?;
    let port = name.split_off(name.len() - 2);
    // The browser's own business elsewhere is none of this test.
    if name != b"127.0.0.1" {
        return None;
    }
    let port = u16::from_be_bytes([port[0], port[1]]);
    let panel = TcpStream::connect(("127.0.0.1", port)).ok()?;
    client.write_all(&[5, 0, 0, 1, 0, 0, 0, 0, 0, 0]).ok()?;
    let generation = {
        let mut state = shared.0.lock().unwrap();
        if state.wire == Wire::Cut {
            return None;
        }
        for stream in [&client, &panel] {
            state.open.push(stream.try_clone().ok()?);
        }
        state.generation
    };
    let (up, down) = (
        (client.try_clone().ok()?, panel.try_clone().ok()?),
        (panel, client),
    );
    let other = Arc::clone(shared);
    std::thread::spawn(move || pump(up, &other, generation));
    pump(down, shared, generation);
    Some(())
}

/// Carries bytes from one to the other until either ends.
fn pump((mut from, mut to): (TcpStream, TcpStream), shared: &Shared, generation: u64) {
    let (state, changed) = &**shared;
    let mut bytes = [0; 65_536];
    while let Ok(count @ 1..) = from.read(&mut bytes) {
        let held = |state: &mut State| {
            let waits = matches!(state.wire, Wire::Slow | Wire::HalfOpen);
            generation < state.silent || state.generation == generation && waits
        };
        let mut state = changed.wait_while(state.lock().unwrap(), held).unwrap();
        if state.generation != generation {
            break;
        }
        let text = String::from_utf8_lossy(&bytes[..count]);
        if text.contains("\"axes\":") {
            let number = |key: &str| -> Option<u64> {
                let (_, rest) = text.split_once(&format!("\"{key}\":"))?;
                rest.split([',', '}']).next()?.parse().ok()
            };
            state.frames.extend(number("press").zip(number("echo")));
        }
        drop(state);
        if to.write_all(&bytes[..count]).is_err() {
            break;
        }
    }
    for stream in [&from, &to] {
        // It may have ended by itself.
        let _ = stream.shutdown(Shutdown::Both);
    }
}

/// How far presses of these frames may go, each until its last echo is too old.
fn farthest(frames: &[(u64, u64)]) -> f64 {
    let presses = frames.chunk_by(|a, b| a.0 == b.0);
    presses
        .map(|press| longest(press[0].1, press[press.len() - 1].1))
        .sum()
}

/// Holds the button down until the axis has gone so far.
fn press(user: &User, tab: &mut Tab<'_>, button: &str, far: f64) {
    let (end, begin) = (Instant::now() + LIMIT, z(user));
    let mut from = begin;
    tab.mouse(button, "mousePressed");
    loop {
        let now = z(user);
        if (now - begin).abs() > far {
            return;
        }
        // On a busy computer a press may end for want of frames; then it is pressed anew.
        if now == from {
            tab.mouse(button, "mouseReleased");
            tab.mouse(button, "mousePressed");
        }
        from = now;
        assert!(Instant::now() < end, "{now}");
    }
}

/// A browser whose way to the panel is the proxy.
fn behind(proxy: &Proxy, user: &User) -> Browser {
    let option = format!(
        "--proxy-server=socks5://{} --proxy-bypass-list='<-loopback>'",
        proxy.address
    );
    Browser::with(user, &option)
}

#[test]
fn a_stream_that_is_silent_is_made_anew() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let proxy = Proxy::start();
    let mut browser = behind(&proxy, &user);
    let mut tab = browser.tab(&page.link());
    let old = "document.body.classList.contains('old')";
    proxy.silence();
    tab.wait(old);
    tab.wait(&format!("!{old}"));
}

#[test]
fn a_network_that_fails_in_a_press_leaves_the_axis_at_rest() {
    let user = User::with_machine();
    let page = Page::start(&user);
    let proxy = Proxy::start();
    let mut browser = behind(&proxy, &user);
    // What the browser itself says of a network that is not there, or on which a request is held for too long.
    browser.expected.push("net::ERR_");
    browser.expected.push("408 (Request Timeout)");
    let mut tab = browser.tab(&page.link());
    let count = leadscrew_seed::amount(3, 20);
    leadscrew_seed::only_fresh(|seed| {
        let mut below = chance(seed);
        for number in 0..count {
            // There and back, so that no limit ends a press.
            let button = ["[data-jog=\"Z-\"]", "[data-jog=\"Z+\"]"][number % 2];
            tab.until("document.body.classList.contains('operates')", |tab| {
                tab.click("#take");
            });
            tab.wait("!document.body.classList.contains('old')");
            proxy.frames();
            let from = z(&user);
            press(&user, &mut tab, button, below(1_000) as f64 / 1_000.0);
            let wire = [Wire::Cut, Wire::Slow, Wire::HalfOpen][number % 3];
            proxy.set(wire);
            // The finger stays where it is, and the board ends it.
            let at = user.wait_for("idle")["mz"].as_f64().unwrap();
            let (gone, most) = ((at - from).abs(), farthest(&proxy.frames()));
            assert!(gone > 0.0 && gone < most, "{wire:?}: {gone} of {most}");
            std::thread::sleep(Duration::from_millis(below(400)));
            // What was held comes now; the page has values again, and nothing moves.
            proxy.set(Wire::Whole);
            tab.wait("document.body.classList.contains('old') === false");
            std::thread::sleep(Duration::from_millis(below(200)));
            let then = user.wait_for("idle");
            assert_eq!(then["mz"], at, "{wire:?}");
            tab.mouse(button, "mouseReleased");
            let then = user.wait_for("idle");
            assert_eq!(then["mz"], at, "{wire:?}");
        }
    });
}
