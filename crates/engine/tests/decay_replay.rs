//! Token replay, decays and baselines on nets made by hand.

mod nets;

use runglight_engine::log::{Nanoseconds, SECOND};
use runglight_engine::plant::SignalClass;
use runglight_engine::process::baseline::Markov;
use runglight_engine::process::decay::{Decay, DecayState, FULL, Samples};
use runglight_engine::process::event_log::EventLog;
use runglight_engine::process::replay::{TokenReplay, Tokens};
use runglight_engine::process::succession::Succession;

use nets::{log_of, net_of};

/// start → a → p1 → (b | τ) → p2 → c → p1 …, p2 → τ → last: `b` may be skipped, `c` goes back.
fn loop_net() -> runglight_engine::process::petri::PetriNet {
    net_of(
        &["start", "p1", "p2", "last"],
        &[
            (Some("a"), &[0], &[1]),
            (Some("b"), &[1], &[2]),
            (None, &[1], &[2]),
            (Some("c"), &[2], &[1]),
            (None, &[2], &[3]),
        ],
    )
}

fn replay(log: &EventLog) -> TokenReplay {
    TokenReplay::of(&loop_net(), &log.activities)
}

#[test]
fn a_trace_the_net_allows_fits() {
    let log = log_of(&["a", "b", "c"], &[&[(0, 0), (1, 1), (2, 2), (1, 3)]]);
    let tokens = replay(&log).trace(log.trace(0));
    assert!(tokens.fits());
    assert_eq!(tokens.fitness(), 1.0);
    // Initial token, four visible firings and the silent one to the end.
    assert_eq!((tokens.produced, tokens.consumed), (6, 6));
}

#[test]
fn silent_transitions_fire_where_they_enable_the_event() {
    let log = log_of(&["a", "b", "c"], &[&[(0, 0), (2, 1), (2, 2)]]);
    let tokens = replay(&log).trace(log.trace(0));
    assert!(tokens.fits());
    // a, twice τ and c, twice τ to the end, and the final token.
    assert_eq!(tokens.consumed, 1 + 4 + 2 + 1);
}

#[test]
fn missing_and_remaining_tokens_are_counted() {
    // `b` twice: the second lacks its token, and one more is left behind at the end.
    let log = log_of(&["a", "b", "c"], &[&[(0, 0), (1, 1), (1, 2)]]);
    let tokens = replay(&log).trace(log.trace(0));
    assert_eq!((tokens.missing, tokens.remaining), (1, 1));
    assert!(tokens.fitness() < 1.0);
}

#[test]
fn an_activity_the_net_does_not_have_moves_nothing() {
    let log = log_of(&["a", "b", "c", "x"], &[&[(0, 0), (3, 1), (1, 2)]]);
    let mut replay = replay(&log);
    let tokens = replay.trace(log.trace(0));
    assert_eq!(tokens.unknown, 1);
    assert_eq!(Tokens { unknown: 0, ..tokens }.fitness(), 1.0);
    replay.restart();
    replay.step(0);
    let before = replay.marking().to_vec();
    assert!(!replay.step(3).known);
    assert_eq!(replay.marking(), before);
}

#[test]
fn a_join_is_served_as_far_as_silent_transitions_can() {
    // `c` needs both branches; one of them can be reached silently, the other never began.
    let net = net_of(
        &["start", "left", "right", "last"],
        &[(None, &[0], &[1]), (Some("b"), &[0], &[2]), (Some("c"), &[1, 2], &[3])],
    );
    let mut replay = TokenReplay::new(&net, ["b", "c"]);
    let tokens = replay.trace(&[1]);
    assert_eq!((tokens.missing, tokens.remaining), (1, 0));
}

#[test]
fn endless_silent_growth_ends() {
    let net = net_of(&["p", "q", "last"], &[(None, &[0], &[0, 1]), (Some("c"), &[2], &[2])]);
    let mut replay = TokenReplay::new(&net, ["c"]);
    assert_eq!(replay.trace(&[0]).missing, 1);
}

#[test]
fn markings_without_number_are_forgotten_not_kept() {
    // Every firing adds a token: no marking comes twice.
    let net = net_of(&["p", "q"], &[(Some("a"), &[0], &[0, 1])]);
    let mut replay = TokenReplay::new(&net, ["a"]);
    for count in 1..40_000 {
        let moved = replay.step(0);
        assert_eq!(replay.touched(&moved), &[0, 1]);
        assert_eq!(replay.marking(), &[1, count]);
    }
}

fn state_after(events: &[(u32, i64)]) -> (Decay, DecayState, Nanoseconds) {
    let log = log_of(&["a", "b", "c"], &[events]);
    let mut replay = replay(&log);
    let decay = Decay::fit(&mut replay, &log, &[0]);
    let mut state = DecayState::new(replay.net());
    state.restart(replay.net(), log.time[0]);
    replay.restart();
    for (&activity, &time) in log.activity.iter().zip(&log.time) {
        let moved = replay.step(activity);
        state.follow(replay.touched(&moved), replay.marking(), time);
    }
    (decay, state, log.time.last().copied().unwrap_or_default())
}

