//! The learned controller at work: rules 1 to 3, the safe state, its shadow, and its guards.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test that cannot go on says why")]

mod tank;

use std::sync::Arc;

use runglight_engine::control::controller::{Controller, Mode};
use runglight_engine::control::decide::Fired;
use runglight_engine::control::error::ControlError;
use runglight_engine::control::guards::Guards;
use runglight_engine::control::learn::{LearnParameters, learn};
use runglight_engine::control::program::Program;
use runglight_engine::control::shadow::Shadow;
use runglight_engine::control::structured_text;
use runglight_engine::control::tree::Tree;
use runglight_engine::finding::{Finding, Kind, Severity};
use tank::{EMPTY, FILL, Ladder, SCAN, Tank, figure_5, figure_7, net, recorded};

const LEARN: LearnParameters = LearnParameters { reaction_s: 0.3 };

/// Activities that a controller performs at the tank, and the extremes of the level.
fn run(controller: &mut Controller, seconds: i64) -> (Vec<String>, f64, f64, Vec<Finding>) {
    let mut tank = Tank::new();
    let (mut lowest, mut highest) = (100.0f64, 0.0f64);
    let mut findings = Vec::new();
    let mut outputs = Vec::new();
    for scan in 0..seconds * 10 {
        tank.advance();
        (lowest, highest) = (lowest.min(tank.level), highest.max(tank.level));
        let done = controller.scan(scan * SCAN, &tank.image());
        for &(terminal, value) in &done.writes {
            tank.write(terminal - 3, value);
        }
        if done.writes.contains(&(3, 1)) {
            outputs.push("fill".to_owned());
        } else if done.writes.contains(&(4, 1)) {
            outputs.push("empty".to_owned());
        }
        findings.extend(done.findings);
    }
    (outputs, lowest, highest, findings)
}

fn guards(program: &Arc<Program>, swings: u32) -> Guards {
    learn(program, &[&recorded(&mut Ladder::new(swings), 880)], LEARN).unwrap().guards
}

#[test]
fn rules_1_and_2_need_nothing_but_the_net() {
    let mut controller = Controller::new(figure_5(), Guards::default(), None, &[]).unwrap();
    let (outputs, _, highest, findings) = run(&mut controller, 36_000);
    assert_eq!(findings, []);
    assert_eq!(controller.mode(), Mode::Running);
    assert!(highest < 93.0, "{highest}");
    assert!(outputs.len() > 3_500, "{}", outputs.len());
    assert!(outputs.chunks_exact(2).all(|pair| pair == ["fill", "empty"]));
}

#[test]
fn a_counter_decides_where_the_net_cannot() {
    let program = figure_7();
    let learned = learn(&program, &[&recorded(&mut Ladder::new(3), 880)], LEARN).unwrap();
    assert_eq!((learned.departures, learned.runs), (0, 23));
    let tree = learned.guards.points.iter().find_map(|point| point.choice.clone()).unwrap();
    let Tree::Count { counter, preset: 3, reached, below } = tree else { panic!("{tree:?}") };
    assert_eq!((counter.counts.as_str(), counter.reset_by), ("t7", None));
    assert_eq!(*reached, Tree::Wait);
    assert_eq!(*below, Tree::Output { transition: "t1".to_owned(), after_s: 0.0 });

    // For ten hours: not only for as long as was recorded.
    let mut controller = Controller::new(program, learned.guards, None, &[]).unwrap();
    let (outputs, _, highest, findings) = run(&mut controller, 36_000);
    assert_eq!(findings, []);
    assert!(highest < 93.0, "{highest}");
    let mut ladder = Ladder::new(3);
    let log = recorded(&mut ladder, 36_000);
    let fills = log.signal.iter().zip(&log.value).filter(|(s, v)| **s == 3 && **v == 1).count();
    assert_eq!(outputs.iter().filter(|output| *output == "fill").count(), fills);
}

#[test]
fn a_network_decides_where_the_net_cannot() {
    let decide = |run: &[Fired]| {
        let emptied = run.iter().filter(|fired| fired.transition == 7).count();
        if emptied < 3 {
            vec![(Some(1), 0.9), (None, 0.1)]
        } else {
            vec![(None, 0.8), (Some(1), 0.2)]
        }
    };
    let with = |decide| Controller::new(figure_7(), Guards::default(), decide, &[]);
    assert!(matches!(with(None), Err(ControlError::Undecided { .. })));
    let mut controller = with(Some(Box::new(decide))).unwrap();
    let (outputs, lowest, _, findings) = run(&mut controller, 3_600);
    assert_eq!((findings, lowest), (vec![], 0.0));
    let expected = outputs.len();
    assert!((560..=600).contains(&expected), "{expected}");
}

