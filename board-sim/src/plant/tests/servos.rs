//! Drives that are not ideal, on the bus: what they report, when they fail, and what is odd about them.

extern crate std;

use core::time::Duration;
use std::vec::Vec;

use super::super::*;
use leadscrew_core::bus::{
    AxisMode, Controlword, DriveCommand, DriveStatus, Emcy, Mode, NmtCommand, Object, SdoBuffer,
    SdoProtocol, SdoUpload, SyncProducer,
};
use leadscrew_core::params::Entry;
use leadscrew_core::units::{Acceleration, Feed, Length};

const Z: NodeId = NodeId::DRIVE_Z;

/// Kv 30, nothing else: an increment of the slant bed is 100 nm.
fn options() -> ServoOptions {
    ServoOptions {
        speed_limit: Feed::from_nm_per_min(30_000_000_000),
        acceleration_limit: Acceleration::from_nm_per_s2(6_000_000_000),
        ..ServoOptions::LOOPS_ALONE
    }
}

/// The drive of Z under commands by hand.
struct Bench {
    plant: Plant,
    sync: SyncProducer,
    heard: Vec<Frame>,
}

impl Bench {
    fn new(servo: ServoOptions) -> Self {
        Self::with(&Params::sheets(), servo)
    }

    /// With torque, at zero.
    fn with(params: &Params, servo: ServoOptions) -> Self {
        let options = PlantOptions {
            servos: [None, Some(servo)],
            ..PlantOptions::default()
        };
        let mut bench = Self {
            plant: Plant::new(params, &options).unwrap(),
            sync: SyncProducer::new(),
            heard: Vec::new(),
        };
        bench.tick(None);
        bench.plant.hear(&NmtCommand::Start.frame(None), |_| {});
        for control in [0x06, 0x07, 0x0F] {
            bench.tick(Some((control, 0)));
        }
        assert_eq!(bench.power(), Power::Enabled);
        bench
    }

    /// A period up to a SYNC that latches this controlword and target.
    fn tick(&mut self, command: Option<(u16, i32)>) {
        if let Some((control, target)) = command {
            let command = DriveCommand {
                control: Controlword::from_raw(control),
                target: Increments::new(target),
            };
            self.plant.exchange(&[command.frame(Z)], |_| {});
        }
        self.plant.advance();
        self.heard.clear();
        let heard = &mut self.heard;
        self.plant
            .exchange(&[self.sync.next()], |frame| heard.push(frame));
    }

    fn go(&mut self, target: i32) {
        self.tick(Some((0x0F, target)));
    }

    fn power(&mut self) -> Power {
        self.plant.drive(Axis::Z).power()
    }

    fn place(&mut self) -> i64 {
        self.plant.drive(Axis::Z).place()
    }

    fn emergencies(&self) -> Vec<u16> {
        let ours = self.heard.iter().filter_map(Emcy::decode);
        ours.map(|(node, emcy)| {
            assert_eq!(node, Z);
            emcy.code
        })
        .collect()
    }

    fn read(&mut self, index: u16) -> Option<u32> {
        self.read_sub(index, 0)
    }

    fn read_sub(&mut self, index: u16, sub: u8) -> Option<u32> {
        let mut bytes = [0; 8];
        let mut buffer = SdoBuffer::new(&mut bytes);
        let (object, patience) = (Object::new(index, sub), Duration::from_secs(1));
        let short = SdoProtocol::Short;
        let now = Duration::ZERO;
        let mut upload = SdoUpload::new(Z, object, &mut buffer, short, patience, now);
        while let Some(request) = upload.poll(now) {
            let mut answers = Vec::new();
            self.plant.hear(&request, |frame| answers.push(frame));
            for answer in answers {
                upload.receive(&answer, now);
            }
        }
        upload.outcome()?.ok()?;
        let mut raw = [0; 4];
        raw[..buffer.bytes().len()].copy_from_slice(buffer.bytes());
        Some(u32::from_le_bytes(raw))
    }
}

#[test]
fn the_bus_is_told_where_the_encoder_is_and_the_truth_knows_the_tool() {
    let play = Length::from_nm(10_000);
    let mut bench = Bench::new(ServoOptions { play, ..options() });
    let mut told = 0;
    for k in 1..=2000 {
        // 30 mm/s.
        bench.go(k * 300);
        let statuses = bench.heard.iter().filter_map(DriveStatus::decode);
        let ours = statuses.filter(|(node, _)| *node == Z);
        for (_, status) in ours.collect::<Vec<_>>() {
            assert_eq!(i64::from(status.actual.get()), bench.place());
            told += 1;
        }
    }
    assert_eq!(told, 500);
    // At the last SYNC its interpolation has reached the target before the one just latched.
    let behind = 600_000 - 300 - bench.place();
    assert!(
        (behind - 9962).abs() <= 1,
        "30 mm/s · (1/30 s - 125 µs): {behind}"
    );
    assert_eq!(bench.read(0x6064), Some(bench.place() as u32));
    // 60F4h.
    assert_eq!(
        bench
            .read(0x60F4)
            .map(|error| (error as i64 - behind).abs() <= 1),
        Some(true)
    );
    let truth = bench.plant.truth();
    let tool = truth.loads[1].unwrap().nm();
    // The count is whole, and the tool is half the play behind.
    assert!(
        (tool + 5000 - bench.place() * 100).unsigned_abs() <= 100,
        "{tool}"
    );
    assert_eq!(truth.loads[0], None, "X is an ideal drive");
}

