//! Volume grids: MRC / CCP4 maps for chemists, NRRD and VTK images for engineers.
//!
//! | ending | format | read by |
//! |---|---|---|
//! | `.mrc`, `.map`, `.ccp4` | MRC2014, mode 2 | ChimeraX, PyMOL, Coot, gemmi |
//! | `.nrrd` | NRRD 4, raw | 3D Slicer, ITK, MATLAB |
//! | `.vtk` | legacy VTK, structured points, binary | ParaView, VisIt, PyVista |
//!
//! Each is a short header and the numbers, x fastest, as 32-bit floats. Crates for MRC and VTK open files themselves, and
//! only `knotdock::output` may touch the disk.
//!
//! Sources: Cheng et al., "MRC2014", Journal of Structural Biology 192 (2015); teem.sourceforge.net/nrrd/format.html;
//! "VTK File Formats", Kitware.

use std::io::{self, Write};

/// Values at the nodes of a grid. Index (z ny + y) nx + x.
#[derive(Clone, Copy, Debug)]
pub struct VolumeGrid<'a> {
    /// Place of the first node.
    pub origin: [f64; 3],
    pub spacing: f64,
    pub shape: [usize; 3],
    pub values: &'a [f32],
    /// What the values are, in a line of ASCII.
    pub title: &'a str,
}

pub type WriteVolume = fn(&VolumeGrid, &mut dyn Write) -> io::Result<()>;

/// Formats of volume grids, by ending.
pub const VOLUME_FORMATS: [(&str, WriteVolume); 5] = [
    ("mrc", write_mrc),
    ("map", write_mrc),
    ("ccp4", write_mrc),
    ("nrrd", write_nrrd),
    ("vtk", write_vtk),
];

const MRC_HEADER: usize = 1024;

/// An MRC header that is filled word by word, counted from 1 as in the format's table.
struct MrcHeader([u8; MRC_HEADER]);

impl MrcHeader {
    fn bytes(&mut self, word: usize, bytes: &[u8]) {
        let first = 4 * (word - 1);
        if let Some(place) = self.0.get_mut(first..first + bytes.len()) {
            place.copy_from_slice(bytes);
        }
    }

    fn integers(&mut self, word: usize, values: [i32; 3]) {
        for (index, value) in values.into_iter().enumerate() {
            self.bytes(word + index, &value.to_le_bytes());
        }
    }

    fn floats(&mut self, word: usize, values: [f64; 3]) {
        for (index, value) in values.into_iter().enumerate() {
            self.bytes(word + index, &(value as f32).to_le_bytes());
        }
    }
}

