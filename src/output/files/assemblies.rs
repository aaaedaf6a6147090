//! Assemblies: two meshes in one OBJ file, the receptor as it was and the ligand in its place, one file per rank.
//!
//! The parts are the groups `receptor` and `ligand`. Coordinates are in the unit of the mesh files and in the
//! receptor's frame, in the shortest digits that read back to the same f64. Vertices are those that were docked:
//! coincident ones of the files are one, and triangles that faced inward are turned.

use crate::output::files::file_error;
use knotdock_structures::Error;
use std::io;
use std::path::Path;

use knotdock_scoring::se3::Pose;
use knotdock_structures::mesh::Mesh;

use crate::geometry::ball_field::Surface as ComputedSurface;
use crate::output::files::complexes::file_name;
use crate::output::files::disk;
use crate::output::files::whole_file::write_new;
use crate::output::records::program::VERSION;
use crate::output::tables::fields::number;
use crate::output::tables::poses::PoseRow;

/// A surface as triangles.
#[derive(Clone, Copy)]
pub struct Surface<'a> {
    /// Vertices, in the file's unit.
    pub positions: &'a [[f64; 3]],
    /// Corners of each triangle.
    pub triangles: &'a [[u32; 3]],
}

impl<'a> From<&'a Mesh> for Surface<'a> {
    fn from(mesh: &'a Mesh) -> Self {
        Self {
            positions: mesh.positions(),
            triangles: mesh.triangles(),
        }
    }
}

impl<'a> From<&'a ComputedSurface> for Surface<'a> {
    fn from(surface: &'a ComputedSurface) -> Self {
        Self {
            positions: &surface.positions,
            triangles: &surface.triangles,
        }
    }
}

/// Writes the assemblies of `rows` into a staging folder as `rank_0001.obj` ... and returns the names, in the order of the
/// rows.
///
/// # Errors
/// [`Error`] when the folder cannot be made, or a file is there or cannot be written.
pub fn write_assemblies(
    receptor: Surface,
    ligand: Surface,
    rows: &[PoseRow],
    folder: &Path,
) -> Result<Vec<String>, Error> {
    if !rows.is_empty() {
        disk::create_dir_all(folder).map_err(|source| file_error::unwritable(folder, source))?;
    }
    rows.iter()
        .map(|row| {
            let name = file_name(row.rank, "obj");
            let path = folder.join(&name);
            write_new(&path, |file| write_assembly(file, receptor, ligand, row))
                .map_err(|source| file_error::writing(&path, source))?;
            Ok(name)
        })
        .collect()
}

fn write_assembly(
    file: &mut dyn io::Write,
    receptor: Surface,
    ligand: Surface,
    row: &PoseRow,
) -> io::Result<()> {
    let [w, x, y, z] = row.pose.quaternion();
    let t = row.pose.translation;
    writeln!(file, "# knotdock {VERSION}, rank {}", row.rank)?;
    writeln!(
        file,
        "# ligand turned by (w x y z) {w:.6} {x:.6} {y:.6} {z:.6}, then moved by {} {} {}",
        number(t.x),
        number(t.y),
        number(t.z)
    )?;
    let vertices = write_part(file, "receptor", receptor, &Pose::identity(), 0)?;
    write_part(file, "ligand", ligand, &row.pose, vertices)?;
    Ok(())
}

/// Writes a part after `before` vertices; returns the new number of vertices.
fn write_part(
    file: &mut dyn io::Write,
    name: &str,
    surface: Surface,
    pose: &Pose,
    before: usize,
) -> io::Result<usize> {
    writeln!(file, "g {name}")?;
    for &position in surface.positions {
        let [x, y, z] = pose.apply(position).map(number);
        writeln!(file, "v {x} {y} {z}")?;
    }
    for triangle in surface.triangles {
        let [a, b, c] = triangle.map(|corner| before + corner as usize + 1);
        writeln!(file, "f {a} {b} {c}")?;
    }
    Ok(before + surface.positions.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The file holds both parts, and the ligand's vertices are the images of its mesh under the pose.
    #[test]
    fn the_parts_are_groups_and_the_ligand_is_in_its_place() {
        let corners = [
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0 / 3.0],
        ];
        let faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let mesh = knotdock_structures::mesh::from_triangles(&corners, &faces)
            .unwrap()
            .0;
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let row = PoseRow {
            rank: 7,
            pose: Pose::from_parts([half, 0.0, 0.0, half], [10.0, 20.0, 1e-7]),
        };
        let folder = tempfile::tempdir().unwrap();
        let names =
            write_assemblies((&mesh).into(), (&mesh).into(), &[row], folder.path()).unwrap();
        assert_eq!(names, ["rank_0007.obj"]);
        let text = std::fs::read_to_string(folder.path().join(&names[0])).unwrap();
        let words = |start: &str| -> Vec<String> {
            let lines = text.lines().filter(|line| line.starts_with(start));
            lines
                .map(|line| line[start.len()..].trim().to_owned())
                .collect()
        };
        assert_eq!(words("g "), ["receptor", "ligand"]);
        let vertices: Vec<Vec<f64>> = words("v ")
            .iter()
            .map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect())
            .collect();
        assert_eq!(vertices.len(), 8);
        assert_eq!(vertices[3], [0.0, 0.0, 1.0 / 3.0]);
        // Welding numbers vertices as faces name them: the first face is 1 2 3, and the corner on x comes third.
        for (index, corner) in [0, 2, 1, 3].into_iter().enumerate() {
            assert_eq!(vertices[4 + index], row.pose.apply(corners[corner]));
        }
        // A quarter turn about z takes x to y.
        assert!((vertices[6][0] - 10.0).abs() < 1e-12 && (vertices[6][1] - 21.0).abs() < 1e-12);
        let faces = words("f ");
        assert_eq!((faces.len(), faces[4].as_str()), (8, "5 6 7"));
    }
}
