//! Which word should have come, and which bits say so (section 3.6).
//!
//! The paper contradicts itself: Eq. (3) sums the *equal* bits of prediction and failure, its
//! example counts the *different* ones (two, for 42 against 4e) and gets 0.25 and 1.06. The equation
//! is right: a prediction must resemble what was seen, and with different bits counted the least
//! similar candidate would win. So for 42: 6 / 8 = 0.75, and 2 · 0.75 + 10 / 18 = 2.06. The bits
//! that differ are the paper's "positions 4 and 5" only when counted from the left; their S7
//! addresses, which count from the right, are bits 3 and 2.

use super::regions::Word;

/// A word that could have come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// The word.
    pub word: Word,
    /// How often it was seen to come.
    pub weight: u64,
    /// Its share of all that came, Eq. (2).
    pub popularity: f64,
    /// Equal bits over the width of the word, Eq. (3) and (4).
    pub similarity: f64,
    /// 2 · similarity + popularity, Eq. (5).
    pub score: f64,
    /// Bits that differ from what was seen.
    pub differing: Word,
}

/// All candidates, best first; equal scores by weight, then by word.
pub fn candidates(
    possible: impl IntoIterator<Item = (Word, u64)>,
    seen: Word,
    width: usize,
) -> Vec<Candidate> {
    let possible: Vec<(Word, u64)> = possible.into_iter().collect();
    let sum: u64 = possible.iter().map(|(_, weight)| weight).sum();
    let mut candidates: Vec<Candidate> = possible
        .into_iter()
        .map(|(word, weight)| {
            let differing = word ^ seen;
            let equal = width as u32 - differing.count_ones().min(width as u32);
            let popularity = weight as f64 / sum.max(1) as f64;
            let similarity = f64::from(equal) / width.max(1) as f64;
            let score = 2.0f64.mul_add(similarity, popularity);
            Candidate { word, weight, popularity, similarity, score, differing }
        })
        .collect();
    candidates.sort_by(|a, b| {
        b.score.total_cmp(&a.score).then(b.weight.cmp(&a.weight)).then(a.word.cmp(&b.word))
    });
    candidates
}

/// Table 1: class of a suspect, from the alarm bit and whether its candidate has the highest score.
pub fn class(alarm: bool, highest: bool) -> u8 {
    match (alarm, highest) {
        (true, true) => 1,
        (true, false) => 2,
        (false, true) => 3,
        (false, false) => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Figure 4 and section 3.6: state 52 goes on to 42 (10), 4a (2) or 5a (6); 4e was found.
    fn of_the_paper() -> Vec<Candidate> {
        candidates([(0x42, 10), (0x4a, 2), (0x5a, 6)], 0x4e, 8)
    }

    fn of(word: Word) -> Candidate {
        let ranked = of_the_paper();
        ranked[ranked.iter().position(|c| c.word == word).unwrap_or(usize::MAX)]
    }

    #[test]
    fn popularity_as_in_the_paper() {
        assert_eq!(of(0x42).popularity, 10.0 / 18.0);
        assert_eq!(of(0x4a).popularity, 2.0 / 18.0);
        assert_eq!(of(0x5a).popularity, 6.0 / 18.0);
        assert_eq!(format!("{:.2}", of(0x42).popularity), "0.56");
    }

    #[test]
    fn similarity_counts_equal_bits() {
        assert_eq!(of(0x42).similarity, 6.0 / 8.0);
        assert_eq!(of(0x4a).similarity, 7.0 / 8.0);
        assert_eq!(of(0x5a).similarity, 6.0 / 8.0);
        // What the example of the paper prints: different bits counted, 2 / 8.
        assert_eq!(f64::from(of(0x42).differing.count_ones()) / 8.0, 0.25);
        assert_eq!(format!("{:.2}", 2.0 * 0.25 + of(0x42).popularity), "1.06");
    }

    #[test]
    fn final_scores_and_prediction() {
        let ranked = of_the_paper();
        let words: Vec<Word> = ranked.iter().map(|c| c.word).collect();
        assert_eq!(words, [0x42, 0x4a, 0x5a]);
        let scores: Vec<f64> = ranked.iter().map(|c| c.score).collect();
        assert_eq!(scores, [1.5 + 10.0 / 18.0, 1.75 + 2.0 / 18.0, 1.5 + 6.0 / 18.0]);
        // 42 and 4e differ in bits 3 and 2: positions 4 and 5 counted from the left.
        assert_eq!(ranked[0].differing, 0b0000_1100);
        assert_eq!(ranked[1].differing, 0b0000_0100);
    }

    #[test]
    fn the_reading_of_the_example_would_predict_the_least_similar() {
        let wrong = |c: &Candidate| 2.0 * f64::from(c.differing.count_ones()) / 8.0;
        let (near, far) = (of(0x4a), of(0x5a));
        assert!(wrong(&near) < wrong(&far) && near.similarity > far.similarity);
    }

    #[test]
    fn truth_table_of_classes() {
        assert_eq!(class(true, true), 1);
        assert_eq!(class(true, false), 2);
        assert_eq!(class(false, true), 3);
        assert_eq!(class(false, false), 4);
    }

    #[test]
    fn nothing_possible_gives_nothing() {
        assert_eq!(candidates([], 0x4e, 8), []);
    }
}
