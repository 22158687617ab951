//! Beyond the published steps: where joins were in doubt and the net is not sound, other ways to
//! join are tried. The sound model that most of the runs follow is taken; without one, the first.

use super::model::{Kind, ProcessModel};
use super::to_net::to_net;
use crate::process::event_log::EventLog;
use crate::process::fitness::variants;
use crate::process::language::Language;
use crate::process::petri::PetriNet;
use crate::process::soundness::soundness;

/// Ways of joining that are tried.
const TRIED_AT_MOST: usize = 64;
/// Variants of runs that decide between two sound models.
const VARIANTS_AT_MOST: usize = 256;

/// The model, or one whose doubtful joins are of the other kind.
pub fn repair(model: ProcessModel, doubtful: &[usize], log: &EventLog) -> ProcessModel {
    let joins: Vec<usize> = match doubtful {
        [] => joins_of(&model),
        doubtful => doubtful.to_vec(),
    };
    let net = to_net(&model, &log.activities);
    if joins.is_empty() || soundness(&net).sound == Some(true) {
        return model;
    }
    let mut best: Option<(usize, ProcessModel)> = None;
    for choice in choices(joins.len()).take(TRIED_AT_MOST) {
        let mut other = model.clone();
        for join in choice {
            let kind = &mut other.kinds[joins[join]];
            *kind = if *kind == Kind::Parallel { Kind::Exclusive } else { Kind::Parallel };
        }
        let net = to_net(&other, &log.activities);
        if soundness(&net).sound == Some(true) {
            let fitting = followed(&net, log);
            if best.as_ref().is_none_or(|(most, _)| fitting > *most) {
                best = Some((fitting, other));
            }
        }
    }
    best.map_or(model, |(_, sound)| sound)
}

/// Every gateway that joins.
fn joins_of(model: &ProcessModel) -> Vec<usize> {
    let (into, _) = model.ways();
    (0..model.kinds.len())
        .filter(|&node| model.kinds[node].is_gateway() && into[node].len() > 1)
        .collect()
}

/// One of `count`, then two of them, …
fn choices(count: usize) -> impl Iterator<Item = Vec<usize>> {
    let single = (0..count).map(|one| vec![one]);
    let pairs = (0..count).flat_map(move |a| (a + 1..count).map(move |b| vec![a, b]));
    single.chain(pairs)
}

fn followed(net: &PetriNet, log: &EventLog) -> usize {
    let mut language = Language::new(net, &log.activities);
    let variants = variants(log).into_iter().take(VARIANTS_AT_MOST);
    variants.filter(|(trace, _)| language.allows(trace)).map(|(_, times)| times).sum()
}

#[cfg(test)]
mod tests {
    use super::repair;
    use crate::process::event_log::EventLog;
    use crate::process::soundness::soundness;
    use crate::process::split_miner::model::{END, Kind, ProcessModel, START};
    use crate::process::split_miner::to_net::to_net;

    #[test]
    fn a_join_of_the_wrong_kind_is_changed() {
        let log = EventLog::from_traces([vec!["a"], vec!["b"]]);
        let kinds = vec![
            Kind::Start,
            Kind::End,
            Kind::Exclusive,
            Kind::Task(0),
            Kind::Task(1),
            Kind::Parallel,
        ];
        let flows = vec![(START, 2), (2, 3), (2, 4), (3, 5), (4, 5), (5, END)];
        let model = ProcessModel { kinds, flows };
        assert_eq!(soundness(&to_net(&model, &log.activities)).sound, Some(false));
        let repaired = repair(model, &[5], &log);
        assert_eq!(soundness(&to_net(&repaired, &log.activities)).sound, Some(true));
    }
}
