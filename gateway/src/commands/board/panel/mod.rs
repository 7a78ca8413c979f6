//! `panel`: the page at the machine. This is its side of the bus: it reads the board, and tells the page's server.
//!
//! What pages order goes by the [desk](Desk), which has its turn wherever the link waits. This must not know who watches or
//! orders: sockets, tokens and refusals are those of `leadscrew_panel`.

mod begun;
mod contacts;
mod cuts;
mod desk;
mod finding;
mod path;
mod reading;
mod retract;
mod sent;
mod tables;
mod telling;
mod views;
mod wish;

use std::collections::VecDeque;
use std::io::{self, Write as _};
use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use leadscrew_core::board::device::objects::BEAT;
use leadscrew_core::bus::Beat;
use leadscrew_core::link::Status;
use leadscrew_panel::{Feed, Pace, Programs, Server, Token, Tokens, fresh_token};

use self::begun::Begun;
use self::contacts::Contacts;
use self::cuts::Cuts;
use self::desk::{Asks, Desk};
use self::telling::{levels, places};
use self::views::Views;
use super::monitor::hand::broken;
use super::monitor::told::Told;
use super::watch::{Every, LOG, STATUS, Watch};
use super::{by_hand, heard, mdi, single_block};
use crate::cli::Global;
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::json::Json;
use crate::link::{Link, LinkResult};
use crate::output;
use crate::words::{self, Both, both};

/// Messages of the log that are kept for the page.
const KEPT: usize = 60;

/// Gives out the page until it is interrupted; with `look` nobody orders by it, with a folder it has programs.
pub fn panel(
    global: &Global,
    listen: SocketAddr,
    hosts: &[String],
    look: bool,
    folder: Option<&Path>,
) -> Outcome {
    let programs = match folder {
        Some(folder) => Some(Arc::new(Programs::open(folder).map_err(|error| {
            let folder = words::path(folder);
            Failure::Usage(both!(
                "`{folder}` is no folder that can be read: {error}; name one that is there with --programs",
                "`{folder}` 不是可读的文件夹：{error}；请用 --programs 指定已有的文件夹"
            ))
        })?)),
        None => None,
    };
    let mut link = heard(global)?;
    if !look {
        single_block(global, &mut link)?;
    }
    let tokens = Tokens {
        look: token()?,
        operate: if look { None } else { Some(token()?) },
    };
    let feed = Arc::new(Feed::default());
    let views = Arc::new(Views::new(global));
    let session = by_hand::session(&link.seen);
    let desk = Arc::new(Desk::new(
        link.node(),
        session,
        Arc::clone(&views),
        programs.clone(),
    ));
    let machine = Arc::clone(&desk);
    let told = Arc::clone(&feed);
    let has_programs = programs.is_some();
    let server = Server::start(listen, hosts, tokens, told, machine, programs);
    let server = server.map_err(|error| {
        Failure::Usage(both!(
            "cannot listen at {listen}: {error}; choose another address with --listen",
            "无法监听 {listen}：{error}；请用 --listen 选择其他地址"
        ))
    })?;
    interrupt::defer(UnderWay::Computed);
    tell_links(global, server.address, hosts, tokens)?;
    feed.tell(
        "hello",
        object(|json| {
            json.text("bus", &global.bus.to_string());
            json.integer("node", i64::from(link.node().get()));
            json.flag("programs", has_programs);
        }),
    );
    let begun = Begun::new(global, feed, desk, views);
    finding::carry_out(begun, &server, link)
}

fn token() -> Outcome<Token> {
    fresh_token().map_err(|error| {
        Failure::Usage(both!(
            "this computer gives no random numbers for a token: {error}; look at /dev/urandom",
            "本机无法提供生成令牌所需的随机数：{error}；请检查 /dev/urandom"
        ))
    })
}

