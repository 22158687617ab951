//! Monitors of the parts of a plant find together what one monitor of the whole finds.

#![allow(clippy::expect_used, reason = "a test that cannot go on says why")]

use std::sync::Arc;

use proptest::prelude::*;

use runglight_engine::finding::{Finding, Kind};
use runglight_engine::log::{ChangeLog, ChangeLogBuilder, Gap, SECOND};
use runglight_engine::plant_part::PlantPart;
use runglight_engine::signal_state::enabling::Trigger;
use runglight_engine::signal_state::events::{Row, is_image};
use runglight_engine::signal_state::learn::learn;
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::monitor::Monitor;
use runglight_engine::signal_state::parameters::{Parameters, Timing};
use runglight_engine::signal_state::states::NO_STATE;
use runglight_engine::symbols::SymbolTable;

const MS: i64 = 1_000_000;
const SIGNALS: [&str; 8] =
    ["G-A1-X", "H-C-X", "G-A1-Y", "H-C-STEP", "G-B-X", "I-A2-X", "H-C-Y", "I-A2-Y"];
const WORD: usize = 3;

fn random_log(events: usize) -> impl Strategy<Value = ChangeLog> {
    let step = (0i64..4000, 0usize..SIGNALS.len(), 0i64..3);
    prop::collection::vec(step, events).prop_map(|steps| {
        let mut builder = ChangeLogBuilder::default();
        for name in SIGNALS {
            builder.intern(name);
        }
        let mut time = SECOND;
        for (step, signal, value) in steps {
            // Often the same time, sometimes a long pause.
            time += match step {
                ..1000 => 0,
                3990.. => 400 * SECOND,
                _ => step * MS,
            };
            let value = if signal == WORD { value * 5 } else { value.min(1) };
            builder.push(time, signal as u32, value);
        }
        builder.finish()
    })
}

/// The findings of the whole plant: rows, a gap after some of them, rows.
fn watch_whole(model: &Arc<NominalModel>, rows: &[Row], gap: Option<(usize, Gap)>) -> Vec<Finding> {
    let mut monitor = Monitor::new(Arc::clone(model));
    let mut findings = Vec::new();
    let mut rest = rows;
    if let Some((after, gap)) = gap {
        findings.extend(monitor.observe(&rest[..after]).expect("rows in order"));
        findings.extend(monitor.gap(gap.start, gap.end));
        rest = &rest[after..];
    }
    findings.extend(monitor.observe(rest).expect("rows in order"));
    findings.extend(monitor.finish());
    findings
}

/// The same of a part: its own rows only, cut anywhere, gone on from a saved state after each cut.
fn watch_part(
    whole: &NominalModel,
    groups: &[usize],
    rows: &[Row],
    gap: Option<(usize, Gap)>,
    cuts: &[usize],
) -> Vec<Finding> {
    let (model, part): (NominalModel, PlantPart) = whole.part(groups);
    let model = Arc::new(model);
    let mut monitor = Monitor::new(Arc::clone(&model));
    let mut findings = Vec::new();
    let first = rows.first().expect("rows").time;
    let of_first = rows.iter().take_while(|row| row.time == first).map(|row| row.value);
    monitor.begin(first, is_image(of_first));
    let mut own: Vec<Row> = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        if gap.is_some_and(|(after, _)| after == index) {
            let gap = gap.expect("there is one").1;
            findings.extend(monitor.observe(&own).expect("rows in order"));
            own.clear();
            findings.extend(monitor.advance(gap.start));
            findings.extend(monitor.gap(gap.start, gap.end));
            monitor.begin(row.time, true);
        }
        if cuts.contains(&index) {
            findings.extend(monitor.observe(&own).expect("rows in order"));
            own.clear();
            monitor = Monitor::restore(Arc::clone(&model), &monitor.save()).expect("own state");
        }
        own.extend(part.own(row.signal).map(|signal| Row { signal, ..*row }));
    }
    findings.extend(monitor.observe(&own).expect("rows in order"));
    findings.extend(monitor.advance(rows.last().expect("rows").time));
    findings.extend(monitor.finish());
    findings
}

fn sorted(findings: Vec<Finding>) -> Vec<Finding> {
    let mut findings = findings;
    let key = |f: &Finding| (f.time, f.id.clone(), format!("{:?}", f.state));
    findings.sort_by_key(key);
    // A gap is told by every part.
    findings.dedup_by(|a, b| a.kind == Kind::Gap && a == b);
    findings
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn parts_find_what_the_whole_finds(
        nominal in random_log(150),
        watched in random_log(200),
        cuts in prop::collection::vec(0usize..=200, 0..8),
        gap_after in prop::option::of(1usize..199),
        together in any::<bool>(),
        plat in any::<bool>(),
        alarms in prop::sample::select(vec![1.0, 100.0, 1e6]),
        scan_ms in prop::option::of(1i64..2500),
    ) {
        let parameters = Parameters {
            timing: if plat { Timing::Plat } else { Timing::Adaptive },
            check_every: 2,
            false_alarms_per_day: alarms,
            scan_interval_s: scan_ms.map(|ms| ms as f64 / 1000.0),
            ..Parameters::default()
        };
        let Ok(model) = learn(&[nominal], &SymbolTable::default(), &parameters) else {
            return Ok(());
        };
        let model = Arc::new(model);
        // A scan's rows bear its time.
        let scan = scan_ms.map_or(1, |ms| ms * MS);
        let rows: Vec<Row> = (0..watched.len())
            .map(|i| Row {
                time: watched.time[i] / scan * scan,
                signal: watched.signal[i],
                value: watched.value[i],
            })
            .collect();
        // A gap lies between two times.
        let gap = gap_after.and_then(|after| {
            let (start, end) = (rows[after - 1].time, rows[after].time);
            (start < end).then_some((after, Gap { start, end }))
        });
        let whole = watch_whole(&model, &rows, gap);
        let parts: &[&[usize]] = if together { &[&[0, 2], &[1]] } else { &[&[0], &[1], &[2]] };
        let of_parts =
            parts.iter().flat_map(|groups| watch_part(&model, groups, &rows, gap, &cuts)).collect();
        prop_assert_eq!(sorted(whole), sorted(of_parts));
    }
}

#[test]
fn groups_that_wait_for_one_another_stay_together() {
    let mut builder = ChangeLogBuilder::default();
    for name in SIGNALS {
        builder.intern(name);
    }
    for step in 0..40 {
        builder.push(step * SECOND, (step % 8) as u32, (step / 8) % 2);
    }
    let parameters = Parameters::default();
    let model =
        learn(&[builder.finish()], &SymbolTable::default(), &parameters).expect("it has events");
    assert_eq!(model.independent_groups(), [[0], [1], [2]]);
    let mut rules = model.rules.clone();
    let of_last = rules.iter_mut().find(|rule| model.group_name(rule.chain) == "I");
    let clusters = Box::default();
    // What enables it is an event of the first group.
    of_last.expect("a rule").trigger = Some(Box::new(Trigger { states: [1, NO_STATE], clusters }));
    let declared = NominalModel::assemble(
        model.plant.clone(),
        model.states.clone(),
        rules,
        model.learned.clone(),
        parameters,
    );
    assert_eq!(declared.independent_groups(), [vec![0, 2], vec![1]]);
}
