//! What a prediction must beat: the commonest activity, and what mostly follows the last one or
//! two.

use std::collections::HashMap;

use super::event_log::{ActivityIndex, EventLog};
use super::succession::Succession;

/// How often each activity followed a context.
type Counts = HashMap<ActivityIndex, u32>;

/// Foretells the activity that most often followed the last few.
#[derive(Debug, Clone, Default)]
pub struct Markov {
    /// Followers by the last activities; one map per length of context, the empty one first.
    followers: Vec<HashMap<Vec<ActivityIndex>, Counts>>,
}

impl Markov {
    /// Counts followers of the last `order` activities and of every shorter context; order 0 is
    /// the commonest activity. Contexts lie inside one trace.
    pub fn fit(log: &EventLog, traces: &[usize], order: usize, succession: Succession) -> Self {
        let mut followers = vec![HashMap::new(); order + 1];
        each(log, traces, succession, |before, next| {
            for (length, table) in followers.iter_mut().enumerate() {
                if length <= before.len() {
                    let context = before[before.len() - length..].to_vec();
                    let counts: &mut Counts = table.entry(context).or_default();
                    *counts.entry(next).or_default() += 1;
                }
            }
        });
        Self { followers }
    }

    /// What follows the activities of a trace so far; the longest known context decides, the
    /// smallest number where several are as common.
    pub fn next(&self, before: &[ActivityIndex]) -> Option<ActivityIndex> {
        self.followers.iter().enumerate().rev().find_map(|(length, table)| {
            let context = before.get(before.len().checked_sub(length)?..)?;
            let counts = table.get(context)?;
            let best = counts.iter().max_by_key(|&(&next, &count)| (count, u32::MAX - next));
            best.map(|(&next, _)| next)
        })
    }

    /// How many events it foretells rightly, and how many there were to foretell.
    pub fn score(
        &self,
        log: &EventLog,
        traces: &[usize],
        succession: Succession,
    ) -> (usize, usize) {
        let mut score = (0, 0);
        each(log, traces, succession, |before, next| {
            score.0 += usize::from(self.next(before) == Some(next));
            score.1 += 1;
        });
        score
    }
}

/// Every event that can be foretold, with the activities of its trace before it.
fn each(
    log: &EventLog,
    traces: &[usize],
    succession: Succession,
    mut take: impl FnMut(&[ActivityIndex], ActivityIndex),
) {
    for &trace in traces {
        let activities = log.trace(trace);
        for event in 0..activities.len() {
            if let Some((next_trace, next)) = succession.next(log, trace, event) {
                take(&activities[..=event], log.trace(next_trace)[next]);
            }
        }
    }
}
