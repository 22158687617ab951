//! Value change dumps, IEEE 1364-2005, clause 18.

mod names;
mod read;
mod write;

pub(crate) use read::read;
pub(crate) use write::write;

/// Our own comments start with this.
const OWN: &str = "runglight";
