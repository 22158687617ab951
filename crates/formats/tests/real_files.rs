//! Logs of real machines; skipped where the folder is not there.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scratch;

use runglight_formats::{ReadOptions, Reading, read};
use scratch::{options, real_file};

fn read_real(name: &str, json: &str) -> Option<Result<Reading, String>> {
    Some(read(&real_file(name)?, &options(json)).map_err(|error| error.to_string()))
}

#[test]
fn filling_line_gives_its_edges() {
    let Some(reading) = read_real("vps_filling/Filling_ALL.module.csv", "{}") else { return };
    let log = reading.unwrap().log;
    let mut last = vec![None; log.signals.len()];
    let mut highest = vec![0; log.signals.len()];
    for (&signal, &value) in log.signal.iter().zip(&log.value) {
        highest[signal as usize] = highest[signal as usize].max(value);
    }
    let mut edges = 0;
    for (&signal, &value) in log.signal.iter().zip(&log.value) {
        let signal = signal as usize;
        let changed = last[signal].is_some_and(|last| last != value);
        edges += u32::from(changed && highest[signal] == 1);
        last[signal] = Some(value);
    }
    assert_eq!(edges, 2_196);
    assert!(log.signals.iter().any(|name| name == "State"));
    assert!(!log.signals.iter().any(|name| name.ends_with("Distance")));
    assert_eq!(log.time[0], 1_529_500_027_127_000_000);
}

#[test]
fn production_line_has_its_gap() {
    let Some(reading) = read_real("vps_filling/Production.csv", "{}") else { return };
    let log = reading.unwrap().log;
    assert_eq!(log.gaps.len(), 1);
    assert_eq!((log.gaps[0].end - log.gaps[0].start) / 1_000_000_000, 167);
}

#[test]
fn conveyor_keeps_control_words_and_names_measurements() {
    let Some(reading) = read_real("smartfactory_owl_conveyor/log1.csv", "{}") else { return };
    let Reading { log, report } = reading.unwrap();
    assert_eq!(log.signals.iter().filter(|name| name.ends_with("Ctrl")).count(), 6);
    for measured in ["I_w_BLO_Weg", "O_w_HL_current", "O_i_energie_gesamt"] {
        assert!(report.left_out.iter().any(|left_out| left_out.column == measured), "{measured}");
    }
    // 63601502741.055 s after 0001-01-01 is 2016-06-14 12:05:41.055.
    assert_eq!(log.time[0], 1_465_905_941_055_000_000);
    let json = r#"{"bits": ["O_w_BLO_Axis_Ctrl"], "analog": [["I_w_BLO_Weg", 100.0]]}"#;
    let bits = read_real("smartfactory_owl_conveyor/log1.csv", json).unwrap().unwrap().log;
    assert!(bits.signals.iter().any(|name| name == "O_w_BLO_Axis_Ctrl.0"));
    assert!(bits.signals.iter().any(|name| name == "I_w_BLO_Weg"));
}

#[test]
fn traffic_signal_is_the_same_from_csv_and_parquet() {
    let Some(csv) = read_real("atspm_signal/sample_raw_data.csv", "{}") else { return };
    let csv = csv.unwrap();
    let parquet = read_real("atspm_signal/sample_raw_data.parquet", "{}").unwrap().unwrap();
    assert_eq!(csv.report.rows, 37_152);
    assert_eq!(csv.log.len(), 2 * 37_152);
    assert_eq!(csv.log, parquet.log);
    assert_eq!(csv.log.signals[0], "1136-5-0");
    assert!(csv.report.notes.iter().any(|note| note.contains("occurrence")));
}

#[test]
fn liqueur_plant_says_which_option_it_needs() {
    let Some(error) = read_real("liqueur_plant/LiqueurPlant2024_LOG.txt", "{}") else { return };
    let error = error.unwrap_err();
    assert!(error.contains("signal_columns") && error.contains("source"), "{error}");
    let json = r#"{"signal_columns": ["source", "info"], "reorder_s": 1e9}"#;
    let reading = read_real("liqueur_plant/LiqueurPlant2024_LOG.txt", json).unwrap().unwrap();
    assert_eq!(reading.report.rows, 720);
    assert_eq!(reading.log.signals[0], "s1-StartFilling");
    // 03-04-24 14:46:40.40
    assert_eq!(reading.log.time[0], 1_712_155_600_400_000_000);
}

#[test]
fn every_real_log_ends_in_data_or_one_line() {
    let Some(folder) = real_file("") else { return };
    let mut tried = 0;
    let mut folders = vec![folder];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            tried += 1;
            if let Err(error) = read(&path, &ReadOptions::default()) {
                let error = error.to_string();
                assert!(!error.contains('\n'), "{error}");
                assert!(error.contains(&*path.file_name().unwrap().to_string_lossy()), "{error}");
            }
        }
    }
    assert!(tried > 20);
}
