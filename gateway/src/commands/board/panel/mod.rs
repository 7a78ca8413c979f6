//! `panel`: the page at the machine. This is its side of the bus: it reads the board, and tells the page's server.
//!
//! What pages order goes by the [desk](Desk), which has its turn wherever the link waits. This must not know who watches or
//! orders: sockets, tokens and refusals are those of `leadscrew_panel`.

mod desk;
mod wish;

use std::collections::VecDeque;
use std::io::{self, Write as _};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use leadscrew_core::alarm::{Alarm, Code, Lang};
use leadscrew_core::board::device::objects::BEAT;
use leadscrew_core::bus::{Beat, BoardStatus};
use leadscrew_core::link::{Logged, Status};
use leadscrew_core::units::Length;
use leadscrew_panel::{Feed, Server, Token, Tokens, fresh_token};

use self::desk::{Desk, Line};
use super::monitor::hand::broken;
use super::monitor::told::{Told, of_alarm, told};
use super::monitor::typed::{self, Typed};
use super::monitor::view::Tone;
use super::watch::{Every, LOG, STATUS, Watch};
use super::{mdi, names, open};
use crate::cli::Global;
use crate::diagnostics::alarm_words;
use crate::failure::{Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::json::Json;
use crate::link::{Link, LinkResult};
use crate::output;
use crate::place::SourceLine;
use crate::words::{Both, both};

/// Between two messages of state: 30 Hz.
const PERIOD: Duration = Duration::from_millis(33);
/// Messages of the log that are kept for the page.
const KEPT: usize = 60;

/// Gives out the page until it is interrupted; with `look` nobody orders by it.
pub fn panel(global: &Global, listen: SocketAddr, hosts: &[String], look: bool) -> Outcome {
    let mut link = open(global)?;
    link.greet()?;
    link.hear_status()?;
    let tokens = Tokens {
        look: token()?,
        operate: if look { None } else { Some(token()?) },
    };
    let feed = Arc::new(Feed::default());
    let desk = Arc::new(Desk::new(link.node()));
    let turns = Arc::clone(&desk);
    link.meanwhile(move |seen, now| turns.turn(seen, now));
    let machine = Arc::clone(&desk);
    let server =
        Server::start(listen, hosts, tokens, Arc::clone(&feed), machine).map_err(|error| {
            Failure::Usage(both!(
                "cannot listen at {listen}: {error}; choose another address with --listen",
                "无法监听 {listen}：{error}；请用 --listen 选择其他地址"
            ))
        })?;
    interrupt::defer(UnderWay::Computed);
    tell_links(global, server.address, hosts, tokens)?;
    Side::new(global, link, feed, desk)?.carry_out(&server)
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

/// The side of the bus at work.
struct Side<'a> {
    global: &'a Global,
    link: Link,
    feed: Arc<Feed>,
    desk: Arc<Desk>,
    typed: Option<Typed>,
    watch: Watch,
    record: Option<(Status, Instant)>,
    /// The number of the last status, and when it came.
    status: (u64, Instant),
    /// In English, in Chinese.
    messages: VecDeque<[Told; 2]>,
}

impl<'a> Side<'a> {
    fn new(global: &'a Global, mut link: Link, feed: Arc<Feed>, desk: Arc<Desk>) -> Outcome<Self> {
        let watch = Watch::new(&mut link)?;
        feed.tell(
            "hello",
            object(|json| {
                json.text("bus", &global.bus.to_string());
                json.integer("node", i64::from(link.node().get()));
            }),
        );
        Ok(Self {
            global,
            status: (link.seen.statuses, Instant::now()),
            link,
            feed,
            desk,
            typed: None,
            watch,
            record: None,
            messages: VecDeque::new(),
        })
    }

    /// What a board that lives does not answer is asked again later.
    fn tolerate<T>(&mut self, read: LinkResult<T>) -> Outcome<Option<T>> {
        if read.is_err() {
            self.link.check_alive()?;
        }
        Ok(read.ok())
    }

    fn carry_out(mut self, server: &Server) -> Outcome {
        let (mut status, mut log) = (Every::new(STATUS), Every::new(LOG));
        loop {
            let now = Instant::now();
            if log.is_due(now) {
                self.read_log()?;
            }
            if status.is_due(now) {
                let read = self.link.status();
                if let Some(status) = self.tolerate(read)? {
                    self.record = Some((status, Instant::now()));
                }
                self.ask_beat()?;
            }
            self.tell_state()?;
            server.attend();
            self.link.listen(Instant::now() + PERIOD, &mut |_| false)?;
            self.watch.attend(&mut self.link)?;
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
            self.desk.note_asked(Beat::new(beat as u16), mode);
        }
        Ok(())
    }

    /// Answers what only a bus that answers knows, and carries out typed lines.
    fn do_asked(&mut self) -> Outcome {
        let asks = self.desk.asks();
        for ticket in asks.reasons {
            let done = match self.link.refusal() {
                Ok(None) => Ok(()),
                Ok(Some(reason)) => Err(alarm_words(&reason)),
                Err(trouble) => {
                    self.link.check_alive()?;
                    Err(Failure::from(trouble).words().unwrap_or_else(broken))
                }
            };
            self.desk.answer(ticket, done);
        }
        for Line { ticket, text, zh } in asks.lines {
            if self.typed.is_some() {
                let alarm = Alarm::of(Code::ProgramUnderWay, &[]);
                self.desk.answer(ticket, Err(alarm_words(&alarm)));
                continue;
            }
            let lang = if zh { Lang::Zh } else { Lang::En };
            match Typed::begin(self.global, &text, lang) {
                Ok(typed) => {
                    self.typed = Some(typed);
                    self.desk.answer(ticket, Ok(()));
                }
                Err(error) => self.desk.answer(ticket, Err(typed::not_begun(&error).0)),
            }
        }
        // A line may take long: who has typed it is told of its end as everybody else is.
        if let Some((words, tone)) = self.typed.as_ref().and_then(Typed::answer) {
            self.typed = None;
            let text = object(|json| {
                json.flag("ok", tone == Tone::Good);
                json.text("en", &words.en);
                json.text("zh", &words.zh);
            });
            self.feed.tell("line", text);
        }
        self.desk.note_typed(self.typed.is_some());
        Ok(())
    }

    fn read_log(&mut self) -> Outcome {
        let read = self.watch.log(&mut self.link);
        let entries = self.tolerate(read)?.unwrap_or_default();
        for entry in &entries {
            if let Some(told) = in_both(entry) {
                if self.messages.len() == KEPT {
                    self.messages.pop_front();
                }
                self.messages.push_back(told);
            }
        }
        if !entries.is_empty() {
            self.feed.tell("log", log(&self.messages));
        }
        if let Some((status, _)) = self.record {
            let read = self.watch.follow(self.global, &mut self.link, &status);
            self.tolerate(read)?;
        }
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
            self.desk.beat(json);
            levels(json, &record, &status);
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
        });
        self.feed.tell("s", text);
        Ok(())
    }
}

