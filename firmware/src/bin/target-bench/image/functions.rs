//! The functions measured, each behind a call that is not inlined.

use super::flown::{self, Flown};
use super::sweep::Case;
use alula::aero::{Coefficients, NACA_0021_RE_160E3};
use alula::mission::{
    Gate, Item, Mission, MissionInput, MissionParameters, MissionState, Missions, Pass, Response,
    Responses, Troubles, Until,
};
use alula::ned::{BodyAxes, Ned};
use alula::planar::equilibrium::{Equilibria, EquilibriumError, FoldMap, FoldMargin};
use alula::planar::{AirData, Attitude, GainParameters, Gains, ThrustLine, VelocityControl};
use alula::spatial::axisymmetric::AxisymmetricControl;
use alula::spatial::{
    ForceError, ForceErrorParameters, ForceErrorState, LateralGains, LateralParameters,
    Orientation, Sideslip, SideslipParameters, SideslipState, WingedControl,
};
use alula::{
    Aerodynamics, AngleOfAttack, BandwidthGains, Combined, CombinedParameters, Fault, Guidance,
    GuidanceParameters, GuidanceState, Hardened, HardenedState, LargeAngle, LargeAngleParameters,
    Model, Parameters, SmallAngle, SmallAngleParameters, Table, Vehicle, VehicleParameters,
};
use core::hint::black_box;

/// What the functions are called on.
pub struct Fixture {
    pub combined_control: VelocityControl<Combined>,
    large_angle_control: VelocityControl<LargeAngle>,
    /// The combined model, chosen at run time.
    chosen_control: VelocityControl<Model<'static>>,
    table_control: VelocityControl<Table<'static>>,
    small_angle: SmallAngle,
    fold_map: FoldMap,
    thrust_line: ThrustLine,
    /// Everything on.
    guidance: Guidance<Combined, BandwidthGains>,
    hardened: Hardened<Guidance<Combined, BandwidthGains>>,
    winged: WingedControl<Combined, BandwidthGains>,
    axisymmetric: AxisymmetricControl<Combined, BandwidthGains>,
    force_error: ForceError,
    sideslip: Sideslip,
    missions: Missions,
    mission: Mission,
}

impl Fixture {
    pub fn new() -> Self {
        let p = CombinedParameters::NACA_0021_RE_160E3;
        let (c0, c1, c2, c3) = (p.c0, p.c1, p.c2, p.c3);
        let delta = 0.1;
        let vehicle = VehicleParameters::PAPER.delta(delta).c_y(0.5);
        let gains = Gains::new(GainParameters::PAPER).unwrap();
        let combined = Combined::new(p).unwrap();
        let large_angle = LargeAngle::new(LargeAngleParameters { c0, c1 }).unwrap();
        let plane = VehicleParameters::PAPER.c_y(0.5);
        let plane = Vehicle::new(plane, combined).unwrap();
        let bandwidth = BandwidthGains::new(&GuidanceParameters::DEFAULT, &plane).unwrap();
        let force = ForceErrorParameters {
            time: 0.2,
            thrust_lag: 0.05,
            most: 60.0,
        };
        Self {
            combined_control: VelocityControl::new(Vehicle::new(vehicle, combined).unwrap(), gains),
            chosen_control: VelocityControl::new(
                Vehicle::new(vehicle, Model::Combined(combined)).unwrap(),
                gains,
            ),
            large_angle_control: VelocityControl::new(
                Vehicle::new(vehicle, large_angle).unwrap(),
                gains,
            ),
            table_control: VelocityControl::new(
                Vehicle::new(vehicle, Table::new(&NACA_0021_RE_160E3)).unwrap(),
                gains,
            ),
            fold_map: FoldMap::new(&Vehicle::new(vehicle, combined).unwrap()),
            small_angle: SmallAngle::new(SmallAngleParameters { c0, c2, c3 }).unwrap(),
            thrust_line: ThrustLine::new(delta).unwrap(),
            guidance: everything_on(Vehicle::new(vehicle, combined).unwrap()),
            hardened: Hardened::new(everything_on(Vehicle::new(vehicle, combined).unwrap())),
            winged: WingedControl::new(
                plane,
                bandwidth,
                LateralGains::new(LateralParameters::PAPER_VEHICLE).unwrap(),
            ),
            axisymmetric: AxisymmetricControl::new(plane, bandwidth, 5.0, 0.2).unwrap(),
            force_error: ForceError::new(force, plane.mass()).unwrap(),
            sideslip: Sideslip::new(SideslipParameters::DEFAULT, &plane).unwrap(),
            missions: missions(&plane),
            mission: missions(&plane).mission(&WORK).unwrap(),
        }
    }
}

