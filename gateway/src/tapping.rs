//! The entry of the tap journal in words and as JSON: what `status` and `retract` show of a tap in a hole.

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{Hand, LengthUnit, TapAxis};
use leadscrew_core::journal::TapRecord;
use leadscrew_core::units::Length;

use crate::json::Json;
use crate::number;
use crate::words::{both, pick};

/// A coordinate of the tap axis as programs write it: X a diameter.
fn coordinate(record: &TapRecord, length: Length) -> i64 {
    match record.hole.axis {
        TapAxis::X => length.nm().saturating_mul(2),
        TapAxis::Z => length.nm(),
    }
}

const fn letter(record: &TapRecord) -> &'static str {
    match record.hole.axis {
        TapAxis::X => "X",
        TapAxis::Z => "Z",
    }
}

/// A few lines for a person.
#[must_use]
pub fn text(record: &TapRecord, lang: Lang) -> String {
    let hole = &record.hole;
    let axis = letter(record);
    let place = |length| number::text::<6>(coordinate(record, length));
    let unit = match hole.notes.unit {
        LengthUnit::Metric => pick(lang, "programmed in mm", "公制编程"),
        LengthUnit::Inch => pick(lang, "programmed in inches", "英制编程"),
    };
    both!(
        "a tap is in a hole\n  \
           axis      {axis}, plane G{plane}, {unit}; machine coordinates follow\n  \
           R plane   {axis}{level}\n  \
           bottom    {axis}{bottom}\n  \
           depth     {depth} mm below R when the entry was written (no. {sequence})\n  \
           lead      {lead} mm per turn, {hand}\n  \
           spindle   {spindle}, S{speed}\n\
         no move of {axis} but the tapping return is safe: `retract` or G30 P99 brings the tap out\n",
        "丝锥在孔里\n  \
           轴        {axis}，平面 G{plane}，{unit}；以下为机床坐标\n  \
           R 平面    {axis}{level}\n  \
           孔底      {axis}{bottom}\n  \
           深度      写记录时在 R 平面以下 {depth} mm（第 {sequence} 条）\n  \
           螺距      每转 {lead} mm，{hand}\n  \
           主轴      {spindle}，S{speed}\n\
         除攻丝返回外，{axis} 轴的任何移动都不安全：请用 `retract` 或 G30 P99 退出丝锥\n",
        plane = hole.notes.plane.code(),
        level = place(hole.level),
        bottom = place(hole.bottom),
        depth = number::text::<6>(hole.depth(record.position).nm()),
        sequence = record.sequence,
        lead = number::text::<6>(hole.lead.rounded().nm()),
        hand = match hole.hand {
            Hand::Right => pick(lang, "right hand", "右旋"),
            Hand::Left => pick(lang, "left hand", "左旋"),
        },
        spindle = hole.spindle.number(),
        speed = number::text::<2>(i64::from(hole.speed.get())),
    )
    .get(lang)
    .to_owned()
}

/// `"tap": {…}`, or `"tap": null` where nothing was ever stored. X is a diameter, depth and lead are not.
pub fn fields(record: Option<&TapRecord>, json: &mut Json) {
    let Some(record) = record else {
        return json.null("tap");
    };
    let hole = &record.hole;
    json.object_at("tap", |json| {
        json.flag("in_hole", record.in_hole);
        json.integer("sequence", i64::from(record.sequence));
        json.text("axis", letter(record));
        json.integer("plane", i64::from(hole.notes.plane.code()));
        json.text(
            "unit",
            match hole.notes.unit {
                LengthUnit::Metric => "mm",
                LengthUnit::Inch => "inch",
            },
        );
        json.decimal::<6>("r_mm", coordinate(record, hole.level));
        json.decimal::<6>("bottom_mm", coordinate(record, hole.bottom));
        json.decimal::<6>("depth_mm", hole.depth(record.position).nm());
        json.decimal::<6>("lead_mm", hole.lead.rounded().nm());
        json.text(
            "hand",
            match hole.hand {
                Hand::Right => "right",
                Hand::Left => "left",
            },
        );
        json.integer("spindle", i64::from(hole.spindle.number()));
        json.decimal::<2>("rpm", i64::from(hole.speed.get()));
    });
}

#[cfg(test)]
mod tests {
    use leadscrew_core::call::{TapNotes, TapSpindle};
    use leadscrew_core::journal::TapHole;
    use leadscrew_core::units::{CentiRpm, Lead, Turns};

    use super::*;

    fn record() -> TapRecord {
        TapRecord {
            sequence: 7,
            in_hole: true,
            hole: TapHole {
                axis: TapAxis::X,
                level: Length::from_nm(29_000_000),
                bottom: Length::from_nm(15_000_000),
                lead: Lead::new(1_250_000, 1).unwrap(),
                hand: Hand::Left,
                spindle: TapSpindle::First,
                speed: CentiRpm::new(50_050),
                notes: TapNotes::default(),
            },
            position: Length::from_nm(20_500_000),
            angle: Turns::from_raw(0),
        }
    }

    #[test]
    fn x_is_a_diameter_and_depth_is_not() {
        let mut json = Json::new();
        json.object(|json| fields(Some(&record()), json));
        assert_eq!(
            String::from_utf8(json.into_bytes()).unwrap(),
            "{\"tap\":{\"in_hole\":true,\"sequence\":7,\"axis\":\"X\",\"plane\":18,\"unit\":\"mm\",\"r_mm\":58,\
             \"bottom_mm\":30,\"depth_mm\":8.5,\"lead_mm\":1.25,\"hand\":\"left\",\"spindle\":1,\"rpm\":500.5}}"
        );
        let mut json = Json::new();
        json.object(|json| fields(None, json));
        assert_eq!(json.into_bytes(), b"{\"tap\":null}");
    }

    #[test]
    fn a_person_reads_the_same() {
        let english = text(&record(), Lang::En);
        for part in [
            "X58\n",
            "X30\n",
            "8.5 mm below R",
            "1.25 mm per turn, left hand",
            "1, S500.5",
        ] {
            assert!(english.contains(part), "{part}: {english}");
        }
        let chinese = text(&record(), Lang::Zh);
        assert!(chinese.contains("每转 1.25 mm，左旋"), "{chinese}");
        assert_eq!(english.lines().count(), chinese.lines().count());
    }
}
