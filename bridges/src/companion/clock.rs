//! The autopilot's time, and the order in which it sent what comes.

/// The autopilot's clock, by `TIMESYNC`: of the last answers, the quickest counts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// The last answers, in turn.
    answers: [Option<Answer>; ANSWERS],
    next: usize,
}

/// Time there and back, and the autopilot's time less ours \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Answer {
    there_and_back: f64,
    ahead: f64,
}

/// Answers that are looked at, one a second: few enough that a clock may drift, or a simulation fall behind, enough that one of them was not held up.
const ANSWERS: usize = 8;

impl Clock {
    /// Takes an answer that arrived `now` \[s\]: sent at `ours` \[ns\] on our clock, answered at `theirs` on the autopilot's.
    pub fn take(&mut self, now: f64, ours: i64, theirs: i64) -> bool {
        let (ours, theirs) = (ours as f64 * 1e-9, theirs as f64 * 1e-9);
        let there_and_back = now - ours;
        let sound = (0.0..1.0).contains(&there_and_back);
        if sound && let Some(place) = self.answers.get_mut(self.next) {
            *place = Some(Answer {
                there_and_back,
                ahead: theirs - 0.5 * (now + ours),
            });
            self.next = (self.next + 1) % ANSWERS;
        }
        sound
    }

    fn quickest(&self) -> Option<Answer> {
        let answers = self.answers.iter().flatten();
        let by = |a: &&Answer, b: &&Answer| a.there_and_back.total_cmp(&b.there_and_back);
        answers.min_by(by).copied()
    }

    /// Time \[s\] that a message takes; 0 if it is not known.
    #[must_use]
    pub fn latency(&self) -> f64 {
        self.quickest().map_or(0.0, |a| 0.5 * a.there_and_back)
    }

    /// The autopilot's time less ours \[s\], if it is known.
    #[must_use]
    pub fn ahead(&self) -> Option<f64> {
        self.quickest().map(|a| a.ahead)
    }
}

/// The order in which messages were sent, by their sequence numbers, counted on through their turns of 256.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Order {
    /// Place of the last message, and when one arrived \[s\].
    last: Option<(i64, f64)>,
}

/// Time \[s\] without any message after which the numbers say nothing of the order: 128 messages may have been lost.
const SILENCE: f64 = 0.2;

impl Order {
    /// The place of a message with this number.
    pub fn place(&mut self, now: f64, number: u8) -> i64 {
        let place = match self.last {
            None => i64::from(number),
            Some((last, at)) => {
                let ahead = number.wrapping_sub(last as u8);
                match now - at > SILENCE {
                    true => last + i64::from(ahead).max(1),
                    false => last + i64::from(ahead as i8),
                }
            }
        };
        let last = self.last.map_or(place, |(last, _)| last.max(place));
        self.last = Some((last, now));
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_the_last_answers_the_quickest_counts() {
        let mut clock = Clock::default();
        assert_eq!((clock.ahead(), clock.latency()), (None, 0.0));
        let second = |t: f64| (t * 1e9) as i64;
        assert!(clock.take(1.04, second(1.0), second(101.02)));
        assert!(clock.take(2.3, second(2.0), second(102.02)));
        assert!((clock.ahead().unwrap() - 100.0).abs() < 1e-9);
        assert!((clock.latency() - 0.02).abs() < 1e-9);
        // From the future, and from long ago.
        assert!(!clock.take(3.0, second(5.0), second(105.0)));
        assert!(!clock.take(9.0, second(5.0), second(105.0)));
        for at in 10..15 {
            let t = f64::from(at);
            assert!(clock.take(t + 0.2, second(t), second(t + 100.1)));
        }
        let (slow, quick) = ((20.2, 20.0, 120.3), (21.1, 21.0, 121.25));
        for (now, ours, theirs) in [slow, quick] {
            assert!((clock.latency() - 0.02).abs() < 1e-9);
            assert!(clock.take(now, second(ours), second(theirs)));
        }
        // The first is not among the last eight any more. The clocks drifted.
        assert!((clock.latency() - 0.05).abs() < 1e-9);
        assert!((clock.ahead().unwrap() - 100.2).abs() < 1e-9);
    }

    #[test]
    fn places_go_on_over_the_turn_of_the_numbers_and_a_silence() {
        let mut order = Order::default();
        assert_eq!(order.place(0.0, 250), 250);
        assert_eq!(order.place(0.1, 3), 259);
        assert_eq!(order.place(0.2, 254), 254);
        assert_eq!(order.place(0.3, 4), 260);
        // After a silence any number is later.
        assert_eq!(order.place(1.0, 3), 515);
    }
}
