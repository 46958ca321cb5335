//! Results of parallel work, taken in the order of the work: sums of floating-point numbers
//! depend on their order, and pictures must not depend on who is done first.
//!
//! Work is handed out in that order as well, and no farther ahead of what was taken than a few
//! pieces a thread. Pieces by halves of the range, as rayon has them, would leave the second half of
//! a block's splats waiting for the first: gigabytes of a large picture.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard};

/// Pieces of work for each thread that may be begun before the oldest of them is taken: enough that
/// one which takes several times as long as its neighbours keeps nobody waiting.
const AHEAD_PER_THREAD: usize = 8;

/// Does pieces of work 0 to `count` on all threads of the pool and hands each result to `take`, by
/// its number and in that order. At most eight results a thread are held at any time.
///
/// # Panics
/// Where `work` or `take` does.
pub fn for_each_in_order<T: Send>(
    count: usize,
    work: impl Fn(usize) -> T + Sync,
    take: impl FnMut(usize, T) + Send,
) {
    use rayon::prelude::*;
    let ahead = AHEAD_PER_THREAD * rayon::current_num_threads();
    let next = AtomicUsize::new(0);
    let order = InOrder::new(take);
    (0..count).into_par_iter().with_max_len(1).for_each(|_| {
        let number = next.fetch_add(1, Ordering::Relaxed);
        let turn = order.wait_until(number, ahead);
        order.add(number, work(number));
        std::mem::forget(turn);
    });
}

/// Takes the results of pieces of work 0, 1, 2 … in that order, whenever they come.
pub struct InOrder<T, F> {
    state: Mutex<State<T, F>>,
    taken: Condvar,
}

struct State<T, F> {
    take: F,
    next: usize,
    waiting: BTreeMap<usize, T>,
    /// Whether a piece will never come, because its thread panicked.
    is_broken: bool,
}

impl<T, F: FnMut(usize, T)> InOrder<T, F> {
    /// Hands each result to `take`, by its number.
    pub const fn new(take: F) -> Self {
        let state = State { take, next: 0, waiting: BTreeMap::new(), is_broken: false };
        Self { state: Mutex::new(state), taken: Condvar::new() }
    }

    /// The result of a piece of work; taken now, or kept until those before it have come.
    pub fn add(&self, number: usize, result: T) {
        let mut state = self.lock();
        state.waiting.insert(number, result);
        let before = state.next;
        let State { take, next, waiting, .. } = &mut *state;
        while let Some(result) = waiting.remove(next) {
            take(*next, result);
            *next += 1;
        }
        if state.next > before {
            self.taken.notify_all();
        }
    }

    /// Waits until the result of piece `number - ahead` is taken. The pieces that are waited for are
    /// all being worked on, because they are handed out in order. What comes back is forgotten when
    /// the work is done; a panic drops it.
    fn wait_until(&self, number: usize, ahead: usize) -> Turn<'_, T, F> {
        let is_far = |state: &mut State<T, F>| number >= state.next + ahead && !state.is_broken;
        drop(self.taken.wait_while(self.lock(), is_far).expect(NO_PANIC));
        Turn(self)
    }

    fn lock(&self) -> MutexGuard<'_, State<T, F>> {
        self.state.lock().expect(NO_PANIC)
    }
}

const NO_PANIC: &str = "no thread panics while it takes a result";

/// A piece being worked on. Dropped, it lets nobody wait for it.
struct Turn<'a, T, F: FnMut(usize, T)>(&'a InOrder<T, F>);

impl<T, F: FnMut(usize, T)> Drop for Turn<'_, T, F> {
    fn drop(&mut self) {
        if let Ok(mut state) = self.0.state.lock() {
            state.is_broken = true;
        }
        self.0.taken.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn results_are_taken_in_order() {
        let mut taken = Vec::new();
        let order = InOrder::new(|number, result: &str| taken.push((number, result.to_owned())));
        for (number, result) in [(2, "c"), (0, "a"), (3, "d"), (1, "b")] {
            order.add(number, result);
        }
        drop(order);
        assert_eq!(taken, [(0, "a".into()), (1, "b".into()), (2, "c".into()), (3, "d".into())]);
    }

    fn pool(threads: usize) -> rayon::ThreadPool {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool")
    }

    /// The first piece of every hundred takes as long as hundreds of others: without a limit these
    /// would all be held.
    #[test]
    fn few_results_wait_however_unequal_the_work() {
        const THREADS: usize = 4;
        let (begun, mut most, mut sum) = (AtomicUsize::new(0), 0, 0);
        pool(THREADS).install(|| {
            let work = |number: usize| {
                begun.fetch_add(1, Ordering::SeqCst);
                if number.is_multiple_of(100) {
                    std::thread::sleep(Duration::from_millis(20));
                }
                number
            };
            for_each_in_order(1000, work, |number, result| {
                assert_eq!(number, result);
                most = most.max(begun.load(Ordering::SeqCst) - number);
                sum += result;
            });
        });
        assert_eq!(sum, 499_500);
        assert!(most <= (AHEAD_PER_THREAD + 1) * THREADS, "{most} pieces were begun and not taken");
    }

    /// The others are far ahead of the first piece, and wait, when taking it fails.
    #[test]
    fn a_panic_while_taking_leaves_nobody_waiting() {
        let work = |number: usize| {
            std::thread::sleep(Duration::from_millis(if number == 0 { 200 } else { 0 }));
        };
        let take = |number: usize, ()| assert_ne!(number, 0, "on purpose");
        let all = || pool(3).install(|| for_each_in_order(1000, work, take));
        assert!(std::panic::catch_unwind(all).is_err());
    }

    #[test]
    fn a_panic_leaves_nobody_waiting() {
        let work = |number: usize| assert_ne!(number, 3, "on purpose");
        let all = || pool(2).install(|| for_each_in_order(1000, work, |_, ()| {}));
        assert!(std::panic::catch_unwind(all).is_err());
    }
}
