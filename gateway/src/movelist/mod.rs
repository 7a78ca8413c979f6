//! The move list in its three formats. A [`Row`] is one move with everything a reader may see; each format is one file
//! that knows only how to write it.

mod csv;
mod jsonl;
mod text;

use leadscrew_core::alarm::Lang;
use leadscrew_core::call::{Aux, FeedRate, Position, SpindleMode};
use leadscrew_core::moves::{Cycle, Move, MoveKind, Stage};
use leadscrew_core::units::{LeadChange, Rpm};

use crate::cli::Format;

/// One line of the move list. Lengths in nanometres, X values are diameters, angles in millionths of a degree.
#[derive(Clone, Copy, Debug)]
struct Row {
    n: u64,
    line: u32,
    cycle: Option<&'static str>,
    pass: Option<u32>,
    start: Option<u8>,
    peck: Option<u32>,
    stage: Option<&'static str>,
    kind: &'static str,
    work: [i64; 3],
    machine: [i64; 3],
    depth: Option<i64>,
    feed: Option<i64>,
    feed_rev: Option<i64>,
    lead: Option<i64>,
    /// Change of the lead per turn.
    lead_change: Option<i64>,
    start_udeg: Option<u32>,
    /// Millionths of a turn, signed.
    rev: Option<i64>,
    /// Millionths of a turn per minute, signed.
    rpm: Option<i64>,
    mode: Option<&'static str>,
    m: Option<u16>,
    t: Option<u16>,
    ms: Option<u32>,
    arc: Option<(i64, i64, &'static str)>,
}

impl Row {
    #[inline]
    fn new(n: u64, step: &Move, origin: &Position) -> Self {
        let to = &step.to;
        let mut row = Self {
            n,
            line: step.span.line,
            cycle: None,
            pass: None,
            start: None,
            peck: None,
            stage: None,
            kind: "",
            work: [
                2 * (to.x - origin.x).nm(),
                (to.z - origin.z).nm(),
                (to.c - origin.c).udeg(),
            ],
            machine: [2 * to.x.nm(), to.z.nm(), to.c.udeg()],
            depth: None,
            feed: None,
            feed_rev: None,
            lead: None,
            lead_change: None,
            start_udeg: None,
            rev: None,
            rpm: None,
            mode: None,
            m: None,
            t: None,
            ms: None,
            arc: None,
        };
        if let Some(tag) = &step.tag {
            row.cycle = Some(cycle_name(tag.cycle));
            row.pass = Some(tag.pass);
            row.start = (tag.start != 0).then_some(tag.start);
            row.peck = (tag.peck != 0).then_some(tag.peck);
            row.stage = Some(stage_name(tag.stage));
            row.depth = Some(tag.depth.nm());
        }
        row.kind = match step.kind {
            MoveKind::Rapid => "rapid",
            MoveKind::Feed(feed) => {
                row.set_feed(feed);
                "feed"
            }
            MoveKind::Arc {
                i,
                k,
                clockwise,
                feed,
            } => {
                row.set_feed(feed);
                row.arc = Some((i.nm(), k.nm(), if clockwise { "cw" } else { "ccw" }));
                "arc"
            }
            MoveKind::Thread(thread) => {
                row.lead = Some(thread.lead.rounded().nm());
                let changes = thread.change != LeadChange::NONE;
                row.lead_change = changes.then(|| thread.change.rounded().nm());
                row.start_udeg = Some(thread.angle_udeg);
                row.rpm = Some(rpm(thread.rpm));
                "thread"
            }
            MoveKind::Dwell(time) => {
                row.ms = Some(time.get());
                "dwell"
            }
            MoveKind::Tap(tap) => {
                row.lead = Some(tap.lead.rounded().nm());
                row.rev = Some(tap.turns.micro());
                row.rpm = Some(i64::from(tap.speed.get()) * 10_000);
                "tap"
            }
            MoveKind::Spindle(spindle) => {
                row.rpm = Some(rpm(spindle.rpm));
                row.mode = Some(match spindle.mode {
                    SpindleMode::Speed => "speed",
                    SpindleMode::Rigid(_) => "rigid",
                    SpindleMode::Orient(angle) => {
                        row.start_udeg = u32::try_from(angle.udeg()).ok();
                        "orient"
                    }
                    SpindleMode::Surface(law) => {
                        let milli = i64::from(law.milli_rpm(to.x));
                        row.rpm = Some(milli * 1000 * i64::from(spindle.rpm.get().signum()));
                        row.feed = Some(law.speed.nm_per_min());
                        "surface"
                    }
                });
                "spindle"
            }
            MoveKind::Aux(Aux::M(code)) => {
                row.m = Some(code);
                "aux"
            }
            MoveKind::Aux(Aux::T(code)) => {
                row.t = Some(code);
                "aux"
            }
        };
        row
    }

