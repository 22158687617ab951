//! The densest place of sorted distances.

/// First and last of the most neighbours among `count` sorted ones that lie together; `apart` says
/// whether a later one is too far from an earlier one. `None` where there are none.
pub(super) fn densest(
    count: usize,
    apart: impl Fn(usize, usize) -> bool,
) -> Option<(usize, usize)> {
    let mut best: Option<(usize, usize)> = None;
    // The window never shrinks: one that is no longer than the best found is of no interest.
    let mut start = 0;
    for end in 0..count {
        if apart(start, end) {
            start += 1;
        } else {
            best = Some((start, end));
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::densest;

    #[test]
    fn the_first_of_equals_is_taken_and_none_of_nothing() {
        let places = [0, 5, 6, 20, 21];
        let apart = |start: usize, end: usize| places[end] - places[start] > 2;
        assert_eq!(densest(places.len(), apart), Some((1, 2)));
        assert_eq!(densest(0, apart), None);
    }
}
