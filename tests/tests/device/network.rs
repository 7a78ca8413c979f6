//! Faults and orders of the network: NMT, heartbeats, a second board, a bus that is too slow.

use leadscrew_board_sim::plant::PlantOptions;
use leadscrew_board_sim::{Doing, Sim};
use leadscrew_core::alarm::{Arg, Code};
use leadscrew_core::board::{Board, Event};
use leadscrew_core::bus::{
    BoardCommand, BoardState, Frame, NmtCommand, NmtState, NodeId, Object, Order, SdoProtocol,
};
use leadscrew_core::params::Params;
use leadscrew_tests::gateway::{Gateway, NODE, Upload};
use leadscrew_tests::machine::{calls, machine};
use leadscrew_tests::params::with;

use crate::parameters::{parameter, write};

/// A long way at a slow feed.
const PROGRAM: &str = "G98 F500\nG01 X40 Z-100\nG01 X20 Z0\nM30\n";

fn heartbeat() -> Frame {
    NmtState::Operational.frame(NodeId::GATEWAY)
}

fn steps(sim: &mut Sim, gateway: &mut Gateway, ticks: usize) -> Vec<Event> {
    let mut events = Vec::new();
    for _ in 0..ticks {
        sim.step();
        events.extend(std::iter::from_fn(|| sim.event()));
        gateway.listen(sim);
    }
    events
}

fn running(params: &Params) -> (Sim, Gateway) {
    let mut sim = machine(params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    Upload::new(1, &calls(PROGRAM, params)).feed(&mut gateway, &mut sim);
    sim.receive(&heartbeat());
    gateway.order(&mut sim, Order::Run);
    steps(&mut sim, &mut gateway, 100);
    assert_eq!(gateway.status.state, BoardState::Run);
    (sim, gateway)
}

#[test]
fn a_board_says_that_it_is_there_and_lives() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    sim.join(NODE).unwrap();
    let mut gateway = Gateway::default();
    gateway.listen(&mut sim);
    assert_eq!(gateway.heartbeats, [NmtState::BootUp]);
    // Pre-operational: heartbeats and transfers, no process data.
    steps(&mut sim, &mut gateway, 500);
    assert_eq!(
        gateway.heartbeats,
        [NmtState::BootUp, NmtState::PreOperational]
    );
    assert_eq!(gateway.heard.len(), 2);
    assert_eq!(gateway.number(&mut sim, 0x1017, 0), Ok(500));
    gateway.order(&mut sim, Order::Hold);
    sim.step();
    assert!(!sim.board().ticker().operator().hold);
    sim.receive(&NmtCommand::Start.frame(None));
    gateway.heard.clear();
    steps(&mut sim, &mut gateway, 1000);
    let sent = |id| gateway.heard.iter().filter(|f| f.id().get() == id).count();
    assert_eq!([0x181, 0x281, 0x381].map(sent), [100, 100, 100]);
    assert_eq!(sent(0x701), 2);
    // One is slower, and one is not sent at all.
    for (index, sub, value) in [(0x1800, 5, 100_u32), (0x1801, 1, 0xC000_0281)] {
        let bytes = value.to_le_bytes();
        let length = if sub == 5 { 2 } else { 4 };
        gateway
            .write(
                &mut sim,
                Object::new(index, sub),
                &bytes[..length],
                SdoProtocol::Short,
            )
            .unwrap();
    }
    gateway.heard.clear();
    steps(&mut sim, &mut gateway, 1000);
    let sent = |id| gateway.heard.iter().filter(|f| f.id().get() == id).count();
    assert_eq!([0x181, 0x281, 0x381].map(sent), [10, 0, 100]);
}

