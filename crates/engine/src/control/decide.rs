//! Rule 3: wait for which input, or set which output.

use crate::log::Nanoseconds;
use crate::process::petri::TransitionIndex;

/// One event of the run so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fired {
    /// What happened.
    pub transition: TransitionIndex,
    /// When.
    pub time: Nanoseconds,
}

/// Says how probable each activity is as the next one: the network of Theis 2019, section III-F.
pub trait Decide: Send {
    /// The chance of each transition after the events of the run so far; `None` stands for the
    /// end of the run. What is not named has no chance.
    fn next(&mut self, run: &[Fired]) -> Vec<(Option<TransitionIndex>, f64)>;
}

impl<F> Decide for F
where
    F: FnMut(&[Fired]) -> Vec<(Option<TransitionIndex>, f64)> + Send,
{
    fn next(&mut self, run: &[Fired]) -> Vec<(Option<TransitionIndex>, f64)> {
        self(run)
    }
}
