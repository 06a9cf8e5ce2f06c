//! Tables of measured coefficients, in memory of the caller's.

use core::mem::offset_of;

use alula::aero::{Node, Polar};

use crate::boundary::{self, Layout};
use crate::code;

/// Most rows of a table.
pub const ALULA_TABLE_ROWS: u32 = 96;

type Data = Polar<{ ALULA_TABLE_ROWS as usize - 1 }>;

/// One row of measured coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct TableRow {
    /// Angle of attack \[rad\].
    pub alpha: f32,
    /// Lift coefficient.
    pub c_l: f32,
    /// Drag coefficient.
    pub c_d: f32,
}

// Rows are read in place: a row has the layout of the core's.
const _: () = {
    assert!(size_of::<TableRow>() == size_of::<Node>());
    assert!(align_of::<TableRow>() == align_of::<Node>());
    assert!(offset_of!(TableRow, alpha) == offset_of!(Node, alpha));
    assert!(offset_of!(TableRow, c_l) == offset_of!(Node, c_l));
    assert!(offset_of!(TableRow, c_d) == offset_of!(Node, c_d));
};

/// A table: opaque memory of the caller's. Set `header`, then call `alula_table_init`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Table {
    /// `ALULA_HEADER(alula_table)` before `alula_table_init`.
    pub header: u32,
    /// Private.
    pub reserved: u32,
    /// Private.
    pub opaque: [u64; 671],
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but unsigned integers.
unsafe impl Layout for Table {}

/// The header word of a table that is initialised.
const INITIALISED: u32 = Table::HEADER | 1 << 31;

/// What is in a [`Table`] after `alula_table_init`.
#[repr(C)]
struct Initialised {
    header: u32,
    data: Data,
}

const _: () = assert!(size_of::<Initialised>() <= size_of::<Table>());
const _: () = assert!(align_of::<Initialised>() <= align_of::<Table>());

/// The model of the table that C points to, which it borrows.
///
/// # Safety
/// `pointer` is null, unaligned, or points to a table that nothing changes for `'a`.
pub(crate) unsafe fn initialised<'a>(pointer: *const Table) -> Result<alula::Table<'a>, i32> {
    boundary::check_pointer(pointer)?;
    // SAFETY: The pointer is neither null nor unaligned, so it points to a header word. INITIALISED is written by
    // `alula_table_init` alone, and only together with the rest of an `Initialised`.
    unsafe {
        match pointer.cast::<u32>().read() {
            INITIALISED => Ok(alula::Table::new(&(*pointer.cast::<Initialised>()).data)),
            Table::HEADER => Err(code::ALULA_ERROR_NOT_INITIALISED),
            _ => Err(code::ALULA_ERROR_LAYOUT),
        }
    }
}

/// Makes `table` the one through `count` rows, by increasing angle: from 0 to π for a symmetric section, or from −π to π
/// for any other. The rows are not needed afterwards. If `row` is not null, it is set to the row that is refused, counted
/// from 0. No controller may be using the table: those that do keep a pointer to it.
///
/// # Safety
/// `table` is null or points to memory of the caller's that holds at least the header word; the whole structure if that
/// is right. `rows` is null or points to `count` rows. `row` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_table_init(
    table: *mut Table,
    rows: *const TableRow,
    count: u32,
    row: *mut u32,
) -> i32 {
    // SAFETY: A table that passes its check is one, of the size in its header word; `rows` points to `count` rows and `row`
    // to a number, by the condition above. A row is laid out as a `Node`, by the assertions above.
    unsafe {
        match initialised(table) {
            Ok(_) | Err(code::ALULA_ERROR_NOT_INITIALISED) => {}
            Err(code) => return code,
        }
        table.cast::<u32>().write(Table::HEADER);
        if let Err(code) = boundary::check_pointer(rows) {
            return code;
        }
        if !row.is_null() && !row.is_aligned() {
            return code::ALULA_ERROR_UNALIGNED;
        }
        // One more than there is room for is enough to tell that there are too many.
        let count = count.min(ALULA_TABLE_ROWS + 1) as usize;
        match Data::new(core::slice::from_raw_parts(rows.cast::<Node>(), count)) {
            Ok(data) => {
                (&raw mut (*table.cast::<Initialised>()).data).write(data);
                table.cast::<u32>().write(INITIALISED);
                code::ALULA_OK
            }
            Err(error) => {
                if !row.is_null() {
                    row.write(error.row as u32);
                }
                code::of_table(error.problem)
            }
        }
    }
}
