//! The symbol table, `symbols.csv`: `address,group,device,signal,class,type,description`.

use std::collections::HashMap;

use thiserror::Error;

use crate::plant::{Plant, SignalClass};

/// One row of the table.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SymbolEntry {
    /// PLC address; the only column that must be filled.
    pub address: String,
    /// Group, where given.
    pub group: Option<String>,
    /// Device, where given.
    pub device: Option<String>,
    /// Signal name, where given.
    pub signal: Option<String>,
    /// Input, output or memory, where given.
    pub class: Option<SignalClass>,
    /// True where the type is a word or integer.
    pub word: bool,
    /// Free text.
    pub description: String,
}

impl SymbolEntry {
    /// `Group-Device-Signal`, where all three are given.
    pub fn full_name(&self) -> Option<String> {
        match (&self.group, &self.device, &self.signal) {
            (Some(group), Some(device), Some(signal)) => Some(format!("{group}-{device}-{signal}")),
            _ => None,
        }
    }
}

/// Why a text is no symbol table.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SymbolError {
    /// The header lacks `address`.
    #[error(
        "symbol table, row 1: expected a column 'address' (and any of group, device, signal, class, type, description), found '{found}'"
    )]
    Header {
        /// The header row as it stands.
        found: String,
    },
    /// A column nobody knows.
    #[error(
        "symbol table, row 1: unknown column '{column}'; known are address, group, device, signal, class, type, description"
    )]
    Column {
        /// Its name.
        column: String,
    },
    /// A row that cannot be used.
    #[error("symbol table, row {row}: {problem}")]
    Row {
        /// Row as a text editor counts, the header being row 1.
        row: u64,
        /// What is wrong and what was expected.
        problem: String,
    },
}

/// Finds rows by address or by full name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct SymbolTable {
    entries: Vec<SymbolEntry>,
    by_symbol: HashMap<String, usize>,
}

const WORD_TYPES: [&str; 16] = [
    "word", "int", "uint", "dint", "udint", "lint", "ulint", "sint", "usint", "byte", "dword",
    "lword", "integer", "int16", "uint16", "int32",
];

impl SymbolTable {
    /// Reads the text of a `symbols.csv`; comma, semicolon and tab all serve.
    ///
    /// # Errors
    /// A missing address column, an unknown column or class, a row without address, an address
    /// or name given twice.
    pub fn parse(text: &str) -> Result<Self, SymbolError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let first = text.lines().next().unwrap_or_default();
        let delimiter = [b';', b'\t', b',']
            .into_iter()
            .find(|&d| first.as_bytes().contains(&d))
            .unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let header = reader.headers().cloned().unwrap_or_default();
        let columns: Vec<String> = header.iter().map(str::to_ascii_lowercase).collect();
        if !columns.iter().any(|c| c == "address") {
            return Err(SymbolError::Header { found: first.chars().take(80).collect() });
        }
        if let Some(column) = columns.iter().find(|c| {
            !["address", "group", "device", "signal", "class", "type", "description"]
                .contains(&c.as_str())
        }) {
            return Err(SymbolError::Column { column: column.clone() });
        }
        let mut table = Self::default();
        for (index, record) in reader.records().enumerate() {
            let counted = index as u64 + 2;
            let record =
                record.map_err(|e| SymbolError::Row { row: counted, problem: csv_problem(&e) })?;
            let row = record.position().map_or(counted, csv::Position::line);
            let entry = parse_row(&columns, &record)
                .map_err(|problem| SymbolError::Row { row, problem })?;
            table.insert(entry).map_err(|problem| SymbolError::Row { row, problem })?;
        }
        Ok(table)
    }

    fn insert(&mut self, entry: SymbolEntry) -> Result<(), String> {
        let index = self.entries.len();
        let names = [Some(entry.address.clone()), entry.full_name()];
        for name in names.into_iter().flatten() {
            match self.by_symbol.insert(name.clone(), index) {
                Some(earlier) if earlier != index => {
                    return Err(format!("'{name}' stands in the table twice; keep one row"));
                }
                _ => {}
            }
        }
        self.entries.push(entry);
        Ok(())
    }

    /// The row of a symbol, by address or by full name.
    pub fn find(&self, symbol: &str) -> Option<&SymbolEntry> {
        self.by_symbol.get(symbol).map(|&index| &self.entries[index])
    }

    /// Writes the table in force for a plant: what a user edits and gives back.
    pub fn of_plant(plant: &Plant) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let mut rows = vec![
            ["address", "group", "device", "signal", "class", "type", "description"]
                .map(str::to_owned),
        ];
        rows.extend(plant.signals.iter().map(|signal| {
            let device = &plant.devices[signal.device()];
            [
                signal.address().unwrap_or(signal.symbol()).to_owned(),
                plant.groups[device.group].name.clone(),
                device.name.clone(),
                signal.name().to_owned(),
                match signal.class {
                    SignalClass::Input => "input",
                    SignalClass::Output => "output",
                    SignalClass::Memory => "memory",
                }
                .to_owned(),
                if signal.word { "INT" } else { "BOOL" }.to_owned(),
                signal.description().to_owned(),
            ]
        }));
        for row in rows {
            // Writing into memory cannot fail.
            let _ = writer.write_record(row);
        }
        writer.into_inner().map(|b| String::from_utf8_lossy(&b).into_owned()).unwrap_or_default()
    }
}

fn parse_row(columns: &[String], record: &csv::StringRecord) -> Result<SymbolEntry, String> {
    let mut entry = SymbolEntry::default();
    for (column, field) in columns.iter().zip(record.iter()) {
        let filled = (!field.is_empty()).then(|| field.to_owned());
        match column.as_str() {
            "address" => entry.address = field.to_owned(),
            "group" => entry.group = filled,
            "device" => entry.device = filled,
            "signal" => entry.signal = filled,
            "class" => {
                if filled.is_some() {
                    entry.class = Some(SignalClass::parse(field).ok_or_else(|| {
                        format!("class '{field}' is none of input, output, memory (or %I, %Q, %M)")
                    })?);
                }
            }
            "type" => entry.word = WORD_TYPES.contains(&field.to_ascii_lowercase().as_str()),
            _ => entry.description = field.to_owned(),
        }
    }
    if entry.address.is_empty() {
        return Err("has no address; fill the address column or delete the row".to_owned());
    }
    if entry.class.is_none() {
        entry.class = match SignalClass::guess(&entry.address) {
            SignalClass::Memory => None,
            known => Some(known),
        };
    }
    Ok(entry)
}

fn csv_problem(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("has {len} fields where the header has {expected_len}")
        }
        csv::ErrorKind::Utf8 { .. } => "is not UTF-8 text".to_owned(),
        _ => "is not readable as CSV".to_owned(),
    }
}
