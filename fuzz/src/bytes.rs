//! Inputs out of bytes. When the bytes are used up, zeros follow.

use alula::Parameters;
use alula::ned::{BodyAxes, Ned, Quaternion};
use alula::planar::{Attitude, Inertial};
use alula::spatial::Orientation;

/// Reads numbers from bytes, front to back.
pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        Self(data)
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn array<const N: usize>(&mut self) -> [u8; N] {
        let mut out = [0; N];
        let n = self.0.len().min(N);
        out[..n].copy_from_slice(&self.0[..n]);
        self.0 = &self.0[n..];
        out
    }

    pub fn byte(&mut self) -> u8 {
        self.array::<1>()[0]
    }

    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.array())
    }

    /// A float of any bit pattern.
    pub fn bits(&mut self) -> f32 {
        f32::from_bits(self.word())
    }

    /// A float between `low` and `high`, ends included.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        let x = f32::from(u16::from_le_bytes(self.array())) / f32::from(u16::MAX);
        low + (high - low) * x
    }

    /// Mostly an ordinary number up to `size`, sometimes any bit pattern or one at an edge.
    pub fn number(&mut self, size: f32) -> f32 {
        const EDGES: [f32; 16] = [
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MAX,
            f32::MIN,
            f32::MIN_POSITIVE,
            f32::EPSILON,
            1e-45,
            -0.0,
            0.0,
            1e3,
            -1e3,
            999.999_94,
            1e-12,
            1e19,
            -1e-20,
        ];
        match self.byte() {
            0..=15 => self.bits(),
            16..=31 => EDGES[usize::from(self.byte() % 16)],
            32..=63 => 0.0,
            64..=95 => self.between(-1e3, 1e3),
            _ => self.between(-size, size),
        }
    }

    pub fn inertial(&mut self, size: f32) -> Inertial {
        Inertial::new(self.number(size), self.number(size))
    }

    /// Mostly an attitude, sometimes any pair.
    pub fn attitude(&mut self) -> Attitude {
        if self.byte() < 24 {
            Attitude {
                cos: self.number(1.0),
                sin: self.number(1.0),
            }
        } else {
            Attitude::from_angle(self.between(-4.0, 4.0))
        }
    }

    /// A vector of the world, its components as [`number`](Self::number) gives them.
    pub fn ned(&mut self, size: f32) -> Ned {
        Ned::new(self.number(size), self.number(size), self.number(size))
    }

    /// An attitude, mostly one.
    pub fn orientation(&mut self) -> Orientation {
        let mut q = [0; 4].map(|_| self.number(1.0));
        if self.byte() & 7 != 0 {
            let norm = q.iter().map(|x| x * x).sum::<f32>().sqrt();
            q = q.map(|x| x / norm);
        }
        let [w, x, y, z] = q;
        let q = Quaternion { w, x, y, z };
        Orientation::from_quaternion(&q, BodyAxes::NoseUp).unwrap_or(Orientation::UNKNOWN)
    }

    /// `base` with some rows changed: to an end of the range, to something inside it, beyond it, or to any bits.
    pub fn parameters<P: Parameters>(&mut self, mut base: P) -> P {
        for _ in 0..self.byte().saturating_sub(128) % 8 {
            let row = usize::from(self.byte()) % P::RANGES.len();
            let range = P::RANGES[row];
            let value = match self.byte() % 8 {
                0 => range.min,
                1 => range.max,
                2 => self.number(range.max),
                3 => base.get(row) * self.between(0.25, 4.0),
                4 | 5 if range.min > 0.0 => {
                    // Uniform in the logarithm.
                    range.min * (range.max / range.min).powf(self.between(0.0, 1.0))
                }
                _ => self.between(range.min, range.max),
            };
            base.set(row, value);
        }
        base
    }
}
