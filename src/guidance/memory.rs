//! What a part remembers as words of 32 bits: the shadow copy that undoes a change of memory from outside, and the way to
//! bytes and back.

use super::status::Status;
use crate::frame::Inertial;
use crate::ned::Ned;

/// A value made of words.
///
/// Every word has a meaning: reading never fails, and zeros are the default. Numbers shorter than a word use its low bits.
pub(super) trait Memory: Sized {
    /// Number of words.
    const WORDS: usize;

    /// Gives every word to `take`, in order.
    fn write(&self, take: &mut impl FnMut(u32));

    /// The value of the next [`WORDS`](Self::WORDS) words.
    fn read(next: &mut impl FnMut() -> u32) -> Self;
}

/// Makes a structure a [`Memory`] by naming all of its fields; one that is left out does not compile.
macro_rules! memory {
    ($structure:ident { $($field:ident: $type:ty),* $(,)? }) => {
        impl $crate::guidance::memory::Memory for $structure {
            const WORDS: usize = 0 $( + <$type as $crate::guidance::memory::Memory>::WORDS )*;

            #[inline(always)]
            fn write(&self, take: &mut impl FnMut(u32)) {
                let Self { $($field),* } = self;
                $( $crate::guidance::memory::Memory::write($field, take); )*
            }

            #[inline(always)]
            fn read(next: &mut impl FnMut() -> u32) -> Self {
                Self { $($field: $crate::guidance::memory::Memory::read(next)),* }
            }
        }
    };
}
pub(super) use memory;

/// A number of at most one word.
macro_rules! number {
    ($type:ty, $value:ident => $word:expr, $bits:ident => $read:expr) => {
        impl Memory for $type {
            const WORDS: usize = 1;

            #[inline(always)]
            fn write(&self, take: &mut impl FnMut(u32)) {
                let $value = *self;
                take($word);
            }

            #[inline(always)]
            fn read(next: &mut impl FnMut() -> u32) -> Self {
                let $bits = next();
                $read
            }
        }
    };
}
number!(u8, x => u32::from(x), bits => bits as u8);
number!(f32, x => x.to_bits(), bits => f32::from_bits(bits));
number!(Status, x => u32::from(x.bits()), bits => Status::from_bits_retain(bits as u16));

memory!(Ned {
    north: f32,
    east: f32,
    down: f32,
});

impl Memory for Inertial {
    const WORDS: usize = 2;

    #[inline(always)]
    fn write(&self, take: &mut impl FnMut(u32)) {
        self.down().write(take);
        self.forward().write(take);
    }

    #[inline(always)]
    fn read(next: &mut impl FnMut() -> u32) -> Self {
        let (down, forward) = (f32::read(next), f32::read(next));
        Self::new(down, forward)
    }
}

/// The words of `memory`, little-endian.
pub(super) fn to_bytes<const N: usize>(memory: &impl Memory) -> [u8; N] {
    let mut bytes = [0; N];
    let mut places = bytes.as_chunks_mut().0.iter_mut();
    memory.write(&mut |word| {
        if let Some(place) = places.next() {
            *place = word.to_le_bytes();
        }
    });
    bytes
}

/// The value of these bytes; zeros stand for those that are missing.
pub(super) fn from_bytes<M: Memory>(bytes: &[u8]) -> M {
    let mut words = bytes.as_chunks().0.iter();
    M::read(&mut || words.next().map_or(0, |word| u32::from_le_bytes(*word)))
}

/// A copy of a memory of `N` words and a check word of both.
///
/// Whatever changes in memory or copy makes them differ, unless the same changes in both. If it is one word of one of them, or the
/// check word, the memory that was left is known.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct ShadowCopy<const N: usize> {
    words: [u32; N],
    check: u32,
}

/// What a [`ShadowCopy`] has made of a memory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Integrity {
    /// It was as it had been left.
    Intact,
    /// It had changed, and is again as it had been left.
    Restored,
    /// Two of memory, copy and check word have changed: nothing was restored.
    Lost,
}

impl<const N: usize> Default for ShadowCopy<N> {
    /// Of a memory of zeros.
    fn default() -> Self {
        Self {
            words: [0; N],
            check: 0,
        }
    }
}

impl<const N: usize> ShadowCopy<N> {
    /// The shadow of `memory`, which has `N` words.
    #[inline(always)]
    pub fn new(memory: &impl Memory) -> Self {
        let mut shadow = Self::default();
        shadow.renew(memory);
        shadow
    }

    /// Makes this the shadow of `memory`, in place.
    #[inline(always)]
    pub fn renew(&mut self, memory: &impl Memory) {
        let mut places = self.words.iter_mut();
        let mut sum = 0;
        memory.write(&mut |word| {
            sum = fold(sum, word);
            if let Some(place) = places.next() {
                *place = word;
            }
        });
        self.check = sum;
    }

    /// Whether `memory` is as it was left.
    #[inline(always)]
    pub fn is_of(&self, memory: &impl Memory) -> bool {
        let (mut words, mut different) = (self.words.iter(), 0);
        memory.write(&mut |word| different |= words.next().map_or(0, |left| word ^ left));
        different == 0
    }

