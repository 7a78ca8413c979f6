//! A part: its surface over Z at each of some hundred angles, and the chip of each pass.

use crate::tool::{Half, Tool};
use crate::units::{Cubic, Mm, Side, Turns};

/// What is there before the first cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stock {
    /// Outer or inner surface.
    pub side: Side,
    /// Radius at the face.
    pub radius: Mm,
    /// Change of the radius per millimetre of Z.
    pub taper: f64,
    /// The end with the smaller Z.
    pub from: Mm,
    /// The face.
    pub face: Mm,
}

/// How finely the surface is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Angles of a turn, even.
    pub angles: usize,
    /// Distance between two nodes along Z.
    pub step: Mm,
}

impl Grid {
    /// 360 angles, and nodes 2 µm apart; further apart on parts that would take more than about 140 MB.
    #[must_use]
    pub fn of(stock: &Stock) -> Self {
        const ANGLES: usize = 360;
        const MOST_NODES: f64 = 100_000.0;
        let finest = (stock.face.0 - stock.from.0) / MOST_NODES;
        Self {
            angles: ANGLES,
            step: Mm(finest.max(0.002)),
        }
    }
}

/// What a pass removes on each side of the tool's middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chip {
    /// Towards −Z.
    pub minus: Cubic,
    /// Towards +Z.
    pub plus: Cubic,
}

impl Chip {
    /// Both sides.
    #[must_use]
    pub fn whole(&self) -> Cubic {
        self.minus + self.plus
    }
}

/// A part that is being cut.
#[derive(Clone, Debug)]
pub struct Work {
    stock: Stock,
    grid: Grid,
    nodes: usize,
    /// Height of each node in nanometres, angle after angle.
    heights: Vec<i32>,
    /// Highest and lowest of the stock, in millimetres.
    highest: f64,
    chips: Vec<(u32, Chip)>,
    /// Sum over the cuts: +1 where Z grew with the angle, −1 where it fell.
    course: i64,
    /// Where tools went on their helix, in millimetres along Z: what is cut beyond is no thread.
    helix: (f64, f64),
}

const NM: f64 = 1e6;

impl Work {
    /// The stock, uncut.
    #[must_use]
    pub fn new(stock: Stock, grid: Grid) -> Self {
        let length = (stock.face.0 - stock.from.0).max(grid.step.0);
        let nodes = (length / grid.step.0).floor() as usize + 1;
        let height = |k: usize| {
            let z = stock.from.0 + k as f64 * grid.step.0;
            stock
                .side
                .height(stock.radius.0 + stock.taper * (z - stock.face.0))
        };
        let line: Vec<i32> = (0..nodes)
            .map(|k| (height(k) * NM).round() as i32)
            .collect();
        let highest = line.iter().copied().max().unwrap_or(0);
        Self {
            stock,
            grid,
            nodes,
            heights: line.repeat(grid.angles),
            highest: f64::from(highest) / NM,
            chips: Vec::new(),
            course: 0,
            helix: (f64::NEG_INFINITY, f64::INFINITY),
        }
    }

    /// Says between which places the tools went on their helix. Where a tool stops in the work and the spindle turns on, it
    /// cuts a ring: that is beyond.
    pub fn keep_thread_between(&mut self, low: Mm, high: Mm) {
        self.helix = (low.0, high.0);
    }

    /// The places between which there may be thread.
    pub(crate) const fn helix(&self) -> (f64, f64) {
        self.helix
    }

    /// What it was made of.
    #[must_use]
    pub const fn stock(&self) -> &Stock {
        &self.stock
    }

    /// How finely it is kept.
    #[must_use]
    pub const fn grid(&self) -> Grid {
        self.grid
    }

    /// What each pass has removed, in the order of the passes.
    #[must_use]
    pub fn chips(&self) -> &[(u32, Chip)] {
        &self.chips
    }

    /// What has been removed in all.
    #[must_use]
    pub fn removed(&self) -> Cubic {
        self.chips
            .iter()
            .fold(Cubic(0.0), |sum, (_, chip)| sum + chip.whole())
    }

    /// +1 where the tool went towards +Z while the angle grew, else −1.
    pub(crate) const fn course(&self) -> f64 {
        if self.course > 0 { 1.0 } else { -1.0 }
    }

