//! Framed link between the image and its host.
#![no_std]
