//! Orders nobody has seen, made of changes everybody knows.
//!
//! Two changes are *independent* where both orders were learned from one state: `s → a → ab` and
//! `s → b → ab`. What was learned then holds for every order that swaps independent neighbours
//! (Mazurkiewicz's traces): three clamps that close in any order make six orders and eight words,
//! of which a few thousand cycles may well miss some.

use std::collections::HashSet;

use super::machine::{Came, Machine, State};
use super::regions::Word;

/// Transitions looked ahead for a change that came before its turn.
const AHEAD_AT_MOST: usize = 6;
/// Steps of one search, so that no region can stall the watch.
const STEPS_AT_MOST: usize = 20_000;

/// Pairs of changes that come in either order. A change is a bit and its new value; within one
/// region that is the mask and what is set of it afterwards.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Independence {
    pairs: HashSet<(Change, Change)>,
}

type Change = (Word, bool);

impl Independence {
    /// Reads the diamonds of a machine.
    pub fn of(machine: &Machine) -> Self {
        let mut pairs = HashSet::new();
        for state in 0..machine.nodes.len() as State {
            let word = machine.word(state);
            let singles: Vec<Word> = machine
                .from(state)
                .iter()
                .map(|t| machine.word(t.to) ^ word)
                .filter(|mask| mask.count_ones() == 1)
                .collect();
            for (place, &a) in singles.iter().enumerate() {
                for &b in &singles[place + 1..] {
                    let both = word ^ a ^ b;
                    let closes = |first: Word| {
                        machine.find(word ^ first).is_some_and(|s| machine.step(s, both).is_some())
                    };
                    if closes(a) && closes(b) {
                        let (a, b) = ((a, word & a == 0), (b, word & b == 0));
                        pairs.insert((a.min(b), a.max(b)));
                    }
                }
            }
        }
        Self { pairs }
    }

    fn independent(&self, a: Change, b: Change) -> bool {
        self.pairs.contains(&(a.min(b), a.max(b)))
    }

    /// Pairs known.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// True where everything was always seen in one order.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }
}

/// True where a word can be reached from a state by single known changes in some order, each word
/// between known too: a scan that saw two changes at once skipped a word, and that is no fault.
pub fn skipped(machine: &Machine, from: State, word: Word) -> bool {
    let mut seen = vec![from];
    let mut place = 0;
    while place < seen.len() && seen.len() < 256 {
        let here = seen[place];
        place += 1;
        let left = machine.word(here) ^ word;
        for transition in machine.from(here) {
            let entered = machine.word(transition.to);
            // Only changes that are still missing, and none twice.
            if (machine.word(here) ^ entered) & !left != 0 || seen.contains(&transition.to) {
                continue;
            }
            if entered == word {
                return true;
            }
            seen.push(transition.to);
        }
    }
    false
}

/// Words that are awaited, without those of a reading that skipped one: where a nearer word that is
/// awaited as well leads on to a farther one, the nearer was passed on the way, and gets its count.
pub fn unskipped(machine: &Machine, from: Word, awaited: Vec<(Word, u64)>) -> Vec<(Word, u64)> {
    let far = |word: Word| (word ^ from).count_ones();
    let mut left = awaited;
    left.sort_by_key(|(word, _)| (far(*word), *word));
    let mut place = left.len();
    while place > 0 {
        place -= 1;
        let (word, count) = left[place];
        let leads_on = |near: Word| {
            far(near) < far(word)
                && machine.find(near).is_some_and(|state| machine.step(state, word).is_some())
        };
        let nearer = (0..place)
            .filter(|&nearer| leads_on(left[nearer].0))
            .max_by_key(|&nearer| (left[nearer].1, std::cmp::Reverse(nearer)));
        if let Some(nearer) = nearer {
            left[nearer].1 += count;
            left.remove(place);
        }
    }
    left
}

/// True where all changes from a state's word to this one come later on a known path, and each
/// may come before what it overtook. A part of a known change of several bits counts as well.
pub fn before_its_turn(
    machine: &Machine,
    independence: &Independence,
    from: State,
    word: Word,
) -> bool {
    Search::new(machine, Some(independence), from, word).overtaken().is_some()
}

/// The bits a change overtook: it comes later on a known path, but never before these. `None`
/// where no known path has it. Paths that went on so from a state entered so are tried first.
pub fn overtaken(
    machine: &Machine,
    independence: &Independence,
    from: State,
    came: Came,
    word: Word,
) -> Option<Vec<Word>> {
    let early = Search { came, ..Search::new(machine, None, from, word) }.overtaken()?;
    let ahead = machine.word(from) ^ word;
    let waits = |&(bit, value): &Change| {
        bits(ahead).any(|b| !independence.independent((b, word & b != 0), (bit, value)))
    };
    Some(early.into_iter().filter(waits).map(|(bit, _)| bit).collect())
}

struct Search<'a> {
    machine: &'a Machine,
    /// What may overtake what; everything where `None`.
    independence: Option<&'a Independence>,
    from: State,
    came: Came,
    /// The word now.
    word: Word,
    /// Changes of the path that have not happened.
    overtaken: Vec<Change>,
    steps: usize,
}

impl<'a> Search<'a> {
    fn new(
        machine: &'a Machine,
        independence: Option<&'a Independence>,
        from: State,
        word: Word,
    ) -> Self {
        Self {
            machine,
            independence,
            from,
            came: Came::Unknown,
            word,
            overtaken: Vec::new(),
            steps: 0,
        }
    }

