//! What an instruction costs on a Cortex-M4 with its floating-point unit \[cycles\].
//!
//! Source: ARM, *Cortex-M4 Technical Reference Manual* r0p1 (DDI 0439), tables 3-1 (instructions), 7-1 (floating
//! point) and section 3.3.3 (loads and stores), for memory without wait states. Where the manual gives a range:
//!
//! - a branch taken costs 1 + P, P from 1 to 3 by the alignment of its target and by whether that is known early; P = 1
//!   for a target that stands in the instruction, 3 for one in a register or on the stack;
//! - `sdiv` and `udiv` cost 2 to 12; 12 is taken;
//! - `it` costs 0 or 1; 1 is taken. An instruction that its condition skips is counted as if it were executed.
//!
//! Left out: flash wait states, and the integer instructions that the core executes beside a division or a root.

/// One instruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instruction {
    /// Its address.
    pub address: u32,
    /// Address of the next one in memory.
    pub next: u32,
    /// Cycles alone, with no branch taken.
    cycles: u32,
    /// Cycles more if the next instruction executed is not the next in memory.
    taken: u32,
    kind: Kind,
    /// The register that a load or floating-point arithmetic writes.
    result: Registers,
    /// Registers that must be there when it begins: for a load or a store those of the address.
    reads: Registers,
}

/// A set of registers, one bit each: the core's 16, then s0 to s31; d0 is s0 and s1.
type Registers = u64;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Of one integer register.
    Load,
    /// Of one integer register.
    Store,
    /// Floating-point arithmetic.
    Float,
    Other,
}

/// P of a branch to an address in the instruction, and of one to an address in a register or on the stack.
const REFILL: (u32, u32) = (1, 3);

/// One cycle each.
const ONE: &[&str] = &[
    "adc", "add", "addw", "adr", "and", "asr", "bfc", "bfi", "bic", "clz", "cmn", "cmp", "eor",
    "lsl", "lsr", "mla", "mls", "mov", "mrs", "msr", "movt", "movw", "mul", "mvn", "nop", "orn",
    "orr", "rbit", "rev", "ror", "rsb", "sbc", "sbfx", "smlal", "smull", "ssat", "sub", "subw",
    "sxtb", "sxth", "teq", "tst", "ubfx", "umlal", "umull", "uqadd8", "uqsub8", "usat", "uxtab",
    "uxtb", "uxth", "vcmp", "vcmpe", "vmrs", "vmsr",
];
/// Floating-point arithmetic.
const FLOAT: &[(&str, u32)] = &[
    ("vabs", 1),
    ("vneg", 1),
    ("vadd", 1),
    ("vsub", 1),
    ("vcvt", 1),
    ("vcvtr", 1),
    ("vmul", 1),
    ("vnmul", 1),
    ("vmla", 3),
    ("vmls", 3),
    ("vnmla", 3),
    ("vnmls", 3),
    ("vfma", 3),
    ("vfms", 3),
    ("vfnma", 3),
    ("vfnms", 3),
    ("vdiv", 14),
    ("vsqrt", 14),
];
const LOAD: &[&str] = &["ldr", "ldrb", "ldrh", "ldrsb", "ldrsh"];
const STORE: &[&str] = &["str", "strb", "strh"];
/// One cycle, and one for each register.
const MULTIPLE: &[&str] = &[
    "ldm", "ldmia", "ldmdb", "stm", "stmia", "stmdb", "push", "pop", "vpush", "vpop", "vldm",
    "vldmia", "vldmdb", "vstm", "vstmia", "vstmdb",
];
const CONDITIONS: &[&str] = &[
    "eq", "ne", "hs", "lo", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le",
];

