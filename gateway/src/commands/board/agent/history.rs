//! The thread that writes the archive, and what it says: each thing once.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use leadscrew_agent::Store;
use leadscrew_agent::archive::{Archive, Folder, Origin};
use leadscrew_agent::sender::now;

use super::{no_thread, words};
use crate::failure::Outcome;
use crate::words::Both;

/// Between two looks at what waits, and between two tries where the folder cannot be written.
const LOOK: Duration = Duration::from_secs(2);
const AGAIN: Duration = Duration::from_secs(30);
/// Between two looks at the end.
const NAP: Duration = Duration::from_millis(50);

/// The archive at work.
pub struct History {
    thread: Option<JoinHandle<()>>,
    over: Arc<AtomicBool>,
    news: Receiver<Both>,
}

impl History {
    /// Begins.
    ///
    /// # Errors
    /// This computer starts no thread.
    pub fn start(folder: &Path, origin: Origin, store: &Arc<Store>) -> Outcome<Self> {
        let (tell, news) = channel();
        let over = Arc::new(AtomicBool::new(false));
        let work = Work {
            folder: folder.to_owned(),
            archive: Archive::new(origin, Folder::new(folder.to_owned())),
            store: Arc::clone(store),
            over: Arc::clone(&over),
            tell,
            told: None,
        };
        let thread = thread::Builder::new().spawn(move || work.carry_out());
        Ok(Self {
            thread: Some(thread.map_err(|error| no_thread(&error))?),
            over,
            news,
        })
    }

    /// What there is to say.
    pub fn news(&self) -> Vec<Both> {
        self.news.try_iter().collect()
    }

    /// Writes what waits, and ends.
    pub fn end(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // One that has panicked has said so.
            let _ = thread.join();
        }
    }
}

struct Work {
    folder: PathBuf,
    archive: Archive<Folder>,
    store: Arc<Store>,
    over: Arc<AtomicBool>,
    tell: Sender<Both>,
    told: Option<Both>,
}

impl Work {
    fn carry_out(mut self) {
        while !self.over.load(Ordering::Relaxed) {
            let pause = if self.turn(false) { LOOK } else { AGAIN };
            let until = Instant::now() + pause;
            while !self.over.load(Ordering::Relaxed) && Instant::now() < until {
                thread::sleep(NAP);
            }
        }
        self.turn(true);
    }

    /// Writes what is due; true where it could.
    fn turn(&mut self, ending: bool) -> bool {
        let wrong = self.archive.attend(&self.store, now(), ending).err();
        let words = wrong.map(|error| words::archive(&self.folder, &error));
        let is_good = words.is_none();
        if words != self.told {
            let news = words.clone().unwrap_or_else(words::archived_again);
            // Nobody may hear it at the end.
            let _ = self.tell.send(news);
            self.told = words;
        }
        is_good
    }
}
