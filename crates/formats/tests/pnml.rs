//! Petri nets of ours and of other tools.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod scratch;

use runglight_engine::plant::SignalClass;
use runglight_engine::process::petri::{PetriNet, Transition};
use runglight_formats::pnml;
use scratch::Scratch;

fn net() -> PetriNet {
    let transition = |id: &str, label: Option<&str>, class, inputs: &[u32], outputs: &[u32]| {
        let (id, label) = (id.to_owned(), label.map(str::to_owned));
        Transition { id, label, class, inputs: inputs.to_vec(), outputs: outputs.to_vec() }
    };
    PetriNet {
        name: "tank <1> & \"more\"".to_owned(),
        places: ["source", "p1", "sink"].map(str::to_owned).to_vec(),
        transitions: vec![
            transition("t0", Some("%IX0.1=0 & %IX0.2=1"), Some(SignalClass::Input), &[0], &[1]),
            transition("t1", Some("fill 'fast' ü"), Some(SignalClass::Output), &[1], &[2]),
            transition("t2", None, None, &[1], &[0]),
        ],
        initial: vec![1, 0, 0],
        last: vec![0, 0, 2],
    }
}

fn error(text: &str) -> String {
    let scratch = Scratch::new();
    pnml::read(&scratch.file("net.pnml", text)).unwrap_err().to_string()
}

fn of_another_tool(more: &str, arc: &str) -> String {
    format!(
        r#"<?xml version="1.0"?>
        <pnml><net id="net1" type="http://www.pnml.org/version-2009/grammar/pnmlcoremodel">
        <name><text>another tool's</text></name>
        <page id="n0">
          <place id="p1"><name><text>start</text></name></place>
          <place id="p2"><name><text>end</text></name></place>
          <transition id="a"><name><text>%IX0.0=1</text></name>
            <graphics><position x="1" y="2"/></graphics></transition>
          <transition id="b"><name><text>tau</text></name>
            <toolspecific tool="ProM" version="6.4" activity="$invisible$" localNodeID="x"/></transition>
          <arc id="1" source="p1" target="a"/>
          <arc id="2" source="a" target="p2">{arc}</arc>
          <arc id="3" source="p1" target="b"/>
          <arc id="4" source="b" target="p2"/>
        </page>{more}</net></pnml>"#
    )
}

#[test]
fn what_is_written_is_read_back() {
    let scratch = Scratch::new();
    let path = scratch.path("net.pnml");
    pnml::write(&net(), &path).unwrap();
    assert_eq!(pnml::read(&path).unwrap(), net());
}

#[test]
fn nets_of_other_tools_are_read() {
    let scratch = Scratch::new();
    let text = of_another_tool("", "<inscription><text>1</text></inscription>");
    let read = pnml::read(&scratch.file("net.pnml", text)).unwrap();
    assert_eq!(read.name, "another tool's");
    assert_eq!(read.places, ["p1", "p2"]);
    assert_eq!((read.initial, read.last), (vec![1, 0], vec![0, 1]));
    assert_eq!(read.transitions[0].class, Some(SignalClass::Input));
    assert_eq!(read.transitions[1].label, None);
}

#[test]
fn what_cannot_be_used_is_said() {
    let final_of = |place| {
        format!(
            "<finalmarkings><marking><place idref=\"{place}\"><text>1</text></place></marking></finalmarkings>"
        )
    };
    for (text, expected) in [
        ("<html></html>".to_owned(), "the root element is <html>, not <pnml>"),
        ("<pnml></pnml>".to_owned(), "no <net> element"),
        ("<pnml><net>".to_owned(), "breaks off"),
        (of_another_tool("", "<inscription><text>2</text></inscription>"), "weighs 2"),
        (of_another_tool("<arc id='9' source='p1' target='p2'/>", ""), "does not lead between"),
        (of_another_tool("<arc id='9' source='p1' target='a'/>", ""), "two arcs"),
        (of_another_tool("<place id='p1'/>", ""), "two places have the id 'p1'"),
        (of_another_tool("<place id='p3'/>", ""), "no initial marking"),
        (of_another_tool(&final_of("p9"), ""), "'p9' that is not there"),
    ] {
        let found = error(&text);
        assert!(found.contains(expected), "{found}");
        assert_eq!(found.lines().count(), 1);
    }
}
