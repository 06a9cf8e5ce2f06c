//! The guidance with a state that survives changes of memory from outside.

use super::input::GuidanceInput;
use super::memory::{self, Integrity, Memory, ShadowCopy, memory};
use super::output::GuidanceOutput;
use super::planner::{Candidate, PlanSearch};
use super::state::GuidanceState;
use super::status::Status;
use super::update::Guidance;
use crate::aero::Aerodynamics;
use crate::control::GainLaw;
use crate::ned::BodyRates;
use crate::spatial::Orientation;

/// A [`Guidance`] whose state is kept twice, with a check word of both.
///
/// For a vehicle whose memory may change between steps: by radiation, or by a stray pointer. Any one changed number of the
/// state is undone, and the command is the one without the change. After more changes the state is reset to power-on.
/// Either sets [`Status::STATE_RESET`]. Commands are those of the bare [`Guidance`], to the bit.
///
/// ```
/// use alula::prelude::*;
///
/// let model = Combined::new(CombinedParameters::PAPER_BELIEF)?;
/// let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
/// let guidance = Hardened::new(Guidance::new(vehicle, &GuidanceParameters::default())?);
///
/// let mut state = HardenedState::default();
/// let output = guidance.update(&mut state, &GuidanceInput::default(), 0.01);
/// assert_eq!(output.status, Status::empty());
/// // A bit flips.
/// let mut bytes = state.to_bytes();
/// bytes[40] ^= 1;
/// state = HardenedState::from_bytes(&bytes);
/// let output = guidance.update(&mut state, &GuidanceInput::default(), 0.01);
/// assert_eq!(output.status, Status::STATE_RESET);
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Hardened<G>(G);

/// The state of a [`Hardened`] guidance. The default is power-on. Equal are those whose [bytes](Self::to_bytes) are.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct HardenedState {
    state: GuidanceState,
    shadow: ShadowCopy<{ GuidanceState::WORDS }>,
}
memory!(HardenedState {
    state: GuidanceState,
    shadow: ShadowCopy<{ GuidanceState::WORDS }>,
});

impl PartialEq for HardenedState {
    fn eq(&self, other: &Self) -> bool {
        self.to_bytes() == other.to_bytes()
    }
}

impl HardenedState {
    /// Length of [`to_bytes`](Self::to_bytes).
    pub const BYTES: usize = 4 * Self::WORDS;

    /// Little-endian words of 32 bits: the bytes of the [`GuidanceState`], their copy, and a check word. The order belongs to
    /// this version of the library.
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        memory::to_bytes(self)
    }

    /// The state of these bytes. Any will do: what no step has left is restored or reset at the next step.
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Self {
        memory::from_bytes(bytes)
    }

    /// The state of the guidance inside.
    pub fn guidance(&self) -> &GuidanceState {
        &self.state
    }
}

/// The state that a step of the guidance has left.
impl From<GuidanceState> for HardenedState {
    #[inline(always)]
    fn from(state: GuidanceState) -> Self {
        let shadow = ShadowCopy::new(&state);
        Self { state, shadow }
    }
}

impl<G> Hardened<G> {
    /// Wraps `guidance`.
    pub const fn new(guidance: G) -> Self {
        Self(guidance)
    }

    /// The guidance inside.
    pub const fn guidance(&self) -> &G {
        &self.0
    }
}

impl<A: Aerodynamics, G: GainLaw> Hardened<Guidance<A, G>> {
    /// Thrust \[N\] of the safe command, as [`Guidance::safe_thrust`].
    pub fn safe_thrust(&self, state: &HardenedState) -> f32 {
        self.0.safe_thrust(&state.state)
    }

    /// The state of a vehicle that flies already, as [`Guidance::take_over`].
    pub fn take_over(
        &self,
        orientation: &Orientation,
        thrust: f32,
        rates: BodyRates,
    ) -> HardenedState {
        self.0.take_over(orientation, thrust, rates).into()
    }

    /// One step, as [`Guidance::update`].
    #[inline]
    pub fn update(
        &self,
        state: &mut HardenedState,
        input: &GuidanceInput,
        dt: f32,
    ) -> GuidanceOutput {
        let HardenedState { state, shadow } = state;
        let integrity = shadow.restore(state);
        if integrity == Integrity::Lost {
            self.0.reset(state);
        }
        let mut output = self.0.update(state, input, dt);
        shadow.renew(state);
        output.status |= Status::STATE_RESET.when(integrity != Integrity::Intact);
        output
    }

    /// A plan, as [`Guidance::plan`].
    pub fn plan(&self, state: &mut HardenedState) {
        let mut search = self.search(state);
        while self.look(&mut search).is_some() {}
        self.adopt(state, &search);
    }

    /// Begins a plan apart from the `state`, as [`Guidance::search`]. Where memory has changed since the last step it is a search that is at
    /// its end and has found nothing: the next step undoes the change.
    pub fn search(&self, state: &HardenedState) -> PlanSearch {
        let HardenedState { state, shadow } = state;
        if shadow.is_of(state) {
            self.0.search(state)
        } else {
            PlanSearch::default()
        }
    }

