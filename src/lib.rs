//! Longitudinal flight control from hover to cruise.
#![no_std]
