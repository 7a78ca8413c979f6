//! The name of a thread that nobody has named, by its pitch, its angle and its crest or root.

use leadscrew_metrology::{Degrees, Designation, Mm, Side};

/// What the program says of a thread.
#[derive(Clone, Copy, Debug)]
pub struct Traits {
    /// Bolt or nut.
    pub side: Side,
    /// Distance of neighbouring grooves.
    pub pitch: Mm,
    /// Starts.
    pub starts: u8,
    /// Angle between the flanks.
    pub angle: Degrees,
    /// Change of the radius per millimetre of Z.
    pub taper: f64,
    /// Its lead is the same all along.
    pub is_constant: bool,
    /// Diameter of the uncut surface, where the program says it.
    pub crest: Option<Mm>,
    /// Diameter that the last pass leaves.
    pub root: Mm,
}

/// Pitches of ISO 261.
const METRIC: [f64; 22] = [
    0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.75, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5,
    4.0, 4.5, 5.0, 6.0,
];

/// Sizes of UNC by B1.1: threads per inch, size.
const UNC: [(f64, &str); 33] = [
    (64.0, "#1"),
    (56.0, "#2"),
    (48.0, "#3"),
    (40.0, "#4"),
    (40.0, "#5"),
    (32.0, "#6"),
    (32.0, "#8"),
    (24.0, "#10"),
    (24.0, "#12"),
    (20.0, "1/4"),
    (18.0, "5/16"),
    (16.0, "3/8"),
    (14.0, "7/16"),
    (13.0, "1/2"),
    (12.0, "9/16"),
    (11.0, "5/8"),
    (10.0, "3/4"),
    (9.0, "7/8"),
    (8.0, "1"),
    (7.0, "1-1/8"),
    (7.0, "1-1/4"),
    (6.0, "1-3/8"),
    (6.0, "1-1/2"),
    (5.0, "1-3/4"),
    (4.5, "2"),
    (4.5, "2-1/4"),
    (4.0, "2-1/2"),
    (4.0, "2-3/4"),
    (4.0, "3"),
    (4.0, "3-1/4"),
    (4.0, "3-1/2"),
    (4.0, "3-3/4"),
    (4.0, "4"),
];

/// Sizes of UNF.
const UNF: [(f64, &str); 24] = [
    (80.0, "#0"),
    (72.0, "#1"),
    (64.0, "#2"),
    (56.0, "#3"),
    (48.0, "#4"),
    (44.0, "#5"),
    (40.0, "#6"),
    (36.0, "#8"),
    (32.0, "#10"),
    (28.0, "#12"),
    (28.0, "1/4"),
    (24.0, "5/16"),
    (24.0, "3/8"),
    (20.0, "7/16"),
    (20.0, "1/2"),
    (18.0, "9/16"),
    (18.0, "5/8"),
    (16.0, "3/4"),
    (14.0, "7/8"),
    (12.0, "1"),
    (12.0, "1-1/8"),
    (12.0, "1-1/4"),
    (12.0, "1-3/8"),
    (12.0, "1-1/2"),
];

/// The likely name. A thread of no norm that is known gets one that says nothing about limits.
pub fn guess(traits: &Traits) -> Designation {
    if traits.angle.0 != 60.0 || traits.taper != 0.0 || !traits.is_constant {
        return free(traits);
    }
    let name = metric(traits).or_else(|| unified(traits));
    let read = name.and_then(|name| Designation::read(&name, traits.side).ok());
    read.unwrap_or_else(|| free(traits))
}

/// A thread of no norm.
pub fn free(traits: &Traits) -> Designation {
    Designation::free(
        traits.side,
        major(traits),
        traits.pitch,
        traits.starts,
        traits.angle,
        traits.taper,
    )
}

/// The nominal diameter: of the crest, else as deep as the basic profile with its rounded root.
fn major(traits: &Traits) -> Mm {
    let height = traits.pitch.0 * 3f64.sqrt() / 2.0;
    match (traits.side, traits.crest) {
        (Side::External, Some(crest)) => crest,
        (Side::External, None) => traits.root + Mm(height * 17.0 / 12.0),
        (Side::Internal, Some(crest)) => crest + Mm(height * 1.25),
        (Side::Internal, None) => traits.root,
    }
}

/// The nearest multiple, where it is near.
fn near(value: f64, step: f64) -> Option<f64> {
    let nearest = (value / step).round() * step;
    (nearest > 0.0 && (nearest - value).abs() < 0.4 * step).then_some(nearest)
}

