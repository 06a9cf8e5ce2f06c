//! Sessions and sequence numbers: which of the undamaged messages are new.

use crate::Counters;

/// Remembers the last message accepted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Order {
    last: Option<(u32, u32)>,
}

/// What an accepted message is to the receiver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// The first of a new session: what earlier sessions configured is void.
    NewSession,
    /// The next of this session. Numbers may be skipped: lost messages stay lost.
    Next,
}

impl Order {
    /// Whether the message `sequence` of `session` is new; counted if not. Both numbers wrap: one is newer than
    /// another if it is ahead by less than 2³¹.
    pub fn admit(
        &mut self,
        session: u32,
        sequence: u32,
        counters: &mut Counters,
    ) -> Option<Admission> {
        let admission = match self.last {
            Some((current, last)) if current == session => {
                if !newer(sequence, last) {
                    counters.out_of_order += 1;
                    return None;
                }
                Admission::Next
            }
            Some((current, _)) if !newer(session, current) => {
                counters.stale += 1;
                return None;
            }
            _ => Admission::NewSession,
        };
        self.last = Some((session, sequence));
        Some(admission)
    }

    /// Session and number of the last message accepted; zeros before the first.
    pub fn last(&self) -> (u32, u32) {
        self.last.unwrap_or_default()
    }
}

fn newer(number: u32, than: u32) -> bool {
    (number.wrapping_sub(than) as i32) > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_news_is_admitted() {
        let mut order = Order::default();
        let mut counters = Counters::default();
        let mut admit = |session, sequence| order.admit(session, sequence, &mut counters);
        assert_eq!(admit(7, 100), Some(Admission::NewSession));
        assert_eq!(admit(7, 101), Some(Admission::Next));
        assert_eq!(admit(7, 101), None);
        assert_eq!(admit(7, 90), None);
        assert_eq!(admit(7, 105), Some(Admission::Next));
        assert_eq!(admit(6, 106), None);
        assert_eq!(admit(8, 1), Some(Admission::NewSession));
        assert_eq!(admit(7, 107), None);
        assert_eq!((counters.out_of_order, counters.stale), (2, 2));
    }

    #[test]
    fn numbers_wrap() {
        let mut order = Order::default();
        let counters = &mut Counters::default();
        assert!(order.admit(u32::MAX, u32::MAX, counters).is_some());
        assert_eq!(order.admit(u32::MAX, 0, counters), Some(Admission::Next));
        assert_eq!(order.admit(u32::MAX, u32::MAX, counters), None);
        assert_eq!(order.admit(3, 9, counters), Some(Admission::NewSession));
        assert_eq!(order.last(), (3, 9));
    }
}
