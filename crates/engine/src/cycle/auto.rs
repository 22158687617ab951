//! Proposed regions: bits that switch together.
//!
//! Two bits switch together where most changes of either lie close to one of the other's, and the
//! closer the better. Bits are joined, the closest pair first, while a region stays small: regions of a byte keep sequences stable
//! (section 3.3). Bits that never change are watched by the byte they lie in.

use std::collections::{BTreeMap, HashMap, VecDeque};

use crate::log::{ChangeLog, SECOND};

use super::address::Place;
use super::parameters::CycleParameters;
use super::regions::{Directory, Modes, Region};

/// Least closeness, from 0 (never within the time that counts) to 1 (always in the same reading).
const TOGETHER: f64 = 0.4;
/// Changes looked back on.
const LOOKED_BACK_ON: usize = 16;

/// Regions of all bits but outputs and the mode bits; the paper watches inputs only, since an
/// output that fails shows in the sensor that does not answer.
pub fn propose(
    logs: &[&ChangeLog],
    maps: &[Vec<Option<u32>>],
    directory: &Directory,
    modes: &Modes,
    parameters: &CycleParameters,
) -> Vec<Region> {
    let bits = directory.bits().len();
    let mut watched = vec![true; bits];
    for (bit, watched) in watched.iter_mut().enumerate() {
        *watched = directory.place(bit).is_none_or(|place| !place.area.starts_with('Q'));
    }
    for mode in modes.all() {
        watched[mode.bit] = false;
    }
    let (changes, beside) = count(logs, maps, &watched, parameters);
    let mut pairs: Vec<(f64, u32, u32)> = beside
        .into_iter()
        .map(|((a, b), both)| {
            let more = changes[a as usize].max(changes[b as usize]).max(1);
            (both / f64::from(more), a, b)
        })
        .filter(|pair| pair.0 >= TOGETHER)
        .collect();
    pairs.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
    let mut region_of: Vec<usize> = (0..bits).collect();
    let mut members: Vec<Vec<usize>> = (0..bits).map(|bit| vec![bit]).collect();
    for (_, a, b) in pairs {
        let (into, from) = (region_of[a as usize], region_of[b as usize]);
        if into != from && members[into].len() + members[from].len() <= parameters.auto_bits {
            let moved = std::mem::take(&mut members[from]);
            for &bit in &moved {
                region_of[bit] = into;
            }
            members[into].extend(moved);
        }
    }
    let key = |bit: usize| {
        let place = directory.place(bit).map(Place::word_order);
        (place.is_none(), place, directory.bits()[bit].symbol.clone())
    };
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut still: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for (bit, of_bit) in members.into_iter().enumerate() {
        match of_bit.as_slice() {
            [] => {}
            [only] if !watched[*only] => {}
            [only] if changes[*only] == 0 => {
                let byte = directory.place(bit).filter(|place| place.bit.is_some());
                let byte = byte.map_or_else(String::new, |p| format!("{}{}", p.area, p.number));
                still.entry(byte).or_default().push(bit);
            }
            _ => groups.push(of_bit),
        }
    }
    for of_byte in still.into_values() {
        groups.extend(of_byte.chunks(parameters.auto_bits.max(1)).map(<[usize]>::to_vec));
    }
    for group in &mut groups {
        group.sort_by_key(|&bit| key(bit));
    }
    groups.sort_by_key(|group| key(group[0]));
    let name = |group: &[usize]| {
        let bit = &directory.bits()[group[0]];
        bit.address.clone().unwrap_or_else(|| bit.symbol.clone())
    };
    groups
        .iter()
        .map(|group| Region {
            name: format!("auto-{}", name(group)),
            slots: group.iter().copied().map(Some).collect(),
        })
        .collect()
}

type Beside = HashMap<(u32, u32), f64>;

/// Changes per bit, and the sum of how close the changes of two bits came.
fn count(
    logs: &[&ChangeLog],
    maps: &[Vec<Option<u32>>],
    watched: &[bool],
    parameters: &CycleParameters,
) -> (Vec<u32>, Beside) {
    let together = (parameters.together_s * SECOND as f64) as i64;
    let mut changes = vec![0u32; watched.len()];
    let mut beside = Beside::new();
    for (log, map) in logs.iter().zip(maps) {
        let mut values: Vec<Option<bool>> = vec![None; watched.len()];
        let mut recent: VecDeque<(u32, i64)> = VecDeque::new();
        for ((&time, &signal), &value) in log.time.iter().zip(&log.signal).zip(&log.value) {
            let Some(bit) = map[signal as usize].filter(|&bit| watched[bit as usize]) else {
                continue;
            };
            let before = values[bit as usize].replace(value != 0);
            if before.unwrap_or(false) == (value != 0) || before.is_none() {
                continue;
            }
            changes[bit as usize] += 1;
            let mut met: Vec<u32> = vec![bit];
            for &(other, since) in recent.iter().rev() {
                let apart = time.saturating_sub(since);
                if apart > together {
                    break;
                }
                if !met.contains(&other) {
                    met.push(other);
                    let close = 1.0 - apart as f64 / together.max(1) as f64;
                    *beside.entry((bit.min(other), bit.max(other))).or_default() += close;
                }
            }
            recent.push_back((bit, time));
            if recent.len() > LOOKED_BACK_ON {
                recent.pop_front();
            }
        }
    }
    (changes, beside)
}
