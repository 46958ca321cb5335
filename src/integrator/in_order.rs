//! Results of parallel work, taken in the order of the work: sums of floating-point numbers
//! depend on their order, and pictures must not depend on who is done first.

use std::collections::BTreeMap;
use std::sync::Mutex;

/// Takes the results of pieces of work 0, 1, 2 … in that order, whenever they come.
pub struct InOrder<T, F> {
    state: Mutex<State<T, F>>,
}

struct State<T, F> {
    take: F,
    next: usize,
    waiting: BTreeMap<usize, T>,
}

impl<T, F: FnMut(usize, T)> InOrder<T, F> {
    /// Hands each result to `take`, by its number.
    pub const fn new(take: F) -> Self {
        Self { state: Mutex::new(State { take, next: 0, waiting: BTreeMap::new() }) }
    }

    /// The result of a piece of work; taken now, or kept until those before it have come.
    pub fn add(&self, number: usize, result: T) {
        let mut state = self.state.lock().expect("no thread panics while it takes a result");
        state.waiting.insert(number, result);
        let State { take, next, waiting } = &mut *state;
        while let Some(result) = waiting.remove(next) {
            take(*next, result);
            *next += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
