//! Ways on that a make of devices takes: what is news to one gun may be known from the others.

use super::sisters::Family;

/// How often each transition was taken, by all sisters together.
#[derive(Debug, Clone, Default)]
pub struct Ways {
    /// Sorted by family.
    taken: Box<[(Family, u64)]>,
}

impl Ways {
    /// From every rule's family and evidence.
    pub fn of(rules: impl Iterator<Item = (Family, u64)>) -> Self {
        let mut taken: Vec<(Family, u64)> = rules.collect();
        taken.sort_unstable();
        taken.dedup_by(|next, kept| {
            let alike = next.0 == kept.0;
            kept.1 += if alike { next.1 } else { 0 };
            alike
        });
        Self { taken: taken.into() }
    }

    /// How often sisters took a transition; none where it is a rule of no sister, not even of how
    /// they start.
    pub fn taken(&self, family: Family) -> Option<u64> {
        let found = self.taken.binary_search_by_key(&family, |&(family, _)| family);
        found.ok().map(|at| self.taken[at].1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sisters_are_counted_together() {
        let ways = Ways::of([(7, 40), (3, 0), (7, 1)].into_iter());
        assert_eq!(ways.taken(7), Some(41));
        assert_eq!(ways.taken(3), Some(0), "how a machine starts is known, but no evidence");
        assert_eq!(ways.taken(5), None);
    }
}
