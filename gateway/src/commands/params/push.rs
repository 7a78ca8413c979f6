//! `params push`: a set to a board, as one transaction.
//!
//! ```text
//! read and check the files ─► read the board's set ─► compare ─► stage ─► drives ─► commit by its hash ─► read back
//! ```
//!
//! Whatever happens on the way, the board has its old set or the new one. The drives come between: the board has looked at
//! the set before any of them is written, and where one of them refuses, the board's set has not been touched [D122].
//!
//! Files that name every value need no set to be laid over: then the board's is not read, but asked, once the new one is
//! staged, what that would change [D155].

use std::io::IsTerminal as _;
use std::path::PathBuf;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use leadscrew_can::Address;
use leadscrew_core::alarm::Code;
use leadscrew_core::board::DriveNodes;
use leadscrew_core::bus::Order;
use leadscrew_core::link::identity;
use leadscrew_core::params::{Entry, PASSWORD, PASSWORD_KEPT, Params};

use super::{block, drive};
use crate::cli::{Global, Push};
use crate::commands::board::{Greeted, Machine};
use crate::commands::ending;
use crate::diagnostics::say;
use crate::failure::{Failure, Outcome};
use crate::interrupt::{self, UnderWay};
use crate::link::{Link, Trouble};
use crate::output;
use crate::params::difference::{self, Change, DriveChange, changes};
use crate::params::{self, Loaded};
use crate::setup::{alone, told_good};
use crate::words::{Both, both, pick};

/// Parameter 9026: the board takes it by itself also where it refuses a whole set.
const WRITE_ENABLE: u16 = 9026;

/// What is to come into force.
#[derive(Debug)]
pub struct Wish<'a> {
    /// Machine files.
    pub files: &'a [PathBuf],
    /// Options over them.
    pub set: &'a [String],
    /// Over the built-in machine, instead of the board's set.
    pub built_in: bool,
    /// Of the board's parameters.
    pub password: Option<u32>,
}

/// What has changed.
#[derive(Debug, Default)]
pub struct Done {
    /// Of the set.
    pub changes: Vec<Change>,
    /// Of the drives.
    pub drives: Vec<DriveChange>,
    /// What is to be said about it.
    pub notes: Vec<Both>,
    /// Of the set that is in force then.
    pub identity: u32,
    /// A set that was there already has been taken, whether it differs or not.
    pub restored: bool,
}

/// Sends what was typed.
pub fn run(global: &Global, args: &Push) -> Outcome {
    let files: Vec<_> = global.params.iter().chain(&args.files).cloned().collect();
    if files.is_empty() && global.set.is_empty() && !args.built_in {
        return Err(Failure::Usage(both!(
            "`params push` needs something to send: machine files, `--set NO=VALUE`, or `--built-in`",
            "`params push` 需要要发送的内容：机床参数文件、`--set NO=VALUE` 或 `--built-in`"
        )));
    }
    let wish = Wish {
        files: &files,
        set: &global.set,
        built_in: args.built_in,
        password: args.password,
    };
    transact(global, &wish)
}

/// Carries a wish out, or shows what it would do.
pub fn transact(global: &Global, wish: &Wish) -> Outcome {
    // What is wrong with the files by themselves needs no board to be told.
    let alone = alone(global, wish.files, wish.set)?;
    if global.bus == Address::Sim && global.state.is_none() {
        return Err(no_board());
    }
    let mut greeted = Greeted::meet(global)?;
    let whole = wish.built_in || alone.names_all();
    let mut told = None;
    let has_block = alone.params.block_node() != 0;
    if whole
        && alone.drives.is_empty()
        && !has_block
        && !new_password(&alone.params)
        && !global.dry_run
    {
        let wanted = told_good(global, alone)?;
        interrupt::defer(UnderWay::Machine);
        let done = replace(&mut greeted.link, &wanted.params, wish.password);
        let kept = greeted.keep();
        let done = done?;
        kept?;
        if let Some(done) = done {
            return tell(global, &done);
        }
        // It names every value: laid over the board's set it is the same, and its warnings have been said.
        told = Some(wanted);
    }
    let mut machine = greeted.read()?;
    let wanted = match told {
        Some(wanted) => wanted,
        None => {
            let base = (!wish.built_in).then(|| machine.params.clone());
            told_good(global, load(global, wish, base)?)?
        }
    };
    interrupt::defer(UnderWay::Machine);
    let done = carry_out(global, &mut machine, &wanted, wish.password);
    let kept = machine.keep();
    let done = done?;
    kept?;
    tell(global, &done)
}

