//! Chunks as they are compressed: by zstd or lz4, as every writer does unless it is told otherwise.

use std::borrow::Cow;
use std::io::Read;

/// Longest chunk that is unpacked \[bytes\]. Writers make chunks of some megabytes; what says more is damaged.
const MOST: u64 = 1 << 30;

/// The records in a chunk of `size` bytes, when unpacked; or why they cannot be read.
pub(super) fn records<'a>(
    compression: &str,
    packed: &'a [u8],
    size: u64,
) -> Result<Cow<'a, [u8]>, String> {
    if size > MOST {
        return Err(format!("more than {MOST} bytes"));
    }
    match compression {
        "" => Ok(Cow::Borrowed(packed)),
        "zstd" => {
            let decoder = ruzstd::decoding::StreamingDecoder::new(packed);
            unpacked(
                decoder.map_err(|_| damaged(compression))?,
                compression,
                size,
            )
        }
        "lz4" => unpacked(
            lz4_flex::frame::FrameDecoder::new(packed),
            compression,
            size,
        ),
        other => Err(format!("the compression `{other}`, which is not read")),
    }
}

fn damaged(compression: &str) -> String {
    format!("damaged {compression}")
}

/// All that `from` gives, which is `size` bytes.
fn unpacked<'a>(from: impl Read, compression: &str, size: u64) -> Result<Cow<'a, [u8]>, String> {
    let mut bytes = Vec::new();
    match from.take(size + 1).read_to_end(&mut bytes) {
        Ok(_) if bytes.len() as u64 == size => Ok(Cow::Owned(bytes)),
        _ => Err(damaged(compression)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::{read, tests::log, write};
    use super::*;
    use std::io::{Cursor, Write};

    /// Packs bytes.
    type Pack = fn(&[u8]) -> Vec<u8>;

    /// The file with its one chunk packed by `pack` as `compression`: what follows it, an index, is not read.
    fn packed(file: &[u8], compression: &str, pack: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
        let number = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
        let mut chunk = 8;
        while file[chunk] != 0x06 {
            chunk += 9 + number(chunk + 1);
        }
        // Kind, length; times, size, checksum; the name of the compression; the records.
        let (head, name) = (chunk + 9, chunk + 9 + 28);
        let records = &file[name + 4 + 8..][..number(name + 4)];
        let records = pack(records);
        let length = 28 + 4 + compression.len() + 8 + records.len();
        [
            &file[..chunk + 1],
            &(length as u64).to_le_bytes(),
            &file[head..name],
            &(compression.len() as u32).to_le_bytes(),
            compression.as_bytes(),
            &(records.len() as u64).to_le_bytes(),
            &records,
            &file[chunk + 9 + number(chunk + 1)..],
        ]
        .concat()
    }

    fn lz4(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = lz4_flex::frame::FrameEncoder::new(Vec::new());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    fn zstd(bytes: &[u8]) -> Vec<u8> {
        ruzstd::encoding::compress_to_vec(bytes, ruzstd::encoding::CompressionLevel::Fastest)
    }

    #[test]
    fn packed_chunks_hold_the_same_messages() {
        let mut out = Cursor::new(Vec::new());
        write(&log(), &mut out).unwrap();
        let plain = read("x", out.get_ref()).unwrap();
        let packs = [("zstd", zstd as Pack), ("lz4", lz4)];
        for (name, pack) in packs {
            let file = packed(out.get_ref(), name, pack);
            let unpacked = read("x", &file).unwrap();
            assert_eq!(
                format!("{:?}", unpacked.topics),
                format!("{:?}", plain.topics)
            );
            // The checksum is that of the whole file as it was, which is not this one.
            assert_eq!(unpacked.notes.len(), 1, "{:?}", unpacked.notes);
            // Every byte of it damaged, one after the other: no panic, and what is left out is said.
            for at in 0..file.len() {
                let mut file = file.clone();
                file[at] ^= 0x55;
                let _ = read("x", &file);
            }
            let short = packed(out.get_ref(), name, |bytes| {
                let packed = pack(bytes);
                packed[..packed.len() / 2].to_vec()
            });
            let error = read("x", &short).unwrap_err().to_string();
            assert!(error.contains(&format!("damaged {name}: 1")), "{error}");
        }
        let other = packed(out.get_ref(), "br", <[u8]>::to_vec);
        let error = read("x", &other).unwrap_err().to_string();
        assert!(
            error.contains("the compression `br`, which is not read: 1"),
            "{error}"
        );
    }

    #[test]
    fn what_unpacks_to_too_much_is_left_out() {
        let zeros = zstd(&[0; 1 << 16]);
        assert_eq!(records("zstd", &zeros, 1 << 16).unwrap().len(), 1 << 16);
        assert!(records("zstd", &zeros, 1 << 12).is_err());
        assert!(records("zstd", &zeros, 1 << 40).is_err());
    }
}
