use super::*;

const NODE: NodeId = NodeId::BOARD;

#[test]
fn commands_have_their_bytes() {
    let hold = BoardCommand::order(Order::Hold, 6);
    let frame = hold.frame(NODE);
    assert_eq!(frame.id().get(), 0x201);
    assert_eq!(frame.payload(), [7, 2, 0, 255, 255, 255]);
    assert_eq!(BoardCommand::decode(&frame), Some((NODE, hold)));

    let settings = BoardCommand {
        count: 0,
        order: None,
        single_block: Some(true),
        dry_run: Some(false),
        feed: Some(150),
        rapid: Some(0),
        spindle: Some(120),
        echo: None,
    };
    let frame = settings.frame(NODE);
    assert_eq!(frame.payload(), [0, 0, 0x31, 150, 0, 120]);
    assert_eq!(BoardCommand::decode(&frame), Some((NODE, settings)));
    assert_eq!(
        BoardCommand {
            dry_run: Some(true),
            ..BoardCommand::default()
        }
        .frame(NODE)
        .payload(),
        [0, 0, 0x22, 255, 255, 255]
    );
    for order in (0..=u8::MAX).filter_map(Order::from_raw) {
        let fresh = BoardCommand {
            echo: Some(Beat::new(0x0201)),
            ..BoardCommand::order(order, 255)
        };
        let frame = fresh.frame(NODE);
        assert_eq!(
            frame.payload(),
            [0, order.raw(), 0, 255, 255, 255, 0x01, 0x02]
        );
        assert_eq!(BoardCommand::decode(&frame), Some((NODE, fresh)));
    }
}

#[test]
fn a_command_that_makes_no_sense_is_none() {
    let id = CobId::of(Service::Rpdo1, NODE);
    let with = |bytes: &[u8]| BoardCommand::decode(&Frame::new(id, bytes).unwrap());
    assert!(with(&[0, 5, 0, 255, 255, 255]).is_some());
    assert!(with(&[0, 5, 0, 255, 255, 255, 0, 0]).is_some());
    assert_eq!(with(&[0, 7, 0, 255, 255, 255]), None);
    assert_eq!(with(&[0, 5, 0, 255, 255]), None);
    let other = Frame::new(CobId::of(Service::Rpdo2, NODE), &[0; 6]).unwrap();
    assert_eq!(BoardCommand::decode(&other), None);
}

#[test]
fn the_status_has_its_bytes() {
    let status = BoardStatus {
        state: BoardState::Alarm,
        flags: BoardFlags {
            hold: true,
            single_block: false,
            dry_run: false,
            program: true,
            locked: false,
        },
        alarm: Some(317),
        count: 7,
        late: 3,
        credit: 0x1234,
    };
    let frame = status.frame(NODE);
    assert_eq!(frame.id().get(), 0x181);
    assert_eq!(frame.payload(), [7, 0x09, 0x3D, 0x01, 7, 3, 0x34, 0x12]);
    assert_eq!(BoardStatus::decode(&frame), Some((NODE, status)));
    let full = BoardStatus {
        late: 1000,
        credit: 100_000,
        ..BoardStatus::default()
    };
    assert_eq!(full.frame(NODE).payload(), [0, 0, 0, 0, 0, 255, 255, 255]);
    for (raw, state) in (0..).zip(BoardState::ALL) {
        let frame = BoardStatus {
            state,
            ..BoardStatus::default()
        }
        .frame(NODE);
        assert_eq!(frame.payload()[0], raw);
        assert_eq!(BoardStatus::decode(&frame).unwrap().1.state, state);
    }
    let id = CobId::of(Service::Tpdo1, NODE);
    let unknown = Frame::new(id, &[8, 0, 0, 0, 0, 0, 0, 0]).unwrap();
    assert_eq!(BoardStatus::decode(&unknown), None);
    for raw in 0..0x20 {
        assert_eq!(BoardFlags::from_raw(raw).raw(), raw);
    }
}

#[test]
fn place_and_spindle_have_their_bytes() {
    let place = BoardPlace {
        line: 0x0102_0304,
        number: 5,
    };
    let frame = place.frame(NODE);
    assert_eq!(frame.id().get(), 0x281);
    assert_eq!(frame.payload(), [4, 3, 2, 1, 5, 0, 0, 0]);
    assert_eq!(BoardPlace::decode(&frame), Some((NODE, place)));

    let spindle = BoardSpindle {
        angle: Turns::from_raw(3 << 32 | 0x8000_0000),
        speed: MilliRpm::new(-300_000),
        sync_error: Some(Length::from_nm(-380)),
    };
    let frame = spindle.frame(NODE);
    assert_eq!(frame.id().get(), 0x381);
    assert_eq!(
        frame.payload(),
        [0x00, 0x80, 0x20, 0x6C, 0xFB, 0xFF, 0xDA, 0xFF]
    );
    let (_, heard) = BoardSpindle::decode(&frame).unwrap();
    assert_eq!(heard.angle, Turns::from_raw(0x8000_0000));
    assert_eq!(
        (heard.speed, heard.sync_error),
        (spindle.speed, spindle.sync_error)
    );
}

#[test]
fn angles_wrap_downwards_and_errors_saturate() {
    let heard = |spindle: BoardSpindle| BoardSpindle::decode(&spindle.frame(NODE)).unwrap().1;
    let angle = |raw| {
        let angle = Turns::from_raw(raw);
        heard(BoardSpindle {
            angle,
            ..BoardSpindle::default()
        })
        .angle
        .raw()
    };
    assert_eq!(angle(-1), 0xFFFF_0000);
    assert_eq!(angle(0xFFFF), 0);
    assert_eq!(angle(i64::MIN), 0);
    let error = |nm| {
        heard(BoardSpindle {
            sync_error: Some(Length::from_nm(nm)),
            ..BoardSpindle::default()
        })
        .sync_error
    };
    for (nm, wire) in [
        (19, 10),
        (-19, -10),
        (327_670, 327_670),
        (1_000_000, 327_670),
        (-1_000_000, -327_670),
        (i64::MIN, -327_670),
    ] {
        assert_eq!(error(nm), Some(Length::from_nm(wire)));
    }
    assert_eq!(heard(BoardSpindle::default()).sync_error, None);
}

#[test]
fn mappings_are_as_long_as_their_frames() {
    let lengths = [
        (
            Mapped::bytes(&BoardCommand::MAPPING),
            BoardCommand {
                echo: Some(Beat::default()),
                ..BoardCommand::default()
            }
            .frame(NODE),
        ),
        (
            Mapped::bytes(&BoardStatus::MAPPING),
            BoardStatus::default().frame(NODE),
        ),
        (
            Mapped::bytes(&BoardPlace::MAPPING),
            BoardPlace::default().frame(NODE),
        ),
        (
            Mapped::bytes(&BoardSpindle::MAPPING),
            BoardSpindle::default().frame(NODE),
        ),
        (
            Mapped::bytes(&BoardBeat::MAPPING),
            BoardBeat::default().frame(NODE),
        ),
    ];
    for (bytes, frame) in lengths {
        assert_eq!(usize::from(bytes), frame.payload().len());
    }
}
