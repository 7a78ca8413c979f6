//! G75, G76 and G78: the sheets' examples as printed, and each rule for words left out.

use super::*;
use crate::units::{Feed, Lead};

const O0013: &str = "O0013; (系统最小输入增量为 0.0001mm)
G50 X100 Z50 M3 S300; (设置工件坐标系启动主轴，指定转速)
G04 X2; (延时 2s，主轴转速稳定)
G00 X80 Z10; (快速移动到加工起点)
G76 P020560 Q1500 R0.1; (精加工重复次数 2，倒角宽度 3mm，刀具角度 60°，最小切入深度 0.15，精车余量 0.1)
G76 X60.64 Z-62 P36800 Q18000 F6; (螺纹牙高 3.68，第一螺纹切削深度 1.8)
G00 X100 Z50 ; (返回程序起点)
M30; (程序结束)";

const O0008: &str = "O0008;

G00 X150 Z50 M3 S500; (快速定位，启动主轴，指定转速500)

G0 X125 Z-24; (定位到加工起点，起点或加工终点根据对刀点、刀宽计算)

G75 R0.5 F150; (加工循环)

G75 X40 Z-50 P60000 Q30000; (X轴每次进刀6mm,退刀0.5mm,进给到终点(X40)后,快速

返回到起点(X125), Z轴进刀3mm, 循环以上步骤继续运行)

G0 X150 Z50; (返回到加工起点)

M30; (程序结束)
";

const G78: &str = "G00 X80 Z10	（快速定位至加工起点）
G78 P020545 Q0.15 R0.5	（精加工重复次数 2，刀具角度 45° 最小切入深度 0.15，精车余量 0.5）
G78 X60 Z-60 P3 Q1.8 F300 J1.5 K2	（螺纹牙高 3mm（总切深），第一次螺纹切削深度 1.8mm，长轴方向退尾 2mm，短轴方向退尾 1.5mm）
G00 X80 Z10	
";

fn thread(text: &str) -> ThreadCall {
    thread_with(text, &Params::sheets(), Options::default())
}

fn thread_with(text: &str, params: &Params, options: Options) -> ThreadCall {
    let (events, alarm) = read_with(text.as_bytes(), params, options);
    assert_eq!(alarm, None, "{text}");
    events
        .into_iter()
        .rev()
        .find_map(|event| match event {
            Event::Call(Call {
                kind: CallKind::Thread(call),
                ..
            }) => Some(call),
            _ => None,
        })
        .unwrap_or_else(|| panic!("no thread in {text}"))
}

fn groove(text: &str) -> GrooveCall {
    kinds(text)
        .into_iter()
        .rev()
        .find_map(|kind| match kind {
            CallKind::Groove(call) => Some(call),
            _ => None,
        })
        .unwrap_or_else(|| panic!("no groove in {text}"))
}

/// J and K in micrometres.
fn run_out(call: &ThreadCall) -> Option<(i64, i64)> {
    let run_out = call.run_out?;
    Some((
        run_out.short.value.nm() / 1_000,
        run_out.long.value.nm() / 1_000,
    ))
}

#[test]
fn o0013_as_printed() {
    let calls = calls(O0013);
    let lines: Vec<u32> = calls.iter().map(|call| call.span.line).collect();
    assert_eq!(lines, [2, 3, 4, 6, 7, 8]);
    assert_eq!(calls[0].kind, spindle(300));
    // The tool stood at the machine's zero when G50 called that X100 Z50.
    assert_eq!(calls[0].origin, at(-1_000_000, -500_000));
    assert_eq!(calls[2].kind, CallKind::Rapid(at(-200_000, -400_000)));
    let CallKind::Thread(thread) = calls[3].kind else {
        panic!("{:?}", calls[3]);
    };
    assert_eq!(thread.cycle, ThreadCycle::G76);
    assert_eq!(thread.start, at(-200_000, -400_000));
    assert_eq!(thread.end_x.value, um(30_320 - 50_000));
    assert_eq!(thread.end_x.span, span(6, 5, 11));
    assert_eq!(thread.end_z.value, mm(-112));
    assert_eq!(thread.height.value, um(3_680));
    assert_eq!(thread.height.span, span(6, 17, 23));
    assert_eq!(thread.first_depth.value, um(1_800));
    assert_eq!(thread.min_step.value, um(150));
    assert_eq!(thread.min_step.span, span(5, 13, 18));
    assert_eq!(thread.allowance.value, um(100));
    assert_eq!(thread.taper.value, mm(0));
    assert_eq!((thread.finish_passes.value, thread.angle.value), (2, 60));
    assert_eq!(thread.finish_passes.span, span(5, 5, 12));
    assert_eq!(run_out(&thread), Some((3_000, 3_000)));
    assert_eq!(Some(thread.lead.value), Lead::new(6_000_000, 1));
    assert_eq!(thread.rpm, Rpm::new(300));
    assert_eq!(thread.increment, Length::from_nm(100));
    assert_eq!(thread.cut_in.value, CutIn::Trailing);
    assert_eq!(thread.starts.value, 1);
    assert_eq!(calls[4].kind, CallKind::Rapid(at(0, 0)));
    assert_eq!(calls[5].kind, CallKind::End(30));
}