    /// Makes `memory` what was left, where it has changed and that is known.
    #[inline(always)]
    pub fn restore<M: Memory>(&self, memory: &mut M) -> Integrity {
        if self.is_of(memory) {
            Integrity::Intact
        } else {
            self.restore_changed(memory)
        }
    }

    /// Of a memory and its copy, that differ, the one that the check word is of. If it is of both or of neither, that is not known.
    #[cold]
    #[inline(never)]
    fn restore_changed<M: Memory>(&self, memory: &mut M) -> Integrity {
        let mut sum = 0;
        memory.write(&mut |word| sum = fold(sum, word));
        let left = self.words.iter().copied().fold(0, fold);
        if left == sum || (left != self.check && sum != self.check) {
            Integrity::Lost
        } else if sum == self.check {
            Integrity::Intact
        } else {
            let mut words = self.words.iter().copied();
            *memory = M::read(&mut || words.next().unwrap_or(0));
            Integrity::Restored
        }
    }
}

impl<const N: usize> Memory for ShadowCopy<N> {
    const WORDS: usize = N + 1;

    fn write(&self, take: &mut impl FnMut(u32)) {
        self.words.iter().for_each(|&word| take(word));
        take(self.check);
    }

    fn read(next: &mut impl FnMut() -> u32) -> Self {
        let words = core::array::from_fn(|_| next());
        Self {
            words,
            check: next(),
        }
    }
}

/// The check word `sum` after one more word: turned by seven bits, and the word added without carry. For given words
/// before and after, a word and the check are one to one: a change of any one word changes it. Two changes may cancel, so it
/// is never asked whether anything has changed, only which of two has. Zeros have the check word 0.
#[inline(always)]
const fn fold(sum: u32, word: u32) -> u32 {
    sum.rotate_left(7) ^ word
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    #[derive(Debug, PartialEq)]
    struct Part {
        small: u8,
        vector: Ned,
        flags: Status,
        number: f32,
    }
    memory!(Part {
        small: u8,
        vector: Ned,
        flags: Status,
        number: f32,
    });

    fn words(memory: &impl Memory) -> Vec<u32> {
        let mut words = Vec::new();
        memory.write(&mut |word| words.push(word));
        words
    }

    #[test]
    fn what_is_written_is_read_again() {
        let part = Part {
            small: 200,
            vector: Ned::new(-1.5, 1e-40, 7.0),
            flags: Status::from_bits_retain(0xffff),
            number: f32::INFINITY,
        };
        let written = words(&part);
        assert_eq!(written.len(), Part::WORDS);
        assert_eq!(written.first(), Some(&200));
        let mut rest = written.iter().copied();
        assert_eq!(Part::read(&mut || rest.next().unwrap()), part);
    }

    type Kept = ShadowCopy<{ Part::WORDS }>;

    fn part() -> Part {
        let mut next = 1u32;
        Part::read(&mut || {
            next = next.wrapping_mul(2_654_435_761).wrapping_add(7);
            next
        })
    }

    /// A memory and its shadow, some of whose bits have flipped.
    fn flipped(bits: &[usize]) -> (Part, Kept) {
        let part = part();
        let mut all = words(&part);
        all.extend(words(&Kept::new(&part)));
        for bit in bits {
            all[bit / 32] ^= 1 << (bit % 32);
        }
        let mut rest = all.into_iter();
        let mut next = || rest.next().unwrap();
        (Part::read(&mut next), Kept::read(&mut next))
    }

    #[test]
    fn whatever_bit_flips_the_memory_that_was_left_is_known() {
        let all = 32 * (2 * Part::WORDS + 1);
        let mut restored = 0;
        for bit in 0..all {
            let (mut memory, shadow) = flipped(&[bit]);
            // The unused bits of short numbers are not there to be changed.
            restored += u32::from(shadow.restore(&mut memory) == Integrity::Restored);
            assert_eq!(memory, part(), "{bit}");
        }
        // A byte, four numbers and 16 flags.
        assert_eq!(restored, 8 + 4 * 32 + 16);
    }

    #[test]
    fn memory_and_spare_both_changed_are_not_taken_for_sound() {
        for bit in 32..64 {
            let (mut memory, shadow) = flipped(&[bit, 32 * Part::WORDS + (bit + 5) % 160]);
            assert_eq!(shadow.restore(&mut memory), Integrity::Lost, "{bit}");
        }
    }

    /// Two flips whose effects on the check word cancel.
    #[test]
    fn two_flips_that_the_check_word_does_not_see_are_found() {
        for bit in 0..32 {
            // A number of the vector, and the one after it, which the check word turns by seven bits less.
            let (mut memory, shadow) = flipped(&[32 + bit, 64 + (bit + 7) % 32]);
            let sums =
                [words(&memory), words(&part())].map(|words| words.into_iter().fold(0, fold));
            assert_eq!(sums[0], sums[1]);
            assert_eq!(shadow.restore(&mut memory), Integrity::Lost, "{bit}");
        }
    }

    #[test]
    fn zeros_are_sound() {
        assert_eq!(ShadowCopy::<3>::default(), ShadowCopy::new(&Ned::ZERO));
        assert_eq!(
            ShadowCopy::<3>::default().restore(&mut { Ned::ZERO }),
            Integrity::Intact
        );
    }
}
