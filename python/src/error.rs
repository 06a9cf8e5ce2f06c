//! Errors as exceptions that name the parameter.

use alula_sim::experiment::{self, Located};
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    alula,
    FieldError,
    PyValueError,
    "A parameter, a field or an argument that is refused.\n\n\
     Attributes: `field`, its name or dotted path as in \"vehicle.mass_kg\"; `problem`, what is wrong with it."
);
create_exception!(
    alula,
    Fault,
    PyValueError,
    "A law has no command for its inputs: one is not finite or absurd, or the law is undefined there.\n\n\
     Attributes: `name`, as in the column `status` of `Law.commands`; `field`, the argument, empty where the law is undefined."
);

/// An exception with attributes.
fn with(error: PyErr, attributes: &[(&str, &str)]) -> PyErr {
    let set = Python::attach(|py| {
        let value = error.value(py);
        attributes
            .iter()
            .try_for_each(|(k, v)| value.setattr(*k, v))
    });
    set.map_or_else(|e| e, |()| error)
}

/// The refusal of a field; `text` is the message.
fn refusal(text: String, error: &experiment::FieldError) -> PyErr {
    let attributes = [("field", &*error.field), ("problem", &*error.problem)];
    with(FieldError::new_err(text), &attributes)
}

/// The refusal of `field`.
pub fn field(field: &str, problem: impl Into<String>) -> PyErr {
    of_field(experiment::FieldError {
        field: field.to_owned(),
        problem: problem.into(),
    })
}

/// The harness's refusal of a field.
pub fn of_field(error: experiment::FieldError) -> PyErr {
    refusal(error.to_string(), &error)
}

/// A law's fault. The argument that it is about has its name, but for the attitude, which is `theta`.
pub fn of_fault(fault: ::alula::Fault) -> PyErr {
    let name = fault.name();
    let field = match fault {
        ::alula::Fault::Undefined => "",
        ::alula::Fault::Attitude => "theta",
        _ => name,
    };
    let attributes = [("name", name), ("field", field)];
    with(Fault::new_err(fault.to_string()), &attributes)
}

/// An error about the argument `argument`: one that names no field of its own has its name.
pub fn of_argument(argument: &str, error: anyhow::Error) -> PyErr {
    let text = format!("{error:#}");
    let error = of(error);
    let names_none = Python::attach(|py| error.get_type(py).is(py.get_type::<PyValueError>()));
    match names_none {
        true => field(argument, text),
        false => error,
    }
}

/// An error of the harness, as the exception that it holds: Python's own, a field's, the operating system's.
pub fn of(error: anyhow::Error) -> PyErr {
    let text = format!("{error:#}");
    if let Some(located) = error.downcast_ref::<Located>() {
        return refusal(text, &located.error);
    }
    if let Some(field) = error.downcast_ref::<experiment::FieldError>() {
        return refusal(text, field);
    }
    if error.chain().any(|cause| cause.is::<std::io::Error>()) {
        return PyOSError::new_err(text);
    }
    match error.downcast::<PyErr>() {
        Ok(own) => own,
        Err(_) => PyValueError::new_err(text),
    }
}
