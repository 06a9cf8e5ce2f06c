//! What a vehicle can do on its wing, from what is believed of it: drag, glide, climb, turns. Computed once.

use crate::aero::Aerodynamics;
use crate::air::AngleOfAttack;
use crate::control::Guard;
use crate::guidance::{greatest_rate, takeover};
use crate::math;
use crate::spatial::SLIP;
use crate::vehicle::Vehicle;

/// Speeds of the table, in multiples of the stall speed: the first, and the step.
const FIRST: f32 = 1.15;
const STEP: f32 = 0.15;
const SPEEDS: usize = 16;
/// Part of the thrust there is that level flight may take, and of what is left that a climb may.
const THRUST_SHARE: f32 = 0.9;
const CLIMB_SHARE: f32 = 0.7;
/// Part of the greatest lift that a turn may take. The rest is for gusts.
const LIFT_SHARE: f32 = 0.7;
/// Acceleration of turns in hover, where thrust alone makes them [m/s²].
const HOVER_TURN: f32 = 2.0;
/// Part of the greatest rate of the guidance by rule that a path lets it bank with, and the least [rad/s]. The rest is for gusts.
const ROLL_SHARE: f32 = 0.8;
const LEAST_ROLL: f32 = 0.05;
/// Part of the greatest sideslip that a path counts on.
const SLIP_SHARE: f32 = 0.5;
/// Half of the longest time in which the bank of a path's turns goes from one side to the other \[s\].
const BANKING: f32 = 0.5;
/// Part of the speed from which on the air alone has a say in the course at which a heading has as much: the guard is ½ at 1/√3.
const EQUAL: f32 = 0.577_350_26;
/// Step of the search for an angle of attack, half a degree \[rad\], and how many: up to 30°, where every wing has stalled.
const DEGREE: f32 = 8.726_646e-3;
const ANGLES: u8 = 61;

/// Wind to hover in, over the stall speed, from which on a vehicle brakes level. `mapping` has 0.32; vehicles that climb by a few metres have 0.5 and more.
const HELD: f32 = 0.4;

/// What a vehicle can do on its wing.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Ability {
    /// Speed at which the greatest lift carries the weight [m/s].
    pub stall_speed: f32,
    /// Drag of level flight and the thrust there is, both over the weight, at the speeds of the table.
    table: [[f32; 2]; SPEEDS],
    gravity: f32,
    weight: f32,
    /// How fast paths let it bank [rad/s].
    roll: f32,
    /// The same as far as what turns it about its nose allows it, times the airspeed [rad m/s²]; and the acceleration of a sideslip that is had at once, over
    /// the squared airspeed [1/m].
    roll_in_air: f32,
    slip: f32,
    /// Greatest wind to hover in, and to land and take off in [m/s]: there the wing is kept along it besides.
    pub hover_wind: f32,
    pub landing_wind: f32,
    /// How the air takes over from the heading that is asked for.
    takeover: Guard,
}

/// (c_L, c_D) at an angle of attack: a function, and not a model, so that the search is compiled once.
type Polar<'a> = &'a dyn Fn(f32) -> (f32, f32);

/// c_D where the lift coefficient is `lift`, on the way to stall.
fn drag_at(polar: Polar<'_>, lift: f32) -> f32 {
    let mut below = (0.0, polar(0.0));
    for n in 1..ANGLES {
        let (c_l, c_d) = polar(DEGREE * f32::from(n));
        if c_l >= lift {
            let (low, drag) = below.1;
            let part = (lift - low) / math::max(c_l - low, 1e-6);
            return drag + math::clamp(part, 0.0, 1.0) * (c_d - drag);
        }
        below = (f32::from(n), (c_l, c_d));
    }
    below.1.1
}

impl Ability {
    pub fn new<A: Aerodynamics>(vehicle: &Vehicle<A>) -> Self {
        let polar = |alpha: f32| {
            let c = vehicle
                .model()
                .coefficients(AngleOfAttack::from_radians(alpha));
            (c.c_l, c.c_d)
        };
        let available = |speed: f32| vehicle.thrust_max() * vehicle.propeller().available(speed);
        let stall_speed = vehicle.stall_speed();
        let takeover = takeover(vehicle);
        let in_hover = vehicle.turning_in_hover();
        let rate = greatest_rate(in_hover);
        let hover_wind = vehicle.hover_wind(FIRST * stall_speed);
        let empty = Self {
            stall_speed,
            table: [[0.0; 2]; SPEEDS],
            gravity: vehicle.gravity(),
            weight: vehicle.weight(),
            roll: math::max(ROLL_SHARE * rate, LEAST_ROLL),
            roll_in_air: vehicle.roll(),
            slip: SLIP_SHARE * SLIP * vehicle.side() / vehicle.mass(),
            hover_wind,
            landing_wind: math::min(hover_wind, EQUAL * takeover.tau()),
            takeover,
        };
        empty.filled(&polar, &available, vehicle.k_a())
    }