    /// Looks at one candidate more, as [`Guidance::look`].
    pub fn look(&self, search: &mut PlanSearch) -> Option<Candidate> {
        self.0.look(search)
    }

    /// Takes what `search` found, as [`Guidance::adopt`]. Where memory has changed since the last step nothing is taken.
    pub fn adopt(&self, state: &mut HardenedState, search: &PlanSearch) {
        let HardenedState { state, shadow } = state;
        if shadow.is_of(state) {
            self.0.adopt(state, search);
            shadow.renew(state);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::aero::{Combined, CombinedParameters};
    use crate::guidance::{Air, GuidanceParameters, Mode};
    use crate::ned::Ned;
    use crate::spatial::{Orientation, Reference};
    use crate::vehicle::{Vehicle, VehicleParameters};

    const DT: f32 = 0.01;

    fn guidance() -> Hardened<Guidance<Combined>> {
        let vehicle = VehicleParameters {
            thrust_max: 1.3 * 98.1,
            ..VehicleParameters::PAPER_BELIEF
        };
        let model = Combined::new(CombinedParameters::PAPER_BELIEF).unwrap();
        let p = GuidanceParameters::default();
        Hardened::new(Guidance::new(Vehicle::new(vehicle, model).unwrap(), &p).unwrap())
    }

    /// At speed, in wind, off the reference.
    fn input() -> GuidanceInput {
        GuidanceInput {
            velocity: Ned::new(5.0, 0.4, 0.1),
            orientation: Orientation::NOSE_UP,
            air: Air::Wind(Ned::new(-2.0, 0.6, 0.3)),
            position_error: Some(Ned::new(-0.4, 0.2, 0.5)),
            reference: Reference {
                velocity: Ned::new(5.0, 0.0, 0.0),
                ..Reference::default()
            },
            ..GuidanceInput::default()
        }
    }

    fn after(steps: usize) -> HardenedState {
        let mut state = HardenedState::default();
        for _ in 0..steps {
            guidance().update(&mut state, &input(), DT);
        }
        state
    }

    #[test]
    fn the_commands_are_those_of_the_bare_guidance() {
        let (guidance, mut state) = (guidance(), HardenedState::default());
        let mut bare = GuidanceState::default();
        for _ in 0..200 {
            let output = guidance.update(&mut state, &input(), DT);
            assert_eq!(output, guidance.guidance().update(&mut bare, &input(), DT));
            assert_eq!(state, HardenedState::from(bare));
        }
        assert_eq!(bare.mode(), Mode::Flying);
    }

    /// Every bit of the state: what flips is undone, reported once, and forgotten.
    #[test]
    fn a_flipped_bit_is_undone_wherever_it_is() {
        let (guidance, before) = (guidance(), after(120));
        let undisturbed = guidance.update(&mut { before }, &input(), DT);
        let mut reported = 0;
        for bit in 0..8 * HardenedState::BYTES {
            let mut bytes = before.to_bytes();
            bytes[bit / 8] ^= 1 << (bit % 8);
            let mut state = HardenedState::from_bytes(&bytes);
            let output = guidance.update(&mut state, &input(), DT);
            assert_eq!(output.command, undisturbed.command, "{bit}");
            assert_eq!(output.mode, Mode::Flying);
            reported += u32::from(output.status.contains(Status::STATE_RESET));
            let next = guidance.update(&mut state, &input(), DT);
            assert!(!next.status.contains(Status::STATE_RESET), "{bit}");
        }
        // Nine short numbers of 8 bits and one of 16, the rest of 32. A flip in the copy changes nothing.
        let words = GuidanceState::WORDS as u32;
        assert_eq!(reported, 32 * (words - 10) + 9 * 8 + 16);
    }

    /// More than one change is not undone: the state is as at power-on, and the flight goes on.
    #[test]
    fn what_cannot_be_restored_is_reset() {
        let guidance = guidance();
        let mut bytes = after(120).to_bytes();
        bytes[4 * 3] ^= 1;
        bytes[4 * (GuidanceState::WORDS + 5)] ^= 1;
        let mut state = HardenedState::from_bytes(&bytes);
        assert_ne!(state.guidance().integral(), Ned::ZERO);
        let output = guidance.update(&mut state, &input(), DT);
        assert!(output.status.contains(Status::STATE_RESET));
        assert_eq!(output.mode, Mode::Flying);
        let next = guidance.update(&mut state, &input(), DT);
        assert!(!next.status.contains(Status::STATE_RESET));
    }

    #[test]
    fn the_state_goes_to_bytes_and_back() {
        let bytes = after(50).to_bytes();
        let mut back = HardenedState::from_bytes(&bytes);
        assert_eq!((back, back.to_bytes()), (after(50), bytes));
        let output = guidance().update(&mut back, &input(), DT);
        assert!(!output.status.contains(Status::STATE_RESET));
        let on = [0; HardenedState::BYTES];
        assert_eq!(HardenedState::from_bytes(&on), HardenedState::default());
    }
}