fn missions(vehicle: &Vehicle<Combined>) -> Missions {
    let parameters = MissionParameters::cruising_at(20.0);
    let responses = Responses::default()
        .link(Response::Return)
        .battery(Response::Land)
        .air(Response::Loiter);
    Missions::new(vehicle, &parameters, responses).unwrap()
}

/// Every kind of item.
const WORK: [Item; 14] = {
    const fn waypoint(north: f32, east: f32, pass: Pass) -> Item {
        let place = Ned::new(north, east, -20.0);
        Item::Waypoint { place, pass }
    }
    const fn loiter(radius: f32, until: Until) -> Item {
        let centre = Ned::new(300.0, 100.0, -30.0);
        Item::Loiter {
            centre,
            radius,
            until,
        }
    }
    [
        Item::TakeOff { height: 10.0 },
        waypoint(15.0, 5.0, Pass::Hover(3.0)),
        waypoint(400.0, 0.0, Pass::By),
        waypoint(700.0, 300.0, Pass::By),
        waypoint(650.0, 200.0, Pass::Over),
        loiter(150.0, Until::Turns(1.0)),
        Item::Speed(17.0),
        Item::Altitude { down: -40.0 },
        waypoint(500.0, 200.0, Pass::Hover(1.0)),
        loiter(-150.0, Until::Time(20.0)),
        Item::Speed(3.0),
        waypoint(0.0, 30.0, Pass::By),
        Item::Speed(20.0),
        Item::Return,
    ]
};

/// Step of the missions \[s\].
const STEP: f32 = 0.04;

/// A mission flown by what does as it is asked, on a ground.
struct Flight {
    state: MissionState,
    told: MissionInput,
    place: Ned,
    /// A generator of what happens to it.
    random: u32,
}

impl Flight {
    fn new() -> Self {
        Self {
            state: MissionState::default(),
            told: MissionInput::default()
                .position(Ned::ZERO)
                .thrust(20.0)
                .armed(true),
            place: Ned::ZERO,
            random: 1,
        }
    }

    /// Once in ten seconds something fails or is good again, the wind changes, and it goes to another item.
    fn happen(&mut self) {
        let mut drawn = |most: u32| {
            self.random = (self.random)
                .wrapping_mul(1_664_525)
                .wrapping_add(1_013_904_223);
            (self.random >> 8) % most
        };
        if drawn(250) > 0 {
            return;
        }
        let troubles = [0, 0, 0, 1, 2, 4, 8, 16, 32][drawn(9) as usize];
        self.told.troubles = Troubles::from_bits_truncate(troubles);
        let mut wind = || drawn(13) as f32 - 6.0;
        self.told.wind = Ned::new(wind(), wind(), 0.0);
        if drawn(3) == 0 {
            self.state.go_to(drawn(WORK.len() as u32 + 1) as usize);
        }
    }

    #[inline(always)]
    fn step(&mut self, f: &Fixture) {
        let asked = f
            .missions
            .step(&mut self.state, &f.mission, &self.told, STEP);
        let velocity = match asked.gate {
            Gate::Off => Ned::ZERO,
            _ => asked.reference.velocity - asked.position_error * 0.5,
        };
        self.place += velocity * STEP;
        self.told.velocity = velocity;
        // Its nose is up.
        self.told.airspeed = Some(-0.8 * velocity.down);
        if self.place.down > 0.0 {
            self.place.down = 0.0;
            self.told.velocity = Ned::ZERO;
        }
        self.told.position = Some(self.place);
    }
}