/// The links to open.
fn tell_links(global: &Global, address: SocketAddr, hosts: &[String], tokens: Tokens) -> Outcome {
    if !address.ip().is_loopback() {
        let text = both!(
            "warning: the page goes over the network without TLS, and its tokens with it: who reads them operates the machine; \
             listen at 127.0.0.1 behind a proxy\n",
            "警告：页面及其令牌未经 TLS 在网络上传输，截获者即可操作机床；请监听 127.0.0.1 并使用代理\n"
        );
        // Who reads the links by program is warned too.
        let _ = io::stderr().write_all(text.get(global.lang()).as_bytes());
    }
    let links = |token: Token| -> Vec<String> {
        let token = token.text();
        let here = std::iter::once(format!("http://{address}/#{token}"));
        here.chain(hosts.iter().map(|host| format!("https://{host}/#{token}")))
            .collect()
    };
    let looks = links(tokens.look);
    let operates = tokens.operate.map(links).unwrap_or_default();
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            for (key, links) in [("links", &operates), ("look", &looks)] {
                json.array_at(key, |json| {
                    links.iter().for_each(|link| json.text_item(link))
                });
            }
        });
    }
    let mut text = Both::default();
    if !operates.is_empty() {
        text = both!(
            "who has this link operates the machine:\n{list}\n",
            "持有此链接者可以操作机床：\n{list}\n",
            list = operates.join("\n")
        );
    }
    let looks = both!(
        "who has this one sees it, and orders nothing:\n{list}\nCtrl-C ends the panel; a program goes on.\n",
        "持有此链接者只能查看：\n{list}\n按 Ctrl-C 结束面板，程序继续运行。\n",
        list = looks.join("\n")
    );
    let text = text.get(global.lang()).to_owned() + looks.get(global.lang());
    output::write(text.as_bytes())
}

/// The side of the bus at work, as long as the board is heard.
struct Side<'a, 'b> {
    begun: &'b mut Begun<'a>,
    link: Link,
    watch: Watch,
    cuts: Cuts,
    contacts: Contacts,
    record: Option<(Status, Instant)>,
    /// The number of the last status, and when it came.
    status: (u64, Instant),
    /// In English, in Chinese.
    messages: VecDeque<[Told; 2]>,
    /// The board has started again, and all of it is to be read anew.
    anew: bool,
}

impl<'a, 'b> Side<'a, 'b> {
    /// Whatever was read of a board before is read anew.
    fn new(begun: &'b mut Begun<'a>, mut link: Link) -> Outcome<Self> {
        let watch = Watch::new(&mut link)?;
        begun.desk.find(link.seen.boots);
        let turns = Arc::clone(&begun.desk);
        link.meanwhile(move |seen, now| turns.turn(seen, now));
        Ok(Self {
            status: (link.seen.statuses, Instant::now()),
            contacts: Contacts::new(begun.global),
            begun,
            link,
            watch,
            cuts: Cuts::default(),
            record: None,
            messages: VecDeque::new(),
            anew: false,
        })
    }

    /// What a board that lives does not answer is asked again later.
    fn tolerate<T>(&mut self, read: LinkResult<T>) -> Outcome<Option<T>> {
        if read.is_err() {
            self.link.check_alive()?;
        }
        Ok(read.ok())
    }

    /// Until the panel is interrupted; with a failure once the board is not heard.
    fn carry_out(&mut self, server: &Server) -> Outcome {
        let (mut status, mut log) = (Every::new(STATUS), Every::new(LOG));
        let mut pace = Pace::new(Instant::now());
        loop {
            let now = Instant::now();
            if log.is_due(now) {
                self.read_log()?;
            }
            if status.is_due(now) {
                let read = self.link.status();
                if let Some(status) = self.tolerate(read)? {
                    self.begun.views.note_place(status.position);
                    self.record = Some((status, Instant::now()));
                }
                self.ask_beat()?;
            }
            self.read_cuts(now)?;
            self.tell_state()?;
            server.attend();
            self.link
                .listen(pace.next(Instant::now()), &mut |_| false)?;
            if self.watch.attend(&mut self.link)? {
                self.anew = true;
                (self.record, log, status) = (None, Every::new(LOG), Every::new(STATUS));
                self.begun.views.forget();
            }
            self.do_asked()?;
            if interrupt::requested() {
                return Ok(());
            }
        }
    }

