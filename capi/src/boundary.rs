//! Pointers from C: what is checked before they are followed.

use crate::code;

/// Version of this ABI. It changes whenever a structure or the meaning of a field does.
pub const ALULA_ABI_VERSION: u32 = 1;

/// The version of the ABI that the library was built with, for a caller of the shared library to compare with
/// `ALULA_ABI_VERSION`.
#[unsafe(no_mangle)]
pub extern "C" fn alula_abi_version() -> u32 {
    ALULA_ABI_VERSION
}

/// A structure that C hands over.
///
/// # Safety
/// `repr(C)`, begins with its header word, and every pattern of bits is a value of it.
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
    // SAFETY: not null, aligned to at least four bytes, and by the caller's word there is a header.
    if unsafe { pointer.cast::<u32>().read() } == T::HEADER {
        Ok(())
    } else {
        Err(code::ALULA_ERROR_LAYOUT)
    }
}

/// The structure that C points to, to be read before anything is written.
///
/// # Safety
/// As [`check`]; and a header word that is right is followed by the rest of the structure.
#[inline(always)]
pub(crate) unsafe fn read<'a, T: Layout>(pointer: *const T) -> Result<&'a T, i32> {
    // SAFETY: the caller's word; the header tells that the whole structure is there, and any bits are a value.
    unsafe {
        check(pointer)?;
        Ok(&*pointer)
    }
}

/// Writes `value` where C points to, if there is room for it.
///
/// # Safety
/// As [`read`], and the structure may be written.
#[inline(always)]
pub(crate) unsafe fn write<T: Layout>(pointer: *mut T, value: T) -> i32 {
    // SAFETY: the caller's word.
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

/// Writes what `step` answers where C points to, or `safe` if it answers with a code. Without room nothing is done.
///
/// # Safety
/// As [`write`].
#[inline(always)]
pub(crate) unsafe fn answer<T: Layout>(
    pointer: *mut T,
    safe: T,
    step: impl FnOnce() -> Result<T, i32>,
) -> i32 {
    // SAFETY: the caller's word.
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
