//! `agent`: tells a broker and a metrics store what the machine does. This is its side of the bus and of the terminal.
//!
//! ```text
//! reading   what the board says, as observations      words   what is said here, in two languages
//! cut       what its certificates say of the cut
//! ```
//!
//! It orders nothing, and must not know topics or packets: what is told, kept and sent is `leadscrew_agent`'s.

mod cut;
mod reading;
mod words;

use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use leadscrew_agent::metrics::{Metrics, Pulse, Server};
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
use crate::words::{Both, both, pick};

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
    if wish.broker.is_none() && wish.metrics.is_none() {
        return Err(Failure::Usage(both!(
            "nobody is to be told: name a broker with --broker, or an address for figures with --metrics",
            "没有指定接收方：请用 --broker 指定代理服务器，或用 --metrics 指定指标地址"
        )));
    }
    let shared = Arc::new(Shared::default());
    let broker = broker(wish, &machine)?;
    let kept = match &broker {
        Some(_) => {
            let path = store_path(wish, &machine)?;
            Some((open_store(&path, wish.limit)?, path))
        }
        None => None,
    };
    let keeper = match &kept {
        Some((store, path)) => {
            Keeper::new(Arc::clone(store)).map_err(|error| words::store(path, &error))?
        }
        None => Keeper::without_store(),
    };
    let metrics = match wish.metrics {
        Some(listen) => {
            let store = kept.as_ref().map(|(store, _)| Arc::clone(store));
            Some(give_figures(listen, store, Arc::clone(&shared))?)
        }
        None => None,
    };
    interrupt::defer(UnderWay::Computed);
    let path = kept
        .as_ref()
        .map(|(_, path)| path.clone())
        .unwrap_or_default();
    tell_beginning(global, broker.as_ref(), &path, metrics.as_ref())?;
    let sender = match (broker, kept) {
        (Some(broker), Some((store, _))) => Some(start(broker, store, Arc::clone(&shared))?),
        _ => None,
    };
    let agent = Agent {
        global,
        keeper,
        shared,
        path,
        told: None,
        full: false,
        sender,
        metrics: metrics.map(|(metrics, _)| metrics),
    };
    agent.carry_out()
}

fn broker(wish: &cli::Agent, machine: &str) -> Outcome<Option<Broker>> {
    let Some(address) = &wish.broker else {
        return Ok(None);
    };
    let node = wish.name.clone().unwrap_or_else(|| node(machine));
    let names = Names::new(&wish.group, &node, machine).map_err(|error| words::name(&error))?;
    Ok(Some(Broker {
        address: address.clone(),
        login: login(wish)?,
        tls: tls(wish)?,
        names,
    }))
}

/// The figures, and where they are given.
fn give_figures(
    listen: SocketAddr,
    store: Option<Arc<Store>>,
    shared: Arc<Shared>,
) -> Outcome<(Arc<Metrics>, SocketAddr)> {
    let metrics = Arc::new(Metrics::default());
    let given = Arc::clone(&metrics);
    let text = move || {
        if let Some(figures) = store.as_ref().and_then(|store| store.figures().ok()) {
            given.kept(&figures, shared.is_connected());
        }
        given.text()
    };
    let server = Server::start(listen, Arc::new(text)).map_err(|error| {
        Failure::Usage(both!(
            "cannot listen at {listen}: {error}; choose another address with --metrics",
            "无法监听 {listen}：{error}；请用 --metrics 选择其他地址"
        ))
    })?;
    Ok((metrics, server.address))
}

/// The thread that sends, and what it says.
struct Sender {
    thread: Option<JoinHandle<()>>,
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
        thread: Some(thread),
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
    metrics: Option<Arc<Metrics>>,
}

impl Agent<'_> {
    fn carry_out(mut self) -> Outcome {
        let ended = self.read();
        self.shared.end();
        let sender = self.sender.as_mut();
        if let Some(thread) = sender.and_then(|sender| sender.thread.take()) {
            // What is on its way to the broker has a moment.
            let _ = thread.join();
        }
        self.turn();
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
                if let Some(metrics) = &self.metrics {
                    metrics.take(&kept);
                }
                if std::mem::take(&mut self.full) {
                    say(self.global, &words::kept_again());
                }
                true
            }
            Err(error) => {
                if !std::mem::replace(&mut self.full, true)
                    && let Some(words) = words::store(&self.path, &error).words()
                {
                    say(self.global, &words);
                }
                false
            }
        }
    }

    /// Takes what a board says of itself and nobody is told but in figures.
    fn pulse(&self, pulse: Pulse) {
        if let Some(metrics) = &self.metrics {
            metrics.pulse(pulse);
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
fn tell_beginning(
    global: &Global,
    broker: Option<&Broker>,
    path: &Path,
    metrics: Option<&(Arc<Metrics>, SocketAddr)>,
) -> Outcome {
    if let Some(warning) = broker.and_then(words::in_the_clear) {
        say(global, &warning);
    }
    let figures = metrics.map(|(_, address)| format!("http://{address}/metrics"));
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.text("bus", &global.bus.to_string());
            if let Some(broker) = broker {
                json.text("broker", &broker.address.to_string());
                json.text("topic", &broker.names.machine());
                json.text("store", &path.display().to_string());
            }
            if let Some(figures) = &figures {
                json.text("metrics", figures);
            }
        });
    }
    let mut text = String::new();
    if let Some(broker) = broker {
        let line = both!(
            "{bus} is told to {address} as {topic}; kept in {path} until the broker has it\n",
            "{bus} 的数据以 {topic} 发送到 {address}；在代理服务器收到之前保存在 {path}\n",
            bus = global.bus,
            address = broker.address,
            topic = broker.names.machine(),
            path = path.display()
        );
        text.push_str(line.get(global.lang()));
    }
    if let Some(figures) = figures {
        let line = both!("figures are at {figures}\n", "指标地址：{figures}\n");
        text.push_str(line.get(global.lang()));
    }
    text.push_str(pick(
        global.lang(),
        "It moves nothing; Ctrl-C ends it.\n",
        "它不移动任何部件；按 Ctrl-C 结束。\n",
    ));
    output::write(text.as_bytes())
}
