//! `handwheel`: a simulated handwheel on the bus. It leads an axis, or a program along its path.
//!
//! As a real one it claims what it leads, tells where it is turned to, and has nothing to stop: where its frames stay away,
//! the board leads nothing any more.

use std::time::{Duration, Instant};

use leadscrew_core::bus::WheelRequest;
use leadscrew_core::operating::{Led, OperatingMode, PressState};

use super::by_hand::{ANSWER, End, RENEWAL, own, refusal, tell};
use super::heard;
use crate::cli::{Global, Handwheel};
use crate::failure::Outcome;
use crate::interrupt;
use crate::link::Link;
use crate::output;
use crate::words::both;

/// A program goes on for no longer than this behind the last count: the mean over 50 ms.
const PATH_ENDS: Duration = Duration::from_millis(400);
/// An axis that has gone nowhere for so long has made its counts.
const STANDS: Duration = Duration::from_millis(150);

/// Turns it.
pub fn handwheel(global: &Global, wheel: &Handwheel) -> Outcome {
    let mut link = heard(global)?;
    let leads = wheel.axis.led();
    if leads != Led::Path {
        link.set_mode(OperatingMode::Wheel)?;
    }
    let (session, claim) = own(&link);
    let mut claim = Claim {
        session,
        number: claim,
        wheel,
        turned: 0,
    };
    let end = claim.carry_out(&mut link)?;
    if leads != Led::Path {
        return tell(global, &mut link, end);
    }
    tell_turned(global, &link, claim.turned)
}

/// One claim of the wheel.
struct Claim<'a> {
    session: u8,
    number: u8,
    wheel: &'a Handwheel,
    /// How far it is turned.
    turned: i32,
}

impl Claim<'_> {
    /// The frame with the newest beat.
    fn send(&self, link: &mut Link) -> Outcome {
        let request = WheelRequest {
            session: self.session,
            leads: self.wheel.axis.led(),
            factor: self.wheel.factor.factor(),
            claim: self.number,
            // It wraps, as that of a wheel does.
            count: self.turned as u16,
            echo: link.beat()?,
        };
        Ok(link.send(&[request.frame(link.node())])?)
    }

    /// What became of it, once the board has it.
    fn state(&self, link: &Link) -> Option<PressState> {
        let told = link.seen.beat?;
        (told.session == self.session && told.press == self.number).then_some(told.state)
    }

    /// Sends it once; true where the board lets it lead.
    fn leads(&self, link: &mut Link) -> Outcome<Option<bool>> {
        self.send(link)?;
        link.idle(RENEWAL)?;
        link.check_alive()?;
        match self.state(link) {
            Some(PressState::Refused) => Err(refusal(link)),
            Some(PressState::Runs) => Ok(Some(true)),
            Some(_) => Ok(Some(false)),
            None => Ok(None),
        }
    }

    /// Claims, turns, and waits until what follows has made the counts.
    fn carry_out(&mut self, link: &mut Link) -> Outcome<End> {
        let begun = Instant::now();
        loop {
            match self.leads(link)? {
                Some(true) => break,
                Some(false) => return Ok(End::Broken),
                None if begun.elapsed() < ANSWER => {}
                None => return Err(refusal(link)),
            }
        }
        let begun = Instant::now();
        while self.turned != self.wheel.counts && !interrupt::requested() {
            let by_now = begun.elapsed().as_millis() * u128::from(self.wheel.rate) / 1000;
            let by_now = i32::try_from(by_now).unwrap_or(i32::MAX);
            self.turned = self.wheel.counts.signum() * by_now.min(self.wheel.counts.abs());
            if self.leads(link)? != Some(true) {
                return Ok(End::Broken);
            }
        }
        self.run_out(link)
    }

    /// The wheel stands, and its claim is still alive.
    fn run_out(&self, link: &mut Link) -> Outcome<End> {
        let begun = Instant::now();
        let mut stood = (link.status()?.position, Instant::now());
        loop {
            if self.leads(link)? != Some(true) {
                return Ok(End::Broken);
            }
            if self.wheel.axis.led() == Led::Path {
                if begun.elapsed() >= PATH_ENDS {
                    return Ok(End::Done);
                }
                continue;
            }
            let at = link.status()?.position;
            if at != stood.0 {
                stood = (at, Instant::now());
            } else if stood.1.elapsed() >= STANDS {
                return Ok(End::Done);
            }
        }
    }
}

/// How far it was turned.
fn tell_turned(global: &Global, link: &Link, counts: i32) -> Outcome {
    let node = link.node().get();
    if global.json {
        return output::json(|json| {
            json.flag("ok", true);
            json.integer("node", i64::from(node));
            json.integer("counts", i64::from(counts));
        });
    }
    let text = both!(
        "node {node}: the wheel was turned by {counts} counts\n",
        "节点 {node}：手轮转动了 {counts} 个脉冲\n"
    );
    output::write(text.get(global.lang()).as_bytes())
}