impl Instruction {
    /// The instruction at `address`, `length` bytes long, from its disassembly.
    ///
    /// # Errors
    /// It is not in the tables.
    pub fn new(address: u32, length: u32, text: &str) -> Result<Self, String> {
        let (name, operands) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let name = name.split('.').next().unwrap_or(name);
        let name = stem(name).ok_or(format!("cycles unknown: {text}"))?;
        let registers = registers(operands);
        let float = FLOAT.iter().find(|(f, _)| *f == name);
        let kind = match name {
            _ if LOAD.contains(&name) => Kind::Load,
            _ if STORE.contains(&name) => Kind::Store,
            _ if float.is_some() => Kind::Float,
            _ => Kind::Other,
        };
        // A store with a register as its offset is not buffered.
        let indexed = operands.contains('[') && address_registers(operands).len() > 1;
        let words = |registers: &[Registers]| registers.iter().map(|r| r.count_ones()).sum::<u32>();
        let cycles = match (name, float) {
            (_, Some((_, cycles))) => *cycles,
            ("sdiv" | "udiv", _) => 12,
            ("ldrd" | "strd", _) => 3,
            ("vldr" | "vstr", _) => 1 + words(&registers[..1.min(registers.len())]),
            // Between two core registers and two of the unit's.
            ("vmov", _) if registers.len() > 2 => 2,
            ("vmov", _) => 1,
            ("tbb" | "tbh", _) => 2,
            _ if LOAD.contains(&name) || (STORE.contains(&name) && indexed) => 2,
            _ if MULTIPLE.contains(&name) => {
                let list = operands.split_once('{').map_or("", |(_, list)| list);
                1 + words(&self::registers(list))
            }
            _ => 1,
        };
        let to_pc = matches!(name, "pop" | "ldm" | "ldr" | "mov" | "add")
            && registers.contains(&PC)
            && !operands.contains("[pc");
        let taken = match name {
            "b" | "bl" | "cbz" | "cbnz" => REFILL.0,
            "bx" | "blx" | "tbb" | "tbh" => REFILL.1,
            _ if to_pc => REFILL.1,
            _ => 0,
        };
        Ok(Self {
            address,
            next: address + length,
            cycles,
            taken,
            kind,
            result: registers.first().copied().unwrap_or(0),
            reads: match kind {
                Kind::Load | Kind::Store => all(address_registers(operands)),
                // Of a multiplication with accumulation this leaves out the addend, which is read a cycle later.
                Kind::Float => all(registers.into_iter().skip(1)),
                Kind::Other if matches!(name, "vmov" | "vldr") => {
                    all(registers.into_iter().skip(1))
                }
                Kind::Other => all(registers),
            },
        })
    }

    /// Cycles, `before` being the instruction executed before it.
    pub fn after(&self, before: Option<&Self>) -> u32 {
        let Some(before) = before else {
            return self.cycles;
        };
        let refill = if before.next == self.address {
            0
        } else {
            before.taken
        };
        let depends = before.result & self.reads != 0;
        let neighbour = match before.kind {
            // The address phase of this one overlaps with the data phase of the last.
            Kind::Load if matches!(self.kind, Kind::Load | Kind::Store) && !depends => {
                return refill + self.cycles.max(2) - 1;
            }
            // The result of floating-point arithmetic is there a cycle later.
            Kind::Float if depends => 1,
            _ => 0,
        };
        refill + self.cycles + neighbour
    }
}

/// The name in the tables: without the condition and without the `s` of those that set the flags.
fn stem(name: &str) -> Option<&str> {
    let known = |n: &&str| {
        ONE.contains(n)
            || FLOAT.iter().any(|(f, _)| f == n)
            || LOAD.contains(n)
            || STORE.contains(n)
            || MULTIPLE.contains(n)
            || matches!(
                *n,
                "b" | "bl" | "bx" | "blx" | "cbz" | "cbnz" | "tbb" | "tbh"
            )
            || matches!(
                *n,
                "sdiv" | "udiv" | "ldrd" | "strd" | "vldr" | "vstr" | "vmov"
            )
    };
    if name.starts_with("it") && name[1..].bytes().all(|b| matches!(b, b't' | b'e')) {
        return Some("nop");
    }
    let unconditional = |n| CONDITIONS.iter().find_map(|c| str::strip_suffix(n, c));
    let flagless = |n| str::strip_suffix(n, "s");
    [
        Some(name),
        unconditional(name),
        flagless(name),
        unconditional(name).and_then(flagless),
    ]
    .into_iter()
    .flatten()
    .find(known)
}

const PC: Registers = 1 << 15;

/// The registers in `operands`, in order.
fn registers(operands: &str) -> Vec<Registers> {
    operands
        .split(|c: char| !c.is_ascii_alphanumeric() && c != '#' && c != '_')
        .filter_map(register)
        .collect()
}

fn register(word: &str) -> Option<Registers> {
    let core = ["sb", "sl", "fp", "ip", "sp", "lr", "pc"];
    if let Some(n) = core.iter().position(|name| *name == word) {
        return Some(1 << (9 + n));
    }
    let number = |prefix| word.strip_prefix(prefix)?.parse::<u32>().ok();
    let core = number('r').filter(|n| *n < 16).map(|n| 1 << n);
    let single = || number('s').filter(|n| *n < 32).map(|n| 1 << (16 + n));
    let double = || number('d').filter(|n| *n < 16).map(|n| 3 << (16 + 2 * n));
    core.or_else(single).or_else(double)
}

fn address_registers(operands: &str) -> Vec<Registers> {
    registers(operands.split_once('[').map_or("", |(_, address)| address))
}