/// It holds a password that is to become the board's: no identity shows whether that is the one there is.
fn new_password(params: &Params) -> bool {
    let password = Entry::find(PASSWORD, None).map_or(0, |entry| params.get(entry));
    !matches!(password, 0 | PASSWORD_KEPT)
}

/// Puts a set in the place of the one in force, without reading that. `None` where the board is protected: the write
/// enable may be all that changes, and that needs another way.
fn replace(link: &mut Link, wanted: &Params, password: Option<u32>) -> Outcome<Option<Done>> {
    let mut done = Done {
        identity: identity(wanted),
        ..Done::default()
    };
    if link.parameters_identity()? == done.identity {
        return Ok(Some(done));
    }
    link.attend()?;
    if let Some(password) = password {
        link.open_parameters(password)?;
    }
    match link.stage(wanted) {
        Err(Trouble::Parameters {
            reason: Some(alarm),
            ..
        }) if alarm.code == Code::ParametersProtected => return Ok(None),
        staged => staged?,
    }
    let old = link.before(wanted)?;
    drive::check_periods(link, &[], &old, wanted)?;
    drive::check_setpoints(link, &[], &old, wanted)?;
    link.commit(wanted)?;
    done.changes = changes(&old, wanted);
    note_offsets(link, &mut done)?;
    Ok(Some(done))
}

/// Nothing that could be written to was named.
pub fn no_board() -> Failure {
    Failure::Usage(both!(
        "this needs a board: name its bus (`--bus can0`), or the flash of a simulated one (`--state FILE`)",
        "这需要一块控制板：请指定总线（`--bus can0`），或模拟控制板的闪存（`--state FILE`）"
    ))
}

fn load(global: &Global, wish: &Wish, base: Option<Params>) -> Outcome<Loaded> {
    params::load_over(base, wish.files, wish.set, global.lang())
}

