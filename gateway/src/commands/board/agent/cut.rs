//! What is told of the cut of a thread: the judgement of `run`, as a record.

use leadscrew_agent::record::{Cut, Figure, Measured};
use leadscrew_core::alarm::Lang;
use leadscrew_core::link::{ThreadCertificate, ThreadKind, ThreadState};

use super::set::Sets;
use crate::certified::{self, Judge, is_complete, nothing};
use crate::link::{Link, LinkResult, Trouble};

/// Judges what one board measured, by its own parameters.
#[derive(Debug, Default)]
pub struct Cuts {
    judge: Option<(u32, Judge)>,
}

impl Cuts {
    /// Each certificate behind `last` with its cut. `parameters`: the checksum of those in force.
    ///
    /// # Errors
    /// The board does not answer.
    pub fn judge(
        &mut self,
        link: &mut Link,
        sets: &mut Sets,
        parameters: u32,
        last: u32,
        threads: Vec<ThreadCertificate>,
        lang: Lang,
    ) -> LinkResult<Vec<(ThreadCertificate, Cut)>> {
        let mut judged = Vec::new();
        for thread in threads {
            let record = &thread.record;
            let is_told = thread.number > last && record.state != ThreadState::UnderWay;
            let cut = match record.kind {
                _ if !is_told => Cut::NotRead,
                ThreadKind::Thread => match self.known(link, sets, parameters)? {
                    Ok(judge) => of(judge, &thread, lang),
                    Err(trouble) => Cut::Unknown(trouble.words().get(lang).to_owned()),
                },
                ThreadKind::RigidTap | ThreadKind::FloatingTap => Cut::Hole,
            };
            judged.push((thread, cut));
        }
        Ok(judged)
    }

    fn known<'a>(
        &'a mut self,
        link: &mut Link,
        sets: &'a mut Sets,
        parameters: u32,
    ) -> LinkResult<Result<&'a Judge, &'a Trouble>> {
        let params = match sets.get(link, parameters)? {
            Ok(params) => params,
            Err(trouble) => return Ok(Err(trouble)),
        };
        let judge = self.judge.take().filter(|(of, _)| *of == parameters);
        let judge = judge.unwrap_or_else(|| (parameters, Judge::new(params, None)));
        Ok(Ok(&self.judge.insert(judge).1))
    }
}

fn of(judge: &Judge, thread: &ThreadCertificate, lang: Lang) -> Cut {
    let record = &thread.record;
    let cut = &record.cut;
    let Some(found) = judge.found(cut) else {
        return Cut::Unknown(nothing().get(lang).to_owned());
    };
    let (axis, age_known) = judge.axis(cut);
    let why = judge.missing(record);
    Cut::Measured(Measured {
        axis,
        age_known,
        positions: cut.samples,
        passes: cut.passes,
        lead_nm: cut.lead().nm(),
        grooves: found.grooves.map(|both| both.map(figure)),
        apart: found.apart.map(figure),
        slope: found.lead.map(figure),
        worst: figure(found.worst),
        complete: is_complete(record),
        why: why.map_or_else(String::new, |why| why.get(lang).to_owned()),
    })
}

/// As `run --json` rounds it.
fn figure(of: certified::Figure) -> Figure {
    let [nm, u_nm] = of.whole();
    Figure(nm, u_nm)
}

#[cfg(test)]
mod tests {
    use leadscrew_core::link::{CutTally, PassCut, Tally, ThreadRecord};
    use leadscrew_core::params::Params;
    use leadscrew_core::units::Length;

    use super::*;

    fn thread(positions: u16, grooves: &[i64], strokes: u16) -> ThreadCertificate {
        let nm = Length::from_nm;
        let mut cut = CutTally::NONE;
        for _ in 0..positions {
            cut.take(nm(-2_500), nm(10), nm(1_500_000), nm(10_000_000));
        }
        for groove in grooves {
            cut.close(&PassCut {
                groove: nm(*groove),
                slope: nm(-40),
                scatter: nm(64),
            });
        }
        ThreadCertificate {
            number: 1,
            record: ThreadRecord {
                line: 3,
                kind: ThreadKind::Thread,
                state: ThreadState::Finished,
                tally: Tally {
                    passes: strokes,
                    ..Tally::NONE
                },
                cut,
            },
        }
    }

    fn judged(thread: &ThreadCertificate) -> Cut {
        of(&Judge::new(&Params::slant_bed(), None), thread, Lang::En)
    }

    #[test]
    fn figures_are_those_of_run() {
        let thread = thread(90, &[-700, 500], 2);
        let Cut::Measured(told) = judged(&thread) else {
            panic!("no figures");
        };
        let judge = Judge::new(&Params::slant_bed(), None);
        let found = judge.found(&thread.record.cut).unwrap();
        assert_eq!(told.worst.0, 2_500);
        assert_eq!(told.worst.1, found.worst.u_nm.ceil() as i64);
        assert!(told.worst.1 > 0);
        assert_eq!(
            told.grooves.map(|both| both.map(|of| of.0)),
            Some([-700, 500])
        );
        assert_eq!(told.apart.map(|of| of.0), Some(1_200));
        assert_eq!(told.slope.map(|of| of.0), Some(-40));
        assert_eq!((told.axis, told.passes, told.positions), ('Z', 2, 90));
        assert_eq!((told.lead_nm, told.complete), (1_500_000, true));
    }

    #[test]
    fn what_is_not_known_is_told_in_the_words_of_run() {
        let none = thread(0, &[], 3);
        let judge = Judge::new(&Params::slant_bed(), None);
        let words = judge.words(&none.record).unwrap().en;
        assert_eq!(judged(&none), Cut::Unknown(words));
        for (grooves, part) in [
            (&[][..], "groove not known (a pass has too few positions"),
            (&[1, 2], "groove known of 2 passes of 3 alone"),
        ] {
            let cut = judged(&thread(9, grooves, 3));
            assert_eq!(cut.known(), "partly");
            assert!(cut.why().unwrap().contains(part), "{cut:?}");
        }
        let age = judged(&thread(9, &[1], 1));
        assert_eq!(age.known(), "yes");
        let known = age.measured().unwrap().age_known;
        assert_eq!(age.why().is_none(), known, "{age:?}");
    }
}