    fn set_feed(&mut self, feed: FeedRate) {
        self.feed = Some(feed.nominal().nm_per_min());
        if let FeedRate::PerTurn(per_turn, _) = feed {
            self.feed_rev = Some(per_turn.nm());
        }
    }
}

fn rpm(speed: Rpm) -> i64 {
    i64::from(speed.get()) * 1_000_000
}

/// A G76 in one block has become a G78 [D226]: it is told as what was written.
pub fn name_as_written(step: &mut Move, in_one_block: bool) {
    if in_one_block
        && let Some(tag) = &mut step.tag
        && tag.cycle == Cycle::G78
    {
        tag.cycle = Cycle::G76;
    }
}

pub(crate) fn cycle_name(cycle: Cycle) -> &'static str {
    match cycle {
        Cycle::G74 => "G74",
        Cycle::G75 => "G75",
        Cycle::G76 => "G76",
        Cycle::G78 => "G78",
        Cycle::G92 => "G92",
        Cycle::G32 => "G32",
        Cycle::G34 => "G34",
        Cycle::G84 => "G84",
        Cycle::G88 => "G88",
        Cycle::G30P99 => "G30P99",
    }
}

fn stage_name(stage: Stage) -> &'static str {
    match stage {
        Stage::Approach => "approach",
        Stage::RunIn => "runin",
        Stage::Rough => "rough",
        Stage::Finish => "finish",
        Stage::RunOut => "runout",
        Stage::Retract => "retract",
        Stage::Return => "return",
        Stage::Peck => "peck",
        Stage::Relief => "relief",
        Stage::Shift => "shift",
        Stage::Clamp => "clamp",
        Stage::RPlane => "rplane",
        Stage::Tap => "tap",
        Stage::Reenter => "reenter",
        Stage::Dwell => "dwell",
        Stage::Extract => "extract",
        Stage::Unclamp => "unclamp",
    }
}

/// Appends the header of a format that has one.
pub fn header(format: Format, lang: Lang, out: &mut Vec<u8>) {
    match format {
        Format::Text => text::header(lang, out),
        Format::Jsonl => {}
        Format::Csv => csv::header(out),
    }
}

/// Appends move number `n`. `origin` turns machine into work coordinates.
#[inline]
pub fn push(format: Format, lang: Lang, out: &mut Vec<u8>, n: u64, step: &Move, origin: &Position) {
    let row = Row::new(n, step, origin);
    match format {
        Format::Text => text::row(lang, out, &row),
        Format::Jsonl => jsonl::row(out, &row),
        Format::Csv => csv::row(out, &row),
    }
}

#[cfg(test)]
mod tests {
    use leadscrew_core::alarm::Span;
    use leadscrew_core::call::SpindleCall;
    use leadscrew_core::moves::{Tag, ThreadMove};
    use leadscrew_core::units::{Angle, Feed, FeedPerTurn, Lead, Length, StartAngle};

    use super::*;

    fn at(x: i64, z: i64) -> Position {
        Position {
            x: Length::from_nm(x),
            z: Length::from_nm(z),
            c: Angle::ZERO,
        }
    }

