//! What the taps of a run did: turns, way, speed, and how far axis and spindle were apart.

use super::TapPlace;
use crate::json::Json;
use crate::number;
use crate::synchronism::micrometres;
use crate::words::{Both, both};

/// The most a tap moves in the first tick of a stroke, which begins at rest.
const FIRST_TICK_NM: i64 = 100_000;

/// Figures of all taps of a run.
#[derive(Clone, Debug, Default)]
pub struct Taps {
    /// Where a tap was when one was last seen.
    last: Option<TapPlace>,
    /// That was in the tick before.
    in_hole: bool,
    /// Most turns from R, in millionths.
    deepest_urev: i64,
    /// Turns in all, in and out, in millionths.
    turns_urev: i64,
    /// Synchronous way in all, in and out, in nanometres.
    travel_nm: i64,
    /// Most turns in a tick, in millionths.
    fastest_urev: i64,
    /// Largest distance from the line of axis and spindle, in nanometres.
    skew_nm: i64,
}

impl Taps {
    /// Takes in the next tick.
    pub fn push(&mut self, tap: Option<TapPlace>) {
        let going_on = std::mem::replace(&mut self.in_hole, tap.is_some());
        let Some(now) = tap else { return };
        let last = self.last.replace(now).unwrap_or_default();
        let distance = |from: &TapPlace| (now.depth_nm - from.depth_nm).abs();
        // A hole begins at R or goes on where the last one was left; the first tick has hardly left it. A tapping return
        // begins wherever the tap stands.
        let from = [TapPlace::default(), last]
            .into_iter()
            .find(|start| !going_on && distance(start) <= FIRST_TICK_NM)
            .unwrap_or(if going_on { last } else { now });
        let turned = (now.turned_urev - from.turned_urev).abs();
        self.deepest_urev = self.deepest_urev.max(now.turned_urev.abs());
        self.skew_nm = self.skew_nm.max(now.skew_nm.abs());
        self.turns_urev = self.turns_urev.saturating_add(turned);
        // An ordinary tap is first seen some way below R, on its lead at full speed.
        if going_on {
            self.fastest_urev = self.fastest_urev.max(turned);
        }
        self.travel_nm = self.travel_nm.saturating_add(distance(&from));
    }

    /// Millionths of a turn per minute.
    fn fastest(&self, tick_us: u32) -> i64 {
        let value = i128::from(self.fastest_urev) * 60_000_000 / i128::from(tick_us.max(1));
        i64::try_from(value).unwrap_or(i64::MAX)
    }

    /// `tap`, where there was one.
    pub fn fields(&self, json: &mut Json, tick_us: u32) {
        if self.last.is_none() {
            return;
        }
        json.object_at("tap", |json| {
            json.decimal::<6>("turns_deep", self.deepest_urev);
            json.decimal::<6>("turns", self.turns_urev);
            json.decimal::<6>("travel_mm", self.travel_nm);
            json.decimal::<6>("rpm_max", self.fastest(tick_us));
            json.object_at("skew_um", |json| json.decimal::<3>("max", self.skew_nm));
        });
    }

    /// For a person, in a line.
    pub fn words(&self, tick_us: u32) -> Option<Both> {
        self.last?;
        let deep = number::rounded::<6>(self.deepest_urev, 3);
        let turns = number::rounded::<6>(self.turns_urev, 3);
        let travel = number::rounded::<6>(self.travel_nm, 3);
        let rpm = number::rounded::<6>(self.fastest(tick_us), 0);
        let skew = micrometres(self.skew_nm);
        Some(both!(
            "{deep} turns deep; {turns} turns and {travel} mm in and out; up to {rpm} rpm; \
             worst skew of axis and spindle {en} µm",
            "最深 {deep} 转；进出共 {turns} 转、{travel} mm；最高 {rpm} r/min；轴与主轴最大偏差 {zh} µm",
            en = skew.en,
            zh = skew.zh
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_do_not_run_into_each_other() {
        let mut taps = Taps::default();
        let place = |depth_nm, turned_urev| {
            Some(TapPlace {
                depth_nm,
                turned_urev,
                skew_nm: -depth_nm / 1_000_000,
            })
        };
        for tap in [
            place(0, 0),
            place(2_000_000, -1_000_000),
            None,
            place(10_000, -5_000),
            place(0, 0),
        ] {
            taps.push(tap);
        }
        let mut json = Json::new();
        json.object(|json| taps.fields(json, 1000));
        assert_eq!(
            String::from_utf8(json.into_bytes()).unwrap(),
            r#"{"tap":{"turns_deep":1,"turns":1.01,"travel_mm":2.02,"rpm_max":60000,"skew_um":{"max":0.002}}}"#
        );
        assert_eq!(
            taps.words(1000).unwrap().en,
            "1 turns deep; 1.01 turns and 2.02 mm in and out; up to 60000 rpm; worst skew of axis and spindle 0.002 µm"
        );
    }

    #[test]
    fn the_way_onto_the_lead_is_no_speed() {
        let mut taps = Taps::default();
        for (depth_nm, turned_urev) in [(90_000, 36_000), (98_000, 39_200)] {
            taps.push(Some(TapPlace {
                depth_nm,
                turned_urev,
                skew_nm: 0,
            }));
        }
        // 3200 millionths of a turn in a millisecond.
        assert_eq!(taps.fastest(1000), 192_000_000);
        assert_eq!((taps.turns_urev, taps.travel_nm), (39_200, 98_000));
    }

    #[test]
    fn nothing_is_said_of_taps_where_there_were_none() {
        let mut taps = Taps::default();
        taps.push(None);
        assert!(taps.words(1000).is_none());
        let mut json = Json::new();
        json.object(|json| taps.fields(json, 1000));
        assert_eq!(json.into_bytes(), b"{}");
    }
}
