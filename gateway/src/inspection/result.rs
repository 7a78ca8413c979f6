//! The result of an inspection for a program: `threads` of `measure --json`.

use leadscrew_inspection::{Cut, Job};
use leadscrew_metrology::{Feature, Inspection, Measured, Mm, Nose, Origin, Row, Side};

use crate::json::Json;

/// Millimetres to a nanometre.
pub(super) fn mm(json: &mut Json, key: &str, value: f64) {
    if value.is_finite() {
        json.decimal::<6>(key, (value * 1e6).round() as i64);
    } else {
        json.null(key);
    }
}

/// Micrometres to a nanometre.
pub(super) fn um(json: &mut Json, key: &str, value: Mm) {
    json.decimal::<3>(key, (value.um() * 1e3).round() as i64);
}

/// A list of numbers with a fixed count of decimals.
fn list<const D: u32>(json: &mut Json, key: &str, values: impl Iterator<Item = f64>) {
    let scale = 10f64.powi(D as i32);
    let texts: Vec<String> = values
        .map(|value| crate::number::text::<D>((value * scale).round() as i64))
        .collect();
    json.number(key, format_args!("[{}]", texts.join(",")));
}

/// `threads`, and `threads_along_x`: those that are not measured.
pub fn fields(cuts: &[Cut], along_x: usize, json: &mut Json) {
    json.array_at("threads", |json| {
        for cut in cuts {
            json.object(|json| one(cut, json));
        }
    });
    json.number("threads_along_x", along_x);
}

fn one(cut: &Cut, json: &mut Json) {
    let job = &cut.job;
    json.number("line", job.line);
    if job.thread.text.is_empty() {
        json.null("thread");
    } else {
        json.text("thread", &job.thread.text);
    }
    json.flag("internal", job.stock.side == Side::Internal);
    given(job, json);
    if let Ok((measured, inspection)) = &cut.found {
        found(measured, inspection, json);
    }
    mm(json, "chip_mm3", cut.work.removed().0);
    json.array_at("passes", |json| {
        for (pass, chip) in cut.work.chips() {
            json.object(|json| {
                json.number("pass", pass);
                mm(json, "minus_mm3", chip.minus.0);
                mm(json, "plus_mm3", chip.plus.0);
            });
        }
    });
    match cut.verdict() {
        Some(true) => json.text("verdict", "within"),
        Some(false) => json.text("verdict", "out"),
        None => json.text("verdict", "not_judged"),
    }
}

fn given(job: &Job, json: &mut Json) {
    mm(json, "nominal_pitch_mm", job.thread.pitch.0);
    json.number("starts", job.thread.starts);
    json.object_at("tool", |json| {
        json.number("number", job.tool_number);
        list::<4>(
            json,
            "flank_deg",
            [job.tool.minus.0, job.tool.plus.0].into_iter(),
        );
        match job.tool.nose {
            Nose::Round(radius) => mm(json, "tip_radius_mm", radius.0),
            Nose::Flat(width) => mm(json, "tip_width_mm", width.0),
        }
    });
    mm(json, "surface_mm", job.stock.radius.0 * 2.0);
    mm(json, "face_mm", job.stock.face.0);
    json.object_at("assumed", |json| {
        json.flag("thread", job.assumed.thread);
        json.flag("side", job.assumed.side);
        json.flag("tool", job.assumed.tool);
        json.flag("surface", job.assumed.surface);
        json.flag("face", job.assumed.face);
    });
}

const fn key(row: &Row) -> &'static str {
    match row.feature {
        Feature::Major => "major",
        Feature::Pitch => "pitch",
        Feature::Minor => "minor",
        Feature::Functional => "functional",
    }
}

fn found(measured: &Measured, inspection: &Inspection, json: &mut Json) {
    mm(json, "major_mm", measured.major.mean);
    mm(json, "minor_mm", measured.minor.mean);
    mm(json, "pitch_mm", measured.pitch.mean);
    match measured.wires {
        Some(wires) => {
            mm(json, "wires_mm", wires.over.0);
            mm(json, "wire_mm", wires.wire.0);
        }
        None => json.null("wires_mm"),
    }
    let lead = &measured.lead;
    mm(json, "lead_mm", lead.lead.0);
    um(json, "lead_error_um", lead.error);
    um(json, "lead_cumulative_um", lead.cumulative);
    um(json, "drunkenness_um", measured.drunkenness.worst);
    let harmonics = measured.drunkenness.repeated.iter();
    list::<3>(
        json,
        "harmonics_um",
        harmonics.map(|amplitude| amplitude.um()),
    );
    let flanks = measured.flanks.iter();
    list::<4>(json, "flank_deg", flanks.map(|flank| flank.mean));
    mm(json, "root_radius_mm", measured.root.0);
    list::<3>(
        json,
        "start_to_start_um",
        measured.starts.iter().map(|off| off.um()),
    );
    json.decimal::<6>("taper", (measured.taper * 1e6).round() as i64);
    mm(json, "full_mm", measured.full.0);
    mm(json, "run_out_mm", measured.run_out.0);
    json.array_at("rows", |json| {
        for row in &inspection.rows {
            json.object(|json| self::row(row, json));
        }
    });
    json.text(
        "limits",
        match inspection.limits.origin {
            Origin::Table => "table",
            Origin::Formula => "formula",
            Origin::None => "none",
        },
    );
    match inspection.go {
        Some(goes) => json.flag("go", goes),
        None => json.null("go"),
    }
    match inspection.no_go {
        Some(stays) => json.flag("no_go", stays),
        None => json.null("no_go"),
    }
    json.decimal::<3>("no_go_turns", (measured.loose_turns * 1e3).round() as i64);
}

fn row(row: &Row, json: &mut Json) {
    json.text("diameter", key(row));
    mm(json, "basic_mm", row.nominal.0);
    for (key, limit) in [("low_mm", row.band.low), ("high_mm", row.band.high)] {
        match limit {
            Some(limit) => mm(json, key, limit.0),
            None => json.null(key),
        }
    }
    mm(json, "mean_mm", row.found.mean);
    mm(json, "min_mm", row.found.low);
    mm(json, "max_mm", row.found.high);
    match row.within {
        Some(within) => json.flag("within", within),
        None => json.null("within"),
    }
}