/// State, alarm, overrides and place in the program.
fn levels(json: &mut Json, record: &Status, status: &BoardStatus) {
    json.text("state", status.state.name());
    match status.alarm {
        Some(number) => json.integer("number", i64::from(number)),
        None => json.null("number"),
    }
    match record.alarm.filter(|_| status.alarm.is_some()) {
        Some(alarm) => json.object_at("alarm", |json| {
            let told = [Lang::En, Lang::Zh].map(|lang| of_alarm(&alarm, Tone::Bad, lang));
            message(json, &told);
        }),
        None => json.null("alarm"),
    }
    json.flag("hold", status.flags.hold);
    json.flag("single", status.flags.single_block);
    json.flag("dry", status.flags.dry_run);
    match record.line {
        0 => json.null("line"),
        line => json.text("line", &SourceLine(line).to_string()),
    }
    json.integer("move", i64::from(record.number));
    json.integer("rpm", i64::from(record.speed.rpm().get()));
    json.integer("commanded", i64::from(record.command.get()));
    json.integer("feed", i64::from(record.feed_percent));
    json.integer("rapid", i64::from(record.rapid_percent));
    json.integer("turn", i64::from(record.spindle_percent));
    match record.sync_error {
        Some(error) => json.decimal::<3>("sync_um", error.nm()),
        None => json.null("sync_um"),
    }
    json.integer("late", i64::from(record.late));
}

/// Where the axes are, X as a diameter, by the work's zero and by the machine's.
fn places(json: &mut Json, record: &Status, zero: Option<[Length; 2]>) {
    let place = record.position;
    match zero {
        Some([x, z]) => {
            json.decimal::<6>("wx", (place.x - x).nm().saturating_mul(2));
            json.decimal::<6>("wz", (place.z - z).nm());
        }
        None => {
            json.null("wx");
            json.null("wz");
        }
    }
    json.decimal::<6>("mx", place.x.nm().saturating_mul(2));
    json.decimal::<6>("mz", place.z.nm());
    json.decimal::<6>("mc", place.c.udeg());
    json.text("referenced", &names(record.referenced));
    json.text("unreferenced", &names(record.unreferenced));
}

fn in_both(entry: &Logged) -> Option<[Told; 2]> {
    Some([told(entry, Lang::En)?, told(entry, Lang::Zh)?])
}

fn log(messages: &VecDeque<[Told; 2]>) -> String {
    let mut json = Json::new();
    let items: Vec<String> = messages
        .iter()
        .map(|told| object(|json| message(json, told)))
        .collect();
    json.item(&format!("[{}]", items.join(",")));
    text(json)
}

fn message(json: &mut Json, told: &[Told; 2]) {
    let [en, zh] = told;
    let tone = match en.tone {
        Tone::Bad => "bad",
        Tone::Care => "care",
        Tone::Plain | Tone::Good | Tone::Old => "plain",
    };
    json.text("tone", tone);
    for (key, [en, zh]) in [
        ("text", [&en.text, &zh.text]),
        ("help", [&en.help, &zh.help]),
    ] {
        json.array_at(key, |json| {
            json.text_item(en);
            json.text_item(zh);
        });
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
