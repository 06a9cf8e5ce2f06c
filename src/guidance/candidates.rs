//! The plans that are looked at: to turn to an angle of attack, perhaps after a push-over, or to leave all to the servo.

use super::reference_model::{Plan, ReferenceModel};
use super::rollout::PlanRequest;
use super::wrap::wrap;
use crate::aero::Aerodynamics;
use crate::math;
use crate::vehicle::Vehicle;

/// A push-over before a turn. It takes a time per unit of n + [`MORE_LOAD`], where n is the load factor that the wing can carry short of
/// stall. The faster a wing flies and the more lift it has, the more it climbs on its way through stall, and the more a push-over has to
/// make up for. With 0.225 s whatever n is, a wing of twice the area left its altitude by up to 7.7 m where a level reference slows down, in
/// place of 1.8 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Push {
    No,
    Short,
    Long,
}
use Push::{Long, No, Short};
const MORE_LOAD: f32 = 0.8;
/// The longest push-over \[s\].
const MAX_PUSH: f32 = 0.5;
/// Part of the sink velocity beyond the one wanted that a push-over need not make: who falls turns the nose up at once.
const SINKING: f32 = 0.4;

/// A turn: to an angle of attack \[rad\], after a push-over. `None` leaves all to the servo.
pub(super) type Turn = Option<(f32, Push)>;

/// The turns that are looked at, in this order and round again: each search goes on where the last one has ended. What is cut short
/// leaves steps for more. Six turns more were not missed: docs/results.md.
const TURNS: [Turn; 11] = [
    Some((1.4, Short)),
    Some((0.8, No)),
    Some((0.8, Long)),
    Some((0.0, No)),
    Some((0.116, No)),
    None,
    Some((-0.116, No)),
    Some((1.75, No)),
    Some((-0.8, No)),
    Some((-1.4, No)),
    Some((1.75, Long)),
];

/// Candidates.
pub(super) const COUNT: u8 = TURNS.len() as u8;

/// Candidate `n` of a search that begins with the `first`.
pub(super) fn turn(n: u8, first: u8) -> Turn {
    let n = (usize::from(n) + usize::from(first)) % TURNS.len();
    TURNS.get(n).copied().flatten()
}

/// The first candidate of the next search, after one that began with `first` and looked at so many.
pub(super) fn after(first: u8, looked: u8) -> u8 {
    ((u16::from(first) + u16::from(looked)) % u16::from(COUNT)) as u8
}

/// The plan of a turn that begins as `request` says, with a wing of this `lift` coefficient short of stall.
#[inline(always)]
pub(super) fn plan<A: Aerodynamics>(
    turn: Turn,
    reference_model: &ReferenceModel,
    vehicle: &Vehicle<A>,
    request: &PlanRequest,
    lift: f32,
) -> Plan {
    let Some((alpha, push)) = turn else {
        return Plan::default();
    };
    let flight = &request.flight;
    let v_a = flight.velocity - request.wind;
    let gamma = math::atan2(v_a.forward(), v_a.down());
    let target = gamma - math::PI + vehicle.thrust_line().delta() + alpha;
    let load = lift * vehicle.k_a() * v_a.norm_squared() / vehicle.weight();
    let wanted = reference_model.desired_down(flight.position.down(), request.velocity.down());
    let sinking = math::max(flight.velocity.down() - wanted, 0.0);
    let tuning = &reference_model.tuning;
    let push = match push {
        No => 0.0,
        Short => tuning.short_push,
        Long => tuning.long_push,
    };
    let saved = SINKING / tuning.push_over * sinking / vehicle.gravity();
    Plan {
        push: math::clamp(push * (load + MORE_LOAD) - saved, 0.0, MAX_PUSH),
        target: flight.theta + wrap(target - flight.theta),
        turn: 1,
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::frame::Inertial;
    use crate::guidance::reference_model::PlanarModelState;
    use crate::guidance::{GuidanceParameters, Tuning};
    use crate::vehicle::VehicleParameters;

    fn vehicle() -> Vehicle<Combined> {
        let model = Combined::new(CombinedParameters::NACA_0021_RE_160E3).unwrap();
        Vehicle::new(VehicleParameters::PAPER, model).unwrap()
    }

    /// At 20 m/s, sinking by so much [m/s].
    fn cruise(sink: f32) -> PlanRequest {
        PlanRequest {
            flight: PlanarModelState {
                velocity: Inertial::new(sink, 20.0),
                theta: -86f32.to_radians(),
                ..PlanarModelState::default()
            },
            ..PlanRequest::default()
        }
    }

    fn plan_of(turn: Turn, sink: f32, lift: f32) -> Plan {
        let vehicle = vehicle();
        let model =
            ReferenceModel::new(&GuidanceParameters::default(), &vehicle, &Tuning::default());
        plan(turn, &model, &vehicle, &cruise(sink), lift)
    }

    /// However few a search looks at, the next ones come to every candidate, and none twice before all have been looked at.
    #[test]
    fn all_candidates_are_looked_at() {
        let mut seen = std::vec::Vec::new();
        let mut first = 0;
        for looked in [7, 3, COUNT, 0, 1, 9, 2] {
            seen.extend((0..looked).map(|n| turn(n, first)));
            first = after(first, looked);
        }
        assert_eq!(seen.len(), 3 * TURNS.len());
        assert!(seen.chunks(TURNS.len()).all(|round| round == TURNS));
        // To an angle of attack of 46° from a course that is level forward: nose 44° from up.
        let braking = plan_of(TURNS[1], 0.0, 0.7);
        assert!((braking.target.to_degrees() + 44.2).abs() < 0.05 && braking.push == 0.0);
        assert_eq!(plan_of(None, 0.0, 0.7), Plan::default());
    }

    /// The wing climbs on its way through stall, the more so the more lift it has: the push-over is the longer. Who sinks
    /// already pushes over less, and who falls not at all.
    #[test]
    fn a_push_over_is_as_long_as_the_wing_is_strong() {
        let push = |sink: f32, lift: f32, push: Push| plan_of(Some((0.8, push)), sink, lift).push;
        // k_a |v_a|²/(m g) = 0.646·400/98.1: the load factor at a lift coefficient of 1.
        let load = 2.634;
        let tuning = Tuning::default();
        for (long, factor) in [(Short, tuning.short_push), (Long, tuning.long_push)] {
            // 1e-4 s: 2.634 has four digits.
            for lift in [0.7, 1.4] {
                let expected = factor * (lift * load + MORE_LOAD);
                assert!((push(0.0, lift, long) - math::min(expected, MAX_PUSH)).abs() < 1e-4);
            }
            assert!(push(0.0, 1.4, long) > push(0.0, 0.7, long));
            assert_eq!(push(20.0, 0.7, long), 0.0);
        }
        // 2 m/s of sink that nobody asked for is 0.4 of that in a push-over.
        let less = push(0.0, 0.7, Long) - push(2.0, 0.7, Long);
        let expected = 0.4 * 2.0 / (tuning.push_over * 9.81);
        // 2e-3 s: the wing flies faster by a hundredth, too.
        assert!((less - expected).abs() < 2e-3, "{less}");
        // A turn back to the wing begins at once.
        assert_eq!(push(0.0, 0.7, No), 0.0);
    }
}
