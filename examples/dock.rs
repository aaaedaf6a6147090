//! Docks the example pair, few rotations, and prints the best poses.
use knotdock::{DockOptions, Molecule};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/structures/examples");
    let receptor = Molecule::read(&format!("{examples}/1ppe_receptor_unbound.pdb"))?;
    let ligand = Molecule::read(&format!("{examples}/1ppe_ligand_unbound.pdb"))?;

    let mut options = DockOptions::default();
    options.search.rotations = 300;
    let run = knotdock::dock(&receptor, &ligand, &options)?;
    for (row, rank) in run.poses().iter().zip(1..=3) {
        println!("{rank}: score {:.1}, {:?}", row.score, row.pose);
    }
    assert!(run.outcome().error.worst < options.kernel.tolerance);
    assert!(run.complex(1)?.text.contains("ATOM"));
    Ok(())
}