#[test]
fn a_stopped_node_stops_the_machine_and_answers_nothing() {
    let (mut sim, mut gateway) = running(&Params::sheets());
    sim.receive(&NmtCommand::Stop.frame(Some(NODE)));
    let events = steps(&mut sim, &mut gateway, 1000);
    let Some(Event::Alarm(alarm)) = events.iter().find(|e| matches!(e, Event::Alarm(_))) else {
        panic!("{events:?}");
    };
    assert_eq!(alarm.code, Code::NetworkStop);
    assert!(gateway.number(&mut sim, 0x1000, 0).is_err());
    gateway.heard.clear();
    steps(&mut sim, &mut gateway, 500);
    assert_eq!(gateway.heard.len(), 1, "the heartbeat: {:?}", gateway.heard);
    // The board sends the emergency as soon as it may.
    sim.receive(&NmtCommand::Start.frame(Some(NODE)));
    steps(&mut sim, &mut gateway, 10);
    let [low, high] = Code::NetworkStop.number().to_le_bytes();
    assert_eq!(gateway.emergencies[0].detail, [low, high, 0, 0, 0]);
    gateway.order(&mut sim, Order::Reset);
    steps(&mut sim, &mut gateway, 1000);
    assert_eq!(gateway.status.state, BoardState::Idle);
}

#[test]
fn a_node_that_is_reset_stops_first_and_begins_anew() {
    let (mut sim, mut gateway) = running(&Params::sheets());
    sim.receive(&NmtCommand::ResetNode.frame(Some(NODE)));
    let events = steps(&mut sim, &mut gateway, 1500);
    let at = |wanted: fn(&Event) -> bool| {
        events
            .iter()
            .position(wanted)
            .unwrap_or_else(|| panic!("{events:?}"))
    };
    let stopped = at(|e| matches!(e, Event::Alarm(a) if a.code == Code::NetworkStop));
    let ready = at(|e| *e == Event::Ready);
    assert!(stopped < ready);
    assert!(gateway.heartbeats.contains(&NmtState::BootUp));
    sim.receive(&NmtCommand::Start.frame(None));
    steps(&mut sim, &mut gateway, 20);
    assert_eq!(gateway.status.state, BoardState::Idle);
    assert_eq!(gateway.number(&mut sim, 0x5001, 4), Ok(0));
    // A reset of the communication alone does not touch the machine.
    sim.receive(&NmtCommand::ResetCommunication.frame(Some(NODE)));
    assert_eq!(steps(&mut sim, &mut gateway, 100), []);
    assert_eq!(gateway.heartbeats.last(), Some(&NmtState::BootUp));
}

/// A machine with these latencies of X and Z, in microseconds, that is stopped by `stop`; then `ask` asks for what
/// lets it begin anew, until it is taken. It begins anew where it stopped: it takes its place from the drives then.
fn begins_anew_where_it_stopped(
    latency: [i64; 2],
    stop: fn(&mut Sim, &mut Gateway),
    ask: fn(&mut Sim, &mut Gateway) -> bool,
) {
    let [x, z] = latency;
    let (mut sim, mut gateway) = running(&with(&[("9003.X", x), ("9003.Z", z)]));
    let position = |sim: &Sim| sim.board().ticker().executor().position();
    stop(&mut sim, &mut gateway);
    let mut farthest = position(&sim);
    let mut asked = false;
    for _ in 0..1500 {
        let events = steps(&mut sim, &mut gateway, 1);
        if events.contains(&Event::Ready) {
            assert_eq!(position(&sim), farthest, "{latency:?}");
            return;
        }
        let now = position(&sim);
        if now.z < farthest.z {
            farthest = now;
        } else if !asked {
            asked = ask(&mut sim, &mut gateway);
        }
    }
    panic!("it does not begin anew");
}

/// A drive does later what it is told (9003). A board that began anew at once threw away the end of its stop.
#[test]
fn a_board_begins_anew_when_its_drives_stand_where_it_stopped() {
    for latency in [[20_000, 5_000], [5_000, 20_000], [20_000, 20_000], [0, 0]] {
        let reset = |sim: &mut Sim, _: &mut Gateway| {
            sim.receive(&NmtCommand::ResetNode.frame(Some(NODE)));
        };
        begins_anew_where_it_stopped(latency, reset, |_, _| true);
        let stop = |sim: &mut Sim, gateway: &mut Gateway| gateway.order(sim, Order::Reset);
        begins_anew_where_it_stopped(latency, stop, |sim, gateway| {
            write(gateway, sim, parameter(9007, 0), 10, 1).is_ok()
        });
    }
}

