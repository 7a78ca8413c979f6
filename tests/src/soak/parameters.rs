//! Parameters between two programs: sets that are taken, cut off or refused, write protection, and a password.

use leadscrew_core::board::State;
use leadscrew_core::bus::{Abort, BoardState, Object, SdoError};
use leadscrew_core::link::{ImageWriter, identity};
use leadscrew_core::params::Params;

use super::bench::Bench;
use super::shift::{LONGEST, Shift, changed};
use crate::params::set;

/// A set that comes into force at once.
const IMAGE: Object = Object::new(0x5010, 1);
/// A set that is put aside.
const STAGED: Object = Object::new(0x5010, 9);
/// What is put aside comes into force, by its identity.
const COMMIT: Object = Object::new(0x5010, 11);

/// Where the password is given.
const PASSWORD: Object = Object::new(0x5010, 6);

/// What a set that is not taken may be refused with; anything else is the wire.
const REFUSALS: [Abort; 4] = [
    Abort::Value,
    Abort::TooHigh,
    Abort::TooLow,
    Abort::Incompatible,
];

/// What a damaged image may be refused with: a bit that says how long a number is moves the end of the image.
const DAMAGE: [Abort; 6] = [
    Abort::Value,
    Abort::TooHigh,
    Abort::TooLow,
    Abort::Incompatible,
    Abort::Crc,
    Abort::Length,
];

/// 5010h:02: a set is being stored.
const STORING: u64 = 1;
/// 5010h:02: it is stored and in force.
const DONE: u64 = 2;

/// A parameter's own object.
fn parameter(number: u16) -> Object {
    Object::new(0x2000 + number, 0)
}

/// What was written is stored, or the power is gone.
fn stored(bench: &mut Bench, taken: Result<(), SdoError>) {
    let end = bench.now + LONGEST;
    while bench.sim.has_power() {
        assert!(bench.now < end, "a set is not stored");
        match bench.number(0x5010, 2) {
            Ok(STORING) => bench.tick(),
            Ok(state) => {
                assert_eq!((state, taken), (DONE, Ok(())), "a set that can work");
                return;
            }
            // Anything but the power that goes has been tried again.
            Err(error) => assert!(!bench.sim.has_power(), "{error:?}"),
        }
    }
}

/// A set is written as a whole: in one step, or put aside and committed, in turn.
fn write(bench: &mut Bench, params: &Params) -> Result<(), SdoError> {
    let mut image = [0; ImageWriter::BYTES as usize];
    ImageWriter::new(params).read(0, &mut image);
    if bench.counts.pushed.is_multiple_of(2) {
        return bench.write(IMAGE, &image, &REFUSALS);
    }
    bench.write(STAGED, &image, &REFUSALS)?;
    bench.write(COMMIT, &identity(params).to_le_bytes(), &REFUSALS)
}

/// The machine is ready again with another set.
fn in_force(bench: &mut Bench, params: Params) {
    bench.params = params;
    bench.counts.pushed += 1;
    bench.until("the drives", LONGEST, |bench| {
        bench.state() == State::Idle && bench.says(BoardState::Idle)
    });
}

/// One parameter is changed; nothing else happens meanwhile.
fn change(bench: &mut Bench, number: u16, key: &str, value: u32, bytes: usize) {
    let mut params = bench.params.clone();
    set(&mut params, key, i64::from(value));
    let data = value.to_le_bytes();
    let taken = bench.write(parameter(number), &data[..bytes], &REFUSALS);
    stored(bench, taken);
    in_force(bench, params);
}

/// Nothing is taken.
fn is_shut(bench: &mut Bench) {
    bench.counts.refused += 1;
    let outcome = bench.write(parameter(9007), &[7], &[Abort::LocalControl]);
    let shut = Err(SdoError::Refused(Abort::LocalControl.code()));
    assert_eq!(outcome, shut, "a board that is shut");
    let theirs = bench.number(0x1020, 1).expect("the identity");
    assert_eq!(theirs, u64::from(identity(&bench.params)));
}

impl Shift {
    /// Writing is switched off and on again, or a password is set, given after the power was off, and taken away.
    pub(super) fn locked(&mut self) {
        let bench = &mut self.bench;
        bench.stands(20);
        if bench.random.chance(50) {
            change(bench, 9026, "9026.0", 0, 1);
            is_shut(bench);
            change(bench, 9026, "9026.0", 1, 1);
            return;
        }
        let password = bench.random.within(2, 1 << 31) as u32;
        change(bench, 9028, "9028", password, 4);
        bench.sim.cut_power();
        self.power_up();
        let bench = &mut self.bench;
        is_shut(bench);
        let given = bench.write(PASSWORD, &password.to_le_bytes(), &[]);
        assert_eq!(given, Ok(()), "the password");
        change(bench, 9028, "9028", 0, 4);
    }