    /// With the tables of a vehicle that has this polar, this thrust \[N\] at an airspeed, and this k_a \[kg/m\].
    fn filled(mut self, polar: Polar<'_>, available: &dyn Fn(f32) -> f32, k_a: f32) -> Self {
        let (stall_speed, weight) = (self.stall_speed, self.weight);
        let mut multiple = FIRST;
        for row in &mut self.table {
            let speed = multiple * stall_speed;
            let pressure = k_a * speed * speed / weight;
            let drag = pressure * drag_at(polar, 1.0 / pressure);
            *row = [drag, available(speed) / weight];
            multiple += STEP;
        }
        self
    }

    /// The values of the table at `speed` [m/s], held at its ends: drag and thrust there is, over the weight.
    #[inline]
    fn at(&self, speed: f32) -> [f32; 2] {
        let row = math::clamp(
            (speed / self.stall_speed - FIRST) * (1.0 / STEP),
            0.0,
            (SPEEDS - 1) as f32,
        );
        let below = row as usize;
        let part = row - below as f32;
        match self.table.get(below..) {
            Some([low, high, ..]) => {
                let ([drag, thrust], [more, most]) = (low, high);
                [drag + part * (more - drag), thrust + part * (most - thrust)]
            }
            Some([last, ..]) => *last,
            _ => [0.0; 2],
        }
    }

    /// Gravity [m/s²].
    pub fn gravity(&self) -> f32 {
        self.gravity
    }

    /// Weight \[N\].
    pub fn weight(&self) -> f32 {
        self.weight
    }

    /// Least airspeed on the wing [m/s]. Slower is hover.
    pub fn least_speed(&self) -> f32 {
        FIRST * self.stall_speed
    }

    /// Whether it holds its wing across the air up to a speed from which it brakes level: else it climbs meanwhile.
    pub fn brakes_level(&self) -> bool {
        self.hover_wind >= HELD * self.stall_speed
    }

    /// Greatest airspeed of level flight in the table [m/s]; the least where thrust carries none.
    pub fn most_speed(&self) -> f32 {
        let mut most = self.least_speed();
        for (n, [drag, thrust]) in self.table.iter().enumerate() {
            if *drag <= THRUST_SHARE * *thrust {
                most = (FIRST + STEP * n as f32) * self.stall_speed;
            }
        }
        most
    }

    /// Drag of level flight over the weight at an airspeed [m/s]: the deceleration without thrust in g, and the slope of the glide.
    pub fn drag(&self, airspeed: f32) -> f32 {
        self.at(airspeed)[0]
    }

    /// Thrust \[N\] of steady flight at an airspeed [m/s], at this load factor and slope of the climb.
    pub fn steady_thrust(&self, airspeed: f32, load: f32, slope: f32) -> f32 {
        // As a vehicle n times as heavy flies at 1/√n of the speed.
        let drag = load * self.drag(airspeed / math::sqrt(load.abs()));
        self.weight * math::max(drag + slope, 0.0)
    }

    /// Slopes at an airspeed [m/s]: of the glide without thrust, and of the climb that leaves thrust to turn with; none is negative.
    pub fn slopes(&self, airspeed: f32) -> [f32; 2] {
        let [drag, thrust] = self.at(airspeed);
        [drag, CLIMB_SHARE * math::clamp(thrust - drag, 0.0, 1.0)]
    }

    /// Acceleration to the side [m/s²] of a turn at an airspeed [m/s] with this tangent of the bank.
    pub fn turn(&self, airspeed: f32, tan_bank: f32) -> f32 {
        let carried = airspeed / self.stall_speed;
        let load = LIFT_SHARE * carried * carried;
        let by_lift = math::sqrt(math::max(load * load - 1.0, 0.0).abs());
        math::max(
            self.gravity * math::min(by_lift, tan_bank),
            math::min(HOVER_TURN, self.gravity * tan_bank),
        )
    }

    /// Acceleration to the side [m/s²] of the turns of a path: as [`turn`](Self::turn), and no more than it banks for between two turns.
    pub fn turn_of_paths(&self, airspeed: f32, tan_bank: f32) -> f32 {
        math::min(self.turn(airspeed, tan_bank), self.banked(airspeed))
    }

    /// Half of the time \[s\] in which a bank for an acceleration to the side [m/s²] goes from one side to the other at an airspeed [m/s].
    pub fn banking(&self, airspeed: f32, turn: f32) -> f32 {
        BANKING * turn / self.banked(airspeed)
    }

    /// Acceleration to the side [m/s²] that it banks for in [`BANKING`] at an airspeed [m/s]: by its roll, or, where that is slow, by a sideslip besides.
    fn banked(&self, airspeed: f32) -> f32 {
        let slow =
            self.gravity * BANKING * self.roll_in_air / airspeed + self.slip * airspeed * airspeed;
        let by_rule = self.gravity * BANKING * self.roll;
        math::clamp(slow, self.gravity * BANKING * LEAST_ROLL, by_rule)
    }

