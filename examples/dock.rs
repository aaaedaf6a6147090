//! Docks the example pair, few rotations, and prints the best poses.
use knotdock::dock::pair::PreparedPair;
use knotdock::dock::run::dock;
use knotdock::options::DockOptions;
use knotdock::progress::NoProgress;
use knotdock_structures::molecule::{InputSpec, ReadOptions, read};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = |name: &str| {
        let examples = concat!(env!("CARGO_MANIFEST_DIR"), "/structures/examples");
        InputSpec::whole(format!("{examples}/1ppe_{name}_unbound.pdb"))
    };
    let receptor = read(&file("receptor"), &ReadOptions::default())?;
    let ligand = read(&file("ligand"), &ReadOptions::default())?;

    let mut options = DockOptions::default();
    options.search.rotations = 300;
    let pair = PreparedPair::molecules([&receptor, &ligand], &options)?;
    let outcome = dock(&pair.plan, &pair.points, &NoProgress)?;
    for (row, rank) in outcome.poses.iter().zip(1..=3) {
        println!("{rank}: score {:.1}, {:?}", row.score, row.pose);
    }
    assert!(outcome.error.worst < options.kernel.tolerance);
    Ok(())
}
