//! Grooves and turned contours of a program: cut by the simulated machine's positions, and measured against the program.
//!
//! [`plan`] finds them in the text, [`Turning`] follows the machine's ticks, [`sheet`], [`result`] and [`picture`] tell
//! what was found. How they are measured is in `leadscrew_metrology`.

pub mod picture;
mod plan;
pub mod result;
pub mod sheet;

pub use plan::plan;

use leadscrew_metrology::{
    Contour, Cutter, Element, Grid, Mm, Recess, Sample, Side, Stock, Tool, Turned, Turns, Work,
    recess,
};

use crate::place::SourceLine;
use crate::plot::Across;
use crate::trace::Setpoint;

/// A groove as it is programmed: lengths along it (Z; of one in the face the radius) and across it, in work coordinates.
#[derive(Clone, Debug)]
pub struct Groove {
    /// Its line of the program.
    pub line: u32,
    /// The number of its tool, 0 where the program has named none.
    pub tool: u32,
    /// What it goes into: X of G75, Z of G74.
    pub across: Across,
    /// The width of the tool, where it is known.
    pub width: Option<Mm>,
    /// The lowest and the highest place of the tool's programmed corner.
    pub corners: (Mm, Mm),
    /// Where the feeds begin.
    pub begin: Mm,
    /// Where they end.
    pub floor: Mm,
    /// Its moves: the first, and the one after the last feed.
    moves: (u64, u64),
    /// Work coordinates from those of the machine: radius, Z.
    origin: (Mm, Mm),
}

impl Groove {
    /// The code of its cycle.
    pub const fn code(&self) -> &'static str {
        match self.across {
            Across::X => "G75",
            Across::Z => "G74",
        }
    }

    /// Its walls as they are programmed.
    pub fn walls(&self) -> Option<[Mm; 2]> {
        Some([self.corners.0, self.corners.1 + self.width?])
    }
}

/// A cut of a contour as it is programmed.
#[derive(Clone, Copy, Debug)]
pub struct Piece {
    /// Its line of the program.
    pub line: u32,
    /// Its geometry in work coordinates.
    pub element: Element,
    /// No other cut of this tool goes deeper there: it is the surface of the part.
    pub stays: bool,
    step: u64,
}

/// What one tool turns without a thread or a groove in between.
#[derive(Clone, Debug)]
pub struct Outline {
    /// The number of its tool, 0 where the program has named none.
    pub tool: u32,
    /// The outside, or a bore.
    pub side: Side,
    /// Its cuts in order.
    pub pieces: Vec<Piece>,
    origin: (Mm, Mm),
}

impl Outline {
    /// Its first and its last line, for a person.
    pub fn lines(&self) -> [String; 2] {
        let ends = [self.pieces.first(), self.pieces.last()];
        ends.map(|piece| SourceLine(piece.map_or(0, |piece| piece.line)).to_string())
    }
}

/// All of them.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Grooves.
    pub grooves: Vec<Groove>,
    /// Turned contours.
    pub outlines: Vec<Outline>,
}

/// A groove that was cut.
#[derive(Clone, Debug)]
pub struct CutGroove {
    /// What was programmed.
    pub groove: Groove,
    /// The part about it, where the tool is known.
    pub work: Option<Work>,
    /// What was found; `None` where nothing was cut, or the tool is not known.
    pub found: Option<Recess>,
}

/// A contour that was cut.
#[derive(Clone, Debug)]
pub struct CutOutline {
    /// What was programmed.
    pub outline: Outline,
    /// What was found of each cut.
    pub found: Vec<Option<Turned>>,
}

/// Cuts them while the program runs.
#[derive(Debug)]
pub struct Turning {
    grooves: Vec<(Groove, Option<Cutter>)>,
    outlines: Vec<(Outline, Contour)>,
}

/// What was found.
#[derive(Debug, Default)]
pub struct Found {
    /// In the order of the program.
    pub grooves: Vec<CutGroove>,
    /// Likewise.
    pub outlines: Vec<CutOutline>,
}

/// Uncut material beside a groove, which no tool of it reaches. A wall in its place is in the middle between two nodes.
const BESIDE: Mm = Mm(0.501);

impl Turning {
    /// Nothing is cut yet.
    pub fn new(plan: Plan) -> Self {
        let cutter = |groove: &Groove| {
            let [from, to] = groove.walls()?;
            let stock = Stock {
                side: if groove.floor > groove.begin {
                    Side::Internal
                } else {
                    Side::External
                },
                radius: groove.begin,
                taper: 0.0,
                from: from - BESIDE,
                face: to + BESIDE,
            };
            let work = Work::new(stock, Grid::of(&stock));
            Some(Cutter::new(work, Tool::flat(groove.width?)))
        };
        let grooves = plan.grooves.into_iter().map(|groove| {
            let cutter = cutter(&groove);
            (groove, cutter)
        });
        let outlines = plan.outlines.into_iter().map(|outline| {
            let elements: Vec<Element> = outline.pieces.iter().map(|piece| piece.element).collect();
            let contour = Contour::new(&elements, outline.side);
            (outline, contour)
        });
        Self {
            grooves: grooves.collect(),
            outlines: outlines.collect(),
        }
    }

    /// A tick of the machine.
    pub fn push(&mut self, point: &Setpoint) {
        let mm = |nm: i64| Mm(nm as f64 / 1e6);
        let [x, z] = point.actual_nm.unwrap_or([point.x_nm, point.z_nm]).map(mm);
        for (groove, cutter) in &mut self.grooves {
            let Some(cutter) = cutter else { continue };
            if !(groove.moves.0..=groove.moves.1).contains(&point.step) {
                cutter.interrupt();
                continue;
            }
            let (radius, z) = (x - groove.origin.0, z - groove.origin.1);
            let (along, up) = groove.across.of((z.0, radius.0));
            // The reference of a flat edge is its middle.
            let half = groove.width.unwrap_or_default() * 0.5;
            cutter.push(Sample {
                angle: Turns(point.s1_urev as f64 / 1e6),
                x: Mm(up),
                z: Mm(along) + half,
                pass: 1,
            });
        }
        for (outline, contour) in &mut self.outlines {
            let pieces = &outline.pieces;
            if let Ok(target) = pieces.binary_search_by_key(&point.step, |piece| piece.step) {
                contour.push(target, (z - outline.origin.1, x - outline.origin.0));
            }
        }
    }

    /// What was found, where the program is over.
    pub fn finish(self) -> Found {
        let grooves = self.grooves.into_iter().map(|(groove, cutter)| {
            let work = cutter.map(Cutter::finish);
            let found = work.as_ref().and_then(recess);
            CutGroove {
                groove,
                work,
                found,
            }
        });
        let outlines = self
            .outlines
            .into_iter()
            .map(|(outline, contour)| CutOutline {
                found: contour.finish(),
                outline,
            });
        Found {
            grooves: grooves.collect(),
            outlines: outlines.collect(),
        }
    }
}
