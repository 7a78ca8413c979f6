//! `agent`: tells a broker and a metrics store what the machine does. This is its side of the bus and of the terminal.
//!
//! ```text
//! boards    which boards, and what they are called     reading   what a board says, as observations
//! reader    one board in a thread of its own           cut       what its certificates say of the cut
//! set       the set in force: read once, told as a state  words  what is said here, in two languages
//! history   the thread that writes the archive
//! ```
//!
//! It orders nothing, and must not know topics or packets: what is told, kept and sent is `leadscrew_agent`'s.

mod boards;
mod cut;
mod history;
mod reader;
mod reading;
mod set;
mod words;

use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use leadscrew_agent::archive::{Folder, Origin};
use leadscrew_agent::metrics::{Metrics, Server};
use leadscrew_agent::sender::{Broker, FAREWELL, News, Shared, now, send};
use leadscrew_agent::sparkplug::{Host, Names};
use leadscrew_agent::store::Readers;
use leadscrew_agent::{Keeper, Store, StoreError};

use self::boards::Seat;
use self::history::History;
use self::reader::{Common, Reader};
use crate::cli::{self, Global};
use crate::commands::broker;
use crate::diagnostics;
use crate::failure::{Doing, Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::output;
use crate::state;
use crate::words::{Both, both, pick};

/// Between two looks at the end.
const NAP: Duration = Duration::from_millis(50);
/// A sender with a broker that answers has ended by then.
const ENDED: Duration = FAREWELL.saturating_mul(2);
/// Bytes in a MiB.
const MIB: u64 = 1 << 20;

/// Tells until it is interrupted.
pub fn agent(global: &Global, wish: &cli::Agent) -> Outcome {
    let readers = Readers {
        broker: wish.broker.is_some(),
        archive: wish.archive.is_some(),
    };
    if !readers.broker && !readers.archive {
        if wish.metrics.is_none() {
            return Err(Failure::Usage(both!(
                "nobody is to be told: name a broker with --broker, a folder with --archive, or an address for figures with \
                 --metrics",
                "没有指定接收方：请用 --broker 指定代理服务器，用 --archive 指定归档文件夹，或用 --metrics 指定指标地址"
            )));
        }
        if wish.store.is_some() {
            return Err(Failure::Usage(both!(
                "--store is for a broker or an archive: figures alone are not kept",
                "--store 用于代理服务器或归档：仅有指标时不保存数据"
            )));
        }
    }
    let seats = boards::seats(global, wish)?;
    if let Some(folder) = &wish.archive {
        let tried = Folder::new(folder.clone()).try_out();
        tried.map_err(|error| words::no_archive(folder, &error))?;
    }
    let shared = Arc::new(Shared::default());
    let broker = broker_of(wish, &seats)?;
    let kept = if readers.broker || readers.archive {
        let path = store_path(wish, &seats)?;
        let store = open_store(&path, wish.limit, &seats)?;
        store.serve(readers);
        Some((store, path))
    } else {
        None
    };
    let mut keepers = Vec::new();
    for Seat { machine, .. } in &seats {
        keepers.push(match &kept {
            Some((store, path)) => Keeper::new(Arc::clone(store), machine)
                .map_err(|error| words::store(path, &error))?,
            None => Keeper::without_store(machine),
        });
    }
    let metrics = match wish.metrics {
        Some(listen) => {
            let store = kept.as_ref().map(|(store, _)| Arc::clone(store));
            Some(give_figures(listen, store, Arc::clone(&shared), &seats)?)
        }
        None => None,
    };
    interrupt::defer(UnderWay::Computed);
    let path = kept
        .as_ref()
        .map(|(_, path)| path.clone())
        .unwrap_or_default();
    let sets = broker.is_some() && !wish.no_set;
    tell_beginning(
        global,
        wish,
        &seats,
        broker.as_ref(),
        sets,
        &path,
        metrics.as_ref(),
    )?;
    let history = match (&wish.archive, &kept) {
        (Some(folder), Some((store, _))) => {
            let origin = Origin {
                shop: wish.access.group.clone(),
                node: agent_name(wish, &seats),
            };
            Some(History::start(folder, origin, store)?)
        }
        _ => None,
    };
    let sender = match (broker, kept) {
        (Some(broker), Some((store, _))) => Some(start(broker, store, Arc::clone(&shared))?),
        _ => None,
    };
    let common = Arc::new(Common {
        shared: Arc::clone(&shared),
        path,
        full: AtomicBool::new(false),
        tight: AtomicBool::new(false),
        metrics: metrics.map(|(metrics, _)| metrics),
        alone: seats.len() == 1,
        sets,
    });
    let mut readers = Vec::new();
    for (seat, keeper) in seats.into_iter().zip(keepers) {
        let reader = Reader::new(seat, keeper, Arc::clone(&common));
        let thread = thread::Builder::new().spawn(move || reader.read());
        readers.push(thread.map_err(|error| no_thread(&error))?);
    }
    Agent {
        global,
        shared,
        readers,
        sender,
        history,
    }
    .carry_out()
}

fn broker_of(wish: &cli::Agent, seats: &[Seat]) -> Outcome<Option<Broker>> {
    let Some(address) = &wish.broker else {
        return Ok(None);
    };
    let machines = seats.iter().map(|seat| seat.machine.as_str());
    let all = machines.chain(wish.primary_host.as_deref());
    let names = Names::new(&wish.access.group, &agent_name(wish, seats), all)
        .map_err(|error| broker::wrong_name(&error))?;
    Ok(Some(Broker {
        address: address.clone(),
        login: broker::login(&wish.access)?,
        tls: broker::tls(address, &wish.access)?,
        names,
        primary: wish.primary_host.as_deref().map(Host::new),
    }))
}

fn agent_name(wish: &cli::Agent, seats: &[Seat]) -> String {
    let name = wish.name.clone();
    name.unwrap_or_else(|| boards::node(seats))
}

/// The figures, and where they are given.
fn give_figures(
    listen: SocketAddr,
    store: Option<Arc<Store>>,
    shared: Arc<Shared>,
    seats: &[Seat],
) -> Outcome<(Arc<Metrics>, SocketAddr)> {
    let metrics = Arc::new(Metrics::default());
    for seat in seats {
        metrics.expect(&seat.machine);
    }
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
    let thread = thread::Builder::new().spawn(work);
    let thread = thread.map_err(|error| no_thread(&error))?;
    Ok(Sender {
        thread: Some(thread),
        news,
        told: None,
    })
}

fn no_thread(error: &std::io::Error) -> Failure {
    Failure::Usage(both!(
        "this computer starts no thread: {error}",
        "本机无法启动线程：{error}"
    ))
}

/// An agent at work.
struct Agent<'a> {
    global: &'a Global,
    shared: Arc<Shared>,
    readers: Vec<JoinHandle<Outcome>>,
    sender: Option<Sender>,
    history: Option<History>,
}