    fn overtaken(mut self) -> Option<Vec<Change>> {
        let ahead = self.machine.word(self.from) ^ self.word;
        self.follow(self.from, self.came, ahead, ahead, 0).then_some(self.overtaken)
    }

    /// `ahead`: bits that have changed already; `missing`: those not met on the path yet.
    fn follow(
        &mut self,
        state: State,
        came: Came,
        ahead: Word,
        missing: Word,
        depth: usize,
    ) -> bool {
        if missing == 0 {
            return true;
        }
        self.steps += 1;
        if depth == AHEAD_AT_MOST || self.steps > STEPS_AT_MOST {
            return false;
        }
        let machine = self.machine;
        let left = machine.word(state);
        for (number, transition) in machine.onwards(state, came) {
            let entered = machine.word(transition.to);
            let changed = left ^ entered;
            let happened = changed & missing;
            // No bit may move on the path in another sense than it did, or move again.
            if (entered ^ self.word) & happened != 0 || changed & ahead & !missing != 0 {
                continue;
            }
            let alone = |bit: Word| (bit, entered & bit != 0);
            let may = self.independence.is_none_or(|independence| {
                bits(happened).all(|bit| {
                    self.overtaken.iter().all(|&o| independence.independent(alone(bit), o))
                })
            });
            if !may {
                continue;
            }
            let kept = self.overtaken.len();
            self.overtaken.extend(bits(changed & !happened).map(alone));
            // A path in a known sense stays in it; one that began anywhere may go anywhere.
            let next = if self.came == Came::Unknown { Came::Unknown } else { Came::By(number) };
            if self.follow(transition.to, next, ahead, missing & !happened, depth + 1) {
                return true;
            }
            self.overtaken.truncate(kept);
        }
        false
    }
}

fn bits(mask: Word) -> impl Iterator<Item = Word> {
    (0..Word::BITS).map(|bit| 1 << bit).filter(move |bit| mask & bit != 0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cycle::image::Phase;
    use crate::cycle::sequences::{Entered, Sequence};

    fn machine(rows: &[&[Word]]) -> Machine {
        let sequences: Vec<Sequence> = rows
            .iter()
            .map(|words| Sequence {
                phase: Phase::Work,
                words: (0..)
                    .zip(*words)
                    .map(|(time, &word)| Entered { word, time, quiet: 1, position: time as u32 })
                    .collect(),
                end: 100,
            })
            .collect();
        Machine::of(&sequences)
    }

    fn state(machine: &Machine, word: Word) -> State {
        machine.find(word).unwrap_or(State::MAX)
    }

    /// Three clamps, of whose six orders three were seen; together they show every pair both ways.
    fn clamps() -> Machine {
        machine(&[
            &[0b000, 0b001, 0b011, 0b111],
            &[0b000, 0b010, 0b011, 0b111],
            &[0b000, 0b001, 0b101, 0b111],
            &[0b000, 0b010, 0b110, 0b111],
        ])
    }

    #[test]
    fn a_skipped_word_is_no_fault() {
        let machine = clamps();
        let start = state(&machine, 0);
        assert!(skipped(&machine, start, 0b011));
        assert!(skipped(&machine, start, 0b111));
        assert!(!skipped(&machine, start, 0b100));
        assert!(!skipped(&machine, start, 0b1000));
    }

    #[test]
    fn another_order_of_independent_changes_is_known() {
        let machine = clamps();
        let independence = Independence::of(&machine);
        assert!(!independence.is_empty());
        let first = state(&machine, 0b001);
        assert!(before_its_turn(&machine, &independence, first, 0b101));
        // Clamp 3 was never seen first; it overtakes 1 and 2, and was seen to overtake both.
        let start = state(&machine, 0);
        assert!(before_its_turn(&machine, &independence, start, 0b100));
    }

    #[test]
    fn a_change_that_was_always_last_must_wait() {
        let machine = machine(&[&[0b00, 0b01, 0b11], &[0b00, 0b01, 0b11]]);
        let independence = Independence::of(&machine);
        let start = state(&machine, 0);
        assert!(independence.is_empty());
        assert!(!before_its_turn(&machine, &independence, start, 0b10));
    }

    #[test]
    fn half_of_a_known_double_change_is_on_its_way() {
        let machine = machine(&[&[0b00, 0b11]]);
        let independence = Independence::of(&machine);
        let start = state(&machine, 0);
        assert!(before_its_turn(&machine, &independence, start, 0b10));
        assert!(!before_its_turn(&machine, &independence, start, 0b100));
    }

    #[test]
    fn a_reading_that_skipped_a_word_awaits_the_word_it_skipped() {
        // 110 waits for 111; polled slowly, 111 is gone again by the next reading.
        let drills = machine(&[&[0b110, 0b111, 0b000], &[0b110, 0b000], &[0b110, 0b111, 0b011]]);
        let awaited = vec![(0b000, 80), (0b111, 20), (0b100, 5)];
        assert_eq!(unskipped(&drills, 0b110, awaited), [(0b100, 5), (0b111, 100)]);
        // Both are as near: either may come.
        let either = vec![(0b111, 20), (0b100, 5)];
        assert_eq!(unskipped(&drills, 0b110, either.clone()).len(), either.len());
    }
}
