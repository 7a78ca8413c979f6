//! Steps that a program hardly means: so many, or so long, that they are in the unit of another control.
//!
//! The commonest slip between makers is a factor of 1000: `Q5` for `Q5000`, or the other way round.

use leadscrew_core::units::Length;

/// The most pecks of a hole or of a column, and strokes of a contour, that are not asked about.
pub const MOST: u64 = 250;

/// True for a step that divides nothing, and that as a count of increments (thousandths of a millimetre, or
/// ten-thousandths) would make 2 to 60 steps of the way.
#[must_use]
pub fn is_of_other_unit(step: Length, way: Length) -> bool {
    let (step, way) = (i128::from(step.nm()), i128::from(way.nm().abs()));
    let divides = |factor: i128| (step * 2..=step * 60).contains(&(way * factor));
    step > 0 && (divides(1_000) || divides(10_000))
}

/// True for a peck that is of another unit, or of ten times the size that was meant. One that is a little deeper than the
/// hole is a way to ask for a single cut.
#[must_use]
pub fn is_beyond(peck: Length, depth: Length) -> bool {
    let depth = depth.abs();
    let tenfold = peck >= depth.times(2) && peck < depth.times(10);
    tenfold || is_of_other_unit(peck, depth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_of_another_unit_are_known() {
        let is = |step: i64, way: i64| is_beyond(Length::from_nm(step), Length::from_nm(-way));
        let mm = 1_000_000;
        // Q5000 for 5 mm, in IS-B and IS-C, and P30. for 3.
        assert!(is(5_000 * mm, 52 * mm));
        assert!(is(50_000 * mm, 52 * mm));
        assert!(is(30 * mm, 4 * mm));
        // A single cut.
        assert!(!is(53 * mm, 52 * mm));
        assert!(!is(103 * mm, 52 * mm));
        assert!(!is(100 * mm, 8 * mm));
        assert!(!is(5 * mm, 52 * mm));
        assert!(!is(0, 0));
    }
}