fn write_mrc(grid: &VolumeGrid, file: &mut dyn Write) -> io::Result<()> {
    let count = grid.values.len().max(1) as f64;
    let values = || grid.values.iter().map(|&value| f64::from(value));
    let mean = values().sum::<f64>() / count;
    let least = values().fold(f64::INFINITY, f64::min);
    let most = values().fold(f64::NEG_INFINITY, f64::max);
    let variance = values().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    let size = grid.shape.map(|count| count as i32);
    let mut header = MrcHeader([0; MRC_HEADER]);
    header.integers(1, size);
    // Mode 2: 32-bit floats.
    header.integers(4, [2, 0, 0]);
    header.integers(8, size);
    header.floats(11, grid.shape.map(|count| count as f64 * grid.spacing));
    header.floats(14, [90.0; 3]);
    header.integers(17, [1, 2, 3]);
    header.floats(20, [least, most, mean]);
    // Space group 1: a volume. No symmetry records.
    header.integers(23, [1, 0, 0]);
    header.bytes(28, &20140i32.to_le_bytes());
    header.floats(50, grid.origin);
    header.bytes(53, b"MAP ");
    header.bytes(54, &[0x44, 0x44, 0, 0]);
    header.bytes(55, &(variance.sqrt() as f32).to_le_bytes());
    header.bytes(56, &1i32.to_le_bytes());
    let label: Vec<u8> = grid
        .title
        .bytes()
        .chain(std::iter::repeat(b' '))
        .take(80)
        .collect();
    header.bytes(57, &label);
    file.write_all(&header.0)?;
    for value in grid.values {
        file.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

fn write_nrrd(grid: &VolumeGrid, file: &mut dyn Write) -> io::Result<()> {
    let ([nx, ny, nz], [x, y, z], h) = (grid.shape, grid.origin, grid.spacing);
    write!(
        file,
        "NRRD0004\n# {}\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: {nx} {ny} {nz}\n\
         kinds: domain domain domain\nencoding: raw\nendian: little\n\
         space directions: ({h:?},0,0) (0,{h:?},0) (0,0,{h:?})\nspace origin: ({x:?},{y:?},{z:?})\n\n",
        grid.title
    )?;
    for value in grid.values {
        file.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

fn write_vtk(grid: &VolumeGrid, file: &mut dyn Write) -> io::Result<()> {
    let ([nx, ny, nz], [x, y, z], h) = (grid.shape, grid.origin, grid.spacing);
    write!(
        file,
        "# vtk DataFile Version 3.0\n{}\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {nx} {ny} {nz}\n\
         ORIGIN {x:?} {y:?} {z:?}\nSPACING {h:?} {h:?} {h:?}\nPOINT_DATA {}\nSCALARS depth float 1\n\
         LOOKUP_TABLE default\n",
        grid.title,
        grid.values.len()
    )?;
    for value in grid.values {
        file.write_all(&value.to_be_bytes())?;
    }
    writeln!(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(write: WriteVolume) -> Vec<u8> {
        let values: Vec<f32> = (0..24).map(|value| value as f32 - 3.0).collect();
        let grid = VolumeGrid {
            origin: [1.5, -2.0, 1e6],
            spacing: 0.25,
            shape: [2, 3, 4],
            values: &values,
            title: "depth",
        };
        let mut bytes = Vec::new();
        write(&grid, &mut bytes).unwrap();
        bytes
    }

    #[test]
    fn an_mrc_file_is_as_the_standard_says() {
        let bytes = written(write_mrc);
        assert_eq!(bytes.len(), 1024 + 4 * 24);
        let word = |number: usize| <[u8; 4]>::try_from(&bytes[4 * number - 4..4 * number]).unwrap();
        let integer = |number: usize| i32::from_le_bytes(word(number));
        let float = |number: usize| f32::from_le_bytes(word(number));
        assert_eq!([1, 2, 3, 4, 8, 9, 10].map(integer), [2, 3, 4, 2, 2, 3, 4]);
        assert_eq!([11, 12, 13, 14].map(float), [0.5, 0.75, 1.0, 90.0]);
        assert_eq!(
            [17, 18, 19, 23, 24, 28].map(integer),
            [1, 2, 3, 1, 0, 20140]
        );
        assert_eq!([20, 21, 22].map(float), [-3.0, 20.0, 8.5]);
        assert_eq!([50, 51, 52].map(float), [1.5, -2.0, 1e6]);
        assert_eq!((&word(53), word(54)), (b"MAP ", [0x44, 0x44, 0, 0]));
        assert!(bytes[224..].starts_with(b"depth   "));
        assert_eq!(bytes[1024..1028], (-3.0f32).to_le_bytes());
    }

    #[test]
    fn text_headers_end_where_the_numbers_begin() {
        let nrrd = written(write_nrrd);
        let end = nrrd.windows(2).position(|pair| pair == b"\n\n").unwrap() + 2;
        let header = std::str::from_utf8(&nrrd[..end]).unwrap();
        assert!(header.starts_with("NRRD0004\n") && header.contains("\nsizes: 2 3 4\n"));
        assert!(header.contains("\nspace origin: (1.5,-2.0,1000000.0)\n"));
        assert_eq!(nrrd.len() - end, 4 * 24);
        assert_eq!(nrrd[end..end + 4], (-3.0f32).to_le_bytes());

        let vtk = written(write_vtk);
        let line = b"LOOKUP_TABLE default\n";
        let start = vtk
            .windows(line.len())
            .position(|part| part == line)
            .unwrap()
            + line.len();
        let header = std::str::from_utf8(&vtk[..start]).unwrap();
        assert!(header.contains("\nDIMENSIONS 2 3 4\n") && header.contains("\nPOINT_DATA 24\n"));
        assert_eq!(vtk.len() - start, 4 * 24 + 1);
        assert_eq!(vtk[start..start + 4], (-3.0f32).to_be_bytes());
    }
}
