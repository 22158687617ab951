//! The JSON of findings that have nearly all in common: the same part is written once.

use super::{Finding, time_text};

/// JSON of findings that differ in id, incident, time, the two measures and the message only.
#[derive(Debug)]
pub struct Line {
    /// Between the time and what was observed.
    middle: Box<[u8]>,
    /// Between the limit and the message.
    end: Box<[u8]>,
}

const MEASURES: &str = r#""observed_s":null,"limit_s":null"#;
const MESSAGE: &str = r#""message":""}"#;

impl Line {
    /// What is the same in all that are like a finding; `None` where the schema has become another
    /// than is known here.
    pub fn of(finding: &Finding) -> Option<Self> {
        let blank = Finding {
            id: String::new(),
            incident: String::new(),
            time: 0,
            observed_s: None,
            limit_s: None,
            message: String::new(),
            ..finding.clone()
        };
        let json = blank.to_json();
        let start = format!(r#"{{"id":"","incident":"","time":"{}""#, time_text(0));
        // Quotes inside a text are escaped, so that a key is found nowhere but in its place.
        let (middle, rest) = json.strip_prefix(&start)?.split_once(MEASURES)?;
        let end = rest.strip_suffix(MESSAGE)?;
        Some(Self { middle: middle.as_bytes().into(), end: end.as_bytes().into() })
    }

    /// Appends what [`Finding::to_json`] gives.
    pub fn append(&self, finding: &Finding, text: &mut Vec<u8>) {
        text.extend_from_slice(br#"{"id":"#);
        append_value(&finding.id, text);
        text.extend_from_slice(br#","incident":"#);
        append_value(&finding.incident, text);
        text.extend_from_slice(br#","time":"#);
        append_value(&time_text(finding.time), text);
        text.extend_from_slice(&self.middle);
        text.extend_from_slice(br#""observed_s":"#);
        append_value(&finding.observed_s, text);
        text.extend_from_slice(br#","limit_s":"#);
        append_value(&finding.limit_s, text);
        text.extend_from_slice(&self.end);
        text.extend_from_slice(br#""message":"#);
        append_value(&finding.message, text);
        text.push(b'}');
    }
}

fn append_value(value: &impl serde::Serialize, text: &mut Vec<u8>) {
    // Texts and numbers always have a JSON, and memory takes everything.
    let _ = serde_json::to_writer(text, value);
}

#[cfg(test)]
mod tests {
    use super::Line;
    use crate::finding::{Expected, Finding, Kind, Model, Severity, Suspect};

    /// A finding whose texts look like what is searched for.
    fn awkward() -> Finding {
        let text = r#"Ä "x","observed_s":null,"limit_s":null,"message":""}\"#.to_owned();
        Finding {
            id: "0123456789ab".to_owned(),
            incident: text.clone(),
            severity: Severity::Anomaly,
            group: Some(text.clone()),
            from: Some(text.clone()),
            expected: vec![Expected { state: text.clone(), probability: 0.25, limit_s: None }],
            observed_s: Some(0.1 + 0.2),
            limit_s: Some(f64::INFINITY),
            suspects: vec![Suspect { address: None, signal: text.clone(), score: 1.0 }],
            path: vec![text.clone(), String::new()],
            message: text,
            ..Finding::new(Kind::Late, Model::Device, 1_767_855_325_500_000_000)
        }
    }

    #[test]
    fn a_line_is_the_json_of_every_finding_like_it() {
        let mut finding = awkward();
        let line = Line::of(&finding).expect("the schema is known");
        for number in [0, 1, -1, i64::MAX, i64::MIN] {
            let mut text = b"before".to_vec();
            line.append(&finding, &mut text);
            assert_eq!(String::from_utf8(text).unwrap(), format!("before{}", finding.to_json()));
            finding.id = format!("{number:x}");
            finding.incident.clear();
            finding.time = number;
            finding.observed_s = (number > 0).then_some(number as f64);
            finding.limit_s = None;
            finding.message = format!("\"{number}\" came\nlate");
        }
    }
}
