//! Converts a log: `cargo run --release --example convert FROM TO`.

use std::path::Path;
use std::time::Instant;

use runglight_formats::{ReadOptions, read, write};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [from, to] = arguments.as_slice() else { return Err("usage: convert FROM TO".into()) };
    let log = read(Path::new(from), &ReadOptions::default())?.log;
    let start = Instant::now();
    let rows = write(&log, Path::new(to), None)?;
    println!("{rows} rows, {:.2} M rows/s", rows as f64 / start.elapsed().as_secs_f64() / 1e6);
    Ok(())
}
