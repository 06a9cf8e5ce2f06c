//! Arming: the motor turns only after the switch has been put on while the vehicle was ready to fly.

/// Remembers what the arming switch did.
///
/// A switch that is on at power-on, or is put on before inputs arrive, does not arm: it must be off while the vehicle is
/// ready, and then be put on. What arms is that change, once. It lasts while inputs fail: a gap in the link is not to end a
/// flight. The switch off disarms at once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arming {
    armed: bool,
    /// The switch was off, and the vehicle ready, at the last update.
    waiting: bool,
}

impl Arming {
    /// Whether the motor is armed, after the switch has been read. `ready`: inputs are fresh.
    pub fn update(&mut self, switch: bool, ready: bool) -> bool {
        self.armed = switch && (self.armed || (self.waiting && ready));
        self.waiting = !switch && ready;
        self.armed
    }

    /// Disarms, whatever the switch does, until it is put off and on again.
    pub fn disarm(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ON: bool = true;
    const OFF: bool = false;

    /// Whether it is armed after each of these readings of the switch and of whether the vehicle is ready.
    fn armed<const N: usize>(arming: &mut Arming, readings: [(bool, bool); N]) -> [bool; N] {
        readings.map(|(switch, ready)| arming.update(switch, ready))
    }

    #[test]
    fn a_switch_that_is_on_at_power_on_does_not_arm() {
        let arming = &mut Arming::default();
        assert_eq!(
            armed(arming, [(ON, false), (ON, true), (ON, true)]),
            [false; 3]
        );
        assert_eq!(armed(arming, [(OFF, true), (ON, true)]), [false, true]);
    }

    #[test]
    fn a_switch_put_on_before_the_vehicle_is_ready_does_not_arm() {
        let arming = &mut Arming::default();
        let readings = [(OFF, false), (ON, false), (ON, true), (ON, true)];
        assert_eq!(armed(arming, readings), [false; 4]);
        // Nor does one that is put on in the very tick in which it becomes ready.
        let readings = [(OFF, false), (ON, true)];
        assert_eq!(armed(&mut Arming::default(), readings), [false; 2]);
    }

    #[test]
    fn the_switch_off_disarms_and_a_gap_in_the_inputs_does_not() {
        let arming = &mut Arming::default();
        let readings = [
            (OFF, true),
            (ON, true),
            (ON, false),
            (ON, true),
            (OFF, true),
            (OFF, true),
        ];
        assert_eq!(
            armed(arming, readings),
            [false, true, true, true, false, false]
        );
    }

    #[test]
    fn disarmed_it_waits_for_the_switch_to_change() {
        let arming = &mut Arming::default();
        armed(arming, [(OFF, true), (ON, true)]);
        arming.disarm();
        assert_eq!(armed(arming, [(ON, true), (ON, true)]), [false; 2]);
        assert_eq!(armed(arming, [(OFF, true), (ON, true)]), [false, true]);
    }
}
