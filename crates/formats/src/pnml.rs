//! PNML, ISO/IEC 15909-2: place/transition nets, with a final marking as ProM and PM4Py write it.
//!
//! γ stands as `<toolspecific tool="runglight">`; a silent transition carries ProM's `$invisible$`.

use std::collections::HashMap;
use std::io::{self, Read, Write};
use std::path::Path;

use quick_xml::XmlVersion;
use quick_xml::events::{BytesStart, Event};
use runglight_engine::plant::SignalClass;
use runglight_engine::process::petri::{PetriNet, PlaceIndex, Transition};
use runglight_engine::process::reset::class_of_name;

use crate::error::FormatError;
use crate::output;
use crate::source::Source;
use crate::xml::escaped;

const FORMAT: &str = "PNML";
const INVISIBLE: &str = "$invisible$";
const TYPE: &str = "http://www.pnml.org/version-2009/grammar/ptnet";
const NAMESPACE: &str = "http://www.pnml.org/version-2009/grammar/pnml";
/// A net is drawn and debugged by people: more than this is no net of a machine.
const MOST_NODES: usize = 1 << 20;

/// Reads the first net of a file.
///
/// # Errors
/// No PNML, arcs that lead nowhere or weigh more than 1, or no final marking.
pub fn read(path: &Path) -> Result<PetriNet, FormatError> {
    let mut text = Vec::new();
    Source::open(path)?
        .into_reader()
        .read_to_end(&mut text)
        .map_err(|error| FormatError::io(path, "read this file", error))?;
    let text = String::from_utf8(text)
        .map_err(|_| FormatError::damaged(path, FORMAT, "it is not UTF-8 text"))?;
    Document::default().read(&text).map_err(|reason| FormatError::damaged(path, FORMAT, reason))
}

/// Writes a net; the file appears whole or not at all.
///
/// # Errors
/// What the file system refuses.
pub fn write(net: &PetriNet, path: &Path) -> Result<(), FormatError> {
    output::whole(path, |into| write_to(net, into))
}

fn write_to(net: &PetriNet, into: &mut dyn Write) -> io::Result<()> {
    writeln!(into, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>")?;
    writeln!(into, "<pnml xmlns=\"{NAMESPACE}\">")?;
    writeln!(into, "  <net id=\"net1\" type=\"{TYPE}\">")?;
    writeln!(into, "    <name><text>{}</text></name>", escaped(&net.name))?;
    writeln!(into, "    <page id=\"page1\">")?;
    for (place, &tokens) in net.places.iter().zip(&net.initial) {
        let id = escaped(place);
        write!(into, "      <place id=\"{id}\"><name><text>{id}</text></name>")?;
        if tokens > 0 {
            write!(into, "<initialMarking><text>{tokens}</text></initialMarking>")?;
        }
        writeln!(into, "</place>")?;
    }
    for transition in &net.transitions {
        let id = escaped(&transition.id);
        let name = transition.label.as_deref().map_or_else(|| id.clone(), escaped);
        write!(into, "      <transition id=\"{id}\"><name><text>{name}</text></name>")?;
        if transition.label.is_none() {
            write!(into, "<toolspecific tool=\"ProM\" version=\"6.4\" activity=\"{INVISIBLE}\"/>")?;
        }
        let class = class_name(transition.class);
        write!(into, "<toolspecific tool=\"runglight\" version=\"1\" class=\"{class}\"/>")?;
        writeln!(into, "</transition>")?;
    }
    let mut number = 0;
    let mut arc = |into: &mut dyn Write, from: &str, to: &str| {
        number += 1;
        let (from, to) = (escaped(from), escaped(to));
        writeln!(into, "      <arc id=\"arc{number}\" source=\"{from}\" target=\"{to}\"/>")
    };
    for transition in &net.transitions {
        for &place in &transition.inputs {
            arc(into, &net.places[place as usize], &transition.id)?;
        }
        for &place in &transition.outputs {
            arc(into, &transition.id, &net.places[place as usize])?;
        }
    }
    writeln!(into, "    </page>")?;
    writeln!(into, "    <finalmarkings>\n      <marking>")?;
    for (place, &tokens) in net.places.iter().zip(&net.last) {
        if tokens > 0 {
            let id = escaped(place);
            writeln!(into, "        <place idref=\"{id}\"><text>{tokens}</text></place>")?;
        }
    }
    writeln!(into, "      </marking>\n    </finalmarkings>\n  </net>\n</pnml>")
}

fn class_name(class: Option<SignalClass>) -> &'static str {
    match class {
        Some(SignalClass::Input) => "input",
        Some(SignalClass::Output) => "output",
        Some(SignalClass::Memory) => "memory",
        None => "none",
    }
}

fn class_of(name: &str) -> Option<SignalClass> {
    (name != "none").then(|| SignalClass::parse(name)).flatten()
}

