//! A thread near by: on the left the groove that all passes cut, with the tool's edge, to scale; on the right the passes
//! over their length with lead-in, face and run-out, X larger than Z.

use leadscrew_core::alarm::Lang;
use leadscrew_metrology::{Mm, Side, Tool};
use svg::Node as _;
use svg::node::element::{Group, Path};

use super::pane::{Across, Area, Pane, Range};
use super::{labelled, told};
use crate::number::{self, measured};
use crate::plot::{frame, text};
use crate::words::pick;

/// A pass: one way of the tool along the thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Pass {
    /// Its number at this start, from 1.
    pub number: u32,
    /// The line of the program as the machine counts it.
    pub line: u32,
    /// Its start of a multiple thread, from 1.
    pub start: u8,
    /// Depth below the crest in millimetres, where the cycle knows it.
    pub depth: Option<f64>,
    /// Its way: along the thread, across it.
    pub points: Vec<(f64, f64)>,
    /// The point of the way at which the run-in ends; the first one where there is none.
    pub run_in: usize,
    /// The point of the way at which the run-out begins; the last one where there is none.
    pub run_out: usize,
    /// Where the helix stands along the thread at the spindle's index, in millimetres.
    pub phase: f64,
}

impl Pass {
    /// Where it begins.
    fn begin(&self) -> f64 {
        self.points.first().map_or(0.0, |point| point.0)
    }

    /// Where the first stroke of the thread ends: that of a cycle, or of a chain, which may go on elsewhere.
    fn bottom(&self) -> (f64, f64) {
        let end = (self.run_in + 1).min(self.run_out);
        self.points.get(end).copied().unwrap_or_default()
    }

    /// Where the run-out begins.
    fn leaves(&self) -> (f64, f64) {
        self.points.get(self.run_out).copied().unwrap_or_default()
    }

    fn end(&self) -> (f64, f64) {
        self.points.last().copied().unwrap_or_default()
    }
}

/// A thread: along Z, its depth across it a radius, or along X, its depth along Z.
#[derive(Clone, Debug)]
pub struct Thread {
    /// What is across it, and upwards in its views.
    pub across: Across,
    /// Outer or inner.
    pub side: Side,
    /// In the order of cutting.
    pub passes: Vec<Pass>,
    /// The edge that cuts it.
    pub tool: Tool,
    /// Travel per turn in millimetres.
    pub lead: f64,
    /// Where the part begins along it, where that is known.
    pub face: Option<f64>,
    /// It is assumed.
    pub face_is_assumed: bool,
    /// The surface across it at `level` along it, and its change per millimetre along it.
    pub surface: (f64, f64),
    /// Where along it the surface is known.
    pub level: f64,
    /// The way in which the axis gets onto the lead, where it is known.
    pub lead_in: Option<f64>,
}

impl Thread {
    /// The pass that gets onto the lead last, and how much of the lead-in lies in the material (negative: before it);
    /// `None` where there is no face to tell it by.
    pub fn lead_in_left(&self) -> Option<(&Pass, Option<f64>)> {
        let lead_in = self.lead_in?;
        let last = self.latest()?;
        // Where the tool comes from the other end, that end is not known.
        let face = self.face.filter(|_| self.toward() < 0.0)?;
        let missing = (face - (last.begin() - lead_in)).min(lead_in);
        let tells = !self.begins_behind() && !self.face_is_begin();
        Some((last, tells.then_some(missing)))
    }

    /// The pass that begins last.
    fn latest(&self) -> Option<&Pass> {
        let toward = self.toward();
        let late = |pass: &&Pass| (pass.begin() * toward * 1e6) as i64;
        self.passes.iter().max_by_key(late)
    }

    /// It begins behind the face by more than the lead-in: in an undercut, or behind another thread.
    fn begins_behind(&self) -> bool {
        let (face, last) = (self.face, self.latest());
        let behind = face.zip(last).map(|(face, last)| face - last.begin());
        self.toward() < 0.0 && behind.is_some_and(|behind| behind > self.lead_in.unwrap_or(0.0))
    }

    /// The face is not known, and was taken to be where the passes begin.
    fn face_is_begin(&self) -> bool {
        let mut begins = self.passes.iter().map(Pass::begin);
        let is_there = |face: f64| begins.any(|begin| (begin - face).abs() < 1e-6);
        self.face_is_assumed && self.face.is_some_and(is_there)
    }