fn everything_on(vehicle: Vehicle<Combined>) -> Guidance<Combined, BandwidthGains> {
    // Without a recovery time the first good frame is flown.
    let parameters = GuidanceParameters::DEFAULT.recovery(0.0);
    Guidance::new(vehicle, &parameters).unwrap()
}

/// Where the functions leave their results, but for the commands.
pub struct Output {
    coefficients: Coefficients,
    air: Option<AirData>,
    equilibria: Result<Equilibria, EquilibriumError>,
    fold: Option<FoldMargin>,
    attitude: Attitude,
    number: f32,
    memory: GuidanceState,
    hardened: HardenedState,
    orientation: Result<Orientation, Fault>,
    force_error: ForceErrorState,
    sideslip: SideslipState,
    flight: Flight,
    flown: Flown,
}

/// Takes a command where the law or the guidance has left it, in its caller's frame: a loop that controls something uses it
/// there, and a copy of it would be measured too.
#[inline(always)]
pub fn keep<T>(command: T) {
    let _ = black_box(command);
}

/// What a function with memory remembers when it is called.
#[derive(Clone, Copy, PartialEq)]
pub enum Memory {
    /// Nothing: power-on; or the function has no memory.
    Fresh,
    /// The calls before: it is in flight.
    Kept,
    /// A whole flight, with a vehicle that obeys.
    Flown,
}

impl Output {
    pub fn new() -> Self {
        Self {
            coefficients: Coefficients::default(),
            air: None,
            equilibria: Err(EquilibriumError::Overflow),
            fold: None,
            attitude: Attitude::NOSE_UP,
            number: 0.0,
            memory: GuidanceState::default(),
            hardened: HardenedState::default(),
            orientation: Err(Fault::Undefined),
            force_error: ForceErrorState::default(),
            sideslip: SideslipState::default(),
            flight: Flight::new(),
            flown: Flown::new(),
        }
    }

    /// Makes the memory for the next call what `memory` says.
    pub fn prepare(&mut self, memory: Memory, fixture: &Fixture) {
        if memory == Memory::Flown {
            self.memory = self.flown.fly(&fixture.guidance);
        }
        if memory == Memory::Fresh {
            self.memory = GuidanceState::default();
            self.hardened = HardenedState::default();
            self.flight = Flight::new();
        }
        self.flight.happen();
    }
}

/// A function measured.
pub type Function = fn(&Fixture, &Case, &mut Output);

/// A function that is measured.
pub struct Measured {
    pub name: &'static str,
    pub function: Function,
    /// What it remembers from case to case.
    pub memory: Memory,
}

macro_rules! functions {
    (
        $($name:ident => |$f:ident, $c:ident, $o:ident| $body:expr;)*
        ; $($kept:ident => $of:ident;)*
        ; $($flown:ident => $whole:ident;)*
    ) => {
        $(
            #[inline(never)]
            #[allow(unused_variables)]
            pub fn $name($f: &Fixture, $c: &Case, $o: &mut Output) { $body }
        )*
        /// Every function measured.
        pub const TABLE: &[Measured] = &[
            $(Measured { name: stringify!($name), function: $name, memory: Memory::Fresh },)*
            $(Measured { name: stringify!($kept), function: $of, memory: Memory::Kept },)*
            $(Measured { name: stringify!($flown), function: $whole, memory: Memory::Flown },)*
        ];
    };
}