fn all(registers: impl IntoIterator<Item = Registers>) -> Registers {
    registers.into_iter().fold(0, |all, r| all | r)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn instruction(text: &str) -> Instruction {
        Instruction::new(0x100, 4, text).unwrap()
    }

    /// Cycles of `text` after an instruction that has nothing to do with it.
    fn alone(text: &str) -> u32 {
        instruction(text).after(None)
    }

    /// Cycles of the second of two instructions that follow each other in memory.
    fn second(first: &str, second: &str) -> u32 {
        let first = Instruction::new(0x100, 4, first).unwrap();
        let second = Instruction::new(0x104, 4, second).unwrap();
        second.after(Some(&first))
    }

    #[test]
    fn every_kind_of_instruction_has_the_manuals_cycles() {
        for (text, cycles) in [
            ("movs     r0, #0", 1),
            ("mov.w    r1, #0x3f800000", 1),
            ("lsls     r0, r1, #2", 1),
            ("bics     r0, r1", 1),
            ("addne    r0, #1", 1),
            ("itte     mi", 1),
            ("umull    r0, r1, r2, r3", 1),
            ("udiv     r0, r1, r2", 12),
            ("ldr      r0, [r1, #4]", 2),
            ("ldrb.w   r0, [r1, r2]", 2),
            ("ldrd     r0, r1, [r4, #8]", 3),
            ("str      r0, [r1, #4]", 1),
            ("str.w    r0, [r1, r2, lsl #2]", 2),
            ("strd     r0, r1, [r4, #8]", 3),
            ("push.w   {r4, r5, r6, r7, r8, lr}", 7),
            ("ldm.w    r0!, {r1, r2, r3}", 4),
            ("stmia    r0!, {r1, r2}", 3),
            ("vpush    {d8, d9, d10}", 7),
            ("vldmia   r0, {s0, s1, s2}", 4),
            ("vldr     s0, [pc, #0x28]", 2),
            ("vldr     d0, [r1]", 3),
            ("vstr     s0, [sp, #4]", 2),
            ("vadd.f32 s0, s1, s2", 1),
            ("vmul.f32 s0, s1, s2", 1),
            ("vmla.f32 s0, s1, s2", 3),
            ("vnmls.f32 s0, s1, s2", 3),
            ("vdiv.f32 s0, s1, s2", 14),
            ("vsqrt.f32 s0, s1", 14),
            ("vcmp.f32 s0, #0.0", 1),
            ("vmrs     apsr_nzcv, fpscr", 1),
            ("vmov.f32 s0, #1.0", 1),
            ("vmovmi.f32 s0, s2", 1),
            ("vmov     r0, s4", 1),
            ("vmov     r0, r1, d0", 2),
            ("vmov     r0, r1, s0, s1", 2),
            ("bl       #0x8008dfc", 1),
            ("bls      #0x8008dfc", 1),
        ] {
            assert_eq!(alone(text), cycles, "{text}");
        }
        assert!(Instruction::new(0, 4, "vadd2.f32 s0, s1").is_err());
        assert!(Instruction::new(0, 4, "frobnicate").is_err());
    }

    #[test]
    fn a_branch_costs_its_refill_where_it_is_taken() {
        let target = Instruction::new(0x200, 2, "nop").unwrap();
        let next = Instruction::new(0x104, 2, "nop").unwrap();
        for (text, refill) in [
            ("beq      #0x200", 1),
            ("cbz      r0, #0x200", 1),
            ("bl       #0x200", 1),
            ("bx       lr", 3),
            ("pop      {r7, pc}", 3),
            ("ldr      pc, [r0]", 3),
        ] {
            assert_eq!(target.after(Some(&instruction(text))), 1 + refill, "{text}");
            assert_eq!(next.after(Some(&instruction(text))), 1, "{text}");
        }
    }

    #[test]
    fn a_load_after_a_load_overlaps_unless_its_address_waits() {
        assert_eq!(second("ldr r0, [r1]", "ldr r2, [r1, #4]"), 1);
        assert_eq!(second("ldr r0, [r1]", "str r2, [r1, #4]"), 1);
        assert_eq!(second("ldr r0, [r1]", "ldr r2, [r0]"), 2);
        assert_eq!(second("ldr r0, [r1]", "adds r2, #1"), 1);
        assert_eq!(second("vldr s0, [r1]", "vldr s1, [r1, #4]"), 2);
    }

    #[test]
    fn a_floating_point_result_used_at_once_costs_a_cycle() {
        assert_eq!(second("vmul.f32 s0, s1, s2", "vadd.f32 s4, s0, s5"), 2);
        assert_eq!(second("vmul.f32 s0, s1, s2", "vadd.f32 s0, s4, s5"), 1);
        assert_eq!(second("vmul.f32 s0, s1, s2", "vmla.f32 s4, s0, s5"), 4);
        // The addend is read a cycle later.
        assert_eq!(second("vmul.f32 s0, s1, s2", "vmla.f32 s0, s4, s5"), 3);
        assert_eq!(second("vadd.f32 s0, s1, s2", "vcmp.f32 s0, s4"), 2);
        assert_eq!(second("vadd.f32 s0, s1, s2", "vstr s0, [r0]"), 3);
        assert_eq!(second("vadd.f32 s0, s1, s2", "vmov r0, s0"), 2);
        assert_eq!(second("vldr s0, [r0]", "vadd.f32 s1, s0, s0"), 1);
    }
}
