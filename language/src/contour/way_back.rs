//! The end of a contour of G71 or G72 whose last blocks are rapids that lead back: the cycle returns by itself [D368].

use leadscrew_core::units::Length;

use super::profile::Profile;
use super::words::{Allowance, Along};
use super::{Axes, Contour};
use crate::plane::{Element, Point, Shape};

/// How many of the elements are the contour, where the rest are rapids at its end that turn back clear of all that is cut.
/// `None` where nothing is to be left out, or where such a rapid does not stay clear.
#[must_use]
pub fn without_way_back(
    start: Point,
    axes: Axes,
    along: Along,
    elements: &[Element],
) -> Option<usize> {
    let is_cut = |element: &Element| !matches!(element.shape, Shape::Rapid);
    let cuts = elements.iter().rposition(is_cut)? + 1;
    if cuts == elements.len() {
        return None;
    }
    let cut = Contour::new(start, axes, elements[..cuts].to_vec()).ok()?;
    let one_way = match along {
        Along::Z => !axes.z,
        Along::X => !axes.x,
    };
    // Both move alike with the allowances.
    let none = Allowance::default();
    let profile = Profile::new(&cut, along, &none, one_way, Length::ZERO).ok()?;
    let highest = profile.pieces.iter().map(|piece| piece.to.h).max()?;
    let mut at = profile.frame.enter(elements[cuts - 1].end);
    let mut back = None;
    for (index, element) in elements.iter().enumerate().skip(cuts) {
        let to = profile.frame.enter(element.end);
        if to.l < at.l || (one_way && to.h < at.h) {
            back.get_or_insert(index);
        }
        if back.is_some() && at.h.min(to.h) < highest {
            return None;
        }
        at = to;
    }
    back
}