#[test]
fn o0008_as_printed() {
    let calls = calls(O0008);
    assert_eq!(calls.len(), 6);
    assert_eq!(calls[0].kind, spindle(500));
    let CallKind::Groove(groove) = calls[3].kind else {
        panic!("{:?}", calls[3]);
    };
    assert_eq!(calls[3].span, span(9, 1, 4));
    assert_eq!(groove.start, at(1_250_000, -240_000));
    assert_eq!(groove.end_x.value, mm(20));
    assert_eq!(groove.end_z.value, mm(-50));
    assert!(groove.last_written);
    assert_eq!(groove.peck.map(|peck| peck.value), Some(mm(3)));
    assert_eq!(groove.step.map(|step| step.value), Some(mm(3)));
    assert_eq!(groove.relief.value, mm(0));
    assert_eq!(groove.retract.value, um(500));
    assert_eq!(
        groove.feed,
        FeedRate::PerMinute(Feed::from_nm_per_min(150_000_000))
    );
    assert_eq!(calls[5].span.line, 15);
}

#[test]
fn g78_as_printed() {
    let (events, alarm) = read(G78);
    assert_eq!(alarm, None);
    let Event::Warning(warning) = events[1] else {
        panic!("{events:?}");
    };
    assert_eq!((warning.number(), warning.span), (4900, span(2, 5, 12)));
    assert_eq!(events.len(), 4);
    let thread = thread(G78);
    assert_eq!(thread.cycle, ThreadCycle::G78);
    assert_eq!((thread.finish_passes.value, thread.angle.value), (2, 45));
    assert_eq!(thread.cut_in.value, CutIn::Centre);
    assert_eq!(thread.infeed, Infeed::Decreasing);
    assert_eq!(thread.height.value, mm(3));
    assert_eq!(thread.first_depth.value, um(1_800));
    assert_eq!(thread.min_step.value, um(150));
    assert_eq!(thread.allowance.value, um(500));
    assert_eq!(run_out(&thread), Some((1_500, 2_000)));
    assert_eq!(Some(thread.lead.value), Lead::new(300_000_000, 1));
    assert_eq!(thread.rpm, Rpm::STOPPED);
}

#[test]
fn p_is_read_by_its_digits() {
    let parts = |p: &str| {
        let text = std::format!("G0 X80 Z10\nG76 {p}\nG76 X60 Z-20 P10000 Q3000 F2");
        let call = thread(&text);
        (
            call.finish_passes.value,
            run_out(&call).map(|run| run.1),
            call.angle.value,
        )
    };
    assert_eq!(parts("P5"), (1, Some(1_000), 5));
    assert_eq!(parts("P55"), (1, Some(1_000), 55));
    assert_eq!(parts("P355"), (1, Some(600), 55));
    assert_eq!(parts("P1055"), (1, Some(2_000), 55));
    assert_eq!(parts("P0055"), (1, None, 55));
    assert_eq!(parts("P31055"), (3, Some(2_000), 55));
    assert_eq!(parts("P031055"), (3, Some(2_000), 55));
    assert_eq!(parts("P000000"), (0, None, 0));
    assert_eq!(parts(""), (1, Some(1_000), 60));
    assert_eq!(parts("P031055\nG76 P29"), (1, Some(1_000), 29));
}

#[test]
fn the_first_block_may_be_missing_and_stays_when_written() {
    let call = thread("G0 X80 Z10\nG76 X60 Z-20 P10000 Q3000 F2");
    assert_eq!(call.min_step.value, um(100));
    assert_eq!(call.allowance.value, um(100));
    assert_eq!(call.min_step.span, Span::default());
    let call = thread(
        "G0 X80 Z10\nG76 P020560 Q500 R0.2\nG76 X60 Z-20 P10000 Q3000 F2\nG0 X81\nG76 R0.3\nG78 R.9\nG76 X60 Z-20 P10000 Q3000",
    );
    assert_eq!(call.min_step.value, um(50));
    assert_eq!(call.allowance.value, um(300));
    assert_eq!(call.finish_passes.value, 2);
}

