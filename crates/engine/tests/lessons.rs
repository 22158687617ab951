//! A plant learned group by group, anywhere, is the plant learned as a whole.

#![allow(clippy::expect_used, reason = "a test that cannot go on says why")]

use std::sync::Arc;

use proptest::prelude::*;

use runglight_engine::log::{ChangeLog, ChangeLogBuilder, Gap, SECOND};
use runglight_engine::signal_state::learn::context::Context;
use runglight_engine::signal_state::learn::lesson::{Learner, Lesson, LessonError};
use runglight_engine::signal_state::learn::merge::{MergeError, merge};
use runglight_engine::signal_state::learn::survey::{NO_PLACE, Survey, SurveyError};
use runglight_engine::signal_state::learn::{LearnError, learn};
use runglight_engine::signal_state::model::NominalModel;
use runglight_engine::signal_state::parameters::{Parameters, Timing};
use runglight_engine::symbols::SymbolTable;

const MS: i64 = 1_000_000;
const SIGNALS: [&str; 10] = [
    "G-A1-X",
    "H-C-X",
    "I_Pump_Up",
    "G-A1-Y",
    "H-C-STEP",
    "G-B-X",
    "I-A2-X",
    "O_Pump_Run",
    "H-C-Y",
    "I-A2-STEP",
];