    fn step(kind: MoveKind, tag: Option<Tag>) -> Move {
        Move {
            span: Span {
                line: 5,
                column: 1,
                end: 4,
            },
            to: at(31_454_400, -59_000_000),
            kind,
            tag,
        }
    }

    fn thread() -> Move {
        step(
            MoveKind::Thread(ThreadMove {
                lead: Lead::new(6_000_000, 1).unwrap(),
                change: LeadChange::NONE,
                pass_angle: StartAngle::INDEX,
                angle_udeg: 28_182_180,
                long_x: false,
                part: leadscrew_core::call::ChainPart::Whole,
                last: false,
                rpm: Rpm::new(300),
            }),
            Some(Tag {
                cycle: Cycle::G76,
                pass: 2,
                start: 1,
                peck: 0,
                stage: Stage::Rough,
                depth: Length::from_nm(2_545_600),
            }),
        )
    }

    fn text(format: Format, step: &Move) -> String {
        let mut out = Vec::new();
        push(
            format,
            Lang::En,
            &mut out,
            12,
            step,
            &at(1_000_000, 1_000_000),
        );
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn json_lines_follow_the_order_of_the_contract() {
        assert_eq!(
            text(Format::Jsonl, &thread()),
            "{\"n\":12,\"line\":5,\"cycle\":\"G76\",\"pass\":2,\"start\":1,\"stage\":\"rough\",\"kind\":\"thread\",\
             \"x\":60.9088,\"z\":-60,\"c\":0,\"mx\":62.9088,\"mz\":-59,\"mc\":0,\"depth\":2.5456,\"lead\":6,\
             \"start_deg\":28.18218,\"rpm\":300}\n"
        );
        let per_turn = FeedRate::PerTurn(FeedPerTurn::from_nm(150_000), Rpm::new(500));
        assert_eq!(
            text(Format::Jsonl, &step(MoveKind::Feed(per_turn), None)),
            "{\"n\":12,\"line\":5,\"kind\":\"feed\",\"x\":60.9088,\"z\":-60,\"c\":0,\"mx\":62.9088,\"mz\":-59,\"mc\":0,\
             \"feed\":75,\"feed_rev\":0.15}\n"
        );
        let arc = MoveKind::Arc {
            i: Length::from_nm(-500),
            k: Length::from_nm(2_000_000),
            clockwise: true,
            feed: FeedRate::PerMinute(Feed::from_nm_per_min(100_000_000)),
        };
        assert!(
            text(Format::Jsonl, &step(arc, None))
                .ends_with("\"feed\":100,\"i\":-0.0005,\"k\":2,\"dir\":\"cw\"}\n")
        );
    }

    #[test]
    fn every_json_line_parses() {
        for kind in [
            MoveKind::Rapid,
            MoveKind::Dwell(leadscrew_core::units::Millis::new(2000)),
            MoveKind::Spindle(SpindleCall::rigid(Rpm::new(-300), Default::default())),
            MoveKind::Aux(Aux::M(30)),
            MoveKind::Aux(Aux::T(101)),
        ] {
            let line = text(Format::Jsonl, &step(kind, None));
            assert!(
                serde_json::from_str::<serde_json::Value>(&line).is_ok(),
                "{line}"
            );
        }
    }

    #[test]
    fn csv_has_a_field_for_each_column() {
        let mut header_line = Vec::new();
        header(Format::Csv, Lang::En, &mut header_line);
        let header_line = String::from_utf8(header_line).unwrap();
        assert_eq!(
            header_line,
            "n,line,file,o,call,cycle,pass,start,peck,stage,kind,x,z,c,mx,mz,mc,depth,feed,feed_rev,lead,start_deg,rev,\
             rpm,mode,m,t,ms,i,k,dir,lead_change\n"
        );
        let row = text(Format::Csv, &thread());
        assert_eq!(row.matches(',').count(), header_line.matches(',').count());
        assert_eq!(
            row,
            "12,5,,,,G76,2,1,,rough,thread,60.9088,-60,0,62.9088,-59,0,2.5456,,,6,28.18218,,300,,,,,,,,\n"
        );
    }
}
