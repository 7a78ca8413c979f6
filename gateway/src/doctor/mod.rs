//! `doctor`: what is set up wrong on a bus, and which of it is the first cause.
//!
//! ```text
//! frames with times ─ heard ─► facts ─ rules ─► findings, in the order of the rules
//!                        ▲
//!   machine: what should be there      ask: objects read over a live bus, by frames that are heard like all others
//! ```
//!
//! Knows no files and no sockets but in [`ask`]; time comes with the frames. What a live bus is asked is read only.

pub mod ask;
pub mod heard;
pub mod hits;
pub mod machine;
pub mod mend;
pub mod page;
pub mod rules;
#[cfg(test)]
mod tests;

use leadscrew_can::{Packet, Stamp};

use self::heard::Heard;
use self::machine::Machine;
use self::rules::{Found, Group, Lack, Rule, Verdict};

/// Frames in, findings out.
#[derive(Clone, Debug)]
pub struct Doctor {
    heard: Heard,
}

/// What a rule has found.
#[derive(Debug)]
pub struct Finding {
    /// The rule.
    pub rule: &'static Rule,
    /// Where, and what shows it.
    pub found: Found,
}

/// The result.
#[derive(Debug)]
pub struct Report {
    /// In the order of the rules: the first is the first cause.
    pub findings: Vec<Finding>,
    /// Rules that could not be judged, and why.
    pub not_judged: Vec<(&'static Rule, Lack)>,
    /// What was heard.
    pub heard: Heard,
}

impl Doctor {
    /// Of this machine nothing was heard yet.
    #[must_use]
    pub fn new(machine: Machine) -> Self {
        Self {
            heard: Heard::new(machine),
        }
    }

    /// A packet.
    pub fn push(&mut self, at: Stamp, packet: &Packet) {
        self.heard.push(at, packet);
    }

    /// It was listened until then.
    pub fn until(&mut self, at: Stamp) {
        self.heard.until(at);
    }

    /// Asks all rules.
    #[must_use]
    pub fn report(mut self) -> Report {
        self.heard.close();
        let mut findings: Vec<Finding> = Vec::new();
        let mut not_judged = Vec::new();
        let explained = |findings: &[Finding], number: u8, by: &[u8]| {
            by.iter()
                .filter(|other| **other < number)
                .any(|other| findings.iter().any(|finding| finding.rule.number == *other))
        };
        for rule in rules::all() {
            if rule.group == Group::Drive
                && findings
                    .iter()
                    .any(|finding| finding.rule.group != Group::Drive)
            {
                not_judged.push((rule, Lack::Earlier));
                continue;
            }
            let by: &[u8] = match rule.number {
                4 => &[1, 2, 3],
                13 => &[12],
                28 => &[27],
                _ => &[],
            };
            match (rule.judge)(&self.heard) {
                Verdict::Clean => {}
                Verdict::Found(_) if explained(&findings, rule.number, by) => {}
                Verdict::Not(lack) => not_judged.push((rule, lack)),
                Verdict::Found(all) => {
                    findings.extend(all.into_iter().map(|found| Finding { rule, found }));
                }
            }
        }
        Report {
            findings,
            not_judged,
            heard: self.heard,
        }
    }
}