/// What an open element adds its text to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Wanted {
    Name,
    Tokens,
    Weight,
    FinalTokens,
}

#[derive(Debug, Default)]
struct Place {
    id: String,
    initial: u32,
    last: u32,
}

#[derive(Debug, Default)]
struct OpenTransition {
    id: String,
    name: Option<String>,
    invisible: bool,
    class: Option<Option<SignalClass>>,
}

/// A net as it is read; elements that are open are kept by name.
#[derive(Debug, Default)]
struct Document {
    open: Vec<String>,
    name: String,
    nets: usize,
    places: Vec<Place>,
    by_id: HashMap<String, PlaceIndex>,
    transitions: Vec<OpenTransition>,
    arcs: Vec<(String, String)>,
    marked: Option<PlaceIndex>,
    has_final: bool,
}

impl Document {
    fn read(mut self, text: &str) -> Result<PetriNet, String> {
        let mut xml = quick_xml::Reader::from_str(text);
        loop {
            match xml.read_event().map_err(|error| error.to_string())? {
                Event::Start(element) => {
                    self.start(&element)?;
                    self.open.push(element.local_name().as_ref().to_owned());
                }
                Event::Empty(element) => self.start(&element)?,
                Event::End(_) => {
                    self.open.pop();
                }
                Event::Text(text) => {
                    let text = text.xml_content(XmlVersion::Explicit1_1).into_owned();
                    self.text(&text)?;
                }
                Event::CData(text) => self.text(&text.into_inner())?,
                Event::GeneralRef(entity) => {
                    let resolved = resolve(&entity)?;
                    self.text(&resolved)?;
                }
                Event::DocType(_) => return Err("it has a document type definition".to_owned()),
                Event::Eof => break,
                _ => {}
            }
        }
        if !self.open.is_empty() {
            return Err("it breaks off before </pnml>".to_owned());
        }
        if self.nets == 0 {
            return Err("it has no <net> element".to_owned());
        }
        self.finish()
    }

    fn start(&mut self, element: &BytesStart<'_>) -> Result<(), String> {
        let tag = element.local_name().as_ref().to_owned();
        if self.open.is_empty() && tag != "pnml" {
            return Err(format!("the root element is <{tag}>, not <pnml>"));
        }
        if tag == "net" {
            self.nets += 1;
        }
        if self.nets != 1 {
            return Ok(());
        }
        let attribute = |wanted: &str| -> Result<Option<String>, String> {
            for attribute in element.attributes() {
                let attribute = attribute.map_err(|error| error.to_string())?;
                if attribute.key.as_ref() == wanted {
                    let value = attribute
                        .normalized_value(XmlVersion::Explicit1_1)
                        .map_err(|error| error.to_string())?;
                    return Ok(Some(value.into_owned()));
                }
            }
            Ok(None)
        };
        let needed = |wanted: &str| {
            attribute(wanted)?.ok_or_else(|| format!("a <{tag}> has no attribute {wanted}"))
        };
        let in_final = self.is_open("finalmarkings");
        match tag.as_str() {
            "place" if in_final => {
                let id = needed("idref")?;
                let place = self.by_id.get(&id).copied();
                self.marked = Some(place.ok_or_else(|| {
                    format!("the final marking names a place '{id}' that is not there")
                })?);
            }
            "place" => {
                let id = needed("id")?;
                let index = self.places.len() as PlaceIndex;
                if self.by_id.insert(id.clone(), index).is_some() {
                    return Err(format!("two places have the id '{id}'"));
                }
                self.places.push(Place { id, ..Place::default() });
            }
            "transition" => {
                let id = needed("id")?;
                self.transitions.push(OpenTransition { id, ..OpenTransition::default() });
            }
            "arc" => self.arcs.push((needed("source")?, needed("target")?)),
            "toolspecific" if self.is_open("transition") => {
                let tool = attribute("tool")?;
                let invisible = attribute("activity")?.as_deref() == Some(INVISIBLE);
                let class = attribute("class")?;
                if let Some(transition) = self.transitions.last_mut() {
                    transition.invisible |= invisible;
                    if tool.as_deref() == Some("runglight") {
                        transition.class = class.as_deref().map(class_of);
                    }
                }
            }
            _ => {}
        }
        if self.places.len() + self.transitions.len() + self.arcs.len() > MOST_NODES {
            return Err(format!("it has more than {MOST_NODES} places, transitions and arcs"));
        }
        Ok(())
    }

    fn is_open(&self, tag: &str) -> bool {
        self.open.iter().any(|open| open == tag)
    }