#[test]
fn run_out_of_g76_is_for_one_cycle() {
    let cycle = "G76 X60 Z-20 P10000 Q3000 F2";
    let of = |first: &str, words: &str| {
        run_out(&thread(&std::format!(
            "G0 X80 Z10\n{first}\n{cycle} {words}"
        )))
    };
    assert_eq!(of("", ""), Some((1_000, 1_000)));
    assert_eq!(of("", "J2"), Some((2_000, 2_000)));
    assert_eq!(of("", "K3"), Some((1_000, 3_000)));
    assert_eq!(of("", "K0"), Some((1_000, 1_000)));
    assert_eq!(of("", "J2 K0"), Some((2_000, 2_000)));
    assert_eq!(of("", "J0 K3"), None);
    assert_eq!(of("G76 P0060", "K3"), None);
    assert_eq!(of("G76 J2 K3", ""), Some((2_000, 3_000)));
    assert_eq!(of("G76 J2 K3", "J1"), Some((1_000, 3_000)));
    // The second cycle knows nothing of the first one's words.
    assert_eq!(
        of(&std::format!("G76 J2 K3\n{cycle}"), ""),
        Some((1_000, 1_000))
    );
    assert_eq!(of("G78 J2 K3", ""), Some((1_000, 1_000)));
}

#[test]
fn run_out_of_g78_is_modal_as_a_pair() {
    let cycle = "G78 X60 Z-20 P1 Q0.3 F2";
    let of = |before: &str, words: &str| {
        run_out(&thread(&std::format!(
            "G0 X80 Z10\n{before}\n{cycle} {words}"
        )))
    };
    assert_eq!(of("", ""), Some((1_000, 1_000)));
    assert_eq!(of("", "K3"), Some((1_000, 3_000)));
    assert_eq!(of("", "J3"), Some((3_000, 3_000)));
    assert_eq!(of("", "J0"), None);
    assert_eq!(of("G78 J2", "K3"), Some((2_000, 3_000)));
    assert_eq!(of("G78 J2 K4", "K3"), Some((2_000, 3_000)));
    let pair = std::format!("{cycle} J2 K3");
    assert_eq!(of(&pair, ""), Some((2_000, 3_000)));
    assert_eq!(of(&pair, "J4"), Some((4_000, 4_000)));
    assert_eq!(of(&std::format!("{cycle} J0"), ""), None);
    // What the words leave out follows the lead of each thread, not of the one that brought the words.
    let coarse = "G78 X60 Z-20 P1 Q0.3 F4";
    assert_eq!(of(&std::format!("{coarse} K3"), ""), Some((1_000, 3_000)));
    assert_eq!(of(&std::format!("{coarse} K0"), ""), Some((1_000, 1_000)));
}

#[test]
fn a_run_out_of_the_lead_keeps_what_lies_between_nanometres() {
    // 0.5 · 25.4/11 mm = 1 154 545 + 5/11 nm.
    let call = thread("G0 X80 Z10\nG76 X60 Z-20 P10000 Q3000 I11");
    let run_out = call.run_out.expect("by 019");
    assert_eq!(run_out.short.value, Length::from_nm(1_154_545));
    assert_eq!(run_out.long.value, run_out.short.value);
    let rest = Remainder::from_raw(((5 << Remainder::BITS) / 11) as i16);
    assert_eq!((run_out.short_rest, run_out.long_rest), (rest, rest));
    // A written J has none.
    let call = thread("G0 X80 Z10\nG76 X60 Z-20 P10000 Q3000 I11 J1");
    let run_out = call.run_out.expect("written");
    assert_eq!(run_out.short_rest, Remainder::ZERO);
}

#[test]
fn words_of_g78_in_either_block() {
    let call = |first: &str, second: &str| {
        thread(&std::format!(
            "G0 X80 Z10\n{first}\nG78 X60 Z-20 P1 Q0.3 F2 {second}"
        ))
    };
    assert_eq!(call("", "").infeed, Infeed::Decreasing);
    assert_eq!(call("G78 D0", "").infeed, Infeed::Equal);
    assert_eq!(call("G78 D0", "D1").infeed, Infeed::Decreasing);
    assert_eq!(call("G78 E1.5", "").run_in.value, um(1_500));
    assert_eq!(call("G78 E1.5", "E2").run_in.value, mm(2));
    assert_eq!(
        call("G78 E1.5\nG78 X60 Z-20 P1 Q0.3 F2", "").run_in.value,
        mm(0)
    );
    assert_eq!(call("G78 L3", "").starts.value, 3);
    assert_eq!(
        call("G78 L3\nG78 X60 Z-20 P1 Q0.3 F2 L2", "").starts.value,
        2
    );
    let modes = [
        ("P10060", CutIn::Centre),
        ("P10160", CutIn::Left),
        ("P10260", CutIn::Right),
        ("P10360", CutIn::RightCentre),
        ("P10460", CutIn::LeftRight),
        ("P60", CutIn::Centre),
    ];
    for (p, mode) in modes {
        assert_eq!(call(&std::format!("G78 {p}"), "").cut_in.value, mode, "{p}");
    }
}

