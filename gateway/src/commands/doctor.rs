//! `doctor`: what is set up wrong on a bus or in a log, as text or JSON.

use std::fs::File;
use std::io::{self, BufReader, Write as _};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use leadscrew_can::{Address, Can, LogReader, LogWriter, Received, Stamp};
use leadscrew_core::alarm::Lang;
use leadscrew_core::params::Params;

use super::board;
use crate::cli::{self, Global};
use crate::doctor::machine::{Clock, Known, Machine};
use crate::doctor::rules::{Lack, Words};
use crate::doctor::{Doctor, Finding, Report, ask, page};
use crate::failure::{Doing, Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::json::Json;
use crate::output;
use crate::params::drives::{DriveName, OfProfile, mode};
use crate::profiles::Chosen;
use crate::setup::{Answer, Setup};
use crate::words::{self, Both, both, pick};

/// How long to listen before an interruption is looked for.
const PATIENCE: Duration = Duration::from_millis(200);

/// Listens or reads, judges, and tells.
pub fn run(global: &Global, args: &cli::Doctor) -> Outcome {
    let lang = global.lang();
    if args.rules {
        return output::write(page::table(lang).as_bytes());
    }
    let (report, notes) = match &args.log {
        Some(path) => of_log(global, args, path)?,
        None if global.bus == Address::Sim => {
            return Err(Failure::Usage(both!(
                "`doctor` listens on a bus or reads a log: name one with `--bus can0` or `--log FILE`",
                "`doctor` 监听总线或读取记录：请用 `--bus can0` 或 `--log FILE` 指定"
            )));
        }
        None => of_bus(global, args)?,
    };
    if global.json {
        output::json(|json| whole(&report, &notes, (lang, &global.bus), json))?;
    } else {
        output::write(text(&report, &notes, lang, &global.bus).as_bytes())?;
    }
    match report.findings.is_empty() {
        true => Ok(()),
        false => Err(Failure::Wrong),
    }
}

/// A log, with the parameters of the options.
fn of_log(
    global: &Global,
    args: &cli::Doctor,
    path: &std::path::Path,
) -> Outcome<(Report, Vec<Both>)> {
    let file =
        File::open(path).map_err(|error| Failure::file(Doing::Read, path.display(), &error))?;
    let setup = Setup::over(global, None, None, Answer::Parameters)?;
    let mut entries = LogReader::new(BufReader::new(file)).peekable();
    let clock = match entries.peek() {
        Some(Ok(entry)) => clock_of(&entry.bus),
        Some(Err(_)) => Clock::Kernel,
        None => {
            return Err(Failure::Usage(both!(
                "there is no frame in `{path}`",
                "`{path}` 中没有报文",
                path = words::path(path)
            )));
        }
    };
    let told = !global.params.is_empty() || !global.set.is_empty();
    let (params, profiles) = (setup.params, setup.profiles);
    let machine = machine(global, args, params, &profiles, told, clock)?;
    let mut doctor = Doctor::new(machine);
    for entry in entries {
        let entry = entry.map_err(|wrong| {
            Failure::Usage(both!(
                "`{path}`: {wrong}",
                "`{path}`：{wrong}",
                path = words::path(path)
            ))
        })?;
        doctor.push(entry.time, &entry.packet);
    }
    let mut notes = Vec::new();
    if !told {
        notes.push(both!(
            "the parameters are those of the built-in machine: name the machine's own with `--params`",
            "参数为内置机床的：请用 `--params` 指定实际机床的参数"
        ));
    }
    Ok((doctor.report(), notes))
}

/// A bus: listen, read the board's parameters, then objects.
fn of_bus(global: &Global, args: &cli::Doctor) -> Outcome<(Report, Vec<Both>)> {
    let mut can = leadscrew_can::open(&global.bus, global.bit_rate()?).map_err(Failure::bus)?;
    interrupt::defer(UnderWay::Computed);
    let seconds = args.seconds;
    tell(
        global,
        &both!("listening for {seconds} s", "监听 {seconds} s"),
    );
    let began = Stamp::now();
    let mut packets = listen(&mut *can, Duration::from_secs(seconds.into()))?;
    let mut notes = Vec::new();
    let own = !global.params.is_empty() || !global.set.is_empty();
    let base = if own || args.listen_only || interrupt::requested() {
        None
    } else {
        let read = || board::base(global, Answer::Parameters);
        match listen_beside(&mut *can, &mut packets, read)? {
            Ok(base) => base,
            Err(failure) => {
                let why = failure.words().unwrap_or_default();
                notes.push(both!(
                    "the board's parameters could not be read ({en}): those of the built-in machine count",
                    "无法读取控制板的参数（{zh}）：以内置机床的参数为准",
                    en = why.en,
                    zh = why.zh
                ));
                None
            }
        }
    };
    let ended = Stamp::now();
    let told = own || base.is_some();
    if !told && notes.is_empty() {
        notes.push(both!(
            "the parameters are those of the built-in machine: name the machine's own with `--params`",
            "参数为内置机床的：请用 `--params` 指定实际机床的参数"
        ));
    }
    let (params, profiles) = match base {
        Some(base) => (base.params, Vec::new()),
        None => {
            let setup = Setup::over(global, None, None, Answer::Parameters)?;
            (setup.params, setup.profiles)
        }
    };
    let clock = match &global.bus {
        Address::SocketCan(_) => Clock::Kernel,
        _ => Clock::Program,
    };
    let machine = machine(global, args, params, &profiles, told, clock)?;
    let mut doctor = Doctor::new(machine.clone());
    doctor.until(began);
    for Received { time, packet } in &packets {
        doctor.push(*time, packet);
    }
    if args.listen_only || interrupt::requested() {
        doctor.until(ended);
    } else {
        let read = ask::READ;
        tell(
            global,
            &both!("reading, and writing nothing: {read}", "只读不写：{read}"),
        );
        let mut hear = |at, packet: &_| doctor.push(at, packet);
        ask::ask(&mut *can, &machine, &mut hear, &|| !interrupt::requested())
            .map_err(Failure::bus)?;
    }
    Ok((doctor.report(), notes))
}

fn listen(can: &mut dyn Can, time: Duration) -> Outcome<Vec<Received>> {
    let mut packets = Vec::new();
    let end = Instant::now() + time;
    while !interrupt::requested() {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            break;
        }
        can.receive(&mut packets, left.min(PATIENCE))
            .map_err(Failure::bus)?;
    }
    Ok(packets)
}