    /// The face, where the thread begins there.
    fn own_face(&self) -> Option<f64> {
        let is_own = !self.begins_behind() && !self.face_is_begin();
        self.face.filter(|_| is_own)
    }

    /// +1 where it is cut toward plus.
    fn toward(&self) -> f64 {
        let first = self.passes.first();
        first.map_or(-1.0, |pass| {
            if pass.bottom().0 > pass.begin() {
                1.0
            } else {
                -1.0
            }
        })
    }

    fn surface_at(&self, z: f64) -> f64 {
        self.surface.0 + self.surface.1 * (z - self.level)
    }

    /// The number of a pass, with its start where there are several.
    fn number(&self, pass: &Pass) -> String {
        if self.passes.iter().any(|pass| pass.start > 1) {
            format!("{}/{}", pass.number, pass.start)
        } else {
            pass.number.to_string()
        }
    }

    /// A line of a pass that a page tells under the pointer.
    fn told(
        &self,
        class: &str,
        points: impl IntoIterator<Item = (f64, f64)>,
        pass: &Pass,
        part: &str,
        lang: Lang,
    ) -> Path {
        let number = self.number(pass);
        let deep = pass.depth.map(measured);
        let words = match lang {
            Lang::En => {
                let deep = deep.map_or_else(String::new, |deep| format!("depth {deep}, "));
                format!("pass {number}, {deep}{part}")
            }
            Lang::Zh => {
                let deep = deep.map_or_else(String::new, |deep| format!("深度 {deep}，"));
                format!("第 {number} 刀，{deep}{part}")
            }
        };
        told(class, points, &words, pass.line, lang)
    }

    /// Where the groove of a pass lies along the thread, from that of the last pass: less than three quarters of a
    /// lead toward plus, and the rest toward minus.
    fn aside(&self, pass: &Pass) -> f64 {
        let last = self.passes.last().map_or(0.0, |last| last.phase);
        let lead = self.lead.max(1e-6);
        let off = (pass.phase - last).rem_euclid(lead);
        if off > lead * 0.75 { off - lead } else { off }
    }

    /// The groove that a pass cuts, by the distance along the thread from that of the last pass: up to the surface.
    pub fn groove(&self, pass: &Pass) -> Vec<(f64, f64)> {
        let (z, radius) = pass.bottom();
        // Each goes along the surface, to where the last one is.
        let at = self.passes.last().map_or(z, |last| last.bottom().0);
        let radius = radius + self.surface.1 * (at - z);
        let surface = self.surface_at(at);
        let up = match self.side {
            Side::External => 1.0,
            Side::Internal => -1.0,
        };
        let height = ((surface - radius) * up).max(0.0);
        let aside = self.aside(pass);
        let outline = self.tool.outline(Mm(height)).into_iter();
        outline
            .map(|(z, u)| (aside + z.0, radius + up * u.0))
            .collect()
    }
}

/// Draws both views.
pub(super) fn draw(document: &mut Group, area: Area, thread: &Thread, n: usize, lang: Lang) {
    if thread.passes.is_empty() {
        return;
    }
    let form = Area {
        right: area.left + 0.34 * (area.right - area.left),
        ..area
    };
    let length = Area {
        left: form.right + 76.0,
        right: area.right - 110.0,
        ..area
    };
    draw_form(document, form, thread, n, lang);
    draw_length(document, length, thread, n, lang);
}

/// The grooves of all passes, one upon the other.
fn draw_form(document: &mut Group, area: Area, thread: &Thread, n: usize, lang: Lang) {
    let grooves: Vec<Vec<(f64, f64)>> = thread
        .passes
        .iter()
        .map(|pass| thread.groove(pass))
        .collect();
    let Some(range) = Range::of(grooves.iter().flatten().copied()) else {
        return;
    };
    let range = range.with_room(0.12, 0.12);
    let pane = Pane::true_to_scale(area, thread.across, range, format!("form{n}"));
    let mut inside = pane.frame(document);
    let at = thread.passes.last().map_or(0.0, |pass| pass.bottom().0);
    let surface = pane.place((0.0, thread.surface_at(at))).1;
    frame::line(
        &mut inside,
        "surface",
        [(area.left, surface), (area.right, surface)],
    );
    for (number, groove) in grooves.iter().enumerate().rev() {
        let pixels = groove.iter().map(|point| pane.place(*point));
        let class = if number + 1 == grooves.len() {
            "tip line"
        } else {
            "line pass"
        };
        inside.append(thread.told(class, pixels, &thread.passes[number], "", lang));
    }
    document.append(inside);
    let words = pick(
        lang,
        "all passes in one groove and the edge, to scale",
        "各次走刀的牙槽与刀刃，按比例",
    );
    document.append(text(area.left, area.top - 8.0, "key", words));
}

