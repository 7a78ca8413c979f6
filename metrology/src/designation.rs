//! What a thread is called on a drawing: `M40x3-6g`, `M30x4P2-6H`, `1/4-20UNC-2A`, `1/2-14NPT`.

use crate::tables;
use crate::units::{Degrees, Mm, Side};

/// The family of a thread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Series {
    /// ISO 68-1, ISO 965: grade and letter of the pitch diameter, then of the crest.
    Metric {
        /// Of the pitch diameter.
        pitch: (u8, char),
        /// Of the major diameter of a bolt, the minor diameter of a nut.
        crest: (u8, char),
    },
    /// ASME B1.1: class 1 to 3, and the length of engagement that its limits are for.
    Unified {
        /// 1, 2 or 3.
        class: u8,
        /// Length of engagement.
        engagement: Mm,
    },
    /// ASME B1.20.1, a taper pipe thread; the plane L1 behind the face.
    Pipe {
        /// L1.
        plane: Mm,
    },
    /// No norm: there are no limits.
    Free,
}

/// A thread by its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Designation {
    /// As written.
    pub text: String,
    /// Bolt or nut.
    pub side: Side,
    /// Nominal major diameter; of a pipe thread, at its plane L1.
    pub major: Mm,
    /// Distance of neighbouring grooves.
    pub pitch: Mm,
    /// Starts.
    pub starts: u8,
    /// Angle between the flanks.
    pub angle: Degrees,
    /// Change of the radius per millimetre of Z; the thread grows away from the face where it is negative.
    pub taper: f64,
    /// What the limits are taken from.
    pub series: Series,
}

/// Why a name says nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotKnown {
    /// No form of name that is known.
    Form,
    /// A size without a pitch, whose coarse pitch is not in the table.
    Pitch,
    /// No tolerance class, or none that is known.
    Class,
    /// The class of a nut on a bolt, or of a bolt on a nut.
    Side,
    /// A pipe size that the table does not have.
    Size,
}

impl Designation {
    /// Reads a name. `side` is the surface that the thread was cut on.
    ///
    /// # Errors
    /// The name says nothing, or it names the other side.
    pub fn read(text: &str, side: Side) -> Result<Self, NotKnown> {
        let plain = without_blanks(text);
        let name = plain.as_str();
        let mut read = if let Some(rest) = name.strip_prefix('M') {
            metric(rest, side)
        } else if let Some(size) = name.strip_suffix("NPT") {
            pipe(size, side)
        } else {
            unified(name, side)
        }?;
        text.trim().clone_into(&mut read.text);
        Ok(read)
    }

    /// A thread without a norm.
    #[must_use]
    pub fn free(side: Side, major: Mm, pitch: Mm, starts: u8, angle: Degrees, taper: f64) -> Self {
        Self {
            text: String::new(),
            side,
            major,
            pitch,
            starts,
            angle,
            taper,
            series: Series::Free,
        }
    }

    /// Travel per turn.
    #[must_use]
    pub fn lead(&self) -> Mm {
        self.pitch * f64::from(self.starts)
    }

    /// Height of the sharp triangle.
    #[must_use]
    pub fn triangle(&self) -> Mm {
        Mm(self.pitch.0 / (2.0 * (self.angle.0.to_radians() / 2.0).tan()))
    }

    /// Radius of the tool's tip by the norm: that of the root of the basic profile.
    #[must_use]
    pub fn tip(&self) -> Mm {
        match (self.series, self.side) {
            // A tip of 60° ends its radius before the sharp corner: the least truncation, of both sides.
            (Series::Pipe { .. }, _) => self.pitch * 0.033,
            (_, Side::External) => Mm(self.triangle().0 / 6.0),
            (_, Side::Internal) => Mm(self.triangle().0 / 12.0),
        }
    }

    /// The basic pitch diameter.
    #[must_use]
    pub fn pitch_diameter(&self) -> Mm {
        match self.series {
            // Major and pitch line are h = 0.8 p apart, less the truncation at both sides alike.
            Series::Pipe { .. } => self.major - self.pitch * 0.8,
            _ => self.major - self.triangle() * 0.75,
        }
    }

    /// The basic minor diameter.
    #[must_use]
    pub fn minor(&self) -> Mm {
        match self.series {
            Series::Pipe { .. } => self.major - self.pitch * 1.6,
            _ => self.major - self.triangle() * 1.25,
        }
    }

    /// Length that a gauge has, or the counterpart.
    #[must_use]
    pub fn engagement(&self) -> Mm {
        match self.series {
            Series::Unified { engagement, .. } => engagement,
            Series::Pipe { plane } => plane,
            _ => self.major * 0.8,
        }
    }
}

/// A name without its blanks; one between digits is the hyphen of `1 1/4`.
fn without_blanks(text: &str) -> String {
    let mut plain = String::new();
    let mut words = text.split_whitespace();
    plain.extend(words.next());
    for word in words {
        let digit = |sign: Option<char>| sign.is_some_and(|sign| sign.is_ascii_digit());
        if digit(plain.chars().last()) && digit(word.chars().next()) {
            plain.push('-');
        }
        plain.push_str(word);
    }
    plain
}

fn number(text: &str) -> Option<f64> {
    let plain = !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let value = text.parse().ok().filter(|_| plain);
    value.filter(|v: &f64| *v > 0.0 && *v < 2000.0)
}