fn metric(traits: &Traits) -> Option<String> {
    let pitch = METRIC
        .iter()
        .find(|p| (**p - traits.pitch.0).abs() < 1e-6)?;
    // Small sizes lie closer.
    let d = near(major(traits).0, if *pitch < 1.0 { 0.5 } else { 1.0 })?;
    let class = match traits.side {
        Side::External => "6g",
        Side::Internal => "6H",
    };
    Some(match traits.starts {
        1 => format!("M{d}x{pitch}-{class}"),
        starts => format!(
            "M{d}x{lead}P{pitch}-{class}",
            lead = pitch * f64::from(starts)
        ),
    })
}

fn unified(traits: &Traits) -> Option<String> {
    if traits.starts != 1 {
        return None;
    }
    let count = 25.4 / traits.pitch.0;
    let whole = (count * 2.0).round() / 2.0;
    // A lead is written with four decimals.
    if (count / whole - 1.0).abs() > 2e-4 || !(3.0..=80.0).contains(&whole) {
        return None;
    }
    let class = match traits.side {
        Side::External => "2A",
        Side::Internal => "2B",
    };
    let major = major(traits).0;
    // A size of the coarse or the fine series has limits of its own; others are UN.
    let series = [(&UNC[..], "UNC"), (&UNF[..], "UNF")];
    let sizes = series.into_iter().flat_map(|(sizes, family)| {
        let of = sizes.iter().filter(|(threads, _)| *threads == whole);
        of.map(move |(_, size)| format!("{size}-{whole}{family}-{class}"))
    });
    let off = |name: &String| {
        let named = Designation::read(name, traits.side).ok()?;
        Some((named.major.0 - major).abs())
    };
    let likely = sizes
        .filter_map(|name| off(&name).map(|off| (off, name)))
        .filter(|(off, _)| *off < 0.4 * 25.4 / 16.0)
        .min_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((_, name)) = likely {
        return Some(name);
    }
    let sixteenths = (major / 25.4 * 16.0).round();
    near(major, 25.4 / 16.0)?;
    let (full, mut part, mut below) = ((sixteenths / 16.0).floor(), sixteenths % 16.0, 16.0);
    while part > 0.0 && part % 2.0 == 0.0 {
        (part, below) = (part / 2.0, below / 2.0);
    }
    let size = match (full > 0.0, part > 0.0) {
        (true, true) => format!("{full}-{part}/{below}"),
        (true, false) => format!("{full}"),
        (false, _) => format!("{part}/{below}"),
    };
    Some(format!("{size}-{whole}UN-{class}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(side: Side, pitch: f64, starts: u8, crest: Option<f64>, root: f64) -> String {
        guess(&Traits {
            side,
            pitch: Mm(pitch),
            starts,
            angle: Degrees(60.0),
            taper: 0.0,
            is_constant: true,
            crest: crest.map(Mm),
            root: Mm(root),
        })
        .text
    }

    #[test]
    fn likely_names() {
        use Side::{External, Internal};
        assert_eq!(name(External, 3.0, 1, Some(39.9), 36.3), "M40x3-6g");
        assert_eq!(name(External, 3.0, 1, None, 36.32), "M40x3-6g");
        assert_eq!(name(External, 2.0, 2, Some(30.0), 27.5), "M30x4P2-6g");
        assert_eq!(name(Internal, 1.5, 1, Some(18.376), 20.0), "M20x1.5-6H");
        assert_eq!(name(External, 1.27, 1, Some(6.35), 4.7), "1/4-20UNC-2A");
        assert_eq!(
            name(External, 2.1167, 1, Some(31.7), 29.0),
            "1-1/4-12UNF-2A"
        );
        assert_eq!(name(External, 0.79375, 1, Some(4.75), 3.8), "#10-32UNF-2A");
        assert_eq!(name(Internal, 1.27, 1, Some(5.1), 6.35), "1/4-20UNC-2B");
        // No coarse and no fine one.
        assert_eq!(name(External, 1.27, 1, Some(19.0), 17.4), "3/4-20UN-2A");
        // No norm has this one.
        assert_eq!(name(External, 3.3, 1, Some(40.0), 36.0), "");
    }

    #[test]
    fn other_angles_tapers_and_growing_leads_have_no_name() {
        let mut traits = Traits {
            side: Side::External,
            pitch: Mm(3.0),
            starts: 1,
            angle: Degrees(30.0),
            taper: 0.0,
            is_constant: true,
            crest: Some(Mm(40.0)),
            root: Mm(36.0),
        };
        assert_eq!(guess(&traits).text, "");
        assert_eq!(guess(&traits).angle, Degrees(30.0));
        traits.angle = Degrees(60.0);
        assert_eq!(guess(&traits).text, "M40x3-6g");
        traits.is_constant = false;
        assert_eq!(guess(&traits).text, "");
    }
}