#[test]
fn a_plant_that_leaves_the_net_ends_in_the_safe_state() {
    let safe = [("%QX0.1".to_owned(), 1)];
    let mut controller = Controller::new(figure_5(), Guards::default(), None, &safe).unwrap();
    let full = [Some(0), Some(0), Some(0), Some(0), Some(0)];
    let first = controller.scan(0, &full);
    assert_eq!(first.writes, [(3, 1)]);
    // The middle sensor before the lower one.
    let wrong = [Some(0), Some(0), Some(1), Some(1), Some(0)];
    let done = controller.scan(SCAN, &wrong);
    assert_eq!(done.writes, [(3, 0), (4, 1)]);
    let finding = &done.findings[0];
    assert_eq!((finding.kind, finding.severity), (Kind::Transition, Severity::Fault));
    assert_eq!(finding.address.as_deref(), Some("%IX0.2"));
    assert_eq!(
        finding.message,
        format!(
            "%IX0.2=1 came out of turn after {FILL}; expected %IX0.1=1; safe state: %QX0.0=0, %QX0.1=1"
        )
    );
    assert_eq!(controller.mode(), Mode::Safe);
    // It holds the safe state, whatever comes.
    assert_eq!(controller.scan(2 * SCAN, &full).writes, [(4, 1)]);
    assert!(controller.scan(3 * SCAN, &full).findings.is_empty());
}

#[test]
fn a_value_never_seen_is_an_unknown_signal() {
    let mut controller = Controller::new(figure_5(), Guards::default(), None, &[]).unwrap();
    controller.scan(0, &[Some(0), Some(0), Some(0), Some(0), Some(0)]);
    let done = controller.scan(SCAN, &[Some(0), Some(7), Some(0), Some(1), Some(0)]);
    assert_eq!(done.findings[0].kind, Kind::UnknownSignal);
}

#[test]
fn two_changes_in_one_scan_have_no_order() {
    let mut controller = Controller::new(figure_5(), Guards::default(), None, &[]).unwrap();
    controller.scan(0, &[Some(0), Some(0), Some(0), Some(0), Some(0)]);
    let done = controller.scan(SCAN, &[Some(0), Some(1), Some(1), Some(1), Some(0)]);
    assert_eq!(done.findings, []);
    assert_eq!(controller.last(), "%IX0.2=1");
}

#[test]
fn whoever_else_writes_the_outputs_ends_control() {
    let mut controller = Controller::new(figure_5(), Guards::default(), None, &[]).unwrap();
    controller.scan(0, &[Some(0), Some(0), Some(0), Some(0), Some(0)]);
    let foreign = [Some(0), Some(0), Some(0), Some(0), Some(1)];
    assert_eq!(controller.scan(SCAN, &foreign).findings, []);
    let done = controller.scan(2 * SCAN, &foreign);
    assert!(done.findings[0].message.contains("something else writes"), "{:?}", done.findings);
    assert_eq!(controller.mode(), Mode::Safe);
}

#[test]
fn a_sensor_that_never_comes_is_late() {
    let program = figure_5();
    let guards = guards(&program, 1);
    let mut controller = Controller::new(program, guards, None, &[]).unwrap();
    let mut tank = Tank::new();
    tank.stuck_ul = true;
    let mut findings = Vec::new();
    for scan in 0..400 {
        tank.advance();
        let done = controller.scan(scan * SCAN, &tank.image());
        for (terminal, value) in done.writes {
            tank.write(terminal - 3, value);
        }
        findings.extend(done.findings);
    }
    let [finding] = &findings[..] else { panic!("{findings:?}") };
    assert_eq!((finding.kind, finding.address.as_deref()), (Kind::Late, Some("%IX0.0")));
    assert_eq!(tank.image()[3..], [Some(0), Some(0)]);
}

#[test]
fn it_takes_over_in_the_middle_of_the_work() {
    let program = figure_5();
    let mut controller =
        Controller::new(Arc::clone(&program), Guards::default(), None, &[]).unwrap();
    // Emptying, between the middle and the lower sensor.
    assert_eq!(controller.scan(0, &[Some(0), Some(1), Some(0), Some(0), Some(1)]).writes, []);
    assert_eq!(controller.last(), "%IX0.2=0");
    let mut controller = Controller::new(program, Guards::default(), None, &[]).unwrap();
    let done = controller.scan(0, &[Some(1), Some(0), Some(1), Some(0), Some(1)]);
    assert_eq!(done.findings[0].kind, Kind::StartState);
    assert_eq!(done.writes, [(4, 0)]);
}

/// Findings of a shadow beside a program.
fn shadowed(
    program: &Arc<Program>,
    guards: Guards,
    ladder: &mut Ladder,
    seconds: i64,
) -> Vec<Finding> {
    let mut shadow = Shadow::new(Arc::clone(program), guards, None, 0.5).unwrap();
    let mut tank = Tank::new();
    let mut findings = Vec::new();
    for scan in 0..seconds * 10 {
        tank.advance();
        let outputs = ladder.scan(&tank.image());
        findings.extend(shadow.scan(scan * SCAN, &tank.image()));
        for (valve, value) in outputs.into_iter().enumerate() {
            tank.write(valve, value);
        }
    }
    findings
}

