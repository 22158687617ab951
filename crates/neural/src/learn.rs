//! From an event log and its net to a network that foretells what comes next.

use runglight_engine::process::decay::Samples;
use runglight_engine::process::event_log::EventLog;
use runglight_engine::process::lesson::Lesson;
use runglight_engine::process::next_activity::NextActivity;
use runglight_engine::process::petri::PetriNet;
use runglight_engine::process::succession::Succession;

use crate::training::{Epoch, Rows, Settings, TrainingError, train};

/// One trace in so many is held out for early stopping.
const HELD_OUT_ONE_IN: usize = 5;

/// Trains on some traces of a log; with early stopping the last fifth of five or more is held out.
///
/// # Errors
/// Nothing to learn from, settings that make no sense, or `goes_on` said `false`.
pub fn learn(
    net: &PetriNet,
    log: &EventLog,
    traces: &[usize],
    succession: Succession,
    settings: &Settings,
    goes_on: impl FnMut(Epoch) -> bool,
) -> Result<NextActivity, TrainingError> {
    let lesson = Lesson::prepare(net, log, traces, succession);
    let samples = &lesson.samples;
    // Of a few traces none can be spared.
    let held_out = settings.patience.filter(|_| traces.len() >= HELD_OUT_ONE_IN);
    let kept = traces.len() - held_out.map_or(0, |_| traces.len().div_ceil(HELD_OUT_ONE_IN));
    let split = samples.bounds[kept];
    let held_out = held_out.map(|_| rows(samples, split..samples.next.len()));
    let classes = lesson.activities.len();
    let network = train(rows(samples, 0..split), held_out, classes, settings, goes_on)?;
    let Lesson { activities, decay, scaling, .. } = lesson;
    NextActivity::new(activities, decay, scaling, network).ok_or(TrainingError::NoSamples)
}

fn rows(samples: &Samples, range: std::ops::Range<usize>) -> Rows<'_> {
    Rows {
        features: samples.rows(range.clone()),
        width: samples.width(),
        classes: &samples.next[range],
    }
}
