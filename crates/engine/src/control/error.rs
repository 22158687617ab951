//! Why a net cannot control.

use thiserror::Error;

/// Why a net, or the guards beside it, cannot be run.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ControlError {
    /// A visible transition tells no changes.
    #[error(
        "the net's transition {label:?} tells no change of a signal; a controller needs a net mined from a PLC's inputs and outputs, with activities like \"%IX0.1=0\""
    )]
    NoChanges {
        /// Its label.
        label: String,
    },
    /// One activity changes inputs and outputs at once.
    #[error(
        "the net's transition {label:?} changes inputs and outputs at once; an activity is of one class"
    )]
    MixedClasses {
        /// Its label.
        label: String,
    },
    /// Nothing is ever written.
    #[error("the net sets no output; it was mined from a log without outputs")]
    NoOutputs,
    /// Silent transitions make tokens without end.
    #[error(
        "the net's silent transitions reach more than {most} markings without an event; it is not sound"
    )]
    Unbounded {
        /// How many were looked at.
        most: usize,
    },
    /// The net gets stuck outside its final marking.
    #[error(
        "the net gets stuck after {after:?}, where nothing is enabled and the run is not over; it is not sound"
    )]
    Stuck {
        /// The last activity.
        after: String,
    },
    /// Rule 3, and nothing to decide with.
    #[error(
        "the net alone does not say what comes after {after:?}: {alternatives}; learn guards from a log or give a next-activity network"
    )]
    Undecided {
        /// The last activity.
        after: String,
        /// What is possible.
        alternatives: String,
    },
    /// Guards of another net.
    #[error(
        "the guards name the transition or place {id:?}, which the net does not have; learn them again from this net"
    )]
    Foreign {
        /// Its identifier.
        id: String,
    },
    /// Too many states to write a program.
    #[error("the net has more than {most} states; that is too much for Structured Text")]
    TooLarge {
        /// How many were looked at.
        most: usize,
    },
    /// No guards are learned from nothing.
    #[error("the log never follows the net: no activity of it opens a run of the net")]
    NeverFollowed,
    /// A safe value for a signal that is no output.
    #[error("{address:?} is no output of the net; it has {outputs}")]
    NoSuchOutput {
        /// What was named.
        address: String,
        /// What there is.
        outputs: String,
    },
}
