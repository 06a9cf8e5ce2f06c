//! Any vehicle that the core accepts.

use alula::aero::{Node, Polar};
use alula::{
    CombinedParameters, LargeAngleParameters, Model, ModelParameters, SmallAngleParameters, Table,
    Vehicle, VehicleParameters,
};

use crate::bytes::Bytes;

/// Intervals that a table of these attacks has room for.
pub const ROOM: usize = 24;

/// Rows by increasing angle with arbitrary coefficients, or arbitrary rows.
pub fn nodes(bytes: &mut Bytes) -> Vec<Node> {
    let how = bytes.byte();
    let count = usize::from(bytes.byte()) % (ROOM + 3);
    let symmetric = how & 1 == 0;
    let mut nodes = Vec::new();
    for n in 0..count {
        let at = n as f32 / (count.max(2) - 1) as f32;
        let even = if symmetric {
            180.0 * at
        } else {
            360.0 * at - 180.0
        };
        let jitter = if n == 0 || n + 1 == count || how & 2 == 0 {
            0.0
        } else {
            bytes.between(-3.0, 3.0)
        };
        let mut node = Node::from_degrees(
            even + jitter,
            bytes.between(-3.0, 3.0),
            bytes.between(1e-3, 3.0),
        );
        if how & 4 != 0 {
            let scale = 10f32.powi(i32::from(bytes.byte() % 8) - 4);
            node.c_l *= scale;
            node.c_d *= scale;
        }
        if symmetric && (n == 0 || n + 1 == count) {
            node.c_l = 0.0;
        }
        if how & 0xf0 == 0xf0 {
            node = Node {
                alpha: bytes.number(4.0),
                c_l: bytes.number(3.0),
                c_d: bytes.number(3.0),
            };
        }
        nodes.push(node);
    }
    if let ([first, .., last], false) = (nodes.as_mut_slice(), symmetric) {
        (last.c_l, last.c_d) = (first.c_l, first.c_d);
    }
    nodes
}

/// A model that the core accepts, as it is told to it.
enum Chosen {
    Parameters(ModelParameters),
    Table(Box<Polar<ROOM>>),
}

fn choose(bytes: &mut Bytes) -> Option<Chosen> {
    use ModelParameters as Of;
    Some(Chosen::Parameters(match bytes.byte() % 4 {
        0 => Of::LargeAngle(bytes.parameters(LargeAngleParameters::NACA_0021_RE_160E3)),
        1 => Of::SmallAngle(bytes.parameters(SmallAngleParameters {
            c0: 0.014,
            c2: 5.5,
            c3: 0.3,
        })),
        2 => {
            let polar = Polar::new(&nodes(bytes)).ok()?;
            return Some(Chosen::Table(Box::new(polar)));
        }
        _ => Of::Combined(bytes.parameters(CombinedParameters::NACA_0021_RE_160E3)),
    }))
}

/// Calls `with` with a vehicle, if the bytes make one that is accepted.
pub fn with<R>(bytes: &mut Bytes, with: impl FnOnce(&mut Bytes, Vehicle<Model>) -> R) -> Option<R> {
    let chosen = choose(bytes)?;
    let model = match &chosen {
        Chosen::Parameters(p) => p.model().ok()?,
        Chosen::Table(polar) => Model::Table(Table::new(polar)),
    };
    let p = bytes.parameters(VehicleParameters::PAPER);
    let vehicle = Vehicle::new(p, model).ok()?;
    Some(with(bytes, vehicle))
}

/// What [`with`] makes a vehicle of, unless that has a table.
pub fn parameters(bytes: &mut Bytes) -> Option<(VehicleParameters, ModelParameters)> {
    match choose(bytes)? {
        Chosen::Parameters(model) => Some((bytes.parameters(VehicleParameters::PAPER), model)),
        Chosen::Table(_) => None,
    }
}