/// A frame that was delayed for long is still the same order, and no new one.
#[test]
fn the_count_of_the_last_order_outlives_the_communication() {
    let (mut sim, mut gateway) = running(&Params::sheets());
    let hold = BoardCommand::order(Order::Hold, gateway.status.count);
    sim.receive(&hold.frame(NODE));
    steps(&mut sim, &mut gateway, 500);
    assert_eq!(gateway.status.state, BoardState::Hold);
    sim.receive(&NmtCommand::ResetCommunication.frame(Some(NODE)));
    sim.receive(&NmtCommand::Start.frame(Some(NODE)));
    steps(&mut sim, &mut gateway, 100);
    assert_eq!(gateway.status.count, hold.count);
    let echo = sim.board().device().beat().ms().to_le_bytes();
    let told = gateway.write(&mut sim, Object::new(0x5000, 7), &echo, SdoProtocol::Short);
    assert_eq!(told, Ok(()));
    let order = Object::new(0x5000, 2);
    let resume = [Order::Resume.raw()];
    let resumed = gateway.write(&mut sim, order, &resume, SdoProtocol::Short);
    assert_eq!(resumed, Ok(()));
    sim.receive(&hold.frame(NODE));
    steps(&mut sim, &mut gateway, 500);
    assert_eq!(gateway.status.state, BoardState::Run);
}

#[test]
fn a_lost_gateway_holds_stops_or_is_carried_on_without() {
    for (reaction, state) in [
        (0, BoardState::Hold),
        (1, BoardState::Alarm),
        (2, BoardState::Run),
    ] {
        let params = with(&[("9025", reaction), ("9024", 200)]);
        let (mut sim, mut gateway) = running(&params);
        // Kept alive, nothing happens.
        for _ in 0..10 {
            sim.receive(&heartbeat());
            steps(&mut sim, &mut gateway, 150);
        }
        assert_eq!(gateway.status.state, BoardState::Run);
        assert_eq!(gateway.emergencies, []);
        let events = steps(&mut sim, &mut gateway, 600);
        assert_eq!(gateway.status.state, state, "reaction {reaction}");
        let [emcy] = gateway.emergencies[..] else {
            panic!("{reaction}: {:?}", gateway.emergencies);
        };
        assert_eq!(emcy.code, 0x8130);
        if reaction == 1 {
            assert_eq!(gateway.status.alarm, Some(Code::GatewayLost.number()));
            assert!(events.iter().any(|e| matches!(e, Event::Alarm(_))));
        } else {
            assert_eq!(gateway.status.alarm, None);
        }
        // It is back, and goes on.
        if reaction == 0 {
            sim.receive(&heartbeat());
            gateway.order(&mut sim, Order::Resume);
            steps(&mut sim, &mut gateway, 100);
            assert_eq!(gateway.status.state, BoardState::Run);
            assert_eq!(
                gateway.number(&mut sim, 0x1001, 0),
                Ok(0),
                "the error is gone"
            );
        }
    }
}

#[test]
fn a_gateway_that_leaves_an_idle_machine_or_was_never_there_is_not_missed() {
    let params = with(&[("9024", 200)]);
    let mut sim = machine(&params, &PlantOptions::default());
    let mut gateway = Gateway::connect(&mut sim);
    sim.receive(&heartbeat());
    let events = steps(&mut sim, &mut gateway, 600);
    assert_eq!(events, []);
    assert_eq!(gateway.emergencies, []);
    assert!(!sim.board().ticker().operator().hold);
    // A program that somebody runs who never said that he lives.
    Upload::new(1, &calls(PROGRAM, &params)).feed(&mut gateway, &mut sim);
    gateway.order(&mut sim, Order::Run);
    steps(&mut sim, &mut gateway, 600);
    assert_eq!(gateway.status.state, BoardState::Run);
}

