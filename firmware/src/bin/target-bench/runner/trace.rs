//! The instructions that QEMU executes between two marks, from its log (`-d in_asm,exec,nochain`).
//!
//! QEMU translates a block of instructions once, and logs its disassembly under a line `IN:`; then it logs every execution
//! of a block under the address of its translation. A block that is announced and then not executed is taken back by
//! `Stopped execution`.

use std::collections::HashMap;
use std::io::BufRead;
use std::rc::Rc;

use super::cycles::Instruction;

/// What was executed between the marks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Instructions.
    pub instructions: u32,
    /// Cycles of the model.
    pub cycles: u32,
}

/// Addresses of the functions that mark the beginning and the end.
#[derive(Clone, Copy, Debug)]
pub struct Marks {
    /// Executed just before.
    pub begin: u32,
    /// Executed just after.
    pub end: u32,
}

/// The cost of everything between the marks, each time they are passed.
///
/// # Errors
/// The log ends, cannot be read or understood; or holds an instruction whose cycles are not known.
pub fn costs(log: impl BufRead, marks: Marks) -> Result<Vec<Cost>, String> {
    let mut trace = Trace::new(marks);
    for line in log.lines() {
        trace.line(&line.map_err(|e| e.to_string())?)?;
    }
    trace.settle()?;
    Ok(trace.costs)
}

/// Instructions that are executed one after the other.
#[derive(Default)]
struct Block {
    /// Address of the first.
    first: u32,
    /// One whose cycles are not known is an error only where it is executed between the marks.
    instructions: Vec<Result<Instruction, String>>,
}

struct Trace {
    marks: Marks,
    /// By the address of the translation.
    blocks: HashMap<u64, Rc<Block>>,
    /// The last block disassembled, of which no translation is known yet.
    new: Block,
    /// Announced; it stands once the next one is.
    announced: Option<Rc<Block>>,
    /// The cost since the beginning, and the last instruction.
    open: Option<(Cost, Option<Instruction>)>,
    costs: Vec<Cost>,
}

impl Trace {
    fn new(marks: Marks) -> Self {
        Self {
            marks,
            blocks: HashMap::new(),
            new: Block::default(),
            announced: None,
            open: None,
            costs: Vec::new(),
        }
    }

    fn line(&mut self, line: &str) -> Result<(), String> {
        let bad = || format!("QEMU's log: {line}");
        if let Some(rest) = line.strip_prefix("Trace ") {
            // `Trace <cpu>: 0x<translation> [<cs_base>/<pc>/…] <symbol>`
            let translation = rest.split_whitespace().nth(1).ok_or_else(bad)?;
            let translation = hexadecimal(translation).ok_or_else(bad)?;
            if !self.new.instructions.is_empty() {
                self.blocks
                    .insert(translation, std::mem::take(&mut self.new).into());
            }
            self.settle()?;
            self.announced = self.blocks.get(&translation).cloned();
            if self.announced.is_none() {
                return Err(bad());
            }
        } else if line.starts_with("Stopped execution") {
            self.announced = None;
        } else if line.starts_with("IN:") {
            self.new = Block::default();
        } else if line.starts_with("0x") {
            // `0x08000188:  f008 fe38  bl       #0x8008dfc`
            let (address, rest) = line.split_once(':').ok_or_else(bad)?;
            let address = hexadecimal(address).ok_or_else(bad)? as u32;
            let (code, text) = rest.trim_start().split_once("  ").ok_or_else(bad)?;
            let length = code.split_whitespace().count() as u32 * 2;
            if self.new.instructions.is_empty() {
                self.new.first = address;
            }
            let instruction = Instruction::new(address, length, text.trim());
            self.new.instructions.push(instruction);
        }
        Ok(())
    }

    /// Counts the block announced, which has been executed.
    fn settle(&mut self) -> Result<(), String> {
        let Some(block) = self.announced.take() else {
            return Ok(());
        };
        if block.first == self.marks.begin {
            self.open = Some(Default::default());
            return Ok(());
        }
        if block.first == self.marks.end {
            self.costs.extend(self.open.take().map(|(cost, _)| cost));
        }
        if let Some((cost, last)) = &mut self.open {
            for instruction in &block.instructions {
                let instruction = instruction.as_ref().map_err(String::clone)?;
                cost.instructions += 1;
                cost.cycles += instruction.after(last.as_ref());
                *last = Some(*instruction);
            }
        }
        Ok(())
    }
}

/// `0x…`, or hexadecimal digits only.
fn hexadecimal(text: &str) -> Option<u64> {
    u64::from_str_radix(text.trim_start_matches("0x"), 16).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const MARKS: Marks = Marks {
        begin: 0x100,
        end: 0x110,
    };

    /// A loop of two turns between the marks; its second turn is announced twice.
    const LOG: &str = "\
----------------
IN: begin
0x00000100:  4770       bx       lr

Trace 0: 0x7f00 [00800408/00000100/00000110/ff000200] begin
----------------
IN: main
0x00000200:  2002       movs     r0, #2

Trace 0: 0x7f40 [00800408/00000200/00000110/ff000200] main
----------------
IN: main
0x00000202:  3801       subs     r0, #1
0x00000204:  d1fd       bne      #0x202

Trace 0: 0x7f80 [00800408/00000202/00000110/ff000200] main
Trace 0: 0x7f80 [00800408/00000202/00000110/ff000200] main
Stopped execution of TB chain before 0x7f80 [00000202] main
Trace 0: 0x7f80 [00800408/00000202/00000110/ff000200] main
----------------
IN: end
0x00000110:  f3bf 8f4f  dsb      sy

Trace 0: 0x7fc0 [00800408/00000110/00000110/ff000200] end
";

    #[test]
    fn what_is_executed_between_the_marks_is_counted() {
        // movs; subs and bne taken, 1 more for the branch; subs and bne not taken.
        let cost = Cost {
            instructions: 5,
            cycles: 6,
        };
        assert_eq!(costs(LOG.as_bytes(), MARKS), Ok(vec![cost]));
    }

    #[test]
    fn an_instruction_without_cycles_is_an_error_between_the_marks_only() {
        let log = LOG.replace("movs     r0, #2", "frobnicate");
        assert_eq!(
            costs(log.as_bytes(), MARKS),
            Err("cycles unknown: frobnicate".into())
        );
        // The `dsb` after the end is none's concern.
        assert!(costs(LOG.as_bytes(), MARKS).is_ok());
    }

    #[test]
    fn an_execution_of_what_was_not_translated_is_an_error() {
        let log = LOG.replace("Trace 0: 0x7f40", "Trace 0: 0x7f44");
        let log = log.replacen("0x00000200:  2002       movs     r0, #2\n", "", 1);
        assert!(costs(log.as_bytes(), MARKS).is_err());
    }
}
