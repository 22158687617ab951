//! When candidates changed: for drawings, and for how far changes lie from events.

use crate::identify::candidates::Candidate;
use crate::identify::view::View;
use crate::log::{ChangeLog, Nanoseconds};

/// The moments at which each of the candidates changed in a view, those in gaps left out.
pub fn trace(log: &ChangeLog, wanted: &[Candidate], view: View) -> Vec<Vec<Nanoseconds>> {
    let mut of_signal: Vec<Vec<usize>> = vec![Vec::new(); log.signals.len()];
    for (place, candidate) in wanted.iter().enumerate() {
        if let Some(places) = of_signal.get_mut(candidate.signal as usize) {
            places.push(place);
        }
    }
    let mut last: Vec<Option<i64>> = vec![None; log.signals.len()];
    let mut moments = vec![Vec::new(); wanted.len()];
    let mut images = log.gaps.iter().map(|gap| gap.end).peekable();
    for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
        let places = &of_signal[signal as usize];
        if places.is_empty() {
            continue;
        }
        while images.next_if(|&end| end < time).is_some() {}
        let Some(before) = last[signal as usize].replace(value) else { continue };
        if images.peek() == Some(&time) {
            continue;
        }
        for &place in places {
            let counts = match wanted[place].bit {
                None => view.counts(before, value),
                Some(bit) => view.bits(before, value) >> bit & 1 == 1,
            };
            if counts {
                moments[place].push(time);
            }
        }
    }
    moments
}
