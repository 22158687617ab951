//! The tank of Theis 2019 in a few lines: enough to drive a controller through its whole work.

use std::sync::Arc;

use runglight_engine::control::program::Program;
use runglight_engine::log::{ChangeLog, ChangeLogBuilder, Nanoseconds, SECOND};
use runglight_engine::plant::SignalClass;
use runglight_engine::process::petri::{PetriNet, Transition};

pub const SCAN: Nanoseconds = SECOND / 10;
pub const UL: &str = "%IX0.0";
pub const FILL: &str = "%QX0.0=1 & %QX0.1=0";
pub const EMPTY: &str = "%QX0.0=0 & %QX0.1=1";

/// A net of transitions `(label, inputs, outputs)`; an empty label is silent.
pub fn net(places: usize, transitions: &[(&str, &[u32], &[u32])], last: usize) -> PetriNet {
    let marking = |at: usize| (0..places).map(|place| u32::from(place == at)).collect();
    PetriNet {
        name: "tank".to_owned(),
        places: (0..places).map(|place| format!("p{place}")).collect(),
        transitions: transitions
            .iter()
            .enumerate()
            .map(|(number, (label, inputs, outputs))| Transition {
                id: format!("t{number}"),
                label: (!label.is_empty()).then(|| (*label).to_owned()),
                class: (!label.is_empty()).then(|| SignalClass::guess(label)),
                inputs: inputs.to_vec(),
                outputs: outputs.to_vec(),
            })
            .collect(),
        initial: marking(0),
        last: marking(last),
    }
}

/// Figure 5: no decision is needed.
pub fn figure_5() -> Arc<Program> {
    let labels =
        ["%IX0.1=0", FILL, "%IX0.1=1", "%IX0.2=1", "%IX0.0=1", EMPTY, "%IX0.0=0", "%IX0.2=0"];
    let arcs: Vec<[u32; 2]> = (0..8).map(|number| [number, number + 1]).collect();
    let transitions: Vec<(&str, &[u32], &[u32])> =
        labels.iter().zip(&arcs).map(|(label, arc)| (*label, &arc[..1], &arc[1..])).collect();
    Arc::new(Program::new(net(9, &transitions, 8)).unwrap())
}

/// Figure 7: after the middle sensor has come free, the tank is filled again, or the run is over.
/// A silent transition leads back, another one out.
pub fn figure_7() -> Arc<Program> {
    let transitions: [(&str, &[u32], &[u32]); 10] = [
        ("%IX0.1=0", &[0], &[1]),
        (FILL, &[1], &[2]),
        ("%IX0.1=1", &[2], &[3]),
        ("%IX0.2=1", &[3], &[4]),
        ("%IX0.0=1", &[4], &[5]),
        (EMPTY, &[5], &[6]),
        ("%IX0.0=0", &[6], &[7]),
        ("%IX0.2=0", &[7], &[8]),
        ("", &[8], &[1]),
        ("", &[8], &[9]),
    ];
    let mut transitions = transitions.to_vec();
    // Filling goes on where the lower sensor is covered all the time.
    transitions.push(("", &[2], &[3]));
    Arc::new(Program::new(net(10, &transitions, 9)).unwrap())
}

/// Level, valves and sensors; valves move one scan after they are told.
pub struct Tank {
    pub level: f64,
    pub stuck_ul: bool,
    told: [i64; 2],
    open: [i64; 2],
}

impl Tank {
    pub fn new() -> Self {
        Self { level: 0.0, stuck_ul: false, told: [0, 0], open: [0, 0] }
    }

    /// One scan later.
    pub fn advance(&mut self) {
        self.level += 0.9 * (self.open[0] - self.open[1]) as f64;
        self.level = self.level.clamp(0.0, 100.0);
        self.open = self.told;
    }

    pub fn write(&mut self, valve: usize, value: i64) {
        self.told[valve] = value;
    }

    /// ul, ll, ml, inv, outv.
    pub fn image(&self) -> [Option<i64>; 5] {
        let over = |level: f64| Some(i64::from(self.level >= level));
        let ul = if self.stuck_ul { Some(0) } else { over(90.0) };
        [ul, over(10.0), over(50.0), Some(self.told[0]), Some(self.told[1])]
    }
}

/// C2 of figure 3; `swings` is the counter's preset.
pub struct Ladder {
    pub swings: u32,
    count: u32,
    was_full: bool,
    fills: bool,
}

impl Ladder {
    pub fn new(swings: u32) -> Self {
        Self { swings, count: 0, was_full: false, fills: false }
    }

    pub fn scan(&mut self, image: &[Option<i64>]) -> [i64; 2] {
        let on = |terminal: usize| image[terminal] == Some(1);
        let (ul, ll, ml) = (on(0), on(1), on(2));
        self.count = if ll { self.count + u32::from(ul && !self.was_full) } else { 0 };
        self.was_full = ul;
        let passes = self.count >= self.swings;
        self.fills = (!ll || (!ml && !passes) || self.fills) && !ul;
        [i64::from(self.fills), i64::from(!self.fills)]
    }
}

/// What a tap sees of a program at the tank.
pub fn recorded(program: &mut Ladder, seconds: i64) -> ChangeLog {
    let mut tank = Tank::new();
    let mut log = ChangeLogBuilder::default();
    let mut before = [None; 5];
    for scan in 0..seconds * 10 {
        tank.advance();
        let outputs = program.scan(&tank.image());
        let image = tank.image();
        for (number, address) in [UL, "%IX0.1", "%IX0.2", "%QX0.0", "%QX0.1"].iter().enumerate() {
            if image[number] != before[number] {
                let signal = log.intern(address);
                log.push(scan * SCAN, signal, image[number].unwrap());
            }
        }
        before = image;
        for (valve, value) in outputs.into_iter().enumerate() {
            tank.write(valve, value);
        }
    }
    log.finish()
}
