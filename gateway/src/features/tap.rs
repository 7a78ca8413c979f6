//! The holes that a program taps, stroke by stroke, with what a picture says of them. Holes that are alike are one feature.

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{Hand, TapMode};
use leadscrew_core::moves::{Stage, Tag, TapMove};
use leadscrew_core::units::Length;
use leadscrew_language::stock::Stock;

use super::PIECES;
use super::depth::Depth;
use crate::drawing::mm;
use crate::number::measured;
use crate::plot::{Reversal, Tap, TapStroke};
use crate::words::both;

/// Holes that are alike.
#[derive(Debug)]
pub(super) struct Holes {
    tap: Tap,
    /// What all of them have.
    first: TapMove,
    depth: Depth,
    /// Turns of the hole under way, and its deepest.
    turned: f64,
    cut: f64,
    hole: u32,
    infeed: u32,
}

impl Holes {
    /// Those of this stroke. `zero`: the coordinate of the work's zero on the axis.
    pub(super) fn new(tap: &TapMove, zero: Length, stock: Option<&Stock>) -> Self {
        let lead = tap.lead.numerator() as f64 / tap.lead.denominator() as f64 / 1e6;
        let depth = Depth::new(tap.axis, (tap.level, tap.bottom), zero, stock);
        Self {
            tap: Tap {
                axis: depth.axis,
                is_rigid: tap.mode == TapMode::Rigid,
                lead,
                is_right_hand: tap.hand == Hand::Right,
                bottom: depth.bottom,
                material: depth.material,
                strokes: Vec::new(),
                reversal: Reversal::default(),
                at: None,
            },
            first: *tap,
            depth,
            turned: 0.0,
            cut: 0.0,
            hole: 0,
            infeed: 0,
        }
    }

    /// This stroke is of such a hole.
    pub(super) fn is_alike(&self, tap: &TapMove) -> bool {
        let of = |tap: &TapMove| {
            let place = (tap.axis, tap.level, tap.bottom);
            (tap.mode, tap.spindle, tap.lead, tap.hand, place)
        };
        of(&self.first) == of(tap)
    }

    /// Adds a stroke from one coordinate of its axis to another; false where it did not fit.
    pub(super) fn push(
        &mut self,
        tap: &TapMove,
        tag: Option<Tag>,
        line: u32,
        way: (Length, Length),
    ) -> bool {
        if tap.opens || self.hole == 0 {
            // Before the surface there is nothing to cut.
            let surface = self.tap.material.0.unwrap_or(0.0).max(0.0);
            (self.turned, self.cut, self.infeed) = (0.0, surface, 0);
            self.hole = self.hole.saturating_add(1);
        }
        let sign = (self.first.bottom.nm() - self.first.level.nm()).signum();
        let below = |at: Length| mm((at.nm() - self.first.level.nm()) * sign);
        let depth = (below(way.0), below(way.1));
        if self.tap.strokes.is_empty() && !tap.opens {
            // Its hole was cut before.
            self.cut = self.cut.max(depth.0);
        }
        let end = self.tap.material.1.unwrap_or(f64::INFINITY);
        let fresh = (self.cut, depth.1.min(end).max(self.cut));
        self.cut = fresh.1;
        let stage = tag.map_or(Stage::Extract, |tag| tag.stage);
        if stage == Stage::Tap {
            self.infeed = self.infeed.saturating_add(1);
        }
        let has_room = self.tap.strokes.len() < PIECES;
        if has_room {
            self.tap.strokes.push(TapStroke {
                hole: self.hole,
                infeed: if stage == Stage::Tap { self.infeed } else { 0 },
                stage,
                line,
                turned: self.turned,
                depth,
                fresh,
            });
        }
        self.turned += (depth.1 - depth.0).abs() / self.tap.lead;
        has_room
    }

    /// The figures of the holes, and their geometry.
    pub(super) fn feature(self, lang: Lang) -> (Vec<String>, Tap) {
        let mut figures = vec![self.hole(lang)];
        figures.extend(self.chip(lang));
        figures.push(self.depth.surface(lang));
        (figures, self.tap)
    }

    fn hole(&self, lang: Lang) -> String {
        let tap = &self.tap;
        let kind = if tap.is_rigid {
            both!("rigid", "刚性攻丝")
        } else {
            both!("with a floating holder", "浮动夹头攻丝")
        };
        let hand = if tap.is_right_hand {
            both!("right-hand", "右旋")
        } else {
            both!("left-hand", "左旋")
        };
        let [lead, turns, level, bottom] = [
            tap.lead,
            tap.bottom / tap.lead,
            self.depth.ends.0,
            self.depth.ends.1,
        ]
        .map(measured);
        let (axis, holes) = (tap.axis, self.hole);
        let told = both!(
            "{kind_en}, {hand_en} · lead {lead} mm along {axis} · R {axis}{level}, bottom {axis}{bottom}: {turns} turns · \
             holes: {holes}",
            "{kind_zh}，{hand_zh} · 导程 {lead} mm，沿 {axis} · R {axis}{level}，孔底 {axis}{bottom}：{turns} 转 · 孔数 {holes}",
            kind_en = kind.en,
            hand_en = hand.en,
            kind_zh = kind.zh,
            hand_zh = hand.zh
        );
        told.get(lang).to_owned()
    }

    /// Infeeds of a hole, their longest chip, and where the tap is between them. `None` for a mere way out.
    fn chip(&self, lang: Lang) -> Option<String> {
        let first = || self.tap.strokes.iter().filter(|stroke| stroke.hole == 1);
        let infeeds = first().filter(|stroke| stroke.stage == Stage::Tap);
        let count = infeeds.clone().count();
        let longest = infeeds.map(TapStroke::cuts).fold(0.0, f64::max);
        if count == 0 {
            return None;
        }
        let chip = measured(longest / self.tap.lead);
        let told = both!(
            "infeeds: {count} · longest chip {chip} turns",
            "进给 {count} 次 · 最长切屑 {chip} 转"
        );
        let mut backs = first().filter(|stroke| stroke.stage == Stage::Retract);
        let Some(back) = backs.next() else {
            return Some(told.get(lang).to_owned());
        };
        let surface = self.tap.material.0.unwrap_or(0.0);
        let way = measured(back.depth.0 - back.depth.1);
        let between = if back.depth.1 <= surface {
            both!("out of the hole after each infeed", "每次进给后退出孔外")
        } else {
            both!(
                "back by {way} mm after each infeed: the tap stays in the hole",
                "每次进给后退回 {way} mm：丝锥不出孔"
            )
        };
        Some(format!("{} · {}", told.get(lang), between.get(lang)))
    }
}
