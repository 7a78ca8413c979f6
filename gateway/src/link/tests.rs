//! Against a board inside this process.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use leadscrew_board_sim::plant::{Flash, PlantOptions};
use leadscrew_board_sim::{Sim, stored_params};
use leadscrew_can::{Can, CanError, Filter, Received};
use leadscrew_core::alarm::Code;
use leadscrew_core::board::Found;
use leadscrew_core::bus::{Frame, NodeId, Order};
use leadscrew_core::link::{ImageWriter, identity};
use leadscrew_core::params::{Entry, Params};

use super::{Inside, Link, Trouble};

fn set(values: &[(&str, i64)]) -> Params {
    let mut params = Params::slant_bed();
    for (key, raw) in values {
        params.set(Entry::find_text(key).unwrap(), *raw).unwrap();
    }
    params
}

fn machine(flash: Flash) -> Inside {
    let options = PlantOptions::default();
    let mut sim = Sim::power_up(&Params::slant_bed(), &options, flash)
        .map(Box::new)
        .unwrap();
    sim.join(NodeId::BOARD).unwrap();
    let tick_us = sim.tick_us();
    Inside::new(sim, tick_us)
}

fn link(inside: &Inside) -> Link {
    Link::on(Box::new(inside.clone()), NodeId::BOARD)
}

/// A flash in which this set is stored.
fn flash_with(params: &Params) -> Flash {
    let inside = machine(Flash::erased());
    link(&inside).commit(params).unwrap();
    inside.sim().flash().clone()
}

fn stored(inside: &Inside) -> (Found, Params) {
    let mut flash = inside.sim().flash().clone();
    flash.power(true);
    let up = stored_params(&mut flash, &Params::slant_bed()).unwrap();
    (up.found, up.params)
}

/// An end of the bus that is pulled out after so many frames.
struct Cut {
    inside: Inside,
    left: Arc<AtomicUsize>,
}

impl Can for Cut {
    fn name(&self) -> &str {
        "cut"
    }

    fn send(&mut self, frames: &[Frame]) -> Result<(), CanError> {
        for frame in frames {
            if self.left.load(Ordering::Relaxed) == 0 {
                return Err(CanError::Closed { name: "cut".into() });
            }
            self.left.fetch_sub(1, Ordering::Relaxed);
            self.inside.send(&[*frame])?;
        }
        Ok(())
    }

    fn receive(&mut self, into: &mut Vec<Received>, patience: Duration) -> Result<usize, CanError> {
        self.inside.receive(into, patience)
    }

    fn listen_for(&mut self, filters: &[Filter]) -> Result<(), CanError> {
        self.inside.listen_for(filters)
    }

    fn dropped(&self) -> Result<u64, CanError> {
        Ok(0)
    }
}

#[test]
fn a_push_that_ends_at_any_frame_leaves_the_old_set_or_the_new_one() {
    let old = set(&[("9007", 12), ("1420.X", 11_000_000_000)]);
    let new = set(&[
        ("9007", 13),
        ("1420.Z", 15_000_000_000),
        ("9101.X", 500_000),
    ]);
    let flash = flash_with(&old);
    let (mut olds, mut news) = (0, 0);
    for frames in 0.. {
        let inside = machine(flash.clone());
        let left = Arc::new(AtomicUsize::new(frames));
        let cut = Cut {
            inside: inside.clone(),
            left: left.clone(),
        };
        let sent = Link::on(Box::new(cut), NodeId::BOARD).commit(&new);
        let complete = sent.is_ok();
        // What is under way ends, and somebody else comes.
        let mut other = link(&inside);
        // In the middle of a block the board takes a request for a piece of it: it is asked again then.
        other.set_patience(Duration::from_millis(20));
        let in_force = other.parameters().unwrap();
        let (found, kept) = stored(&inside);
        assert_eq!(found, Found::Newest, "after {frames} frames");
        assert_eq!(in_force.params, kept, "after {frames} frames");
        if kept == new {
            news += 1;
        } else {
            assert_eq!(kept, old, "after {frames} frames");
            assert_eq!(news, 0, "once it is taken, more frames change nothing");
            assert!(!complete);
            olds += 1;
        }
        if complete {
            break;
        }
        // The next push works.
        if frames % 50 == 0 {
            other.commit(&new).unwrap();
            assert_eq!(stored(&inside).1, new);
        }
    }
    // Seven bytes a frame, and the beginning and the end of the transfer come with them.
    let segments = ImageWriter::BYTES.div_ceil(7);
    assert!(olds >= segments, "{olds} of {segments}");
    assert!(news > 1, "{news}");
}

#[track_caller]
fn refused(written: super::LinkResult, expected: Code) {
    match written {
        Err(Trouble::Parameters { reason, .. }) => {
            assert_eq!(reason.map(|alarm| alarm.code), Some(expected));
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_board_says_why_it_does_not_take_a_set() {
    let protected = set(&[("9026.0", 0)]);
    let inside = machine(flash_with(&protected));
    let mut link = link(&inside);
    let wanted = set(&[("9026.0", 0), ("9007", 13)]);
    refused(link.may_change(), Code::ParametersProtected);
    refused(link.commit(&wanted), Code::ParametersProtected);
    let open = set(&[("9026.0", 1)]);
    let entry = Entry::find_text("9026.0").unwrap();
    link.commit_value(entry, &open).unwrap();
    link.may_change().unwrap();
    link.commit(&wanted).unwrap();
    assert_eq!(stored(&inside), (Found::Newest, wanted));
    assert_eq!(link.last_good().unwrap(), Some(identity(&open)));
}

#[test]
fn a_password_opens_writing() {
    let password = Entry::find_text("parameter_password").unwrap();
    let mut secret = Params::slant_bed();
    secret.set(password, 4711).unwrap();
    let inside = machine(flash_with(&secret));
    let mut link = link(&inside);
    link.attend().unwrap();
    let mut wanted = link.parameters().unwrap().params;
    assert_eq!(wanted.get(password), 1, "it is not told");
    wanted.set(Entry::find_text("9007").unwrap(), 13).unwrap();
    refused(link.commit(&wanted), Code::PasswordMissing);
    refused(link.open_parameters(4712), Code::PasswordWrong);
    // The board hears nothing for a second.
    link.idle(Duration::from_millis(1100)).unwrap();
    link.open_parameters(4711).unwrap();
    link.commit(&wanted).unwrap();
    let (_, kept) = stored(&inside);
    assert_eq!(kept.get(password), 4711, "and stays");
    assert_eq!(
        kept.spindle_tolerance_percent(),
        wanted.spindle_tolerance_percent()
    );
}

#[test]
fn the_last_good_set_comes_back() {
    let first = set(&[("9007", 12)]);
    let second = set(&[("9007", 13)]);
    let inside = machine(flash_with(&first));
    let mut link = link(&inside);
    assert_eq!(link.last_good().unwrap(), None);
    link.commit(&second).unwrap();
    assert_eq!(link.last_good().unwrap(), Some(identity(&first)));
    link.recall().unwrap();
    assert_eq!(link.parameters().unwrap().params, first);
    assert_eq!(stored(&inside), (Found::Newest, first));
    link.hear_status().unwrap();
    link.order(Order::Reset).unwrap();
}