#[test]
fn a_second_board_with_the_same_number_is_an_alarm() {
    let (mut sim, mut gateway) = running(&Params::sheets());
    sim.receive(&NmtState::Operational.frame(NODE));
    let events = steps(&mut sim, &mut gateway, 500);
    assert!(
        events
            .iter()
            .any(|e| matches!(e, Event::Alarm(a) if a.code == Code::NodeTwice)),
        "{events:?}"
    );
}

#[test]
fn a_cycle_that_leaves_no_room_is_refused_when_the_board_joins() {
    for (values, load) in [
        (&[("9021", 1)][..], Some(())),
        (&[("9020", 500)][..], Some(())),
        (&[("9020", 500), ("9000", 2000)][..], Some(())),
        (&[("9020", 500), ("9000", 2000), ("9022", 20)][..], None),
        (&[][..], None),
    ] {
        let params = with(values);
        let mut board = Board::new(&params, None, None).unwrap();
        match (board.join(NODE), load) {
            (Ok(()), None) => {}
            (Err(alarm), Some(_)) => assert_eq!(alarm.code, Code::BusOverload),
            (got, _) => panic!("{values:?}: {got:?}"),
        }
    }
}

#[test]
fn a_board_with_the_number_of_a_drive_does_not_join() {
    let params = with(&[("9015.Z", 40), ("9016", 50), ("9014", 2)]);
    for (number, letter) in [(16, Some(b'X')), (17, None), (40, Some(b'Z'))]
        .into_iter()
        .chain([(49, None), (50, Some(b'S')), (51, Some(b'S')), (52, None)])
    {
        let mut board = Board::new(&params, None, None).unwrap();
        let joined = board.join(NodeId::new(number).unwrap()).map_err(|alarm| {
            let [drive, node, ..] = alarm.args;
            (alarm.code, drive, node)
        });
        let expected = letter.map_or(Ok(()), |letter| {
            let figures = (Arg::Letter(letter), Arg::Int(number.into()));
            Err((Code::DriveNodeOfBoard, figures.0, figures.1))
        });
        assert_eq!(joined, expected);
    }
}

#[test]
fn without_a_network_nothing_is_said() {
    let mut sim = machine(&Params::sheets(), &PlantOptions::default());
    sim.receive(&NmtCommand::Start.frame(None));
    sim.settle();
    for _ in 0..1000 {
        let row = sim.step();
        assert!(row.is_none_or(|row| row.doing == Doing::Idle));
    }
    assert_eq!(sim.transmit(), None);
}

#[test]
fn a_node_that_is_stopped_just_after_run_begins_nothing() {
    let params = Params::sheets();
    for command in [NmtCommand::Stop, NmtCommand::ResetNode] {
        for (settles, ticks) in [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (0, 2)] {
            let mut sim = machine(&params, &PlantOptions::default());
            let mut gateway = Gateway::connect(&mut sim);
            Upload::new(1, &calls(PROGRAM, &params)).feed(&mut gateway, &mut sim);
            gateway.order(&mut sim, Order::Run);
            for _ in 0..settles {
                sim.settle();
            }
            steps(&mut sim, &mut gateway, ticks);
            sim.receive(&command.frame(Some(NODE)));
            let events = steps(&mut sim, &mut gateway, 3000);
            let begun = |event: &Event| matches!(event, Event::Started { .. });
            assert!(!events.iter().any(begun), "{command:?}: {events:?}");
            // Only where both came at once there was nothing yet that could be stopped.
            let alarm = |event: &Event| matches!(event, Event::Alarm(alarm) if alarm.code == Code::NetworkStop);
            let at_once = (settles, ticks) == (0, 0);
            assert_eq!(
                events.iter().any(alarm),
                !at_once,
                "{command:?}: {events:?}"
            );
        }
    }
}