#[test]
fn a_shadow_agrees_with_the_program_it_learned_from() {
    for (program, swings) in [(figure_5(), 1), (figure_7(), 3)] {
        let guards = guards(&program, swings);
        assert_eq!(shadowed(&program, guards, &mut Ladder::new(swings), 36_000), []);
    }
}

#[test]
fn a_shadow_reports_another_preset_within_two_cycles() {
    let program = figure_7();
    let guards = guards(&program, 3);
    let fewer = shadowed(&program, guards.clone(), &mut Ladder::new(2), 80);
    let late = fewer.iter().find(|finding| finding.kind == Kind::Late);
    assert!(late.is_some(), "{fewer:?}");
    let more = shadowed(&program, guards, &mut Ladder::new(4), 100);
    assert_eq!(more[0].kind, Kind::Transition, "{more:?}");
    assert!(more[0].message.starts_with(&format!("The controller set {FILL}")), "{more:?}");
}

/// A press that rests for two seconds before it opens: a TON.
fn timed() -> (Arc<Program>, runglight_engine::log::ChangeLog) {
    let transitions: [(&str, &[u32], &[u32]); 4] = [
        ("%IX0.0=1", &[0], &[1]),
        ("%QX0.0=1", &[1], &[2]),
        ("%IX0.0=0", &[2], &[3]),
        ("%QX0.0=0", &[3], &[4]),
    ];
    let program = Arc::new(Program::new(net(5, &transitions, 4)).unwrap());
    let mut log = runglight_engine::log::ChangeLogBuilder::default();
    let (input, output) = (log.intern("%IX0.0"), log.intern("%QX0.0"));
    log.push(0, input, 0);
    log.push(0, output, 0);
    for cycle in 0..10 {
        let at = |tenths: i64| (cycle * 100 + tenths) * SCAN;
        log.push(at(10 + cycle % 3), input, 1);
        log.push(at(30 + cycle % 3), output, 1);
        log.push(at(50), input, 0);
        log.push(at(51), output, 0);
    }
    (program, log.finish())
}

#[test]
fn a_delay_is_a_timer() {
    let (program, log) = timed();
    let guards = learn(&program, &[&log], LEARN).unwrap().guards;
    let mut controller = Controller::new(Arc::clone(&program), guards.clone(), None, &[]).unwrap();
    controller.scan(0, &[Some(0), Some(0)]);
    assert_eq!(controller.scan(SCAN, &[Some(1), Some(0)]).writes, []);
    assert_eq!(controller.scan(20 * SCAN, &[Some(1), Some(0)]).writes, []);
    assert_eq!(controller.scan(21 * SCAN, &[Some(1), Some(0)]).writes, [(1, 1)]);
    // The other output comes at once, as it did.
    controller.scan(22 * SCAN, &[Some(1), Some(1)]);
    assert_eq!(controller.scan(40 * SCAN, &[Some(0), Some(1)]).writes, [(1, 0)]);
    let text = structured_text::write(&program, &guards, &[], "timed").unwrap();
    assert!(text.contains("PT := T#2000ms"), "{text}");
}

#[test]
fn structured_text_counts_with_a_ctu() {
    let program = figure_7();
    let guards = guards(&program, 3);
    let text = structured_text::write(&program, &guards, &[], "tank").unwrap();
    assert!(text.contains("count_0 : CTU; (* %IX0.2=0 since the run began, preset 3 *)"), "{text}");
    assert!(text.contains("IX0_1 AT %IX0.1 : BOOL;"), "{text}");
    assert!(matches!(
        structured_text::write(&program, &Guards::default(), &[], "tank"),
        Err(ControlError::Undecided { .. })
    ));
}

#[test]
fn nets_and_guards_that_cannot_control_are_refused() {
    let refused = |transitions: &[(&str, &[u32], &[u32])]| {
        Program::new(net(3, transitions, 2)).unwrap_err().to_string()
    };
    assert!(refused(&[("A_Create", &[0], &[1])]).contains("tells no change"));
    assert!(refused(&[("%IX0.0=1", &[0], &[1])]).contains("sets no output"));
    let stuck = Program::new(net(3, &[("%QX0.0=1", &[0], &[1])], 2)).unwrap();
    let error = Controller::new(Arc::new(stuck), Guards::default(), None, &[]).err().unwrap();
    assert!(error.to_string().contains("gets stuck after \"%QX0.0=1\""), "{error}");
    let safe = [("%QX7.0".to_owned(), 0)];
    let error = Controller::new(figure_5(), Guards::default(), None, &safe).err().unwrap();
    assert_eq!(error.to_string(), "\"%QX7.0\" is no output of the net; it has %QX0.0, %QX0.1");
    let foreign = guards(&figure_7(), 3);
    let mut foreign = foreign;
    foreign.points[0].marked = vec!["elsewhere".to_owned()];
    let error = Controller::new(figure_7(), foreign, None, &[]).err().unwrap();
    assert!(error.to_string().contains("\"elsewhere\""), "{error}");
    assert!(EMPTY.contains("%QX0.1=1"));
}
