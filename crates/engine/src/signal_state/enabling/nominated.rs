//! What others have named as a trigger, held against what was found.

use crate::signal_state::states::StateId;

use super::{Delayed, Entry, GAIN, Happenings, INSTANCES_AT_LEAST, TIGHT_RESOLUTIONS};
use super::{delays, residual_spread};

/// The pair from whose later one a transition into `next` is explained best, where that is as far
/// better as a trigger must be than the device's own times, than what it `has`.
pub fn better(
    index: Happenings<'_>,
    instances: &[Entry],
    next: StateId,
    has: [StateId; 2],
    pairs: &[[StateId; 2]],
) -> Option<Delayed> {
    if pairs.is_empty() || instances.len() < INSTANCES_AT_LEAST {
        return None;
    }
    let waits = delays::waits(index, instances, next);
    let mut room = Vec::new();
    let own_spread = residual_spread(&delays::sorted(index, &waits, has, &mut room)?);
    if own_spread <= TIGHT_RESOLUTIONS * index.resolution_s {
        return None;
    }
    let explained = pairs.iter().filter_map(|&states| {
        let delays = delays::sorted(index, &waits, states, &mut room)?;
        let spread = residual_spread(&delays);
        (spread <= GAIN * own_spread).then_some((spread, delays, states))
    });
    let (_, delays, states) = explained.min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Delayed { states, delays })
}
