//! The naming rule: how a full symbol name splits into group, device and signal.

use thiserror::Error;

/// A pattern such as `{group}-{device}-{signal}` (Ghosh 2016, Table 1).
///
/// The placeholders may stand in any order, parted by any text; a missing `{group}` puts every
/// signal into one group. The last placeholder takes the rest of the name, separators included.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NamingRule {
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Literal(String),
    Field(Field),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Field {
    Group,
    Device,
    Signal,
}

/// A name taken apart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Split {
    /// Group, `plant` where the rule names none.
    pub group: String,
    /// Device.
    pub device: String,
    /// Signal.
    pub signal: String,
}

/// Why a text is no naming rule.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "naming rule '{rule}' {problem}; a rule looks like '{{group}}-{{device}}-{{signal}}' and needs at least {{device}} and {{signal}}"
)]
pub struct NamingError {
    rule: String,
    problem: String,
}

impl Default for NamingRule {
    fn default() -> Self {
        let dash = || Part::Literal("-".to_owned());
        Self {
            parts: vec![
                Part::Field(Field::Group),
                dash(),
                Part::Field(Field::Device),
                dash(),
                Part::Field(Field::Signal),
            ],
        }
    }
}

impl NamingRule {
    /// Reads a pattern.
    ///
    /// # Errors
    /// An unknown or repeated placeholder, two placeholders with nothing between them, or a rule
    /// without device or signal.
    pub fn parse(rule: &str) -> Result<Self, NamingError> {
        let error = |problem: String| NamingError { rule: rule.to_owned(), problem };
        let mut parts = Vec::new();
        let mut rest = rule;
        while !rest.is_empty() {
            let Some(open) = rest.find('{') else {
                parts.push(Part::Literal(rest.to_owned()));
                break;
            };
            if open > 0 {
                parts.push(Part::Literal(rest[..open].to_owned()));
            }
            let close = rest[open..]
                .find('}')
                .ok_or_else(|| error("has an opening brace without a closing one".to_owned()))?
                + open;
            let field = match &rest[open + 1..close] {
                "group" => Field::Group,
                "device" => Field::Device,
                "signal" => Field::Signal,
                other => return Err(error(format!("names the unknown part '{{{other}}}'"))),
            };
            if parts.contains(&Part::Field(field)) {
                return Err(error("names one part twice".to_owned()));
            }
            if matches!(parts.last(), Some(Part::Field(_))) {
                return Err(error("needs a separator between two parts".to_owned()));
            }
            parts.push(Part::Field(field));
            rest = &rest[close + 1..];
        }
        for field in [Field::Device, Field::Signal] {
            if !parts.contains(&Part::Field(field)) {
                return Err(error("is incomplete".to_owned()));
            }
        }
        Ok(Self { parts })
    }

    /// Takes a name apart, or `None` where it does not fit.
    pub fn split(&self, name: &str) -> Option<Split> {
        let mut split = Split {
            group: crate::plant::PLANT_GROUP.to_owned(),
            device: String::new(),
            signal: String::new(),
        };
        let mut rest = name;
        let mut parts = self.parts.iter().peekable();
        while let Some(part) = parts.next() {
            match part {
                Part::Literal(text) => rest = rest.strip_prefix(text.as_str())?,
                Part::Field(field) => {
                    let end = match parts.peek() {
                        Some(Part::Literal(text)) => rest.find(text.as_str())?,
                        _ => rest.len(),
                    };
                    if end == 0 {
                        return None;
                    }
                    let text = rest[..end].to_owned();
                    match field {
                        Field::Group => split.group = text,
                        Field::Device => split.device = text,
                        Field::Signal => split.signal = text,
                    }
                    rest = &rest[end..];
                }
            }
        }
        rest.is_empty().then_some(split)
    }
}