#[test]
fn an_ideal_drive_has_no_following_error() {
    let mut bench = Bench::new(options());
    bench.plant = Plant::new(&Params::sheets(), &PlantOptions::default()).unwrap();
    bench.tick(None);
    for index in [0x6065, 0x6066, 0x60F4] {
        assert_eq!(bench.read(index), None);
    }
    assert_eq!(bench.plant.truth().loads, [None, None]);
}

#[test]
fn a_following_error_too_large_for_too_long_is_a_fault_that_can_be_reset() {
    let mut bench = Bench::new(ServoOptions {
        following: Some((Length::from_nm(500_000), 10)),
        ..options()
    });
    assert_eq!(bench.read(0x6065), Some(5000));
    assert_eq!(bench.read(0x6066), Some(10));
    let mut faults = Vec::new();
    for k in 1..=200 {
        // 60 mm/s would be 2 mm behind.
        bench.go(k * 600);
        faults.extend(bench.emergencies().iter().map(|code| (k, *code)));
    }
    let [(at, 0x8611)] = faults[..] else {
        panic!("{faults:?}");
    };
    // 0.5 mm is passed after some 10 ms, and borne for 10 ms.
    assert!((20..24).contains(&at), "{at}");
    assert_eq!(bench.power(), Power::Fault);
    let stood = bench.place();
    bench.tick(Some((0x80, stood as i32)));
    assert_eq!(bench.emergencies(), [0], "the error is gone");
    for control in [0x06, 0x07, 0x0F] {
        bench.tick(Some((control, stood as i32)));
    }
    assert_eq!(bench.power(), Power::Enabled);
    for k in 1..=200 {
        bench.go(stood as i32 + k);
    }
    assert_eq!(bench.power(), Power::Enabled);
    assert!(bench.place() > stood + 100);
}

#[test]
fn quirk_ipos_buffer() {
    let first_motion = |buffer| {
        let mut bench = Bench::new(ServoOptions {
            buffer,
            ..options()
        });
        (1..40)
            .find(|_| {
                bench.go(100_000);
                bench.place() != 0
            })
            .unwrap()
    };
    // The SYNC that latches it, and one period of interpolation.
    assert_eq!(first_motion(0), 2);
    assert_eq!(first_motion(9), 11);
    assert_eq!(first_motion(10), 12);
}

#[test]
fn quirk_undelayed_following_error() {
    let behind = |undelayed| {
        let mut bench = Bench::new(ServoOptions {
            buffer: 5,
            undelayed,
            ..options()
        });
        (1..=1000).for_each(|k| bench.go(k * 300));
        bench.read(0x60F4).unwrap()
    };
    // Five targets in the buffer, and the one that was just latched.
    assert_eq!(behind(true), behind(false) + 6 * 300);
}

#[test]
fn quirk_late_setpoint() {
    let late = Some(Late {
        extrapolate: 1,
        fault: 2,
    });
    let servo = ServoOptions {
        late,
        feed_forward_milli: 1000,
        ..options()
    };
    let at = |k: i32| k * 300;
    // One setpoint is lost in steady motion: it goes on as if nothing were lost.
    let mut places = [false, true].map(|lost| {
        let mut bench = Bench::new(servo);
        for k in 1..=1000 {
            if lost && k == 900 {
                bench.tick(None);
            } else {
                bench.go(at(k));
            }
            assert!(bench.emergencies().is_empty());
        }
        bench.place()
    });
    places.sort_unstable();
    assert_eq!(places[0], places[1]);
    // The second in a row is a fault, one SYNC later.
    let mut bench = Bench::new(servo);
    (1..=900).for_each(|k| bench.go(at(k)));
    bench.tick(None);
    bench.tick(None);
    assert!(bench.emergencies().is_empty());
    bench.tick(None);
    assert_eq!(bench.emergencies(), [0x8250]);
    bench.tick(None);
    assert_eq!(bench.power(), Power::Fault);
    // A drive without this rule waits at its last target.
    let mut bench = Bench::new(ServoOptions {
        late: None,
        ..servo
    });
    (1..=900).for_each(|k| bench.go(at(k)));
    (0..1000).for_each(|_| bench.tick(None));
    assert_eq!(
        (bench.power(), bench.place()),
        (Power::Enabled, at(900).into())
    );
}