/// Puts a set in the place of the machine's, drives included. With `--dry-run` it says what that would change.
///
/// # Errors
/// The board or a drive refuses, or does not answer.
pub fn carry_out(
    global: &Global,
    machine: &mut Machine,
    wanted: &Loaded,
    password: Option<u32>,
) -> Outcome<Done> {
    let old = machine.params.clone();
    let link = &mut machine.link;
    let pending = drive::pending(link, &wanted.drives, &DriveNodes::of(&wanted.params))?;
    // The block of a board that is simulated for this command alone is set up.
    let of_block = match global.state {
        None => block::pending(link, &wanted.params)?,
        Some(_) => Vec::new(),
    };
    let all = pending.iter().map(drive::Pending::change);
    let all = all.chain(of_block.iter().map(block::Pending::change));
    let mut done = Done {
        changes: changes(&old, &wanted.params),
        drives: all.collect(),
        identity: identity(&wanted.params),
        ..Done::default()
    };
    drive::check_periods(link, &wanted.drives, &old, &wanted.params)?;
    drive::check_setpoints(link, &wanted.drives, &old, &wanted.params)?;
    done.notes.extend(wanted.profiles.iter().map(|own| {
        let Both { en, zh } = own.profile.of_drive(own.drive);
        both!(
            "note: drive {en}: `leadscrew drives show` says which, and what is odd about it",
            "注意：驱动器 {zh}：`leadscrew drives show` 列出未核实项和特殊之处"
        )
    }));
    note_offsets(link, &mut done)?;
    if global.dry_run || done.changes.is_empty() && done.drives.is_empty() {
        return Ok(done);
    }
    link.attend()?;
    if let Some(password) = password {
        link.open_parameters(password)?;
    }
    let steps = pending.len() + usize::from(!done.changes.is_empty()) + of_block.len().min(1);
    let bar = progress(global, steps);
    // The write enable is taken where a whole set is not; no drive is touched where that is not.
    let switch = match done.changes[..] {
        [Change { entry, .. }] if entry.no == WRITE_ENABLE => Some(entry),
        _ => None,
    };
    if switch.is_none() || !pending.is_empty() {
        link.stage_over(&old, &wanted.params)?;
    }
    let alarmed = link.status()?.alarm.is_some();
    if !pending.is_empty() {
        done.notes
            .extend(drive::apply(link, &pending, &mut || bar.inc(1))?);
        if let Err(trouble) = link.wait_at_rest() {
            return Err(drive::only_drives(trouble.into()));
        }
    }
    let changed = match switch {
        _ if done.changes.is_empty() => Ok(()),
        Some(entry) => link.commit_value(entry, &wanted.params),
        None => link.commit(&wanted.params),
    };
    if let Err(trouble) = changed {
        return Err(drive::with_drives(link, &pending, trouble, !alarmed));
    }
    bar.inc(1);
    if !of_block.is_empty() {
        done.notes.extend(block::apply(link, &of_block)?);
        bar.inc(1);
    }
    // The board has noticed that the drives were silent; there may be an alarm of its own that nobody has seen.
    if done.changes.is_empty() && !alarmed {
        let reset = link.order(Order::Reset);
        reset.map_err(|trouble| drive::only_drives(trouble.into()))?;
    }
    bar.finish_and_clear();
    machine.params.clone_from(&wanted.params);
    Ok(done)
}

/// Says where a change of old offsets has no effect: the board has a table of its own.
fn note_offsets(link: &mut Link, done: &mut Done) -> Outcome {
    let old = |change: &Change| matches!(change.entry.no, 1221..=1226 | 9101..=9132 | 9201..=9216 | 9301..=9316);
    if done.changes.iter().any(old) && link.offsets_revision()?.0 != 0 {
        done.notes.push(both!(
            "note: the board has a tool table, which counts; parameters 1221 to 1226, 9101 to 9132, 9201 to 9216 and 9301 to \
             9316 have no effect (`leadscrew tools`, `leadscrew offsets`)",
            "注意：控制板有刀具表，以刀具表为准；参数 1221 至 1226、9101 至 9132、9201 至 9216、9301 至 9316 不起作用（`leadscrew tools`、`leadscrew offsets`）"
        ));
    }
    Ok(())
}

/// A bar on a terminal, nothing elsewhere and beside a result for programs.
fn progress(global: &Global, steps: usize) -> ProgressBar {
    if global.json || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
    // The template is right: it is a constant.
    if let Ok(style) = ProgressStyle::with_template("{msg} [{bar:30}] {pos}/{len}") {
        bar.set_style(style);
    }
    bar.set_message(pick(global.lang(), "writing", "写入"));
    bar
}

/// Says what has changed, or would.
pub fn tell(global: &Global, done: &Done) -> Outcome {
    let lang = global.lang();
    for note in &done.notes {
        say(&format!("{}\n", note.get(lang)));
    }
    let same = done.changes.is_empty() && done.drives.is_empty() && !done.restored;
    if global.json {
        return output::json(|o| {
            o.flag("ok", true);
            o.flag("done", !global.dry_run && !same);
            o.text("parameters", &format!("{:08x}", done.identity));
            difference::fields(o, &done.changes, &done.drives);
        });
    }
    if same {
        return output::write(pick(lang, "nothing to change\n", "无需更改\n").as_bytes());
    }
    let mut text = difference::text(&done.changes, &done.drives, lang);
    let identity = done.identity;
    let end = ending(
        global,
        &both!("identity {identity:08x}", "标识 {identity:08x}"),
    );
    text.push_str(end.get(lang));
    output::write(text.as_bytes())
}
