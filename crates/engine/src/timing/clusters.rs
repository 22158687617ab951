//! The clusters of one transition, kept where it is: nearly all transitions have exactly one, and
//! a plant has tens of thousands of transitions.

use std::ops::{Deref, DerefMut};

use serde::{Deserialize, Serialize};

use super::TimeCluster;

/// A slice of clusters that needs no memory of its own where it is a single one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Vec<TimeCluster>", into = "Vec<TimeCluster>")]
pub struct Clusters(Kept);

#[derive(Debug, Clone, PartialEq)]
enum Kept {
    One(TimeCluster),
    Other(Box<[TimeCluster]>),
}

impl Default for Clusters {
    fn default() -> Self {
        Self(Kept::Other(Box::default()))
    }
}

impl From<&[TimeCluster]> for Clusters {
    fn from(clusters: &[TimeCluster]) -> Self {
        Self(match clusters {
            [only] => Kept::One(*only),
            other => Kept::Other(other.into()),
        })
    }
}

impl From<Vec<TimeCluster>> for Clusters {
    fn from(clusters: Vec<TimeCluster>) -> Self {
        clusters.as_slice().into()
    }
}

impl From<Clusters> for Vec<TimeCluster> {
    fn from(clusters: Clusters) -> Self {
        clusters.to_vec()
    }
}

impl Deref for Clusters {
    type Target = [TimeCluster];

    fn deref(&self) -> &[TimeCluster] {
        match &self.0 {
            Kept::One(only) => std::slice::from_ref(only),
            Kept::Other(other) => other,
        }
    }
}

impl DerefMut for Clusters {
    fn deref_mut(&mut self) -> &mut [TimeCluster] {
        match &mut self.0 {
            Kept::One(only) => std::slice::from_mut(only),
            Kept::Other(other) => other,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_comes_back() {
        for number in 0..4u32 {
            let clusters: Vec<TimeCluster> = (1..=number)
                .map(|i| TimeCluster::of(&vec![f64::from(i); i as usize], 10))
                .collect();
            let kept = Clusters::from(clusters.clone());
            assert_eq!(*kept, *clusters);
            assert_eq!(Vec::from(kept), clusters);
        }
    }

    #[test]
    fn one_takes_no_more_room_than_it_needs() {
        assert_eq!(size_of::<TimeCluster>(), 56);
        assert_eq!(size_of::<Clusters>(), 64);
    }
}
