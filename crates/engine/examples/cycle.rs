//! Region words per second that the cycle machine's monitor takes, on one core:
//! `cargo run --release --example cycle`.
//!
//! Twenty regions of a byte go round, each change in a reading of its own, in the four orders that
//! were learned of every pair; nothing is out of turn.

use std::sync::Arc;
use std::time::Instant;

use runglight_engine::cycle::learn::learn;
use runglight_engine::cycle::monitor::Monitor;
use runglight_engine::cycle::parameters::{CycleParameters, ModeSpec, RegionSpec, RegionSpecs};
use runglight_engine::log::ChangeLog;
use runglight_engine::naming::NamingRule;
use runglight_engine::plant::Plant;
use runglight_engine::signal_state::events::Row;
use runglight_engine::symbols::SymbolTable;

const REGIONS: u32 = 20;
const CYCLES: u32 = 4_000;
const LEARNED: u32 = 200;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let signals: Vec<String> = (0..REGIONS)
        .flat_map(|byte| (0..8).map(move |bit| format!("I{byte}.{bit}")))
        .chain(["M0.0".to_owned()])
        .collect();
    let work = signals.len() as u32 - 1;
    let mut rows: Vec<Row> = Vec::new();
    let mut push = |signal, value| {
        let time = rows.len() as i64 * 1_000_000;
        rows.push(Row { time, signal, value });
    };
    let mut random = 12345u32;
    for cycle in 0..CYCLES {
        push(work, i64::from(cycle % 2 == 0));
        for value in [1, 0] {
            for pair in 0..4 {
                for region in 0..REGIONS {
                    random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let swapped = random >> 31;
                    push(region * 8 + pair * 2 + swapped, value);
                    push(region * 8 + pair * 2 + (1 - swapped), value);
                }
            }
        }
    }
    let learned = (rows.len() / CYCLES as usize) * LEARNED as usize;
    let log = ChangeLog {
        time: rows[..learned].iter().map(|row| row.time).collect(),
        signal: rows[..learned].iter().map(|row| row.signal).collect(),
        value: rows[..learned].iter().map(|row| row.value).collect(),
        signals: signals.clone(),
        ..ChangeLog::default()
    };
    let rule = NamingRule::parse("{group}-{device}-{signal}")?;
    let plant = Plant::arrange(&signals, &SymbolTable::parse("address\n")?, &rule);
    let modes = ModeSpec { work_complete: "M0.0".to_owned(), ..ModeSpec::default() };
    let bytes = RegionSpec::Text(format!("I0-I{} by byte", REGIONS - 1));
    let regions = RegionSpecs::from([("byte".to_owned(), bytes)]);
    let model = Arc::new(learn(&[log], &plant, &modes, &regions, &CycleParameters::default())?);
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let mut monitor = Monitor::new(Arc::clone(&model));
        let began = Instant::now();
        let mut findings = 0;
        for batch in rows.chunks(1024) {
            findings += monitor.observe(batch)?.len();
        }
        best = best.min(began.elapsed().as_secs_f64());
        assert!(findings == 0, "a sound log has {findings} findings");
    }
    let words = rows.len() - CYCLES as usize;
    println!("{{\"words\": {words}, \"words_per_s\": {:.0}}}", words as f64 / best);
    Ok(())
}
