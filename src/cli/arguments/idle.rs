//! Options that would do nothing, which are refused rather than left aside: what was meant by them did not happen.
//!
//! An option that stands at its default is no different from one that is not given. Weights of effects that are off are not refused: they say what
//! the effect would weigh.

use knotdock::options::DockOptions;

use crate::cli::messages::failure::Failure;

/// An option that says something of molecules alone.
struct OfMolecules {
    name: &'static str,
    differs: fn(&DockOptions, &DockOptions) -> bool,
}

/// Whether a field differs between two sets of options.
macro_rules! of_molecules {
    ($name:literal, $field:ident) => {
        OfMolecules {
            name: $name,
            differs: |one, other| one.$field != other.$field,
        }
    };
}

const OF_MOLECULES: [OfMolecules; 15] = [
    of_molecules!("core-weight", core_weight),
    of_molecules!("electrostatics-weight", electrostatics_weight),
    of_molecules!("ph", ph),
    of_molecules!("contact-weight", contact_weight),
    of_molecules!("contact-potential", contact_potential),
    of_molecules!("fine-contact-weight", fine_contact_weight),
    of_molecules!("fine-contact-potential", fine_contact_potential),
    of_molecules!("atom-pair-weight", atom_pair_weight),
    of_molecules!("relaxed-weight", relaxed_weight),
    of_molecules!("atom-pair-potential", atom_pair_potential),
    of_molecules!("peptidase-weight", peptidase_weight),
    of_molecules!("unresolved-weight", unresolved_weight),
    of_molecules!("termini-weight", termini_weight),
    of_molecules!("restraint-weight", restraint_weight),
    of_molecules!("antibody", antibody),
];

/// Those of [`OF_MOLECULES`] that stand neither at their default nor at what runs recorded before there was such an option.
fn given(options: &DockOptions) -> impl Iterator<Item = &'static OfMolecules> {
    let [default, first] = [DockOptions::default(), DockOptions::of_first_version()];
    OF_MOLECULES.iter().filter(move |option| {
        (option.differs)(options, &default) && (option.differs)(options, &first)
    })
}

/// Refuses a share of a finer search where none is asked for.
pub fn refuse_idle(options: &DockOptions) -> Result<(), Failure> {
    if options.fine_share != DockOptions::default().fine_share && options.fine_rotations.is_none() {
        return Err(
            Failure::input("--fine-share is of a finer search, and none is asked for")
                .remedy("give --fine-rotations or --fine-angle, too, or leave it out"),
        );
    }
    Ok(())
}

/// Refuses options that say something of molecules, for meshes.
pub fn refuse_of_meshes(options: &DockOptions) -> Result<(), Failure> {
    match given(options).next() {
        Some(OfMolecules { name, .. }) => Err(Failure::input(format!(
            "--{name} is of molecules, and these are meshes"
        ))
        .remedy("leave it out: of meshes the shape is all there is to score")),
        None => Ok(()),
    }
}
