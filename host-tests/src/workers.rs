//! Work on all cores.

use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// One thread per core.
pub fn per_core() -> NonZero<usize> {
    std::thread::available_parallelism().unwrap_or(NonZero::<usize>::MIN)
}

/// Does `work` on every one of `items` and its number, on `threads` threads, each of which takes the next one when it is done with the
/// last. No more are taken once one says not to go on.
pub fn for_each<T: Sync>(
    items: &[T],
    threads: NonZero<usize>,
    work: impl Fn(usize, &T) -> bool + Sync,
) {
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        for _ in 0..threads.get().min(items.len()) {
            scope.spawn(|| {
                while !stop.load(Ordering::Relaxed) {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(number) else {
                        break;
                    };
                    if !work(number, item) {
                        stop.store(true, Ordering::Relaxed);
                    }
                }
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    fn done(threads: usize, last: usize) -> Vec<usize> {
        let items: Vec<usize> = (0..100).collect();
        let done = Mutex::new(Vec::new());
        for_each(&items, NonZero::new(threads).unwrap(), |number, &item| {
            assert_eq!(number, item);
            done.lock().unwrap().push(item);
            item != last
        });
        let mut done = done.into_inner().unwrap();
        done.sort_unstable();
        done
    }

    #[test]
    fn every_item_is_done_once_whatever_the_threads() {
        let all: Vec<usize> = (0..100).collect();
        for threads in [1, 3, 200] {
            assert_eq!(done(threads, usize::MAX), all);
        }
    }

    #[test]
    fn none_is_taken_after_one_says_stop() {
        assert_eq!(done(1, 10), (0..=10).collect::<Vec<_>>());
        for_each(&[0; 0], per_core(), |_, _| panic!("nothing to do"));
    }
}