    /// Another parameter set comes into force, unless the power goes while it is
    /// being stored: then it is the old one or the new one.
    pub(super) fn push(&mut self) {
        let bench = &mut self.bench;
        bench.stands(20);
        let params = changed(&mut bench.random, &bench.params);
        let stood = bench.position();
        let cut = bench.random.chance(30);
        if cut {
            let bytes = bench.random.within(0, 5_000);
            bench.sim.flash_mut().cut_after(bytes as u32);
        }
        bench.watch.set_params(&params);
        let taken = write(bench, &params);
        stored(bench, taken);
        if !bench.sim.has_power() {
            self.old_or_new(params);
            return;
        }
        bench.sim.flash_mut().power(true);
        in_force(bench, params);
        bench.keeps(stood);
    }

    /// The power went while a set was being stored.
    fn old_or_new(&mut self, new: Params) {
        self.power_up();
        let bench = &mut self.bench;
        let theirs = bench.number(0x1020, 1).expect("the identity");
        if theirs == u64::from(identity(&new)) {
            bench.params = new;
            bench.counts.pushed += 1;
        }
        // `compare` says whether it is the old one where it is not the new one.
        bench.watch.set_params(&bench.params);
    }

    /// A damaged image, or a value out of its range.
    pub(super) fn refused(&mut self) {
        let bench = &mut self.bench;
        bench.counts.refused += 1;
        let outcome = if bench.random.chance(50) {
            let params = changed(&mut bench.random, &bench.params);
            let mut image = [0; ImageWriter::BYTES as usize];
            ImageWriter::new(&params).read(0, &mut image);
            let place = bench.random.within(0, image.len() as i64 - 1) as usize;
            image[place] ^= 1 << bench.random.within(0, 7);
            bench.write(IMAGE, &image, &DAMAGE)
        } else {
            let tolerance = Object::new(0x2000 + 9007, 0);
            let value = bench.random.of(&[0_u8, 51, 200, 255]);
            bench.write(tolerance, &[value], &REFUSALS)
        };
        assert!(
            matches!(outcome, Err(SdoError::Refused(_))),
            "taken: {outcome:?}"
        );
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_board_sim::Sim;
    use leadscrew_board_sim::plant::PlantOptions;
    use leadscrew_core::link::{ImageError, ImageReader};

    use super::super::bench::Wire;
    use super::super::script::Draws;
    use super::*;

    /// Of each kind of damage that one bit does, the first place.
    #[test]
    fn an_image_with_a_wrong_bit_is_refused_at_once_whatever_the_bit_says() {
        let (params, options) = (Params::sheets(), PlantOptions::default());
        let sim = Sim::new(&params, &options).expect("the machine starts");
        let mut bench = Bench::new(
            Draws::live(1),
            sim,
            params.clone(),
            options,
            Wire::default(),
        );
        bench.until("the node", 100, |bench| bench.says(BoardState::Idle));
        let mut whole = [0; ImageWriter::BYTES as usize];
        ImageWriter::new(&params).read(0, &mut whole);
        let mut seen: [Option<Abort>; 4] = [None; 4];
        for bit in 0..whole.len() * 8 {
            let mut image = whole;
            image[bit / 8] ^= 1 << (bit % 8);
            let mut reader = ImageReader::new();
            let mut draft = params.clone();
            let read = reader
                .take(&image, &mut draft)
                .and_then(|()| reader.finish(&draft));
            let (kind, abort) = match read.expect_err("a wrong bit") {
                ImageError::Table(_) => (0, Abort::Incompatible),
                ImageError::Length => (1, Abort::Length),
                ImageError::Checksum => (2, Abort::Crc),
                ImageError::Range(_) => (3, Abort::Value),
            };
            if seen[kind].replace(abort).is_none() {
                let refused = Err(SdoError::Refused(abort.code()));
                assert_eq!(bench.write(IMAGE, &image, &DAMAGE), refused, "bit {bit}");
            }
        }
        assert!(seen[1].is_some(), "no bit moves the end: {seen:?}");
    }
}
