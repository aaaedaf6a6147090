//! Knots as files: a table (`knots.csv`), a mesh of spheres (OBJ), and pseudo-atoms (PDB).

use std::path::Path;

use knotdock::output::files::whole_file::StagedFile;
use knotdock_structures::{Ball, Error, Knots};

/// Ways to export balls, by ending.
pub const EXPORTS: [(&str, ExportBalls); 2] = [("obj", write_mesh), ("pdb", write_pseudo_atoms)];

pub type ExportBalls = fn(&Knots, &Path) -> Result<StagedFile, Error>;

const COLUMNS: &str = "x,y,z,r,weight";

/// Writes the table: one row per knot, in the file's unit, with 17 significant digits.
pub fn write_table(knots: &Knots, path: &Path) -> Result<StagedFile, Error> {
    StagedFile::write(path, |file| {
        writeln!(file, "{COLUMNS}")?;
        for ((center, radius), weight) in knots.centers.iter().zip(&knots.radii).zip(&knots.weights)
        {
            let [x, y, z] = center;
            writeln!(
                file,
                "{x:.16e},{y:.16e},{z:.16e},{radius:.16e},{:.16e}",
                weight
            )?;
        }
        Ok(())
    })
}

/// Writes the balls as an OBJ mesh: a sphere of 80 triangles each, inscribed in its ball.
pub fn write_mesh(knots: &Knots, path: &Path) -> Result<StagedFile, Error> {
    let (vertices, triangles) = icosphere();
    StagedFile::write(path, |file| {
        writeln!(file, "# {} balls written by knotdock sample", knots.len())?;
        for (index, (center, radius)) in knots.centers.iter().zip(&knots.radii).enumerate() {
            writeln!(file, "o ball_{}", index + 1)?;
            for vertex in &vertices {
                let [x, y, z] = [0, 1, 2].map(|axis| center[axis] + radius * vertex[axis]);
                writeln!(file, "v {x:?} {y:?} {z:?}")?;
            }
            let first = index * vertices.len() + 1;
            for triangle in &triangles {
                let [a, b, c] = triangle.map(|corner| first + corner);
                writeln!(file, "f {a} {b} {c}")?;
            }
        }
        Ok(())
    })
}

/// Vertices and triangles of the spheres of some balls, each as [`write_mesh`] writes it.
pub fn spheres(balls: &[Ball]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (vertices, triangles) = icosphere();
    let (mut positions, mut corners) = (Vec::new(), Vec::new());
    for ball in balls {
        let first = positions.len() as u32;
        positions.extend(
            vertices
                .iter()
                .map(|vertex| [0, 1, 2].map(|axis| ball.center[axis] + ball.radius * vertex[axis])),
        );
        corners.extend(
            triangles
                .iter()
                .map(|of| of.map(|corner| first + corner as u32)),
        );
    }
    (positions, corners)
}

/// An icosahedron with its triangles cut in four and its vertices moved to the unit sphere: 42 vertices, 80 triangles.
fn icosphere() -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut vertices: Vec<[f64; 3]> = Vec::new();
    for (short, long) in [
        (-1.0, -golden),
        (1.0, -golden),
        (-1.0, golden),
        (1.0, golden),
    ] {
        vertices.extend([[0.0, short, long], [short, long, 0.0], [long, 0.0, short]]);
    }
    let squared =
        |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
    let beside = |a: usize, b: usize| squared(vertices[a], vertices[b]) < 4.5;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if beside(a, b) && beside(b, c) && beside(a, c) {
                    let [p, q, r] = [a, b, c].map(|corner| vertices[corner]);
                    let outward = p[0] * (q[1] * r[2] - q[2] * r[1])
                        + p[1] * (q[2] * r[0] - q[0] * r[2])
                        + p[2] * (q[0] * r[1] - q[1] * r[0]);
                    faces.push(if outward > 0.0 { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    let mut middles = std::collections::HashMap::new();
    let mut triangles = Vec::new();
    for [a, b, c] in faces {
        let mut middle = |a: usize, b: usize| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let point = [0, 1, 2].map(|axis| 0.5 * (vertices[a][axis] + vertices[b][axis]));
                vertices.push(point);
                vertices.len() - 1
            })
        };
        let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    for vertex in &mut vertices {
        let length = vertex.iter().map(|value| value * value).sum::<f64>().sqrt();
        *vertex = vertex.map(|value| value / length);
    }
    (vertices, triangles)
}