/// The passes over their length.
fn draw_length(document: &mut Group, area: Area, thread: &Thread, n: usize, lang: Lang) {
    let ends = thread
        .passes
        .iter()
        .flat_map(|pass| pass.points.iter().copied());
    let begins = thread.passes.iter().map(Pass::begin);
    let near = thread.own_face().unwrap_or(begins.fold(f64::MIN, f64::max));
    let face = (near, thread.surface_at(near));
    let Some(range) = Range::of(ends.chain([face])) else {
        return;
    };
    // Room below for the lead-in, and above for the words of the marks.
    let range = range.with_room(0.05, 0.2);
    let pane = Pane::filled(area, thread.across, range, format!("length{n}"));
    let mut inside = pane.frame(document);
    let far = range.z.0;
    let surface = [far, near].map(|z| pane.place((z, thread.surface_at(z))));
    frame::line(&mut inside, "surface", surface);
    for pass in &thread.passes {
        let pixels: Vec<(f64, f64)> = pass.points.iter().map(|point| pane.place(*point)).collect();
        let parts = [
            (
                "line run-out",
                0,
                pass.run_in,
                pick(lang, "run-in, ", "切入段，"),
            ),
            ("line thread", pass.run_in, pass.run_out, ""),
            (
                "line run-out",
                pass.run_out,
                pixels.len() - 1,
                pick(lang, "run-out, ", "退尾段，"),
            ),
        ];
        for (class, from, to, part) in parts.into_iter().filter(|(_, from, to, _)| to > from) {
            let points = pixels[from..=to].iter().copied();
            inside.append(thread.told(class, points, pass, part, lang));
        }
    }
    document.append(inside);
    marks(document, &pane, thread, lang);
    depths(document, &pane, thread, lang);
    let factor = pane.stretch();
    let (along, up) = match thread.across {
        Across::X => ("Z", "X"),
        Across::Z => ("X", "Z"),
    };
    let words = match lang {
        Lang::En => format!("passes over {along}, {up} drawn ×{factor:.1}"),
        Lang::Zh => format!("各次走刀沿 {along} 方向，{up} 放大 ×{factor:.1}"),
    };
    document.append(text(area.left, area.top - 8.0, "key", &words));
}