/// A row: time, signal by name, value.
type Row = (i64, &'static str, i64);

fn random_rows(rows: usize) -> impl Strategy<Value = Vec<Row>> {
    let step = (0i64..4000, 0usize..SIGNALS.len(), 0i64..4);
    prop::collection::vec(step, rows).prop_map(|steps| {
        let mut time = SECOND;
        let row = |(step, signal, value): (i64, usize, i64)| {
            time += if step < 1500 { 0 } else { step / 10 * 10 * MS };
            let name = SIGNALS[signal];
            (time, name, if name.ends_with("STEP") { value * 5 } else { value.min(1) })
        };
        steps.into_iter().map(row).collect()
    })
}

fn log_of(rows: &[Row], gaps: &[Gap]) -> ChangeLog {
    let mut builder = ChangeLogBuilder::default();
    for &(time, name, value) in rows {
        let signal = builder.intern(name);
        builder.push(time, signal, value);
    }
    ChangeLog { gaps: gaps.to_vec(), ..builder.finish() }
}

/// Surveys of pieces, saved, restored and merged backwards.
fn survey_of(rows: &[Row], gaps: &[Gap], piece: usize, places: bool) -> Survey {
    let numbered: Vec<(i64, Row)> = (0..).zip(rows.iter().copied()).collect();
    let mut all = Survey::new(gaps.to_vec());
    for piece in numbered.chunks(piece).rev() {
        let mut survey = Survey::new(gaps.to_vec());
        survey.add(piece.iter().map(|&(place, (time, name, value))| {
            (time, name, value, if places { place } else { NO_PLACE })
        }));
        all.merge(Survey::restore(&survey.save()).expect("own bytes")).expect("same gaps");
    }
    all
}

fn lessons_of(context: &Arc<Context>, rows: &[Row], places: bool) -> Vec<Lesson> {
    let signals: Vec<(&str, usize)> = context.signals().collect();
    let groups: Vec<&str> = context.groups().collect();
    // Backwards: they may come as they like.
    let lesson = |group: usize| {
        let mut learner = Learner::new(Arc::clone(context), group).expect("the group is there");
        for (place, &(time, name, value)) in (0..).zip(rows) {
            let signal = signals.iter().position(|(symbol, _)| *symbol == name).expect("surveyed");
            if signals[signal].1 == group {
                let row = (time, signal as u32, value, places.then_some(place));
                learner.add(std::iter::once(row)).expect("its own row, in order");
            }
        }
        Lesson::restore(&learner.learn().save()).expect("own bytes")
    };
    (0..groups.len()).rev().map(lesson).collect()
}

fn in_parts(
    rows: &[Row],
    gaps: &[Gap],
    parameters: &Parameters,
    piece: usize,
    places: bool,
) -> Result<NominalModel, String> {
    let survey = survey_of(rows, gaps, piece, places);
    let context = Context::of(&survey, &SymbolTable::default(), parameters);
    let context = context.map_err(|error| error.to_string())?;
    let context = Arc::new(Context::restore(&context.save()).expect("own bytes"));
    let lessons = lessons_of(&context, rows, places);
    merge(&context, lessons).map_err(|error| error.to_string())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn lessons_make_the_model_of_the_whole_log(
        rows in random_rows(300),
        gap in prop::option::of((0usize..300, 0usize..300, 0i64..2)),
        piece in 1usize..400,
        places in any::<bool>(),
        plat in any::<bool>(),
        start in 0usize..3,
    ) {
        let mut rows = rows;
        if !places {
            // What a cluster makes of rows that do not tell their places.
            rows.sort();
        }
        let gaps: Vec<Gap> = gap
            .map(|(from, to, before)| {
                let ends = (rows[from.min(to)].0, rows[from.max(to)].0 - before);
                Gap { start: ends.0, end: ends.1 }
            })
            .into_iter()
            .collect();
        let starting: &[(&str, &str)] = [&[][..], &[("H-C", "Y")], &[("A1", "Y")]][start];
        let parameters = Parameters {
            timing: if plat { Timing::Plat } else { Timing::Adaptive },
            starting: starting.iter().map(|(d, s)| ((*d).to_owned(), (*s).to_owned())).collect(),
            ..Parameters::default()
        };
        let whole = learn(&[log_of(&rows, &gaps)], &SymbolTable::default(), &parameters);
        let parts = in_parts(&rows, &gaps, &parameters, piece, places);
        match (whole, parts) {
            (Ok(whole), Ok(parts)) => {
                prop_assert_eq!(&whole.plant, &parts.plant);
                prop_assert_eq!(&whole.states, &parts.states);
                prop_assert_eq!(&whole.rules, &parts.rules);
                prop_assert_eq!(&whole.learned, &parts.learned);
                prop_assert_eq!(&whole.parameters, &parts.parameters);
            }
            (Err(whole), Err(parts)) => prop_assert_eq!(whole.to_string(), parts),
            (whole, parts) => prop_assert!(false, "{:?} and {:?}", whole.is_ok(), parts.is_ok()),
        }
    }
}

#[test]
fn what_bears_the_same_time_is_learned_alike() {
    // Y answers X of its device at once or a little later; the other devices go on with Y.
    let mut rows: Vec<Row> = Vec::new();
    for cycle in 0..80i64 {
        let value = 1 - cycle % 2;
        let start = cycle * 20 * SECOND + cycle * cycle % 97 * 100 * MS;
        let answer = start + (800 + cycle * 7 % 5 * 10) * MS;
        rows.push((start, "G-A1-X", value));
        rows.extend(["G-A1-Y", "G-B-X"].map(|name| (answer, name, value)));
        rows.extend(["H-C-X", "O_Pump_Run"].map(|name| (answer + 30 * MS, name, value)));
    }
    let parameters = Parameters::default();
    let whole = learn(&[log_of(&rows, &[])], &SymbolTable::default(), &parameters);
    let whole = whole.expect("the log has events");
    let at_once = whole
        .rules
        .iter()
        .filter_map(|rule| rule.trigger.as_deref())
        .filter(|trigger| trigger.clusters.iter().all(|cluster| cluster.maximum_s == 0.0));
    assert_eq!(at_once.count(), 2);
    let parts = in_parts(&rows, &[], &parameters, 33, true).expect("all groups have lessons");
    assert_eq!(whole.rules, parts.rules);
}

fn small() -> Vec<Row> {
    (0..40).map(|i| (i * SECOND, SIGNALS[i as usize % 2], i / 2 % 2)).collect()
}

#[test]
fn lessons_that_do_not_fit_are_refused() {
    let rows = small();
    let survey = survey_of(&rows, &[], 7, false);
    let context = Context::of(&survey, &SymbolTable::default(), &Parameters::default())
        .map(Arc::new)
        .expect("rows");
    let lessons = lessons_of(&context, &rows, false);
    let of = |lessons: &[Lesson]| merge(&context, lessons.to_vec()).map(|model| model.rules);
    assert!(of(&lessons).is_ok());
    assert_eq!(of(&lessons[..1]), Err(MergeError::Missing { group: "G".to_owned() }));
    let doubled = [lessons[0].clone(), lessons[0].clone()];
    assert_eq!(of(&doubled), Err(MergeError::Stranger { group: 1 }));
    let empty =
        [0, 1].map(|group| Learner::new(Arc::clone(&context), group).expect("a group").learn());
    assert_eq!(of(&empty), Err(MergeError::Learn(LearnError::NoEvents)));
}

#[test]
fn rows_that_do_not_fit_are_refused() {
    let survey = survey_of(&small(), &[], 100, false);
    let context = Context::of(&survey, &SymbolTable::default(), &Parameters::default())
        .map(Arc::new)
        .expect("rows");
    let mut learner = Learner::new(Arc::clone(&context), 0).expect("a group");
    let group = || "G".to_owned();
    learner.add([(5, 0, 1, None)].into_iter()).expect("fits");
    let older = learner.add([(4, 0, 0, None)].into_iter());
    assert_eq!(older, Err(LessonError::Order { row: 2, group: group() }));
    let strange = learner.add([(6, 1, 0, None)].into_iter());
    assert_eq!(strange, Err(LessonError::Stranger { row: 2, group: group() }));
    let beyond = Learner::new(Arc::clone(&context), 2).map(|_| ());
    assert_eq!(beyond, Err(LessonError::Group { group: 2, groups: 2 }));
}

#[test]
fn bytes_that_are_none_are_refused() {
    let survey = survey_of(&small(), &[], 100, false);
    let mut bytes = survey.save();
    bytes[3] ^= 1;
    assert_eq!(Survey::restore(&bytes), Err(SurveyError::Damaged));
    assert_eq!(Context::restore(&bytes), None);
    assert!(Lesson::restore(&bytes).is_none());
    let other = Survey::new(vec![Gap { start: 0, end: 1 }]);
    assert_eq!(Survey::new(Vec::new()).merge(other), Err(SurveyError::OtherGaps));
}