/// Writes the balls as pseudo-atoms of a PDB file, with three decimals.
///
/// These are HETATM records named `X` of residue `BAL`, one residue for each ball. The radius is in the columns of
/// the temperature factor and the weight in those of the occupancy.
pub fn write_pseudo_atoms(knots: &Knots, path: &Path) -> Result<StagedFile, Error> {
    for (index, center) in knots.centers.iter().enumerate() {
        if let Some(value) = center
            .iter()
            .find(|value| !(-999.9994..9999.9994).contains(*value))
        {
            let error = format!(
                "ball {} has coordinate {value}, which the eight columns of a PDB file do not hold",
                index + 1
            );
            return Err(
                Error::input(error).help("move or scale the mesh, or export the balls as .obj")
            );
        }
    }
    StagedFile::write(path, |file| {
        writeln!(
            file,
            "REMARK 99 {} BALLS OF KNOTDOCK SAMPLE; RADIUS AS TEMPERATURE FACTOR, WEIGHT AS OCCUPANCY",
            knots.len()
        )?;
        for (index, (center, radius)) in knots.centers.iter().zip(&knots.radii).enumerate() {
            let [x, y, z] = center;
            // Names are reused past what the columns hold; a chain has 9,999 residues.
            let chain = char::from(b'A' + (index / 9999 % 26) as u8);
            let weight = knots.weights[index].clamp(0.0, 999.99);
            writeln!(
                file,
                "HETATM{:>5}  X   BAL {chain}{:>4}    {x:8.3}{y:8.3}{z:8.3}{weight:6.2}{:6.2}           X",
                index % 99_999 + 1,
                index % 9999 + 1,
                radius.min(999.99),
            )?;
        }
        writeln!(file, "END")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn knots() -> Knots {
        Knots::new(
            vec![[1.0 / 3.0, -1e6, 2e-7], [0.0, 1.0, 2.0]],
            vec![0.1, 2.0],
        )
        .unwrap()
    }

    #[test]
    fn a_table_reads_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("knots.csv");
        write_table(&knots(), &path).unwrap().place().unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("x,y,z,r,weight"));
        for (line, (center, radius)) in lines.zip(knots().centers.iter().zip(knots().radii)) {
            let row: Vec<f64> = line
                .split(',')
                .map(|field| field.parse().unwrap())
                .collect();
            assert_eq!(row, [center[0], center[1], center[2], radius, 1.0]);
        }
        assert!(
            text.contains("3.3333333333333331e-1"),
            "17 significant digits"
        );
    }

    /// The spheres are closed, face outward and lie just inside their balls.
    #[test]
    fn a_mesh_of_balls_has_nearly_their_volume() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("balls.obj");
        write_mesh(&knots(), &path).unwrap().place().unwrap();
        let (mesh, report) = knotdock_structures::mesh::read(&path).unwrap();
        assert!(report.is_sound() && report.parts == 2 && report.triangles == 160);
        let volume = 4.0 / 3.0 * std::f64::consts::PI * (0.001 + 8.0);
        assert!(
            mesh.volume() < volume && mesh.volume() > 0.85 * volume,
            "{}",
            mesh.volume()
        );
    }

    #[test]
    fn pseudo_atoms_keep_to_their_columns() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("balls.pdb");
        let error = write_pseudo_atoms(&knots(), &path).err().unwrap();
        assert!(error.message().contains("ball 1 has coordinate -1000000"));
        assert!(error.remedy().is_some_and(|remedy| remedy.contains(".obj")));
        assert!(!path.exists());
        let near = Knots::new(vec![[-1.5, 2.25, 1234.5]], vec![1.75]).unwrap();
        write_pseudo_atoms(&near, &path).unwrap().place().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let atom = text.lines().nth(1).unwrap();
        let column = |from: usize, to: usize| atom[from - 1..to].trim().to_owned();
        assert_eq!(column(1, 6), "HETATM");
        assert_eq!(
            [column(31, 38), column(39, 46), column(47, 54)],
            ["-1.500", "2.250", "1234.500"]
        );
        assert_eq!([column(55, 60), column(61, 66)], ["1.00", "1.75"]);
    }
}