    /// How much more the air has to say in the course than a heading that is asked for, at an airspeed [m/s].
    pub fn air_over_heading(&self, airspeed: f32) -> f32 {
        let air = self.takeover.mu(airspeed);
        air / math::max(1.0 - air, 1e-3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::air::AirData;
    use crate::frame::Body;
    use crate::vehicle::VehicleParameters;

    fn vehicle() -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters {
            c0: 0.045,
            ..CombinedParameters::NACA_0021_RE_160E3
        });
        Vehicle::new(VehicleParameters::PAPER, model.unwrap()).unwrap()
    }

    /// At the speed of the table the vehicle's own aerodynamic force carries the weight, and its drag is the one told.
    #[test]
    fn drag_is_that_of_the_vehicle_where_lift_carries_it() {
        let vehicle = vehicle();
        let ability = Ability::new(&vehicle);
        for speed in [16.0, 20.0, 24.0_f32] {
            // The angle of attack with the lift, by bisection on the force itself.
            let force = |alpha: f32| {
                let (sin, cos) = math::sin_cos(alpha);
                // i is along the tail: air velocity along the nose and to the belly.
                let air = AirData::new(Body::new(-speed * cos, speed * sin), vehicle.thrust_line());
                let f = vehicle.aerodynamic_force(&air);
                let lift = -(f.j() * cos) - f.i() * sin;
                let drag = f.i() * cos - f.j() * sin;
                (lift, drag)
            };
            let (mut low, mut high) = (0.0, 0.2);
            for _ in 0..30 {
                let mid = 0.5 * (low + high);
                if force(mid).0 < vehicle.weight() {
                    low = mid;
                } else {
                    high = mid;
                }
            }
            let drag = force(low).1 / vehicle.weight();
            assert!(
                (ability.drag(speed) / drag - 1.0).abs() < 0.03,
                "{speed}: {} {drag}",
                ability.drag(speed)
            );
        }
    }

    /// The turns of a path are banked for within a second, by what turns the vehicle: in hover 9.8 rad/s² make a rate of 0.74 rad/s.
    #[test]
    fn who_banks_slowly_turns_wider() {
        let wing = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let slow = VehicleParameters::PAPER.authority(9.8);
        let slow = Ability::new(&Vehicle::new(slow, wing).unwrap());
        let fast = Ability::new(&vehicle());
        assert_eq!(fast.turn_of_paths(22.0, 0.5), fast.turn(22.0, 0.5));
        let turn = slow.turn_of_paths(22.0, 0.5);
        assert!((turn - 9.81 * 0.8 * 0.74 * 0.5).abs() < 0.02, "{turn}");
        assert!((slow.banking(22.0, turn) - 0.5).abs() < 1e-3);
        assert!(fast.banking(22.0, fast.turn(22.0, 0.5)) < 0.25);
        let none = VehicleParameters::PAPER.authority(0.0);
        let none = Ability::new(&Vehicle::new(none, wing).unwrap());
        assert!(none.turn_of_paths(22.0, 0.5) > 0.2);
    }

    /// At 22 m/s 0.4 of 8 rad m/s² bank for 0.71 m/s² in half a second; half of a sideslip of a tenth of a radian gives its side force besides.
    #[test]
    fn who_rolls_slowly_turns_wider() {
        let wing = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        let turn = |roll: f32, c_y: f32| {
            let p = VehicleParameters::PAPER.roll_authority(roll).c_y(c_y);
            let ability = Ability::new(&Vehicle::new(p, wing).unwrap());
            let turn = ability.turn_of_paths(22.0, 0.5);
            assert!((ability.banking(22.0, turn) - BANKING).abs() < 1e-3 || roll > 1e3);
            turn
        };
        let rolled = 9.81 * 0.5 * 0.4 * 2.0 / 22.0;
        // 0.05 rad/s is the least that a path counts on.
        assert!((turn(2.0, 0.0) - 9.81 * 0.5 * 0.05).abs() < 1e-3);
        assert!((turn(8.0, 0.0) - 4.0 * rolled).abs() < 1e-3);
        let slipped = 0.05 * 0.646 * 0.3 / 10.0 * 22.0 * 22.0;
        assert!((turn(8.0, 0.3) - 4.0 * rolled - slipped).abs() < 1e-3);
        // Where the roll is quick no sideslip is counted on.
        assert_eq!(turn(1e6, 0.3), turn(1e6, 0.0));
    }

    #[test]
    fn a_turn_takes_no_more_than_bank_and_lift() {
        let ability = Ability::new(&vehicle());
        let fast = ability.turn(3.0 * ability.stall_speed, 0.5);
        assert!((fast - 0.5 * 9.81).abs() < 1e-3);
        let slow = ability.turn(1.25 * ability.stall_speed, 1.0);
        let load = math::sqrt(1.0 + (slow / 9.81) * (slow / 9.81));
        assert!(load < 0.75 * 1.25 * 1.25, "{load}");
    }
}
