//! Surfaces as triangle meshes: OBJ (text), binary STL and binary PLY.
//!
//! OBJ and PLY keep all digits. STL holds 32-bit floats, seven digits of a coordinate.

use std::io::{self, Write};

use knotdock::geometry::ball_field::Surface;

pub type WriteSurface = fn(&Surface, &mut dyn Write) -> io::Result<()>;

/// Formats of surfaces, by ending.
pub const SURFACE_FORMATS: [(&str, WriteSurface); 3] =
    [("obj", write_obj), ("stl", write_stl), ("ply", write_ply)];

fn write_obj(surface: &Surface, file: &mut dyn Write) -> io::Result<()> {
    let (positions, triangles) = (&surface.positions, &surface.triangles);
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

fn write_stl(surface: &Surface, file: &mut dyn Write) -> io::Result<()> {
    let (positions, triangles) = (&surface.positions, &surface.triangles);
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

fn write_ply(surface: &Surface, file: &mut dyn Write) -> io::Result<()> {
    let (positions, triangles) = (&surface.positions, &surface.triangles);
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
        let surface = Surface {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        };
        let folder = tempfile::tempdir().unwrap();
        for (ending, write) in SURFACE_FORMATS {
            let path = folder.path().join("a").with_extension(ending);
            let mut bytes = Vec::new();
            write(&surface, &mut bytes).unwrap();
            std::fs::write(&path, bytes).unwrap();
            let (mesh, report) = knotdock_structures::mesh::read(&path).unwrap();
            assert!(report.is_sound() && report.triangles == 4, "{ending}");
            assert!(
                (mesh.volume() - 1.0).abs() < 1e-6,
                "{ending}: {}",
                mesh.volume()
            );
        }
    }
}
