//! Work that falls into tasks which have nothing to do with one another, on several threads.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Fewer events than this are not worth a thread of their own.
const EVENTS_A_THREAD: usize = 100_000;
/// More threads would wait for memory.
const THREADS_AT_MOST: usize = 8;

/// How many threads so many events are worth.
pub(super) fn threads_for(events: usize) -> usize {
    let cores = thread::available_parallelism().map_or(1, NonZero::get);
    cores.min(events / EVENTS_A_THREAD).clamp(1, THREADS_AT_MOST)
}

/// Does tasks until there is none left; their results, in order. This thread works at `bench`,
/// others at ones they make.
pub(super) fn share_out<B, R: Send>(
    tasks: usize,
    threads: usize,
    bench: &mut B,
    make: impl Fn() -> B + Sync,
    work: impl Fn(&mut B, usize) -> R + Sync,
) -> Vec<R> {
    if threads < 2 {
        return (0..tasks).map(|task| work(bench, task)).collect();
    }
    let next = AtomicUsize::new(0);
    let take = |bench: &mut B| {
        let mut done = Vec::new();
        loop {
            let task = next.fetch_add(1, Ordering::Relaxed);
            if task >= tasks {
                return done;
            }
            done.push((task, work(bench, task)));
        }
    };
    let mut done = thread::scope(|scope| {
        let others = (1..threads).map(|_| scope.spawn(|| take(&mut make())));
        let others: Vec<_> = others.collect();
        let mut done = take(bench);
        for other in others {
            match other.join() {
                Ok(more) => done.extend(more),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        done
    });
    done.sort_unstable_by_key(|(task, _)| *task);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::share_out;

    #[test]
    fn results_are_in_order_on_any_number_of_threads() {
        for threads in 1..4 {
            let squares = share_out(
                100,
                threads,
                &mut 0,
                || 0,
                |bench, task| {
                    *bench += 1;
                    task * task
                },
            );
            assert_eq!(squares, (0..100).map(|task| task * task).collect::<Vec<_>>());
        }
    }
}
