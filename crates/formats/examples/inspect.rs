//! Reads a log and prints the report: `cargo run --release --example inspect FILE [OPTIONS_JSON]`.

use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("usage: inspect FILE [OPTIONS_JSON]")?;
    let options = arguments.next().unwrap_or_else(|| "{}".to_owned());
    let options = serde_json::from_str(&options)?;
    let start = Instant::now();
    let reading = runglight_formats::read(Path::new(&path), &options)?;
    let seconds = start.elapsed().as_secs_f64();
    println!("{}", serde_json::to_string_pretty(&reading.report)?);
    println!(
        "{} rows of {} signals, {} gaps, scan interval {:?} ns; {:.2} M file rows/s",
        reading.log.len(),
        reading.log.signals.len(),
        reading.log.gaps.len(),
        reading.log.scan_interval,
        reading.report.rows as f64 / seconds / 1e6
    );
    Ok(())
}