/// A fraction, a whole number, both (`1-1/4`), a decimal, or a screw number (`#10`); inches.
fn inches(text: &str) -> Option<f64> {
    if let Some(screw) = text.strip_prefix('#') {
        let screw = screw.parse::<u8>().ok();
        return screw.map(|n| 0.06 + 0.013 * f64::from(n));
    }
    if let Some((whole, part)) = text.split_once('-') {
        return Some(number(whole)? + inches(part)?);
    }
    match text.split_once('/') {
        Some((above, below)) => Some(number(above)? / number(below)?),
        None => number(text),
    }
}

/// `6g`, and what comes after it.
fn grade(text: &str) -> Option<((u8, char), &str)> {
    let mut signs = text.chars();
    let digit = signs.next()?.to_digit(10).filter(|d| (3..=9).contains(d))?;
    let letter = signs.next().filter(|c| "efghGH".contains(*c))?;
    Some(((digit as u8, letter), signs.as_str()))
}

fn metric(rest: &str, side: Side) -> Result<Designation, NotKnown> {
    let (size, class) = rest.split_once('-').ok_or(NotKnown::Class)?;
    let (size, way) = size
        .split_once(['x', 'X', '×'])
        .map_or((size, None), |(d, p)| (d, Some(p)));
    let major = number(size).ok_or(NotKnown::Form)?;
    let (pitch, starts) = match way {
        None => {
            let known = tables::COARSE.iter().find(|(d, _)| *d == major);
            (known.ok_or(NotKnown::Pitch)?.1, 1)
        }
        Some(way) => match way.trim_start_matches("Ph").split_once('P') {
            None => (number(way).ok_or(NotKnown::Form)?, 1),
            Some((lead, pitch)) => {
                let both = number(lead).zip(number(pitch)).ok_or(NotKnown::Form)?;
                let starts = (both.0 / both.1).round();
                if !(1.0..=99.0).contains(&starts) || (starts * both.1 - both.0).abs() > 1e-9 {
                    return Err(NotKnown::Form);
                }
                (both.1, starts as u8)
            }
        },
    };
    let (pitch_class, rest) = grade(class).ok_or(NotKnown::Class)?;
    let (crest, rest) = if rest.is_empty() {
        (pitch_class, rest)
    } else {
        grade(rest).ok_or(NotKnown::Class)?
    };
    if !rest.is_empty() || crest.1 != pitch_class.1 {
        return Err(NotKnown::Class);
    }
    if pitch_class.1.is_ascii_uppercase() != (side == Side::Internal) {
        return Err(NotKnown::Side);
    }
    Ok(Designation {
        series: Series::Metric {
            pitch: pitch_class,
            crest,
        },
        ..Designation::free(side, Mm(major), Mm(pitch), starts, Degrees(60.0), 0.0)
    })
}

fn unified(name: &str, side: Side) -> Result<Designation, NotKnown> {
    let (rest, class) = name.rsplit_once('-').ok_or(NotKnown::Form)?;
    let (size, threads) = rest.rsplit_once('-').ok_or(NotKnown::Form)?;
    let at = threads.find("UN").ok_or(NotKnown::Form)?;
    let (count, family) = threads.split_at(at);
    if !matches!(family, "UN" | "UNC" | "UNF" | "UNEF" | "UNS") {
        return Err(NotKnown::Form);
    }
    let major = inches(size).ok_or(NotKnown::Form)?;
    let pitch = 1.0 / number(count).ok_or(NotKnown::Form)?;
    let (class, letter) = match class.as_bytes() {
        [class @ b'1'..=b'3', letter @ (b'A' | b'B')] => (class - b'0', *letter),
        _ => return Err(NotKnown::Class),
    };
    if (letter == b'B') != (side == Side::Internal) {
        return Err(NotKnown::Side);
    }
    let engagement = if matches!(family, "UNC" | "UNF") {
        major
    } else {
        9.0 * pitch
    };
    Ok(Designation {
        series: Series::Unified {
            class,
            engagement: Mm::from_inch(engagement),
        },
        ..Designation::free(
            side,
            Mm::from_inch(major),
            Mm::from_inch(pitch),
            1,
            Degrees(60.0),
            0.0,
        )
    })
}

fn pipe(name: &str, side: Side) -> Result<Designation, NotKnown> {
    let (size, count) = name
        .trim_end_matches('-')
        .rsplit_once('-')
        .ok_or(NotKnown::Form)?;
    let known = tables::NPT.iter().find(|row| row.0 == size);
    let &(_, outside, threads, plane) = known.ok_or(NotKnown::Size)?;
    if number(count) != Some(threads) {
        return Err(NotKnown::Size);
    }
    let pitch = 1.0 / threads;
    // E0 at the small end, E1 at the plane L1.
    let e1 = outside - (0.05 * outside + 1.1) * pitch + plane / 16.0;
    Ok(Designation {
        series: Series::Pipe {
            plane: Mm::from_inch(plane),
        },
        ..Designation::free(
            side,
            Mm::from_inch(e1 + 0.8 * pitch),
            Mm::from_inch(pitch),
            1,
            Degrees(60.0),
            // A bolt grows away from its face, a nut shrinks.
            match side {
                Side::External => -1.0 / 32.0,
                Side::Internal => 1.0 / 32.0,
            },
        )
    })
}