    /// A board above node 31 sends no beat.
    fn ask_beat(&mut self) -> Outcome {
        if self.link.seen.beat.is_some() {
            return Ok(());
        }
        let read = self.link.read_number(BEAT);
        let beat = self.tolerate(read)?;
        let read = self.link.mode();
        let mode = self.tolerate(read)?;
        if let (Some(beat), Some(mode)) = (beat, mode) {
            self.begun.desk.note_asked(Beat::new(beat as u16), mode);
        }
        Ok(())
    }

    /// Answers what only a bus that answers knows, and carries out typed lines.
    fn do_asked(&mut self) -> Outcome {
        let asks = self.begun.desk.asks();
        let Asks { halts, .. } = asks;
        for ticket in asks.reasons {
            let done = match self.link.refusal() {
                Ok(None) => Ok(()),
                Ok(Some(reason)) => Err(alarm_words(&reason)),
                Err(trouble) => {
                    self.link.check_alive()?;
                    Err(Failure::from(trouble).words().unwrap_or_else(broken))
                }
            };
            self.begun.desk.answer(ticket, done);
        }
        if asks.press {
            let read = self.link.refusal();
            if let Some(Some(reason)) = self.tolerate(read)? {
                let why = Err(alarm_words(&reason));
                let text = object(|json| desk::fields(json, &why));
                self.begun.feed.tell("press", text);
            }
        }
        for line in asks.lines {
            self.begun.begin_line(line, halts);
        }
        for program in asks.programs {
            let from = self.record.map(|(record, _)| record.position);
            self.begun.begin_program(program, from, halts);
        }
        self.begun.end_own();
        Ok(())
    }

    fn tell_state(&mut self) -> Outcome {
        let now = Instant::now();
        if self.link.seen.statuses != self.status.0 {
            self.status = (self.link.seen.statuses, now);
        }
        let Some((record, read)) = self.record else {
            return Ok(());
        };
        let mode = self.link.mode();
        let mode = self.tolerate(mode)?;
        let seen = &self.link.seen;
        // The older of both counts.
        let age = now.saturating_duration_since(read.min(self.status.1));
        let status = seen.status.unwrap_or_default();
        let zero = self.watch.zeros.zero();
        let modal = self.watch.zeros.carried.as_ref().map(mdi::modal_words);
        let text = object(|json| {
            json.integer("age_ms", i64::try_from(age.as_millis()).unwrap_or(i64::MAX));
            match mode {
                Some(mode) => json.text("mode", mode.name()),
                None => json.null("mode"),
            }
            self.begun.desk.beat(json);
            levels(json, &record, &status);
            match self.watch.zeros.read() {
                Some((params, _)) => {
                    json.integer("by_hand_rpm", i64::from(params.spindle_jog_rpm()))
                }
                None => json.null("by_hand_rpm"),
            }
            match zero {
                Some(zero) => {
                    json.text("zero", &format!("G{} T{:02}", zero.system, zero.tool));
                    json.integer("tool", i64::from(zero.tool));
                }
                None => {
                    json.null("zero");
                    json.null("tool");
                }
            }
            places(json, &record, zero.map(|zero| zero.at));
            match &modal {
                Some(words) => json.text("modal", words),
                None => json.null("modal"),
            }
            match self.begun.views.tag() {
                Some(tag) => json.text("by", &tag),
                None => json.null("by"),
            }
        });
        self.begun.feed.tell("s", text);
        Ok(())
    }
}

fn object(fill: impl FnOnce(&mut Json)) -> String {
    let mut json = Json::new();
    json.object(fill);
    text(json)
}

fn text(json: Json) -> String {
    // It was text before.
    String::from_utf8_lossy(&json.into_bytes()).into_owned()
}
