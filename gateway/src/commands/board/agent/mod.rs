//! `agent`: tells a broker and a metrics store what the machine does. This is its side of the bus and of the terminal.
//!
//! ```text
//! reading   what the board says, as observations      words   what is said here, in two languages
//! ```
//!
//! It orders nothing, and must not know topics or packets: what is told, kept and sent is `leadscrew_agent`'s.

mod reading;
mod words;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use leadscrew_agent::mqtt::{Login, Tls};
use leadscrew_agent::sender::{Broker, News, Shared, now, send};
use leadscrew_agent::sparkplug::Names;
use leadscrew_agent::{Keeper, Observation, Store, StoreError};

use self::reading::Reading;
use crate::cli::{self, Global};
use crate::diagnostics;
use crate::failure::{Doing, Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::output;
use crate::state;
use crate::words::{Both, both};

/// Between two looks for a board that is not there.
const AGAIN: Duration = Duration::from_secs(2);
/// Between two looks at the end.
const NAP: Duration = Duration::from_millis(50);
/// Bytes in a MiB.
const MIB: u64 = 1 << 20;
/// Where the name of this computer stands.
const HOST: &str = "/proc/sys/kernel/hostname";

/// Tells until it is interrupted.
pub fn agent(global: &Global, wish: &cli::Agent) -> Outcome {
    let machine = wish.machine.clone().map_or_else(|| machine(global), Ok)?;
    let shared = Arc::new(Shared::default());
    let Some(address) = &wish.broker else {
        return Err(Failure::Usage(both!(
            "nobody is to be told: name a broker with --broker",
            "没有指定接收方：请用 --broker 指定代理服务器"
        )));
    };
    let node = wish.name.clone().unwrap_or_else(|| node(&machine));
    let names = Names::new(&wish.group, &node, &machine).map_err(|error| words::name(&error))?;
    let broker = Broker {
        address: address.clone(),
        login: login(wish)?,
        tls: tls(wish)?,
        names,
    };
    let path = store_path(wish, &machine)?;
    let store = open_store(&path, wish.limit)?;
    let keeper = Keeper::new(Arc::clone(&store)).map_err(|error| words::store(&path, &error))?;
    interrupt::defer(UnderWay::Computed);
    tell_beginning(global, &broker, &path)?;
    let mut agent = Agent {
        global,
        keeper,
        shared: Arc::clone(&shared),
        path,
        told: None,
        full: false,
        sender: None,
    };
    agent.sender = Some(start(broker, store, shared)?);
    agent.carry_out()
}

/// The thread that sends, and what it says.
struct Sender {
    thread: JoinHandle<()>,
    news: Receiver<News>,
    /// What was said last, for it is said once.
    told: Option<Both>,
}

fn start(broker: Broker, store: Arc<Store>, shared: Arc<Shared>) -> Outcome<Sender> {
    let (tell, news) = channel();
    let work = move || send(&broker, &store, &shared, |news| drop(tell.send(news)));
    let thread = thread::Builder::new().spawn(work).map_err(|error| {
        Failure::Usage(both!(
            "this computer starts no thread: {error}",
            "本机无法启动线程：{error}"
        ))
    })?;
    Ok(Sender {
        thread,
        news,
        told: None,
    })
}

/// An agent at work.
struct Agent<'a> {
    global: &'a Global,
    keeper: Keeper,
    shared: Arc<Shared>,
    path: PathBuf,
    /// What was said of the board last.
    told: Option<Both>,
    /// The store takes nothing; that was said.
    full: bool,
    sender: Option<Sender>,
}

impl Agent<'_> {
    fn carry_out(mut self) -> Outcome {
        let ended = self.read();
        self.shared.end();
        if let Some(sender) = self.sender.take() {
            // What is on its way to the broker has a moment.
            let _ = sender.thread.join();
        }
        ended
    }

    /// Reads the board, whenever there is one, until the end.
    fn read(&mut self) -> Outcome {
        while !interrupt::requested() {
            let trouble = match Reading::begin(self.global, self) {
                Ok(mut reading) => reading.carry_out(self),
                Err(trouble) => Err(trouble),
            };
            let words = match trouble {
                Ok(()) => return Ok(()),
                Err(wrong @ Failure::Usage(_)) => return Err(wrong),
                Err(trouble) => trouble.words().unwrap_or_default(),
            };
            self.observe(&Observation::Gone(words.en.clone()));
            self.say(words);
            let until = Instant::now() + AGAIN;
            while Instant::now() < until && !interrupt::requested() {
                self.turn();
                thread::sleep(NAP);
            }
        }
        Ok(())
    }

    /// Keeps what was seen. Where that cannot be done, it was not seen, and is read again.
    fn observe(&mut self, seen: &Observation) -> bool {
        match self.keeper.take(now(), seen) {
            Ok(kept) => {
                self.shared.take(&kept);
                if std::mem::take(&mut self.full) {
                    say(self.global, &words::kept_again());
                }
                true
            }
            Err(error) => {
                if !std::mem::replace(&mut self.full, true) {
                    if let Some(words) = words::store(&self.path, &error).words() {
                        say(self.global, &words);
                    }
                }
                false
            }
        }
    }

    /// Says of the board what was not said last.
    fn say(&mut self, words: Both) {
        if self.told.as_ref() != Some(&words) {
            say(self.global, &words);
            self.told = Some(words);
        }
    }

    /// Says what the sender has to say.
    fn turn(&mut self) {
        let Some(sender) = &mut self.sender else {
            return;
        };
        for news in sender.news.try_iter() {
            let words = words::news(&news);
            if sender.told.as_ref() != Some(&words) {
                say(self.global, &words);
                sender.told = Some(words);
            }
        }
    }
}

