//! The terminal that the panel is drawn on: taken, asked whether it tells when a key is let go, and given back as it was.

use std::io::{Error, IsTerminal as _, Result, stdin, stdout};
use std::mem::ManuallyDrop;
use std::os::fd::AsFd as _;
use std::panic::{set_hook, take_hook};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use nix::errno::Errno;
use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
use ratatui::DefaultTerminal;
use ratatui::crossterm::cursor;
use ratatui::crossterm::event::{
    self, DisableBracketedPaste, DisableFocusChange, EnableBracketedPaste, EnableFocusChange,
    Event, KeyboardEnhancementFlags, PopKeyboardEnhancementFlags, PushKeyboardEnhancementFlags,
};
use ratatui::crossterm::execute;
use ratatui::crossterm::terminal::supports_keyboard_enhancement;

/// Between two looks for a terminal that has been asked.
const LOOK: Duration = Duration::from_millis(5);

/// The whole terminal is drawn on.
static DRAWING: AtomicBool = AtomicBool::new(false);
/// It has been told to say more of its keys and its focus.
static TELLING: AtomicBool = AtomicBool::new(false);
/// And when they are let go.
static TELLS_RELEASE: AtomicBool = AtomicBool::new(false);

/// Both ends of it are there: something is drawn on, and keys are pressed on.
pub fn has_keys() -> bool {
    stdin().is_terminal()
}

/// A terminal that is drawn on. It is [given back](give_back) by hand: dropped where it is gone, it would complain on
/// standard error, which is gone too.
pub type Drawn = ManuallyDrop<DefaultTerminal>;

/// Takes it.
pub fn take() -> Result<Drawn> {
    DRAWING.store(true, Ordering::Relaxed);
    let drawn = ratatui::try_init().map(ManuallyDrop::new);
    let told = take_hook();
    set_hook(Box::new(move |panic| {
        give_back();
        told(panic);
    }));
    drawn
}

/// Has it tell what the panel goes by: pastes as such, focus, and, where it can, when a key is let go. True where it can.
pub fn listen() -> Result<bool> {
    TELLING.store(true, Ordering::Relaxed);
    execute!(stdout(), EnableBracketedPaste, EnableFocusChange)?;
    // One that does not answer cannot. It is given two seconds, and may be gone meanwhile.
    let question = thread::spawn(supports_keyboard_enhancement);
    while !question.is_finished() {
        look_for_it()?;
        thread::sleep(LOOK);
    }
    let tells = matches!(question.join(), Ok(Ok(true)));
    if tells {
        TELLS_RELEASE.store(true, Ordering::Relaxed);
        let flags = KeyboardEnhancementFlags::DISAMBIGUATE_ESCAPE_CODES
            | KeyboardEnhancementFlags::REPORT_EVENT_TYPES;
        execute!(stdout(), PushKeyboardEnhancementFlags(flags))?;
    }
    Ok(tells)
}

/// Gives it back as it was, where it was taken.
pub fn give_back() {
    // A terminal that is gone takes nothing back.
    if TELLS_RELEASE.swap(false, Ordering::Relaxed) {
        let _ = execute!(stdout(), PopKeyboardEnhancementFlags);
    }
    if TELLING.swap(false, Ordering::Relaxed) {
        let _ = execute!(stdout(), DisableFocusChange, DisableBracketedPaste);
    }
    if DRAWING.swap(false, Ordering::Relaxed) {
        let _ = execute!(stdout(), cursor::Show);
        let _ = ratatui::try_restore();
    }
}

/// What it has said since.
///
/// # Errors
/// Those of the terminal; also where it is gone. The reader of its keys would look for them for ever.
pub fn said() -> Result<Vec<Event>> {
    let mut said = Vec::new();
    loop {
        look_for_it()?;
        if !event::poll(Duration::ZERO)? {
            return Ok(said);
        }
        said.push(event::read()?);
    }
}

fn look_for_it() -> Result<()> {
    let screen = stdout();
    let mut ends = [PollFd::new(screen.as_fd(), PollFlags::empty())];
    match poll(&mut ends, PollTimeout::ZERO) {
        // A signal, as of a window that changes its size: it is there.
        Err(Errno::EINTR) => return Ok(()),
        looked => looked?,
    };
    let gone = PollFlags::POLLHUP | PollFlags::POLLERR | PollFlags::POLLNVAL;
    match ends[0].revents() {
        Some(told) if told.intersects(gone) => Err(Error::other("the terminal is gone")),
        _ => Ok(()),
    }
}
