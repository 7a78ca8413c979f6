//! `params validate`: whether the set that `--params` and `--set` make can work, and what the encoder is good for.

use leadscrew_core::params::{Entry, Params};
use leadscrew_core::units::{Lead, Length, Rpm};

use crate::cli::Global;
use crate::failure::{Failure, Outcome};
use crate::json::Json;
use crate::output;
use crate::words::{Both, both};
use crate::{diagnostics, number, params};

/// Tells everything that is wrong; exit 1 where an alarm is among it.
pub fn run(global: &Global) -> Outcome {
    let lang = global.lang();
    let loaded = params::load(&global.params, &global.set, lang)?;
    let encoder = loaded.is_good().then(|| Encoder::of(&loaded.params));
    if global.json {
        let line = output::line(|json| {
            json.flag("ok", loaded.is_good());
            loaded.report_fields(json);
            if let Some(encoder) = &encoder {
                json.object_at("encoder", |json| encoder.fields(json));
            }
        });
        output::write(&line)?;
    } else {
        loaded.tell(diagnostics::colour());
        if let Some(encoder) = &encoder {
            let set = Entry::all().iter().filter(|e| loaded.source(e).is_some());
            let (all, set) = (Entry::all().len(), set.count());
            let good = both!(
                "good: {all} values, {set} of them set here, the others the built-in machine's",
                "正确：共 {all} 个值，其中 {set} 个在此设定，其余为内置机床的值"
            );
            let encoder = encoder.text();
            let (good, encoder) = (good.get(lang), encoder.get(lang));
            output::write(format!("{good}\n{encoder}\n").as_bytes())?;
        }
    }
    encoder.map(drop).ok_or(Failure::Wrong)
}

/// What the encoder of the spindle is good for.
struct Encoder {
    counts: u32,
    /// The lowest speeds in threads, and in ordinary taps.
    thread: Rpm,
    tap: Rpm,
    /// A count, along a lead of a millimetre.
    count: Length,
    /// How far an axis may be beside the spindle's angle, along the same lead; where the angle is learned from counts
    /// without times. Of others the ripple of the spindle decides, which nobody knows here.
    error: Option<Length>,
}

impl Encoder {
    fn of(params: &Params) -> Self {
        let encoder = params.resolution();
        let lead = Length::from_nm(1_000_000);
        Self {
            counts: encoder.counts,
            thread: encoder.slowest_of_thread(),
            tap: encoder.slowest_of_tap(),
            count: Length::from_nm(lead.nm() / i64::from(encoder.counts.max(1))),
            // At the highest speed: a tick is longer than a count there.
            error: Lead::new(lead.nm(), 1)
                .and_then(|lead| encoder.uncertainty(lead, Rpm::new(i32::MAX))),
        }
    }

    fn fields(&self, json: &mut Json) {
        json.integer("counts", i64::from(self.counts));
        json.integer("thread_rpm_min", i64::from(self.thread.get()));
        json.integer("tap_rpm_min", i64::from(self.tap.get()));
        json.decimal::<6>("count_mm_of_1_mm", self.count.nm());
        if let Some(error) = self.error {
            json.decimal::<6>("error_mm_of_1_mm", error.nm());
        }
    }

    fn text(&self) -> Both {
        let beside = self.error.map_or(Both::default(), |error| {
            let error = number::text::<6>(error.nm());
            both!(
                ", and a thread may be {error} mm beside the angle",
                "，螺纹与主轴角度之差不超过 {error} mm"
            )
        });
        both!(
            "encoder of the spindle, {counts} counts: threads from {thread} rpm, ordinary taps from {tap} rpm; of a lead of 1 mm \
             a count is {count} mm{beside_en}",
            "主轴编码器，每转 {counts} 计数：螺纹最低 {thread} r/min，浮动攻丝最低 {tap} r/min；导程 1 mm 时一个计数为 \
             {count} mm{beside_zh}",
            counts = self.counts,
            thread = self.thread.get(),
            tap = self.tap.get(),
            count = number::text::<6>(self.count.nm()),
            beside_en = beside.en,
            beside_zh = beside.zh,
        )
    }
}