/// Listens while something else is done. What nobody takes waits in the buffer of the bus, which is full after a second or
/// two.
fn listen_beside<T>(
    can: &mut dyn Can,
    packets: &mut Vec<Received>,
    what: impl FnOnce() -> T,
) -> Outcome<T> {
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        let listener = scope.spawn(|| {
            loop {
                let is_last = done.load(Ordering::Acquire);
                can.receive(packets, PATIENCE)?;
                if is_last {
                    return Ok(());
                }
            }
        });
        let result = what();
        done.store(true, Ordering::Release);
        let heard = listener.join();
        heard
            .unwrap_or_else(|panic| resume_unwind(panic))
            .map_err(Failure::bus)?;
        Ok(result)
    })
}

/// What goes on, for people. A closed standard error leaves nobody to tell.
fn tell(global: &Global, words: &Both) {
    let _ = writeln!(io::stderr(), "{}", words.get(global.lang()));
}

/// Whose stamps the log of a bus with this name has.
fn clock_of(bus: &str) -> Clock {
    match bus.contains(':') || bus.starts_with("sim") {
        true => Clock::Program,
        false => Clock::Kernel,
    }
}

fn machine(
    global: &Global,
    args: &cli::Doctor,
    params: Params,
    profiles: &[OfProfile],
    told: bool,
    clock: Clock,
) -> Outcome<Machine> {
    let mut machine = Machine::new(params, told, global.node(), clock);
    let chosen = Chosen::of(&args.drives.drive, global.lang())?;
    let [x, z] = chosen.axes();
    for drive in &mut machine.drives {
        let of_file = profiles.iter().find(|own| own.drive == drive.name);
        let profile = match drive.name {
            DriveName::X => x.as_ref(),
            DriveName::Z => z.as_ref(),
            _ => None,
        }
        .or(of_file.map(|own| &own.profile));
        let number = |path: &str| -> Option<u32> { profile?.fact(path)?.value.text().parse().ok() };
        let mode = mode(drive.name, &machine.params) as u32;
        drive.known = profile.map(|_| Known {
            window_us: number("sync.window_us"),
            buffer: number(&format!("mode.{mode}.buffer.default")),
        });
    }
    Ok(machine)
}