impl Agent<'_> {
    fn carry_out(mut self) -> Outcome {
        // One board alone may be none that could ever be there.
        while !interrupt::requested() && !self.readers.iter().all(JoinHandle::is_finished) {
            self.turn();
            thread::sleep(NAP);
        }
        let mut ended = Ok(());
        for reader in self.readers.drain(..) {
            // One that has panicked has said so.
            if let Ok(Err(wrong)) = reader.join() {
                ended = Err(wrong);
            }
        }
        self.shared.end();
        if let Some(history) = &mut self.history {
            history.end();
        }
        let sender = self.sender.as_mut();
        if let Some(thread) = sender.and_then(|sender| sender.thread.take()) {
            // What is on its way to the broker has a moment. One that does not answer is not waited for: what it has not
            // taken stays in the store.
            let end = Instant::now() + ENDED;
            while !thread.is_finished() && Instant::now() < end {
                thread::sleep(NAP);
            }
            if thread.is_finished() {
                let _ = thread.join();
            }
        }
        self.turn();
        ended
    }

    /// Says what sender and archive have to say.
    fn turn(&mut self) {
        if let Some(history) = &mut self.history {
            for words in history.news() {
                say(self.global, &words);
            }
        }
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

fn store_path(wish: &cli::Agent, seats: &[Seat]) -> Outcome<PathBuf> {
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
    let name = match seats {
        [seat] => seat.machine.clone(),
        _ => agent_name(wish, seats),
    };
    let name = name.replace(|c: char| !c.is_alphanumeric() && c != '-', "_");
    Ok(folder.join(format!("agent-{name}.redb")))
}

fn open_store(path: &Path, limit: u64, seats: &[Seat]) -> Outcome<Arc<Store>> {
    let machines: Vec<&str> = seats.iter().map(|seat| seat.machine.as_str()).collect();
    let store = Store::open(path, limit.saturating_mul(MIB), now())
        .and_then(|store| store.adopt(&machines).map(|()| store));
    store
        .map(Arc::new)
        .map_err(|error: StoreError| words::store(path, &error))
}

/// What is told where.
fn tell_beginning(
    global: &Global,
    wish: &cli::Agent,
    seats: &[Seat],
    broker: Option<&Broker>,
    sets: bool,
    path: &Path,
    metrics: Option<&(Arc<Metrics>, SocketAddr)>,
) -> Outcome {
    if let Some(warning) = broker.and_then(|broker| broker::in_the_clear(&broker.address)) {
        say(global, &warning);
    }
    let figures = metrics.map(|(_, address)| format!("http://{address}/metrics"));
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.array_at("boards", |json| {
                for Seat { machine, global } in seats {
                    json.object(|json| {
                        json.text("machine", machine);
                        json.text("bus", &global.bus.to_string());
                        json.integer("node", global.node().get().into());
                        if let Some(broker) = broker {
                            json.text("topic", &broker.names.machine(machine));
                            if sets {
                                json.text("set", &broker.names.set(machine));
                            }
                        }
                    });
                }
            });
            if let Some(broker) = broker {
                json.text("broker", &broker.address.to_string());
            }
            if let Some(archive) = &wish.archive {
                json.text("archive", &archive.display().to_string());
            }
            if broker.is_some() || wish.archive.is_some() {
                json.text("store", &path.display().to_string());
            }
            if let Some(figures) = &figures {
                json.text("metrics", figures);
            }
        });
    }
    let mut text = String::new();
    if let Some(broker) = broker {
        for Seat {
            machine,
            global: of,
        } in seats
        {
            let line = both!(
                "{bus} is told to {address} as {topic}\n",
                "{bus} 的数据以 {topic} 发送到 {address}\n",
                bus = of.bus,
                address = broker.address,
                topic = broker.names.machine(machine)
            );
            text.push_str(line.get(global.lang()));
        }
    }
    if let Some(archive) = &wish.archive {
        let line = both!(
            "written to {archive} each hour\n",
            "每小时写入 {archive}\n",
            archive = archive.display()
        );
        text.push_str(line.get(global.lang()));
    }
    let path = path.display();
    let kept = match (broker.is_some(), wish.archive.is_some()) {
        (true, false) => Some(both!(
            "kept in {path} until the broker has it\n",
            "在代理服务器收到之前保存在 {path}\n"
        )),
        (true, true) => Some(both!(
            "kept in {path} until the broker has it and it is in a file\n",
            "在代理服务器收到并写入文件之前保存在 {path}\n"
        )),
        (false, true) => Some(both!(
            "kept in {path} until it is in a file\n",
            "在写入文件之前保存在 {path}\n"
        )),
        (false, false) => None,
    };
    if let Some(kept) = kept {
        text.push_str(kept.get(global.lang()));
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