#[test]
fn decays_follow_the_mean_gap_between_activations() {
    // p1 is touched at 0, 2, 5 and p2 at 2, 5, 7: mean gaps of 2.5 s each; start once, in 7 s.
    let (decay, state, end) = state_after(&[(0, 0), (1, 2), (2, 5), (1, 7)]);
    // p1 is touched at 7 too, losing its token: gaps 2, 3, 2.
    let per_s = |gap: f32| FULL / gap;
    assert_close(&decay.rate_per_s, &[per_s(7.0), per_s(7.0 / 3.0), per_s(2.5), per_s(7.0)]);
    let mut sample = [0.0; 12];
    state.sample(&decay, end + SECOND, &mut sample);
    let decayed = |gap: f32, age: f32| (FULL - FULL / gap * age).max(0.0);
    assert_close(&sample[..4], &[0.0, decayed(7.0 / 3.0, 1.0), decayed(2.5, 1.0), 0.0]);
    assert_eq!(sample[4..8], [1.0, 4.0, 3.0, 0.0]);
    assert_eq!(sample[8..], [0.0, 0.0, 1.0, 0.0]);
}

#[test]
fn firing_by_hand_is_the_same_as_replay() {
    let net = loop_net();
    let mut by_hand = DecayState::new(&net);
    by_hand.restart(&net, 0);
    by_hand.fire(&net, &[0], 0);
    by_hand.fire(&net, &[2, 3], 2 * SECOND);
    by_hand.fire(&net, &[1], 3 * SECOND);
    assert_eq!(by_hand, state_after(&[(0, 0), (2, 2), (1, 3)]).1);
}

#[test]
fn samples_never_look_ahead() {
    // Two traces that differ in nothing but when the last event came.
    let early: &[(u32, i64)] = &[(0, 0), (1, 2), (2, 5), (1, 7)];
    let late: &[(u32, i64)] = &[(0, 0), (1, 2), (2, 5), (1, 900)];
    let log = log_of(&["a", "b", "c"], &[early, late]);
    let mut replay = replay(&log);
    let decay = Decay::fit(&mut replay, &log, &[0]);
    let samples = Samples::take(&mut replay, &decay, &log, &[0, 1], Succession::Separate);
    assert_eq!(samples.bounds, [0, 3, 6]);
    assert_eq!(samples.next, [1, 2, 1, 1, 2, 1]);
    assert_eq!(samples.rows(0..3), samples.rows(3..6));
}

#[test]
fn the_reset_that_opens_the_next_run_is_foretold_too() {
    let run: &[(u32, i64)] = &[(0, 0), (1, 2), (2, 5)];
    let later: &[(u32, i64)] = &[(0, 6), (1, 8)];
    let mut log = log_of(&["a", "b", "c"], &[run, later]);
    assert_eq!(Succession::of(&log), Succession::Separate, "no PLC tells of this log");
    log.activities[0].class = Some(SignalClass::Input);
    assert_eq!(Succession::of(&log), Succession::Consecutive);
    let mut replay = replay(&log);
    let decay = Decay::fit(&mut replay, &log, &[0]);
    let samples = Samples::take(&mut replay, &decay, &log, &[0, 1], Succession::of(&log));
    assert_eq!(samples.next, [1, 2, 0, 1]);
    assert_eq!(samples.event, [(0, 1), (0, 2), (1, 0), (1, 1)]);
    log.time[3] = 0;
    assert_eq!(Succession::of(&log), Succession::Separate, "runs of one machine do not overlap");
}

#[test]
fn baselines_count_what_follows() {
    // After `b` comes `c` but where `b` was the second in a row.
    let events: &[(u32, i64)] = &[(0, 0), (1, 1), (2, 2), (1, 3), (2, 4), (1, 5), (1, 6), (0, 7)];
    let log = log_of(&["a", "b", "c"], &[events]);
    let traces = [0];
    let right = |order| {
        let markov = Markov::fit(&log, &traces, order, Succession::Separate);
        markov.score(&log, &traces, Succession::Separate)
    };
    assert_eq!(right(0), (4, 7));
    assert_eq!(right(1), (5, 7));
    assert_eq!(right(2), (6, 7));
    let markov = Markov::fit(&log, &traces, 2, Succession::Separate);
    assert_eq!(markov.next(&[2, 0]), Some(1), "an unknown pair falls back on the last activity");
    assert_eq!(markov.next(&[9]), Some(1), "and an unknown activity on the commonest");
}

fn assert_close(is: &[f32], wanted: &[f32]) {
    assert_eq!(is.len(), wanted.len());
    for (is, wanted) in is.iter().zip(wanted) {
        assert!((is - wanted).abs() < 1e-5, "{is} is not {wanted}");
    }
}