/// The report for people.
fn text(report: &Report, notes: &[Both], lang: Lang, bus: &Address) -> String {
    let mut text = String::new();
    let of = |words: Words| pick(lang, words.0, words.1);
    let ms = report.heard.span().as_millis();
    let (frames, errors) = (report.heard.frames, report.heard.errors.line.count);
    let heard = both!(
        "heard {frames} frames and {errors} errors on the line in {ms} ms\n",
        "{ms} ms 内收到 {frames} 帧，线路错误 {errors} 个\n"
    );
    text.push_str(heard.get(lang));
    for note in notes {
        let note = both!("note: {en}\n", "注意：{zh}\n", en = note.en, zh = note.zh);
        text.push_str(note.get(lang));
    }
    match report.findings.split_first() {
        None => text.push_str(pick(lang, "nothing found\n", "未发现问题\n")),
        Some((first, others)) => {
            let (number, fault) = (first.rule.number, of(first.rule.fault));
            let cause = both!(
                "first cause: {fault} (rule {number})\n",
                "首要原因：{fault}（规则 {number}）\n"
            );
            text.push_str(cause.get(lang));
            text.push_str(&format!("  {}\n", first.found.evidence.get(lang)));
            for (at, packet) in &first.found.hits.frames {
                text.push_str(&format!("  {}", line(*at, packet)));
            }
            let remedy = of(first.rule.remedy);
            text.push_str(both!("remedy: {remedy}\n", "措施：{remedy}\n").get(lang));
            if let Some(mend) = &first.found.mend {
                text.push_str(&format!("  {}\n", mend.line(bus)));
            }
            for Finding { rule, found } in others {
                let (number, fault) = (rule.number, of(rule.fault));
                let told = found.evidence.get(lang);
                let also = both!(
                    "also: {fault} (rule {number}): {told}\n",
                    "另外：{fault}（规则 {number}）：{told}\n"
                );
                text.push_str(also.get(lang));
            }
        }
    }
    let mut lacks: Vec<(Lack, Vec<String>)> = Vec::new();
    for (rule, lack) in &report.not_judged {
        match lacks.iter_mut().find(|(known, _)| known == lack) {
            Some((_, rules)) => rules.push(rule.number.to_string()),
            None => lacks.push((*lack, vec![rule.number.to_string()])),
        }
    }
    for (lack, rules) in lacks {
        let word = if rules.len() == 1 { "rule" } else { "rules" };
        let (rules, why) = (rules.join(" "), why(lack));
        let told = both!(
            "not judged: {word} {rules}: {en}\n",
            "未判断：规则 {rules}：{zh}\n",
            en = why.en,
            zh = why.zh
        );
        text.push_str(told.get(lang));
    }
    text
}

/// Why a rule was not judged.
fn why(lack: Lack) -> Both {
    match lack {
        Lack::Objects(objects) => both!(
            "{objects} did not come over the wire",
            "总线上没有出现 {objects}"
        ),
        Lack::Time => both!(
            "it was not listened for long enough (`--seconds`)",
            "监听时间不足（`--seconds`）"
        ),
        Lack::Profile => both!(
            "the profile of the drives is not named, or does not say it (`--drive`)",
            "未指定驱动器配置，或其中没有该项（`--drive`）"
        ),
        Lack::Clock => both!(
            "the time stamps are not those of the wire",
            "时间戳不是总线上的实时时间"
        ),
        Lack::Parameters => both!(
            "the parameters are not known (`--params`)",
            "参数未知（`--params`）"
        ),
        Lack::Rests => both!(
            "an axis did not stand before and behind a way of 1000 counts",
            "轴在 1000 个脉冲以上的移动前后没有静止"
        ),
        Lack::Earlier => both!("what was found comes first", "先解决已发现的问题"),
    }
}

/// A frame as candump writes it.
fn line(at: Stamp, packet: &leadscrew_can::Packet) -> String {
    let mut log = LogWriter::new(Vec::new(), "-");
    // Memory takes everything.
    let _ = log.push(at, packet);
    let bytes = log.finish().unwrap_or_default();
    String::from_utf8(bytes).unwrap_or_default()
}

fn whole(report: &Report, notes: &[Both], (lang, bus): (Lang, &Address), json: &mut Json) {
    let heard = &report.heard;
    json.flag("ok", report.findings.is_empty());
    json.number("frames", heard.frames);
    json.number("line_errors", heard.errors.line.count);
    json.number("heard_ms", heard.span().as_millis());
    if let Some(first) = report.findings.first() {
        json.number("first_cause", first.rule.number);
    }
    json.array_at("findings", |json| {
        for Finding { rule, found } in &report.findings {
            json.object(|json| {
                json.number("rule", rule.number);
                json.text("group", &format!("{:?}", rule.group).to_lowercase());
                json.text("fault", pick(lang, rule.fault.0, rule.fault.1));
                json.text("remedy", pick(lang, rule.remedy.0, rule.remedy.1));
                if let Some(node) = found.node {
                    json.number("node", node.get());
                }
                json.text("evidence", found.evidence.get(lang));
                if let Some(mend) = &found.mend {
                    json.text("command", &mend.line(bus));
                }
                json.number("count", found.hits.count);
                json.number("longest_ms", found.hits.longest.as_millis());
                for (key, at) in [("first_us", found.hits.first), ("last_us", found.hits.last)] {
                    if let Some(at) = at {
                        json.number(key, at.nanos() / 1000);
                    }
                }
                json.array_at("frames", |json| {
                    for (at, packet) in &found.hits.frames {
                        json.text_item(line(*at, packet).trim_end());
                    }
                });
            });
        }
    });
    json.array_at("not_judged", |json| {
        for (rule, lack) in &report.not_judged {
            json.object(|json| {
                json.number("rule", rule.number);
                json.text("why", why(*lack).get(lang));
            });
        }
    });
    json.array_at("notes", |json| {
        for note in notes {
            json.text_item(note.get(lang));
        }
    });
}
