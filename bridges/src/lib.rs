//! Bridges.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]
#![forbid(unsafe_code)]
