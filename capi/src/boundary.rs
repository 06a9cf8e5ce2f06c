//! Pointers from C: what is checked before they are followed.

use crate::code;

/// Version of this ABI. It changes whenever a structure or the meaning of a field does.
pub const ALULA_ABI_VERSION: u32 = 4;

/// The version of the ABI that the library was built with, for a caller of the shared library to compare with
/// `ALULA_ABI_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn alula_abi_version() -> u32 {
    ALULA_ABI_VERSION
}

/// A structure that C passes by pointer.
///
/// # Safety
/// The type is `repr(C)`, its first word is the header, and every pattern of bits is a valid value of it.
pub unsafe trait Layout: Copy {
    /// What its header word must be: version and size.
    const HEADER: u32 = {
        assert!(size_of::<Self>() < 1 << 16);
        ALULA_ABI_VERSION << 16 | size_of::<Self>() as u32
    };
}

/// Checks a pointer's null and alignment.
#[inline(always)]
pub(crate) fn check_pointer<T>(pointer: *const T) -> Result<(), i32> {
    if pointer.is_null() {
        Err(code::ALULA_ERROR_NULL)
    } else if !pointer.is_aligned() {
        Err(code::ALULA_ERROR_UNALIGNED)
    } else {
        Ok(())
    }
}

/// Checks a pointer, and the header word it points to.
///
/// # Safety
/// `pointer` is null, unaligned, or points to a header word.
#[inline(always)]
pub(crate) unsafe fn check<T: Layout>(pointer: *const T) -> Result<(), i32> {
    check_pointer(pointer)?;
    // SAFETY: The pointer is not null and aligned to four bytes at least, so by the condition above it points to a header
    // word.
    if unsafe { pointer.cast::<u32>().read() } == T::HEADER {
        Ok(())
    } else {
        Err(code::ALULA_ERROR_LAYOUT)
    }
}

/// Checks a pointer that may be null.
///
/// # Safety
/// As [`check`].
#[inline(always)]
pub(crate) unsafe fn check_optional<T: Layout>(pointer: *const T) -> Result<(), i32> {
    if pointer.is_null() {
        return Ok(());
    }
    // SAFETY: As this function's.
    unsafe { check(pointer) }
}

/// The structure that C points to.
///
/// # Safety
/// As [`check`]; a header word that is right is followed by the rest of the structure, and nothing writes to it for `'a`.
#[inline(always)]
pub(crate) unsafe fn read<'a, T: Layout>(pointer: *const T) -> Result<&'a T, i32> {
    // SAFETY: `check` has found the header word of a `T`, so the whole structure is there, by the condition above; any bits
    // are a valid `T`, by the contract of `Layout`.
    unsafe {
        check(pointer)?;
        Ok(&*pointer)
    }
}

/// Writes `value` where C points to, if there is room for it.
///
/// # Safety
/// As [`check`]; a header word that is right is followed by the rest of the structure, and nothing else uses it meanwhile.
#[inline(always)]
pub(crate) unsafe fn write<T: Layout>(pointer: *mut T, value: T) -> i32 {
    // SAFETY: `check` has found the header word of a `T`, so there is room for one, by the condition above.
    unsafe {
        match check(pointer) {
            Ok(()) => {
                pointer.write(value);
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}

/// Runs `step` and writes its result where C points to, or `safe` if it returns a code. Without room for the result `step`
/// is not run.
///
/// # Safety
/// As [`write`].
#[inline(always)]
pub(crate) unsafe fn answer<T: Layout>(
    pointer: *mut T,
    safe: T,
    step: impl FnOnce() -> Result<T, i32>,
) -> i32 {
    // SAFETY: `check` has found the header word of a `T`, so there is room for one, by the condition above. It is written
    // only after `step` has returned, and with it every reference that `step` may have had to the same memory.
    unsafe {
        if let Err(code) = check(pointer) {
            return code;
        }
        let (code, value) = match step() {
            Ok(value) => (code::ALULA_OK, value),
            Err(code) => (code, safe),
        };
        pointer.write(value);
        code
    }
}
