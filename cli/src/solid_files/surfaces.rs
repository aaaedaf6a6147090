//! Surfaces as triangle meshes: OBJ (text), binary STL and binary PLY.
//!
//! OBJ and PLY keep all digits. STL holds 32-bit floats, seven digits of a coordinate.

use knotdock_structures::Error;
use std::io::{self, Write};
use std::path::Path;

use knotdock::output::files::whole_file::StagedFile;

/// A format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceFormat {
    /// Wavefront OBJ.
    Obj,
    /// Binary STL.
    Stl,
    /// Binary PLY, little-endian.
    Ply,
}

impl SurfaceFormat {
    /// The format of a file, by the ending of its name.
    pub fn of(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_string_lossy().to_ascii_lowercase();
        match ending.as_str() {
            "obj" => Some(Self::Obj),
            "stl" => Some(Self::Stl),
            "ply" => Some(Self::Ply),
            _ => None,
        }
    }
}

/// Writes vertices and triangles (numbers of vertices from zero, anticlockwise from outside).
///
/// # Errors
/// [`Error`] when the file cannot be made or written.
pub fn write_surface(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    format: SurfaceFormat,
    path: &Path,
) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| match format {
        SurfaceFormat::Obj => write_obj(positions, triangles, file),
        SurfaceFormat::Stl => write_stl(positions, triangles, file),
        SurfaceFormat::Ply => write_ply(positions, triangles, file),
    })
}

fn write_obj(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    file: &mut dyn Write,
) -> io::Result<()> {
    writeln!(file, "# a surface written by knotdock")?;
    for [x, y, z] in positions {
        writeln!(file, "v {x:?} {y:?} {z:?}")?;
    }
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| u64::from(corner) + 1);
        writeln!(file, "f {a} {b} {c}")?;
    }
    Ok(())
}

fn write_stl(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut header = [0u8; 80];
    let title = b"a surface written by knotdock";
    header[..title.len()].copy_from_slice(title);
    file.write_all(&header)?;
    file.write_all(&(triangles.len() as u32).to_le_bytes())?;
    for triangle in triangles {
        let [a, b, c] = triangle.map(|corner| {
            let place = positions.get(corner as usize).copied().unwrap_or_default();
            nalgebra::Vector3::from(place)
        });
        let normal = (b - a)
            .cross(&(c - a))
            .try_normalize(0.0)
            .unwrap_or_default();
        for vector in [normal, a, b, c] {
            for part in vector.iter() {
                file.write_all(&(*part as f32).to_le_bytes())?;
            }
        }
        file.write_all(&[0, 0])?;
    }
    Ok(())
}

fn write_ply(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    file: &mut dyn Write,
) -> io::Result<()> {
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\ncomment a surface written by knotdock\n\
         element vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        positions.len(),
        triangles.len()
    )?;
    for part in positions.iter().flatten() {
        file.write_all(&part.to_le_bytes())?;
    }
    for triangle in triangles {
        file.write_all(&[3])?;
        for corner in triangle {
            file.write_all(&corner.to_le_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron comes back from every format as the closed mesh that it was.
    #[test]
    fn surfaces_read_back() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
        let triangles = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.obj", "a.stl", "a.ply"] {
            let path = folder.path().join(name);
            let format = SurfaceFormat::of(&path).unwrap();
            let staged = write_surface(&positions, &triangles, format, &path).unwrap();
            staged.place().unwrap();
            let (mesh, report) = knotdock_structures::mesh::read(&path).unwrap();
            assert!(report.is_sound() && report.triangles == 4, "{name}");
            assert!(
                (mesh.volume() - 1.0).abs() < 1e-6,
                "{name}: {}",
                mesh.volume()
            );
        }
        assert_eq!(SurfaceFormat::of(Path::new("a.off")), None);
    }
}
