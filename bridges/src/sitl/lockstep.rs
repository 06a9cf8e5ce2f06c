//! One step of the physics per packet.

use super::{Packet, Sample};

/// What is behind the interface.
pub trait Physics {
    /// One time step under these servo outputs, and the state after it.
    fn step(&mut self, packet: &Packet) -> Sample;
    /// The autopilot was started anew: back to the ground.
    fn restart(&mut self);
}

/// What came.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Steps taken.
    pub steps: u64,
    /// Packets that came again and were answered again.
    pub repeated: u64,
    /// Packets that never came, by the count.
    pub lost: u64,
    /// Packets that came after a later one, and were dropped.
    pub late: u64,
    /// Packets that were malformed, and dropped.
    pub malformed: u64,
    /// Times that the autopilot was started anew.
    pub restarts: u64,
}

/// The state of the conversation.
#[derive(Debug, Default)]
pub struct Lockstep {
    last: Option<u32>,
    /// The count of the last packet that was dropped for being late, unless another was answered since.
    late: Option<u32>,
    answer: String,
    counts: Counts,
}

impl Lockstep {
    /// What came so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes what was received, and gives the answer, if there is one.
    pub fn receive(&mut self, bytes: &[u8], physics: &mut dyn Physics) -> Option<&[u8]> {
        let Ok(packet) = Packet::parse(bytes) else {
            self.counts.malformed += 1;
            return None;
        };
        let count = packet.frame_count;
        match self.last {
            Some(last) if count == last => {
                self.counts.repeated += 1;
                return Some(self.answer.as_bytes());
            }
            Some(last) if count < last => {
                // One that was late comes once. An autopilot that was started anew waits for its answer, and sends the same again.
                if self.late != Some(count) {
                    self.counts.late += 1;
                    self.late = Some(count);
                    return None;
                }
                self.counts.restarts += 1;
                physics.restart();
            }
            Some(last) => self.counts.lost += u64::from(count - last - 1),
            None => {}
        }
        self.last = Some(count);
        self.late = None;
        self.counts.steps += 1;
        self.answer = physics.step(&packet).text();
        Some(self.answer.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Default)]
    struct Clock {
        steps: u32,
        restarts: u32,
    }

    impl Physics for Clock {
        fn step(&mut self, _: &Packet) -> Sample {
            self.steps += 1;
            Sample {
                timestamp: f64::from(self.steps),
                ..Sample::default()
            }
        }

        fn restart(&mut self) {
            *self = Self {
                steps: 0,
                restarts: self.restarts + 1,
            };
        }
    }

    #[test]
    fn each_count_is_one_step_however_often_it_comes() {
        let (mut lockstep, mut clock) = (Lockstep::default(), Clock::default());
        let mut send = |count: u32| {
            let bytes = Packet::new(400, count, &[1500; 16]).bytes();
            let answer = lockstep.receive(&bytes, &mut clock);
            answer.map(|bytes| String::from_utf8(bytes.to_vec()).unwrap())
        };
        // The first packet that comes need not be the first that was sent.
        let first = send(20).unwrap();
        assert!(first.contains("\"timestamp\":1.0"));
        assert_eq!(send(20), Some(first.clone()));
        assert_eq!(send(20), Some(first));
        assert!(send(21).unwrap().contains("\"timestamp\":2.0"));
        // Three lost on the way: one step.
        assert!(send(25).unwrap().contains("\"timestamp\":3.0"));
        assert_eq!(send(24), None);
        assert_eq!(send(11), None);
        // One that waits: ours was lost, or another one's count was taken for it.
        assert!(send(11).unwrap().contains("\"timestamp\":1.0"));
        assert!(send(12).unwrap().contains("\"timestamp\":2.0"));
        // The first packets may be late as any other.
        for first in [1, 0] {
            assert_eq!(send(first), None);
            assert!(send(first).unwrap().contains("\"timestamp\":1.0"));
        }
        assert!(lockstep.receive(&[0; 41], &mut clock).is_none());
        let counts = Counts {
            steps: 7,
            repeated: 2,
            lost: 3,
            late: 4,
            malformed: 1,
            restarts: 3,
        };
        assert_eq!(lockstep.counts(), counts);
        assert_eq!((clock.steps, clock.restarts), (1, 3));
    }
}