functions! {
    empty => |f, c, o| ();
    robust => |f, c, o| keep(f.combined_control.robust(&c.state, &c.reference, None));
    robust_feed_forward => |f, c, o| {
        keep(f.combined_control.robust(&c.state, &c.reference, Some(&c.feed_forward)));
    };
    full => |f, c, o| keep(f.combined_control.full(&c.state, &c.reference, None));
    full_feed_forward => |f, c, o| {
        keep(f.combined_control.full(&c.state, &c.reference, Some(&c.feed_forward)));
    };
    robust_chosen_model => |f, c, o| {
        keep(f.chosen_control.robust(&c.state, &c.reference, None));
    };
    robust_large_angle => |f, c, o| {
        keep(f.large_angle_control.robust(&c.state, &c.reference, None));
    };
    full_large_angle_feed_forward => |f, c, o| {
        keep(f.large_angle_control.full(&c.state, &c.reference, Some(&c.feed_forward)));
    };
    robust_bandwidth => |f, c, o| {
        keep(f.guidance.control().plane().robust(&c.state, &c.reference, None));
    };
    guidance => |f, c, o| keep(f.guidance.update(&mut o.memory, &c.space.input, 0.01));
    guidance_and_plan => |f, c, o| {
        keep(f.guidance.update(&mut o.memory, &c.space.input, 0.01));
        f.guidance.plan(&mut o.memory);
    };
    flown => |f, c, o| keep(f.guidance.update(&mut o.memory, &o.flown.input, flown::STEP));
    hardened => |f, c, o| keep(f.hardened.update(&mut o.hardened, &c.space.input, 0.01));
    mission => |f, c, o| o.flight.step(f);
    winged => |f, c, o| {
        keep(f.winged.robust(&c.space.state, &c.space.reference, None));
    };
    winged_feed_forward => |f, c, o| {
        let s = &c.space;
        keep(f.winged.robust(&s.state, &s.reference, Some(&s.feed_forward)));
    };
    axisymmetric_feed_forward => |f, c, o| {
        let s = &c.space;
        keep(f.axisymmetric.robust(&s.state, &s.reference, Some(&s.feed_forward)));
    };
    orientation => |f, c, o| {
        o.orientation = Orientation::from_quaternion(&c.space.quaternion, BodyAxes::NoseForward);
    };
    force_error => |f, c, o| f.force_error.update(&mut o.force_error, &c.space.sample, 0.01);
    sideslip => |f, c, o| f.sideslip.update(&mut o.sideslip, c.space.v_a, c.force, 0.01);
    combined => |f, c, o| {
        o.coefficients = f.combined_control.vehicle().model().coefficients(c.alpha);
    };
    large_angle => |f, c, o| {
        o.coefficients = f.large_angle_control.vehicle().model().coefficients(c.alpha);
    };
    table => |f, c, o| {
        o.coefficients = f.table_control.vehicle().model().coefficients(c.alpha);
    };
    robust_table => |f, c, o| {
        keep(f.table_control.robust(&c.state, &c.reference, None));
    };
    equilibria => |f, c, o| {
        o.equilibria = Equilibria::find(f.combined_control.vehicle(), &c.reference, c.state.wind);
    };
    fold_margin => |f, c, o| o.fold = f.fold_map.margin(&c.forces);
    small_angle => |f, c, o| o.coefficients = f.small_angle.coefficients(c.alpha);
    air_data => |f, c, o| o.air = Some(AirData::new(c.v_a, &f.thrust_line));
    guard_mu => |f, c, o| o.number = f.combined_control.gains().guard().mu(c.force);
    angle_of_attack => |f, c, o| {
        o.number = AngleOfAttack::from_sin_cos(c.alpha.sin, c.alpha.cos).rad;
    };
    attitude_from_angle => |f, c, o| o.attitude = Attitude::from_angle(c.alpha.rad);
    norm => |f, c, o| o.number = c.v_a.norm();
    ;
    guidance_in_flight => guidance;
    guidance_and_plan_in_flight => guidance_and_plan;
    hardened_in_flight => hardened;
    mission_in_flight => mission;
    ;
    guidance_flown => flown;
}

/// The function called `name`.
pub const fn by_name(name: &str) -> Function {
    let mut n = 0;
    while n < TABLE.len() {
        if equal(TABLE[n].name.as_bytes(), name.as_bytes()) {
            return TABLE[n].function;
        }
        n += 1;
    }
    panic!("no such function");
}

const fn equal(a: &[u8], b: &[u8]) -> bool {
    let mut same = a.len() == b.len();
    let mut n = 0;
    while same && n < a.len() {
        same = a[n] == b[n];
        n += 1;
    }
    same
}
