//! The laws in space: identities, accuracy, flights.
mod accuracy;
mod course;
mod identity;
mod lyapunov;
mod paths;
mod scenario;
mod starts;
mod support;
mod wander;
mod weather;
