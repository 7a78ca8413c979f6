//! `--drive`: which profiles the axes have.

use std::convert::Infallible;
use std::str::FromStr;

use leadscrew_board_sim::plant::ServoOptions;
use leadscrew_core::alarm::Lang;
use leadscrew_core::bus::Mode;
use leadscrew_core::params::Params;
use leadscrew_core::units::Axis;

use super::{IDEAL, Profile};
use crate::failure::{Failure, Outcome};
use crate::words::{Both, both};

/// The axes that can have a profile.
const AXES: [Axis; 2] = [Axis::X, Axis::Z];

/// `NAME` or `X=NAME`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// `None` for all axes.
    axis: Option<String>,
    name: String,
}

impl FromStr for Choice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(match text.split_once('=') {
            Some((axis, name)) => Self {
                axis: Some(axis.trim().to_ascii_uppercase()),
                name: name.trim().to_owned(),
            },
            None => Self {
                axis: None,
                name: text.trim().to_owned(),
            },
        })
    }
}

/// The profiles of X and Z; `None` for ideal drives.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Chosen([Option<Profile>; 2]);

impl Chosen {
    /// What the options say. One for an axis counts more than one for all.
    ///
    /// # Errors
    /// No such drive or axis; an axis twice.
    pub fn of(choices: &[Choice], lang: Lang) -> Outcome<Self> {
        let mut chosen = Self::default();
        for all in [true, false] {
            let mut seen: Vec<Option<&str>> = Vec::new();
            for choice in choices.iter().filter(|choice| choice.axis.is_none() == all) {
                let axis = choice.axis.as_deref();
                if seen.contains(&axis) {
                    let axis = axis.unwrap_or("X, Z");
                    return Err(Failure::Usage(both!(
                        "`--drive` names a drive of {axis} twice",
                        "`--drive` 为 {axis} 指定了两次驱动器"
                    )));
                }
                seen.push(axis);
                let profile = match choice.name.as_str() {
                    IDEAL => None,
                    name => Some(Profile::find(name, lang)?),
                };
                chosen.put(axis, profile)?;
            }
        }
        Ok(chosen)
    }

    /// The profiles of X and Z.
    #[must_use]
    pub const fn axes(&self) -> &[Option<Profile>; 2] {
        &self.0
    }

    fn put(&mut self, axis: Option<&str>, profile: Option<Profile>) -> Outcome {
        let Some(axis) = axis else {
            self.0 = [profile.clone(), profile];
            return Ok(());
        };
        let place = AXES
            .iter()
            .position(|of| char::from(of.letter()).to_string() == axis);
        match place.and_then(|place| self.0.get_mut(place)) {
            Some(place) => {
                *place = profile;
                Ok(())
            }
            None => Err(Failure::Usage(both!(
                "`--drive {axis}=…`: X and Z have drives to choose; C and the spindles stay ideal",
                "`--drive {axis}=…`：只有 X 和 Z 可选择驱动器；C 轴和主轴保持理想"
            ))),
        }
    }

    /// The simulated drives, for a board with this set.
    ///
    /// # Errors
    /// A drive cannot be on the bus of such a board.
    pub fn servos(&self, params: &Params) -> Outcome<[Option<ServoOptions>; 2]> {
        let [x, z] = &self.0;
        let of = |profile: &Option<Profile>, axis| {
            let mode = Mode::of_setpoints(params.drive_mode(axis));
            let servo = profile
                .as_ref()
                .map(|profile| profile.servo(axis, mode, params.tick_us()));
            servo.transpose()
        };
        Ok([of(x, Axis::X)?, of(z, Axis::Z)?])
    }

    /// True where all drives are ideal ones.
    #[must_use]
    pub const fn is_ideal(&self) -> bool {
        matches!(self.0, [None, None])
    }

    /// The axes with their drives, for a person; empty where all are ideal.
    #[must_use]
    pub fn words(&self) -> Option<Both> {
        if self.is_ideal() {
            return None;
        }
        let all = AXES.iter().zip(&self.0).map(|(axis, profile)| {
            let axis = char::from(axis.letter());
            match profile {
                None => Both::same(format!("{axis} {IDEAL}")),
                Some(profile) => profile.of_drive(axis),
            }
        });
        let all: Vec<Both> = all.collect();
        let join = |of: fn(&Both) -> &String, with: &str| {
            all.iter().map(of).cloned().collect::<Vec<_>>().join(with)
        };
        Some(Both {
            en: join(|both| &both.en, ", "),
            zh: join(|both| &both.zh, "，"),
        })
    }
}
