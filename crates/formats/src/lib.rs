//! Change logs in files.
