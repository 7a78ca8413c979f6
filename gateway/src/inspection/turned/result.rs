//! Grooves and contours for a program: `grooves` and `contours` of `measure --json`.

use leadscrew_metrology::{Mm, Side, Size, Spread};

use super::sheet::{across, along, programmed, staying, worst};
use super::{CutGroove, CutOutline, Found};
use crate::inspection::result::{mm, um};
use crate::json::Json;
use crate::plot::Across;

/// `grooves` and `contours`.
pub fn fields(found: &Found, json: &mut Json) {
    json.array_at("grooves", |json| {
        for groove in &found.grooves {
            json.object(|json| one_groove(groove, json));
        }
    });
    json.array_at("contours", |json| {
        for outline in &found.outlines {
            json.object(|json| one_outline(outline, json));
        }
    });
}

/// Programmed, mean, least and most, each as it is written.
fn size(json: &mut Json, key: &str, programmed: f64, found: &Spread, written: &dyn Fn(Mm) -> f64) {
    json.object_at(key, |json| {
        mm(json, "programmed", programmed);
        mm(json, "mean", written(Mm(found.mean)));
        mm(json, "min", written(Mm(found.low)));
        mm(json, "max", written(Mm(found.high)));
    });
}

fn one_groove(cut: &CutGroove, json: &mut Json) {
    let groove = &cut.groove;
    json.number("line", groove.line);
    json.number("tool", groove.tool);
    json.text("into", if groove.across == Across::X { "x" } else { "z" });
    match groove.width {
        Some(width) => mm(json, "tool_width_mm", width.0),
        None => json.null("tool_width_mm"),
    }
    let Some((found, walls)) = cut.found.as_ref().zip(groove.walls()) else {
        return json.flag("measured", false);
    };
    json.flag("measured", true);
    let up = |mm: Mm| across(groove.across, mm);
    let right = |mm: Mm| along(groove.across, mm);
    size(json, "floor_mm", up(groove.floor), &found.floor, &up);
    let width = (walls[1] - walls[0]).0;
    size(json, "width_mm", width, &found.width, &|mm| mm.0);
    for (n, key) in ["wall_minus_mm", "wall_plus_mm"].into_iter().enumerate() {
        size(json, key, right(walls[n]), &found.walls[n], &right);
    }
}

fn one_outline(cut: &CutOutline, json: &mut Json) {
    json.number("tool", cut.outline.tool);
    json.flag("internal", cut.outline.side == Side::Internal);
    if let Some(worst) = worst(cut) {
        for (key, (off, (z, r))) in ["least", "most"].into_iter().zip(worst) {
            json.object_at(key, |json| {
                um(json, "off_um", off);
                mm(json, "x_mm", 2.0 * r.0);
                mm(json, "z_mm", z.0);
            });
        }
    }
    json.array_at("elements", |json| {
        for (piece, found) in staying(cut) {
            let Some(found) = found else { continue };
            json.object(|json| {
                json.number("line", piece.line);
                let (_, asked) = programmed(&piece.element);
                let spread = |json: &mut Json, key: &str, spread: &Spread| {
                    size(json, key, asked, spread, &|mm| mm.0);
                };
                let alone = |json: &mut Json, key: &str, value: f64| {
                    json.object_at(key, |json| {
                        mm(json, "programmed", asked);
                        mm(json, "mean", value);
                    });
                };
                match &found.size {
                    Some(Size::Cylinder(found)) => spread(json, "diameter_mm", found),
                    Some(Size::Face(found)) => spread(json, "face_mm", found),
                    Some(Size::Cone(angle)) => alone(json, "angle_deg", angle.0),
                    Some(Size::Arc(radius)) => alone(json, "radius_mm", radius.0),
                    None => {}
                }
                um(json, "mean_um", Mm(found.off.mean));
                um(json, "least_um", Mm(found.off.low));
                um(json, "most_um", Mm(found.off.high));
            });
        }
    });
}