#[test]
fn the_lead_is_apart_from_the_feed() {
    let cycle = "G76 X60 Z-20 P10000 Q3000";
    assert_eq!(alarm(&std::format!("G0 X80 Z10 F2\n{cycle}")).number(), 313);
    let call = thread(&std::format!(
        "G0 X80 Z10\n{cycle} F1.5\nG1 X80 F200\n{cycle}"
    ));
    assert_eq!(Some(call.lead.value), Lead::new(1_500_000, 1));
    assert_eq!(call.lead.span.line, 2);
    // The lead is no feed either.
    assert_eq!(
        alarm(&std::format!("G0 X80 Z10\n{cycle} F1.5\nG1 X70")).number(),
        4034
    );
    let call = thread(&std::format!("G0 X80 Z10\n{cycle} F1.5\n{cycle} I11.5"));
    assert_eq!(Some(call.lead.value), Lead::new(254_000_000, 115));
    let call = thread(&std::format!("G0 X80 Z10\n{cycle} I8\n{cycle} F2"));
    assert_eq!(Some(call.lead.value), Lead::new(2_000_000, 1));
    let call = thread("G20\nG0 X8 Z1\nG78 X6 Z-2 P.1 Q.03 F.125");
    assert_eq!(Some(call.lead.value), Lead::new(3_175_000, 1));
    let call = thread("G20\nG0 X8 Z1\nG78 X6 Z-2 P.1 Q.03 I13");
    assert_eq!(Some(call.lead.value), Lead::new(25_400_000, 13));
    let call = thread("G0 X80 Z10\nG76 F3\nG76 X60 Z-20 P10000 Q3000");
    assert_eq!(Some(call.lead.value), Lead::new(3_000_000, 1));
}

#[test]
fn p_and_q_follow_the_dialect() {
    let options = Options {
        dialect: Dialect::Gsk988,
        ..Options::default()
    };
    let params = Params::sheets();
    let text = "G0 X80 Z10\nG76 P20560 Q.05 R.1\nG76 X60 Z-20 P1.5 Q.4 F2";
    let call = thread_with(text, &params, options);
    assert_eq!(call.height.value, um(1_500));
    assert_eq!(call.first_depth.value, um(400));
    assert_eq!(call.min_step.value, um(50));
    assert_eq!(alarm(text).number(), 4045);
    let inch = thread("G20 G0 X3 Z1\nG76 X2 Z-1 P6000 Q1500 I10");
    assert_eq!(inch.height.value, Length::from_nm(6000 * 254));
    assert_eq!(inch.increment, Length::from_nm(254));
}

#[test]
fn words_of_g75() {
    let of = |text: &str| groove(&std::format!("G0 X50 Z0 G98 F100\n{text}"));
    let call = of("G75 X40 P20000");
    assert!(!call.last_written && call.step.is_none());
    assert_eq!(call.end_z.value, mm(0));
    assert_eq!(call.retract.value, um(500));
    assert_eq!(call.retract.span, Span::default());
    let call = of("G75 R1\nG75 U-10 W-6 P20000 Q30000 R0.2");
    assert_eq!((call.end_x.value, call.end_z.value), (mm(20), mm(-6)));
    assert_eq!(call.retract.value, mm(1));
    assert_eq!(call.relief.value, um(200));
    let call = of("G75 X40 Z0 P20000");
    assert!(call.last_written && call.step.is_none());
    // An odd increment of a diameter has an exact half.
    let call = of("G75 X40 P3");
    assert_eq!(call.peck.map(|peck| peck.value), Some(Length::from_nm(150)));
    assert_eq!(
        of("G75 X40 P20000 Q5").step.map(|step| step.value),
        Some(Length::from_nm(500))
    );
}

#[test]
fn cycles_leave_position_and_motion_as_they_were() {
    let calls = calls("G0 X80 Z10\nG1 X79 F100\nG78 X60 Z-20 P1 Q.3 F2\nX78");
    assert_eq!(
        calls[3].kind,
        CallKind::Line(
            at(780_000, 100_000),
            FeedRate::PerMinute(Feed::from_nm_per_min(100_000_000))
        )
    );
}