#[test]
fn it_stands_where_it_is_without_torque_and_is_the_same_after_a_restart() {
    let mut bench = Bench::new(options());
    (1..=500).for_each(|k| bench.go(k * 300));
    bench.tick(Some((0x06, 0)));
    let stood = bench.place();
    let tool = bench.plant.truth().loads[1];
    assert!(stood > 0);
    for _ in 0..20 {
        bench.tick(Some((0x06, 0)));
    }
    assert_eq!((bench.place(), bench.plant.truth().loads[1]), (stood, tool));
    bench.plant.drive(Axis::Z).restart();
    bench.tick(None);
    assert_eq!((bench.place(), bench.plant.truth().loads[1]), (stood, tool));
    assert!(bench.read(0x60F4).is_some());
}

#[test]
fn homing_moves_the_tool_and_counts_anew_behind_it() {
    let mut params = Params::sheets();
    params.set(Entry::find_text("9050.Z").unwrap(), 1).unwrap();
    let play = Length::from_nm(10_000);
    let mut bench = Bench::with(&params, ServoOptions { play, ..options() });
    let drive = bench.plant.drive(Axis::Z);
    drive.set_homing(HomingOptions::at_plus_end(20_000));
    drive.set_homing_method(HomingOptions::OFF_THE_PLUS_END);
    let homing = AxisMode(Mode::Homing).frame(Z);
    bench.plant.exchange(&[homing], |_| {});
    bench.go(0);
    let (mut before, mut attained) = (0, false);
    for _ in 0..5000 {
        bench.tick(Some((0x1F, 0)));
        let place = bench.place();
        // Never a leap: 200 000 increments a second.
        assert!((place - before).abs() <= 201, "{before} {place}");
        let tool = bench.plant.truth().loads[1].unwrap().nm();
        assert!((tool - place * 100).abs() <= 5_000, "{tool} {place}");
        before = place;
        attained = bench.read(0x6041).unwrap() & 0x3400 == 0x1400;
        if attained {
            break;
        }
    }
    // The edge of the switch is the mark, and it counts from there.
    assert!(attained);
    assert_eq!((bench.place(), bench.read(0x6064)), (20_000, Some(0)));
    // It goes on from there under targets.
    let streaming = AxisMode(Mode::Position).frame(Z);
    bench.plant.exchange(&[streaming], |_| {});
    (0..10).for_each(|_| bench.go(0));
    (1..=1000).for_each(|k| bench.go(-k.min(500)));
    assert_eq!(
        (bench.place(), bench.read(0x6064)),
        (19_500, Some(-500_i32 as u32))
    );
    // A count is 100 nm, and half the play is behind.
    let tool = bench.plant.truth().loads[1].unwrap().nm();
    assert!((1_955_000..1_955_100).contains(&tool), "{tool}");
}

#[test]
fn in_interpolated_position_it_follows_its_own_object_and_only_with_bit_4() {
    let mut params = Params::sheets();
    params.set(Entry::find_text("9076.Z").unwrap(), 7).unwrap();
    let mut bench = Bench::with(&params, options());
    let mapped = [0x6040_0010, 0x60C1_0120];
    for (sub, raw) in (1..).zip(mapped) {
        assert_eq!(bench.read_sub(0x1600, sub), Some(raw));
    }
    assert_eq!((bench.read(0x6060), bench.read(0x6061)), (Some(7), Some(7)));
    // Enabled without bit 4: it stands, and says so.
    (1..=500).for_each(|k| bench.tick(Some((0x0F, k))));
    assert_eq!(bench.place(), 0);
    assert_eq!(bench.read(0x6041).unwrap() & 0x1000, 0);
    (1..=1000).for_each(|k| bench.tick(Some((0x1F, k.min(500)))));
    assert_eq!(bench.place(), 500);
    assert_eq!(bench.read(0x6041).unwrap() & 0x1000, 0x1000);
    // In mode 8 the target is elsewhere.
    params.set(Entry::find_text("9050.Z").unwrap(), 1).unwrap();
    let mut bench = Bench::with(&params, options());
    let other = AxisMode(Mode::Position).frame(Z);
    bench.plant.exchange(&[other], |_| {});
    (1..=500).for_each(|k| bench.tick(Some((0x1F, k))));
    assert_eq!((bench.place(), bench.read(0x6061)), (0, Some(8)));
}

#[test]
fn figures_that_make_no_drive_make_no_plant() {
    let servos = [
        Some(ServoOptions {
            buffer: 99,
            ..options()
        }),
        None,
    ];
    let options = PlantOptions {
        servos,
        ..PlantOptions::default()
    };
    let error = Plant::new(&Params::sheets(), &options).err();
    assert_eq!(error, Some(PlantError::Servo(Axis::X)));
}
