//! The Python module `alula`: a thin layer over the core (`alula`) and the harness (`alula-sil`).
//!
//! One file per thing that Python sees. What is checked, defaulted or named here is checked, defaulted and named by the
//! core's table of parameters and by the harness; `alula.pyi` declares it for Python.

mod analysis;
mod arguments;
mod campaign;
mod design;
mod equilibria;
mod error;
mod experiment;
mod fleet;
mod flight;
mod frame;
mod goals;
mod guidance;
mod law;
mod mission;
mod model;
mod parameters;
mod replay;
mod simulation;
mod vehicle;

use pyo3::prelude::*;

/// Flight control of tail-sitters from hover to cruise and back, at any angle of attack.
///
/// Models, vehicles, laws, guidance and equilibria are those of the flight library, in single precision; experiments and
/// campaigns are flown by its harness, whose plant is in double precision. SI units; names end in their unit.
///
/// Vectors are (north, east, down). The vertical plane is the one to the north: east is 0 there. Its theta is 0 in hover, nose up,
/// and -pi/2 in level cruise; rates are negative from hover towards cruise.
#[pymodule]
mod _alula {
    #[pymodule_export]
    use crate::analysis::{compare, margins, sweep};
    #[pymodule_export]
    use crate::campaign::{Campaign, campaign, campaigns};
    #[pymodule_export]
    use crate::design::{Design, new};
    #[pymodule_export]
    use crate::equilibria::{Envelope, Equilibrium, envelope, equilibria};
    #[pymodule_export]
    use crate::error::{Fault, FieldError};
    #[pymodule_export]
    use crate::experiment::{Experiment, experiments, fly};
    #[pymodule_export]
    use crate::fleet::Fleet;
    #[pymodule_export]
    use crate::flight::{Beyond, Flight};
    #[pymodule_export]
    use crate::frame::Frame;
    #[pymodule_export]
    use crate::goals::Goals;
    #[pymodule_export]
    use crate::guidance::{Guidance, GuidanceOutput};
    #[pymodule_export]
    use crate::law::{Command, Law};
    #[pymodule_export]
    use crate::mission::{Mission, MissionOutput};
    #[pymodule_export]
    use crate::model::{Model, polars};
    #[pymodule_export]
    use crate::parameters::parameters;
    #[pymodule_export]
    use crate::replay::{Replay, replay};
    #[pymodule_export]
    use crate::simulation::{Moment, Simulation};
    #[pymodule_export]
    use crate::vehicle::Vehicle;

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
