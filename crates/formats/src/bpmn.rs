//! BPMN 2.0 (ISO/IEC 19510), written with a plain layout so that every editor opens it.

use std::io::{self, Write};
use std::path::Path;

use runglight_engine::process::event_log::Activity;
use runglight_engine::process::split_miner::model::{Kind, ProcessModel, START};

use crate::error::FormatError;
use crate::output;
use crate::xml::escaped;

const MODEL: &str = "http://www.omg.org/spec/BPMN/20100524/MODEL";
const DIAGRAM: &str = "http://www.omg.org/spec/BPMN/20100524/DI";
const BOUNDS: &str = "http://www.omg.org/spec/DD/20100524/DC";
const WAYPOINTS: &str = "http://www.omg.org/spec/DD/20100524/DI";

/// Pixels between two columns and two rows of the layout.
const COLUMN: usize = 180;
const ROW: usize = 110;

/// Writes a process model; the file appears whole or not at all.
///
/// # Errors
/// What the file system refuses.
pub fn write(
    model: &ProcessModel,
    activities: &[Activity],
    path: &Path,
) -> Result<(), FormatError> {
    output::whole(path, |into| write_to(model, activities, into))
}

fn write_to(model: &ProcessModel, activities: &[Activity], into: &mut dyn Write) -> io::Result<()> {
    let (incoming, outgoing) = model.ways();
    let used = |node: usize| !incoming[node].is_empty() || !outgoing[node].is_empty();
    writeln!(into, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(
        into,
        "<definitions xmlns=\"{MODEL}\" xmlns:bpmndi=\"{DIAGRAM}\" xmlns:dc=\"{BOUNDS}\" \
         xmlns:di=\"{WAYPOINTS}\" id=\"definitions\" targetNamespace=\"runglight\">"
    )?;
    writeln!(into, "  <process id=\"process\" isExecutable=\"false\">")?;
    for (node, &kind) in model.kinds.iter().enumerate().filter(|&(node, _)| used(node)) {
        let (tag, name) = match kind {
            Kind::Start => ("startEvent", None),
            Kind::End => ("endEvent", None),
            Kind::Task(activity) => ("task", activities.get(activity as usize)),
            Kind::Exclusive => ("exclusiveGateway", None),
            Kind::Parallel => ("parallelGateway", None),
            Kind::Inclusive => ("inclusiveGateway", None),
        };
        let name = name
            .map_or_else(String::new, |activity| format!(" name=\"{}\"", escaped(&activity.name)));
        write!(into, "    <{tag} id=\"node{node}\"{name}>")?;
        for flow in &incoming[node] {
            write!(into, "<incoming>flow{flow}</incoming>")?;
        }
        for flow in &outgoing[node] {
            write!(into, "<outgoing>flow{flow}</outgoing>")?;
        }
        writeln!(into, "</{tag}>")?;
    }
    for (flow, (from, to)) in model.flows.iter().enumerate() {
        writeln!(
            into,
            "    <sequenceFlow id=\"flow{flow}\" sourceRef=\"node{from}\" targetRef=\"node{to}\"/>"
        )?;
    }
    writeln!(into, "  </process>")?;
    write_diagram(model, into)?;
    writeln!(into, "</definitions>")
}

fn write_diagram(model: &ProcessModel, into: &mut dyn Write) -> io::Result<()> {
    let places = layout(model);
    writeln!(into, "  <bpmndi:BPMNDiagram id=\"diagram\">")?;
    writeln!(into, "    <bpmndi:BPMNPlane id=\"plane\" bpmnElement=\"process\">")?;
    for (node, place) in places.iter().enumerate() {
        let Some((column, row)) = *place else { continue };
        let (width, height) = size(model.kinds[node]);
        let (x, y) = (column * COLUMN + 100 - width / 2, row * ROW + 100 - height / 2);
        writeln!(
            into,
            "      <bpmndi:BPMNShape id=\"shape{node}\" bpmnElement=\"node{node}\">\
             <dc:Bounds x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>\
             </bpmndi:BPMNShape>"
        )?;
    }
    for (flow, &(from, to)) in model.flows.iter().enumerate() {
        let (Some(a), Some(b)) = (places[from], places[to]) else { continue };
        let point = |(column, row): (usize, usize)| {
            format!("<di:waypoint x=\"{}\" y=\"{}\"/>", column * COLUMN + 100, row * ROW + 100)
        };
        writeln!(
            into,
            "      <bpmndi:BPMNEdge id=\"edge{flow}\" bpmnElement=\"flow{flow}\">{}{}</bpmndi:BPMNEdge>",
            point(a),
            point(b)
        )?;
    }
    writeln!(into, "    </bpmndi:BPMNPlane>\n  </bpmndi:BPMNDiagram>")
}

fn size(kind: Kind) -> (usize, usize) {
    match kind {
        Kind::Task(_) => (120, 70),
        Kind::Start | Kind::End => (36, 36),
        _ => (50, 50),
    }
}

/// Column and row of each node: columns by distance from the start, rows as they come.
fn layout(model: &ProcessModel) -> Vec<Option<(usize, usize)>> {
    let (_, outgoing) = model.ways();
    let mut places = vec![None; model.kinds.len()];
    let mut rows = Vec::new();
    let mut wave = vec![START];
    places[START] = Some((0, 0));
    let mut column = 0;
    while !wave.is_empty() {
        rows.push(wave.len());
        column += 1;
        let mut next = Vec::new();
        for node in wave {
            for &flow in &outgoing[node] {
                let target = model.flows[flow].1;
                if places[target].is_none() {
                    places[target] = Some((column, next.len()));
                    next.push(target);
                }
            }
        }
        wave = next;
    }
    places
}
