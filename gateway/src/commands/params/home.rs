//! Where the set that a command is about lives: on a board, or nowhere but in this program.

use leadscrew_can::Address;
use leadscrew_core::board::DriveNodes;
use leadscrew_core::params::Params;

use super::block;
use super::drive::{self, Found, Pending};
use crate::cli::Global;
use crate::commands::board::Machine;
use crate::failure::{Failure, Outcome};
use crate::params::difference::DriveChange;
use crate::params::drives::{PERIOD_EXPONENT, PERIOD_VALUE, Setting, Wanted, period_literal};
use crate::params::edit::{Replacement, replaced};
use crate::words::{Both, both};

/// The home of a set.
pub enum Home {
    /// The built-in machine's.
    BuiltIn(Box<Params>),
    /// A board's.
    Board(Box<Machine>),
}

impl Home {
    /// Of the set that the options name.
    ///
    /// # Errors
    /// No bus, no board, another version.
    pub fn open(global: &Global) -> Outcome<Self> {
        if global.bus == Address::Sim && global.state.is_none() {
            return Ok(Self::BuiltIn(Box::default()));
        }
        Ok(Self::Board(Box::new(Machine::meet(global)?)))
    }

    /// The set in force.
    pub fn params(&self) -> &Params {
        match self {
            Self::BuiltIn(params) => params,
            Self::Board(machine) => &machine.params,
        }
    }

    /// Whose it is.
    pub fn name(&self) -> Both {
        match self {
            Self::BuiltIn(_) => both!("the built-in machine", "内置机床"),
            Self::Board(machine) => both!(
                "node {node} on {bus}",
                "{bus} 上节点 {node} ",
                node = machine.link.node().get(),
                bus = machine.link.bus()
            ),
        }
    }

    /// What differs on the drives and on the block that the `wanted` set names, and why nothing is known of the block where
    /// that is so; nothing is known of either where there is no board.
    ///
    /// # Errors
    /// A drive that does not answer, or does not have an object.
    pub fn drive_changes(
        &mut self,
        settings: &[Setting],
        wanted: &Params,
    ) -> Outcome<(Vec<DriveChange>, Option<Failure>)> {
        match self {
            Self::BuiltIn(_) => Ok((Vec::new(), None)),
            Self::Board(machine) => {
                let nodes = DriveNodes::of(wanted);
                let pending = drive::pending(&mut machine.link, settings, &nodes)?;
                let mut changes: Vec<_> = pending.iter().map(drive::Pending::change).collect();
                let unknown = match block::pending(&mut machine.link, wanted) {
                    Ok(pending) => {
                        changes.extend(pending.iter().map(block::Pending::change));
                        None
                    }
                    Err(failure) => Some(failure),
                };
                Ok((changes, unknown))
            }
        }
    }

    /// The text of a file with what the drives say in its drive sections.
    ///
    /// # Errors
    /// As [`drive_changes`](Self::drive_changes).
    pub fn drives_into(&mut self, text: String, settings: &[Setting]) -> Outcome<String> {
        let Self::Board(machine) = self else {
            return Ok(text);
        };
        let nodes = DriveNodes::of(&machine.params);
        let pending = drive::pending(&mut machine.link, settings, &nodes)?;
        let found = |setting: &Setting| {
            let of = pending
                .iter()
                .find(|p| p.drive.name == setting.drive && p.wanted == setting.wanted);
            of.map(|pending| pending.found.clone())
        };
        let mut replacements: Vec<Replacement> = Vec::new();
        for setting in settings {
            let Some(found) = found(setting) else {
                continue;
            };
            if setting.by_profile {
                replacements.push(own_line(&text, setting, &found)?);
                continue;
            }
            let number_of = |object| {
                let other = settings.iter().find(|other| {
                    other.drive == setting.drive
                        && other.span == setting.span
                        && other.wanted.object() == object
                })?;
                match (
                    pending
                        .iter()
                        .find(|p| p.drive.name == other.drive && p.wanted == other.wanted),
                    &other.wanted,
                ) {
                    (
                        Some(Pending {
                            found: Found::Number(number),
                            ..
                        }),
                        _,
                    )
                    | (None, Wanted::Number { value: number, .. }) => Some(*number),
                    _ => None,
                }
            };
            let period = match (number_of(PERIOD_VALUE), number_of(PERIOD_EXPONENT)) {
                (Some(value), Some(exponent)) => Some((value, exponent)),
                _ => None,
            };
            let by = match (&found, period) {
                (Found::Number(_), Some((value, exponent))) => period_literal(value, exponent)
                    .ok_or_else(|| {
                        Failure::WrongBecause(both!(
                            "drive {drive} interpolates over {value} × 10^{exponent} s, which is no whole microsecond: write \
                             60C2.1 and 60C2.2 by themselves instead of `interpolation_period`",
                            "驱动器 {drive} 的插补周期为 {value} × 10^{exponent} s，不是整微秒：请分别写 60C2.1 和 60C2.2，而不要写 \
                             `interpolation_period`",
                            drive = setting.drive
                        ))
                    })?,
                _ => found.literal(),
            };
            let replacement = Replacement {
                span: setting.span.clone(),
                by,
            };
            if !replacements.contains(&replacement) {
                replacements.push(replacement);
            }
        }
        Ok(replaced(&text, replacements))
    }
}

/// A line of its own for what a drive has otherwise than its profile says, before the line that names the profile.
fn own_line(text: &str, setting: &Setting, found: &Found) -> Outcome<Replacement> {
    let begin = text[..setting.span.start]
        .rfind('\n')
        .map_or(0, |end| end + 1);
    let key = setting.key();
    if !text[begin..].trim_start().starts_with("profile") {
        return Err(Failure::WrongBecause(both!(
            "drive {drive} has another `{key}` than its profile says, and there is no line for it: write `profile` at the \
             beginning of a line under `[drive.{drive}]`",
            "驱动器 {drive} 的 `{key}` 与其配置文件不同，但没有可写入的行：请在 `[drive.{drive}]` 下将 `profile` 写在行首",
            drive = setting.drive
        )));
    }
    let value = found.literal();
    Ok(Replacement {
        span: begin..begin,
        by: format!("{key} = {value}\n"),
    })
}
