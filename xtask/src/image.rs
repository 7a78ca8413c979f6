//! The image for the NUCLEO-G474RE in the formats of flashing tools.

use anyhow::{Context, Result, bail};
use ihex::Record;
use object::Endianness;
use object::elf::{FileHeader32, PT_LOAD};
use object::read::elf::{FileHeader, ProgramHeader};

use crate::{run, target};

/// The program that is flashed.
pub const PROGRAM: &str = "nucleo-g474re";
/// The value of erased flash: it fills the space between two parts of the image.
const ERASED: u8 = 0xFF;
/// Bytes in a record of the hex file, as in most tools.
const IN_A_RECORD: usize = 16;

/// Builds the image and writes `out/nucleo-g474re.elf`, `.bin` and `.hex`.
pub fn image() -> Result<()> {
    write(&run::root().join("out"), PROGRAM)
}

/// Builds the image and writes it into a folder in each format, under this name.
pub fn write(out: &std::path::Path, name: &str) -> Result<()> {
    let elf = target::build(PROGRAM, PROGRAM, &[])?;
    let data = std::fs::read(&elf).with_context(|| format!("there is no {}", elf.display()))?;
    let (start, bytes) = flat(&parts(&data)?)?;
    std::fs::create_dir_all(out).with_context(|| format!("cannot make {}", out.display()))?;
    for (ending, content) in [
        ("elf", data),
        ("hex", hex(start, &bytes)?.into_bytes()),
        ("bin", bytes.clone()),
    ] {
        let path = out.join(format!("{name}.{ending}"));
        std::fs::write(&path, content)
            .with_context(|| format!("cannot write {}", path.display()))?;
        println!("{}", path.display());
    }
    println!("{} bytes of flash from {start:08X}h on", bytes.len());
    Ok(())
}

/// The contents of the flash: addresses and bytes, in the order of the file.
fn parts(elf: &[u8]) -> Result<Vec<(u32, Vec<u8>)>> {
    let header = FileHeader32::<Endianness>::parse(elf)?;
    let endian = header.endian()?;
    let mut parts = Vec::new();
    for program in header.program_headers(endian, elf)? {
        let Ok(bytes) = program.data(endian, elf) else {
            bail!("a part of the image is cut off");
        };
        if program.p_type(endian) == PT_LOAD && !bytes.is_empty() {
            parts.push((program.p_paddr(endian), bytes.to_vec()));
        }
    }
    Ok(parts)
}

/// The parts as one piece, and the address of the piece.
fn flat(parts: &[(u32, Vec<u8>)]) -> Result<(u32, Vec<u8>)> {
    let mut parts: Vec<_> = parts.iter().collect();
    parts.sort_by_key(|(address, _)| *address);
    let Some((start, _)) = parts.first() else {
        bail!("the image holds nothing for the flash");
    };
    let mut piece = Vec::new();
    for (address, bytes) in &parts {
        let at = usize::try_from(address - start)?;
        if at < piece.len() {
            bail!("two parts of the image lie at {address:08X}h");
        }
        piece.resize(at, ERASED);
        piece.extend_from_slice(bytes);
    }
    Ok((*start, piece))
}

/// The bytes as Intel hex. Its addresses have 16 bits; an earlier record gives the upper half.
fn hex(start: u32, bytes: &[u8]) -> Result<String> {
    let mut records = Vec::new();
    let mut upper = None;
    for (index, value) in bytes.chunks(IN_A_RECORD).enumerate() {
        let address = start
            .checked_add(u32::try_from(index * IN_A_RECORD)?)
            .context("the image ends beyond the address space")?;
        let [high, low] = [(address >> 16) as u16, (address & 0xFFFF) as u16];
        if usize::from(low) + value.len() > 1 << 16 {
            bail!("the image does not begin at a multiple of {IN_A_RECORD}");
        }
        if upper != Some(high) {
            records.push(Record::ExtendedLinearAddress(high));
            upper = Some(high);
        }
        records.push(Record::Data {
            offset: low,
            value: value.to_vec(),
        });
    }
    records.push(Record::EndOfFile);
    ihex::create_object_file_representation(&records)
        .map_err(|error| anyhow::anyhow!("the image has no form as Intel hex: {error}"))
}

/// The bytes of a hex file whose records follow each other.
pub fn bytes_of(hex: &str) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    for record in ihex::Reader::new(hex) {
        if let Record::Data { value, .. } = record? {
            bytes.extend(value);
        }
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_become_one_piece() {
        let parts = [(0x0800_0010, vec![5]), (0x0800_0000, vec![1, 2])];
        let (start, piece) = flat(&parts).unwrap();
        assert_eq!(start, 0x0800_0000);
        assert_eq!(piece.len(), 17);
        assert_eq!((&piece[..3], piece[16]), (&[1, 2, ERASED][..], 5));
        assert!(flat(&[(0, vec![1, 2]), (1, vec![3])]).is_err());
        assert!(flat(&[]).is_err());
    }

    #[test]
    fn a_hex_file_has_addresses_and_sums() {
        // The second record begins a new upper half.
        let text = hex(0x0800_FFF0, &[0xAB; 17]).unwrap();
        assert_eq!(
            text.lines().collect::<Vec<_>>(),
            [
                ":020000040800F2",
                ":10FFF000ABABABABABABABABABABABABABABABAB51",
                ":020000040801F1",
                ":01000000AB54",
                ":00000001FF",
            ]
        );
        assert!(hex(0x0800_FFF8, &[0; 16]).is_err());
    }
}