    /// What the text inside `<text>` belongs to.
    fn wanted(&self) -> Option<Wanted> {
        let [.., parent, text] = self.open.as_slice() else { return None };
        if text != "text" || self.is_open("toolspecific") {
            return None;
        }
        match parent.as_str() {
            "name" => Some(Wanted::Name),
            "initialMarking" => Some(Wanted::Tokens),
            "inscription" => Some(Wanted::Weight),
            "place" if self.is_open("finalmarkings") => Some(Wanted::FinalTokens),
            _ => None,
        }
    }

    fn text(&mut self, text: &str) -> Result<(), String> {
        if self.nets != 1 {
            return Ok(());
        }
        let tokens = || {
            let text = text.trim();
            text.parse::<u32>().map_err(|_| format!("'{text}' is no number of tokens"))
        };
        match self.wanted() {
            Some(Wanted::Name) if self.is_open("transition") => {
                if let Some(transition) = self.transitions.last_mut() {
                    transition.name.get_or_insert_default().push_str(text);
                }
            }
            Some(Wanted::Name) if !self.is_open("place") && !self.is_open("arc") => {
                self.name.push_str(text);
            }
            Some(Wanted::Tokens) => {
                let tokens = tokens()?;
                if let Some(place) = self.places.last_mut() {
                    place.initial = tokens;
                }
            }
            Some(Wanted::Weight) if tokens()? != 1 => {
                return Err(format!("an arc weighs {}; only 1 can be used", text.trim()));
            }
            Some(Wanted::FinalTokens) => {
                let tokens = tokens()?;
                if let Some(place) = self.marked {
                    self.places[place as usize].last = tokens;
                    self.has_final |= tokens > 0;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn finish(self) -> Result<PetriNet, String> {
        let mut net = PetriNet { name: self.name.trim().to_owned(), ..PetriNet::default() };
        let mut by_id = HashMap::with_capacity(self.transitions.len());
        for transition in self.transitions {
            let name = transition.name.map(|name| name.trim().to_owned());
            let label = name.filter(|name| !transition.invisible && !name.is_empty());
            let class = transition
                .class
                .unwrap_or_else(|| label.as_deref().and_then(class_of_name))
                .filter(|_| label.is_some());
            if by_id.insert(transition.id.clone(), net.transitions.len()).is_some()
                || self.by_id.contains_key(&transition.id)
            {
                return Err(format!("two nodes have the id '{}'", transition.id));
            }
            let (inputs, outputs) = (Vec::new(), Vec::new());
            net.transitions.push(Transition { id: transition.id, label, class, inputs, outputs });
        }
        for (source, target) in &self.arcs {
            let arc = (self.by_id.get(source), by_id.get(target));
            let back = (by_id.get(source), self.by_id.get(target));
            let (transition, place, list): (usize, PlaceIndex, _) = match (arc, back) {
                ((Some(&place), Some(&t)), _) => (t, place, &mut net.transitions[t].inputs),
                (_, (Some(&t), Some(&place))) => (t, place, &mut net.transitions[t].outputs),
                _ => {
                    return Err(format!(
                        "the arc from '{source}' to '{target}' does not lead between a place and a transition"
                    ));
                }
            };
            if list.contains(&place) {
                let id = &net.transitions[transition].id;
                return Err(format!(
                    "two arcs join '{id}' and '{}'",
                    self.places[place as usize].id
                ));
            }
            list.push(place);
        }
        for transition in &mut net.transitions {
            transition.inputs.sort_unstable();
            transition.outputs.sort_unstable();
        }
        net.initial = self.places.iter().map(|place| place.initial).collect();
        net.last = self.places.iter().map(|place| place.last).collect();
        net.places = self.places.into_iter().map(|place| place.id).collect();
        if net.initial.iter().all(|&tokens| tokens == 0) {
            let source = only_place(&net, |t| &t.outputs);
            net.initial[source.ok_or("it has no initial marking")?] = 1;
        }
        if !self.has_final {
            let sink = only_place(&net, |t| &t.inputs);
            net.last[sink.ok_or("it has no final marking")?] = 1;
        }
        Ok(net)
    }
}

/// The one place that no transition has on the side given: source or sink of a workflow net.
fn only_place(net: &PetriNet, side: impl Fn(&Transition) -> &[PlaceIndex]) -> Option<usize> {
    let used = |place: usize| {
        net.transitions.iter().any(|transition| side(transition).contains(&(place as PlaceIndex)))
    };
    let mut free = (0..net.places.len()).filter(|&place| !used(place));
    let first = free.next()?;
    free.next().is_none().then_some(first)
}

/// A character reference or one of XML's five entities.
fn resolve(entity: &quick_xml::events::BytesRef<'_>) -> Result<String, String> {
    if let Some(character) = entity.resolve_char_ref().map_err(|error| error.to_string())? {
        return Ok(character.to_string());
    }
    let name: &str = entity;
    quick_xml::escape::resolve_predefined_entity(name)
        .map(str::to_owned)
        .ok_or_else(|| format!("it has an entity of its own, '&{name};'"))
}