    /// The heights at an angle, nanometres.
    pub(crate) fn line(&self, angle: usize) -> &[i32] {
        let first = angle % self.grid.angles * self.nodes;
        &self.heights[first..first + self.nodes]
    }

    /// Z of a node.
    pub(crate) fn z(&self, node: usize) -> f64 {
        self.stock.from.0 + node as f64 * self.grid.step.0
    }

    /// The surface at an angle between two Z: Z and radius of each node.
    pub fn section(&self, angle: Turns, from: Mm, to: Mm) -> impl Iterator<Item = (Mm, Mm)> + '_ {
        let index = (angle.0.rem_euclid(1.0) * self.grid.angles as f64).round() as usize;
        let side = self.stock.side;
        let line = self.line(index).iter().enumerate();
        line.map(move |(k, u)| (Mm(self.z(k)), Mm(side.height(f64::from(*u) / NM))))
            .filter(move |(z, _)| *z >= from && *z <= to)
    }

    /// Puts the tool down at an angle: its reference at `z` and radius `x`. `course` is the sign of dz/dangle.
    pub(crate) fn stamp(
        &mut self,
        angle: usize,
        z: f64,
        x: f64,
        tool: &Tool,
        pass: u32,
        course: i64,
    ) {
        let low = self.stock.side.height(x);
        let room = self.highest - low;
        if room <= 0.0 {
            return;
        }
        let at = (z - self.stock.from.0) / self.grid.step.0;
        let first = angle % self.grid.angles * self.nodes;
        let line = &mut self.heights[first..first + self.nodes];
        let step = self.grid.step.0;
        let [minus, plus] = tool.halves();
        // Nodes at and beyond the middle, and those before it, each from the middle outwards.
        let middle = at.ceil().max(0.0) as usize;
        let end = ((at + plus.reach(room) / step).floor() + 1.0).clamp(0.0, self.nodes as f64);
        let start = (at - minus.reach(room) / step)
            .ceil()
            .clamp(0.0, self.nodes as f64);
        let (end, start) = (end as usize, start as usize);
        let begin = middle.min(self.nodes);
        let mut removed = [0.0; 2];
        if end > begin {
            removed[1] = lower(
                line[begin..end].iter_mut(),
                &plus,
                (begin as f64 - at) * step,
                step,
                low,
            );
        }
        if begin > start {
            removed[0] = lower(
                line[start..begin].iter_mut().rev(),
                &minus,
                (at - (begin as f64 - 1.0)) * step,
                step,
                low,
            );
        }
        if removed != [0.0; 2] {
            self.course += course;
        }
        let share = std::f64::consts::PI / self.grid.angles as f64 * step / (NM * NM);
        let chip = self.chip(pass);
        chip.minus = chip.minus + Cubic(removed[0] * share);
        chip.plus = chip.plus + Cubic(removed[1] * share);
    }

    fn chip(&mut self, pass: u32) -> &mut Chip {
        let known = self.chips.iter().rposition(|(number, _)| *number == pass);
        let index = known.unwrap_or_else(|| {
            self.chips.push((pass, Chip::default()));
            self.chips.len() - 1
        });
        &mut self.chips[index].1
    }
}

/// Lowers nodes to one half of an edge, from the middle outwards; gives the sum of the differences of squares (nm²).
fn lower<'a>(
    mut nodes: impl Iterator<Item = &'a mut i32>,
    half: &Half,
    from: f64,
    step: f64,
    low: f64,
) -> f64 {
    let mut removed = 0.0;
    let mut cut = |node: &mut i32, height: f64| {
        let new = (height * NM + 0.5).floor() as i32;
        if new < *node {
            let (old, new_f) = (f64::from(*node), f64::from(new));
            removed += (old - new_f) * (old + new_f).abs();
            *node = new;
        }
    };
    let (begin, rise) = half.begin;
    let in_nose = if begin >= from {
        ((begin - from) / step).floor() as usize + 1
    } else {
        0
    };
    for k in 0..in_nose {
        let Some(node) = nodes.next() else { break };
        cut(node, low + half.nose(from + k as f64 * step));
    }
    if half.slope.is_finite() {
        let mut k = in_nose as f64;
        for node in nodes {
            cut(node, low + rise + (from + k * step - begin) * half.slope);
            k += 1.0;
        }
    }
    removed
}