/// Face, run-out and lead-in.
fn marks(document: &mut Group, pane: &Pane, thread: &Thread, lang: Lang) {
    let area = pane.area;
    let Some(last) = thread.passes.last() else {
        return;
    };
    let mut written: Vec<(f64, f64, u32)> = Vec::new();
    let mut upright = |z: f64, words: String| {
        let at = pane.place((z, 0.0)).0;
        let class = "mark";
        frame::line(document, class, [(at, area.top), (at, area.bottom)]);
        // Words stay inside the view.
        let room = frame::width(&words);
        let left = if at + 6.0 + room > area.right {
            at - 6.0 - room
        } else {
            at + 6.0
        };
        // The first row in which they meet no others.
        let meets = |row: u32| {
            let mut others = written.iter().filter(|(_, _, other)| *other == row);
            others.any(|(from, to, _)| left < to + 8.0 && from - 8.0 < left + room)
        };
        let row = (1..).find(|row| !meets(*row)).unwrap_or(1);
        written.push((left, left + room, row));
        let y = area.top + 16.0 * f64::from(row);
        document.append(text(left, y, "key", &words));
    };
    let place = |mm: f64| thread.across.right(mm);
    if let Some(at) = thread.own_face() {
        let face = match thread.across {
            Across::X => pick(lang, "face", "端面"),
            Across::Z => pick(lang, "rim", "外缘"),
        };
        upright(at, format!("{face} {}", place(at)));
    }
    if last.run_in > 0 {
        let within = last.points[last.run_in].0;
        let words = match lang {
            Lang::En => format!("run-in to {}", place(within)),
            Lang::Zh => format!("切入段至 {}", place(within)),
        };
        upright(within, words);
    }
    let (out, end) = (last.leaves().0, last.end().0);
    if last.run_out + 1 < last.points.len() {
        let words = match lang {
            Lang::En => format!("run-out from {} to {}", place(out), place(end)),
            Lang::Zh => format!("退尾 {} 至 {}", place(out), place(end)),
        };
        upright(out, words);
    } else {
        let words = pick(lang, "no run-out: ends at", "无退尾，终点");
        upright(end, format!("{words} {}", place(end)));
    }
    let Some((late, missing)) = thread.lead_in_left() else {
        return;
    };
    let lead_in = thread.lead_in.unwrap_or(0.0);
    let (begin, y) = (late.begin(), area.bottom - 10.0);
    let bar = [begin, begin - lead_in].map(|z| (pane.place((z, 0.0)).0, y));
    let long = micrometres(lead_in);
    let (class, words) = match missing {
        Some(missing) if missing > 0.0 => {
            let missing = micrometres(missing);
            let words = match lang {
                Lang::En => {
                    format!("⚠ lead-in {long} mm: {missing} mm of it are missing before the face")
                }
                Lang::Zh => format!("⚠ 升速段 {long} mm：端面前缺 {missing} mm"),
            };
            ("missing", words)
        }
        Some(left) => {
            let left = micrometres(-left);
            let words = match lang {
                Lang::En => format!("lead-in {long} mm, {left} mm to spare"),
                Lang::Zh => format!("升速段 {long} mm，余量 {left} mm"),
            };
            ("enough", words)
        }
        None if thread.begins_behind() => {
            let words = match lang {
                Lang::En => format!("begins behind the face: lead-in {long} mm"),
                Lang::Zh => format!("起点在端面之后：升速段 {long} mm"),
            };
            ("enough", words)
        }
        None => {
            let words = match lang {
                Lang::En => format!("lead-in {long} mm, the face is not known"),
                Lang::Zh => format!("升速段 {long} mm，端面位置未知"),
            };
            ("enough", words)
        }
    };
    frame::line(document, class, bar);
    // Bold letters are wider.
    let (class, wider) = match class {
        "missing" => ("warn", 1.12),
        _ => ("key", 1.0),
    };
    let room = frame::width(&words) * wider;
    let left = (bar[0].0.max(bar[1].0) - room).max(area.left + 4.0);
    document.append(text(left, y - 8.0, class, &words));
}

/// A length of millimetres to the micrometre.
fn micrometres(mm: f64) -> String {
    number::rounded::<6>((mm * 1e6).round() as i64, 3)
}

/// Number, diameter and depth of the passes beside the view.
fn depths(document: &mut Group, pane: &Pane, thread: &Thread, lang: Lang) {
    let area = pane.area;
    let heights: Vec<f64> = thread
        .passes
        .iter()
        .map(|pass| pane.place(pass.bottom()).1)
        .collect();
    for n in labelled(&heights, 14.0) {
        let (pass, y) = (&thread.passes[n], heights[n]);
        let number = thread.number(pass);
        let deep = pass
            .depth
            .map_or_else(|| thread.across.size(pass.bottom().1), measured);
        let class = if n + 1 == thread.passes.len() {
            "depth-of name"
        } else {
            "depth-of"
        };
        document.append(text(
            area.right + 10.0,
            y + 4.5,
            class,
            &format!("{number}: {deep}"),
        ));
    }
    let has_depth = thread.passes.iter().any(|pass| pass.depth.is_some());
    let words = match (has_depth, thread.across) {
        (true, _) => pick(lang, "pass: depth mm", "刀次：深度 mm"),
        (false, Across::X) => pick(lang, "pass: ⌀ mm", "刀次：⌀ mm"),
        (false, Across::Z) => pick(lang, "pass: Z mm", "刀次：Z mm"),
    };
    document.append(text(area.right + 10.0, area.top - 8.0, "name", words));
}