fn say(global: &Global, words: &Both) {
    diagnostics::say(&format!("{}\n", words.get(global.lang())));
}

fn login(wish: &cli::Agent) -> Outcome<Option<Login>> {
    let Some(path) = &wish.login else {
        return Ok(None);
    };
    let login = Login::read(path).map_err(|error| words::login(path, &error))?;
    Ok(Some(login))
}

fn tls(wish: &cli::Agent) -> Outcome<Option<Tls>> {
    let wanted = wish.broker.as_ref().is_some_and(|broker| broker.tls);
    match &wish.ca {
        Some(path) if wanted => {
            let tls = Tls::of(path).map_err(|error| words::authority(path, &error))?;
            Ok(Some(tls))
        }
        None if wanted => Err(Failure::Usage(both!(
            "a broker by TLS needs the certificate of its authority: name the file with --ca",
            "通过 TLS 连接代理服务器需要其签发机构的证书：请用 --ca 指定文件"
        ))),
        Some(_) => Err(Failure::Usage(both!(
            "--ca is for a broker by TLS: mqtts://HOST",
            "--ca 只用于 TLS 代理服务器：mqtts://HOST"
        ))),
        None => Ok(None),
    }
}

/// The bus and the node, as a part of a topic.
fn machine(global: &Global) -> Outcome<String> {
    let bus = global.bus.to_string().replace(['/', '+', '#'], "-");
    Ok(format!("{bus}-{}", global.board()?.get()))
}

/// This computer and the machine, as a part of a topic.
fn node(machine: &str) -> String {
    let host = fs::read_to_string(HOST).unwrap_or_default();
    match host.trim() {
        "" => machine.to_owned(),
        host => format!("{host}-{machine}"),
    }
}

fn store_path(wish: &cli::Agent, machine: &str) -> Outcome<PathBuf> {
    if let Some(path) = &wish.store {
        return Ok(path.clone());
    }
    // The service manager names it.
    let given = std::env::var_os("STATE_DIRECTORY").map(PathBuf::from);
    let Some(folder) = given
        .filter(|path| path.is_absolute())
        .or_else(state::folder)
    else {
        return Err(Failure::Usage(both!(
            "there is no folder for what the agent keeps: name a file with --store",
            "没有可保存代理数据的文件夹：请用 --store 指定文件"
        )));
    };
    fs::create_dir_all(&folder)
        .map_err(|error| Failure::file(Doing::Write, folder.display(), &error))?;
    let name = machine.replace(|c: char| !c.is_alphanumeric() && c != '-', "_");
    Ok(folder.join(format!("agent-{name}.redb")))
}

fn open_store(path: &Path, limit: u64) -> Outcome<Arc<Store>> {
    let store = Store::open(path, limit.saturating_mul(MIB), now());
    store
        .map(Arc::new)
        .map_err(|error: StoreError| words::store(path, &error))
}

/// What is told where.
fn tell_beginning(global: &Global, broker: &Broker, path: &Path) -> Outcome {
    if let Some(warning) = words::in_the_clear(broker) {
        say(global, &warning);
    }
    let topic = broker.names.machine();
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.text("bus", &global.bus.to_string());
            json.text("broker", &broker.address.to_string());
            json.text("topic", &topic);
            json.text("store", &path.display().to_string());
        });
    }
    let text = both!(
        "{bus} is told to {address} as {topic}; kept in {path} until the broker has it. Ctrl-C ends it.\n",
        "{bus} 的数据以 {topic} 发送到 {address}；在代理服务器收到之前保存在 {path}。按 Ctrl-C 结束。\n",
        bus = global.bus,
        address = broker.address,
        path = path.display()
    );
    output::write(text.get(global.lang()).as_bytes())
}
