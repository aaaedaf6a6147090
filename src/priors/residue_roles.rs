//! Roles of atoms in contacts: excluded ones, by residues that the user blocks and by priors, and active ones.

use crate::options::refused;
use crate::options::{AntibodySurface, DockOptions};
use crate::priors::{Site, SiteRole};
use knotdock_scoring::terms::effect::restraint::ResidueRole;
use knotdock_structures::Error;
use knotdock_structures::molecule::{Molecule, ResidueSelection};

/// Roles of the atoms of both sides in contacts.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ResidueRoles {
    /// Role of each atom of receptor and ligand.
    pub roles: [Vec<ResidueRole>; 2],
    /// Active residues of receptor and ligand, each as the indices of its atoms.
    pub active: [Vec<Vec<usize>>; 2],
    /// Reasons for the roles, in words; empty if all atoms are free.
    pub reason: String,
}

impl ResidueRoles {
    /// Roles by the options and by the exclusive sites of two molecules. Residues that are both blocked and active
    /// are active. Those of a named site are active, and it blocks all others.
    ///
    /// # Errors
    /// [`Error`] when residues are named that a molecule does not have.
    pub fn new(
        molecules: [&Molecule; 2],
        sites: [&[Site]; 2],
        options: &DockOptions,
    ) -> Result<Self, Error> {
        let named = &options.restraints;
        let blocked = [&named.block_receptor, &named.block_ligand];
        let active = [&named.active_receptor, &named.active_ligand];
        let site = [&named.site_receptor, &named.site_ligand];
        let mut all = Self::default();
        let mut reasons = Vec::new();
        for (side, name) in ["receptor", "ligand"].into_iter().enumerate() {
            let molecule = molecules[side];
            let mut roles = vec![ResidueRole::Free; molecule.atoms.len()];
            if named.antibody == AntibodySurface::Cdrs {
                let reason = exclude_elsewhere(&mut roles, sites[side]);
                reasons.extend(reason.map(|reason| format!("the {name} is {reason}")));
            }
            if let Some(residues) = blocked[side] {
                let atoms = selected(molecule, name, "block", residues)?;
                set_role(&mut roles, &atoms, ResidueRole::Excluded);
                let residues = String::from(residues.clone());
                reasons.push(format!("blocked: {residues} of the {name}"));
            }
            if site[side].is_some() {
                roles.fill(ResidueRole::Excluded);
            }
            let mut is_active = vec![false; roles.len()];
            for (role, residues) in [("active", active[side]), ("site", site[side])] {
                let Some(residues) = residues else { continue };
                let atoms = selected(molecule, name, role, residues)?;
                is_active
                    .iter_mut()
                    .zip(atoms)
                    .for_each(|(is, also)| *is |= also);
                let residues = String::from(residues.clone());
                reasons.push(format!("{role}: {residues} of the {name}"));
            }
            if is_active.contains(&true) {
                all.active[side] = molecule.atoms_by_residue(&is_active);
                set_role(&mut roles, &is_active, ResidueRole::Active);
            }
            all.roles[side] = roles;
        }
        all.reason = reasons.join("; ");
        Ok(all)
    }
}

/// Excludes the atoms outside of a molecule's exclusive sites, and returns the reason; `None` if it has no such site.
fn exclude_elsewhere(roles: &mut [ResidueRole], sites: &[Site]) -> Option<String> {
    let exclusive = || sites.iter().filter(|site| site.role == SiteRole::Exclusive);
    let reasons: Vec<&str> = exclusive().map(|site| site.reason.as_str()).collect();
    if reasons.is_empty() {
        return None;
    }
    roles.fill(ResidueRole::Excluded);
    for &atom in exclusive().flat_map(|site| site.residues.iter().flatten()) {
        roles[atom] = ResidueRole::Free;
    }
    Some(reasons.join(" and "))
}

/// Gives the chosen atoms a role.
fn set_role(roles: &mut [ResidueRole], chosen: &[bool], role: ResidueRole) {
    for (own, chosen) in roles.iter_mut().zip(chosen) {
        if *chosen {
            *own = role;
        }
    }
}

/// Whether each atom of a molecule belongs to the residues to which an option gives a role.
fn selected(
    molecule: &Molecule,
    side: &str,
    role: &str,
    residues: &ResidueSelection,
) -> Result<Vec<bool>, Error> {
    molecule.selected(residues).map_err(|unknown| {
        let bound = format!("residues that the {side} has, among {}", unknown.present());
        refused(&format!("{role}_{side}"), &unknown.part, &bound)
            .help("name residues that the file has, by chain and number")
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use knotdock_structures::molecule::{Atom, Format};

    /// CA atoms of glycines 1 to 4, each `spacing` Å from the next.
    pub fn peptide(spacing: f64) -> Molecule {
        let atom = |residue_number: i64| Atom {
            name: "CA".to_owned(),
            residue_name: "GLY".to_owned(),
            chain: "A".to_owned(),
            residue_number,
            insertion_code: None,
            alternate_location: None,
            element: "C".to_owned(),
            position: [spacing * residue_number as f64, 0.0, 0.0],
            occupancy: 1.0,
            b_factor: 0.0,
            hetero: false,
            radius: 1.9,
            line: 1,
        };
        Molecule::new((1..=4).map(atom).collect(), Format::Pdb)
    }

    #[test]
    fn named_residues_of_either_side_are_blocked_and_nothing_else() {
        let molecule = peptide(10.0);
        let of = |receptor: Option<&str>, ligand: Option<&str>| {
            let options = DockOptions::default().changed(|options| {
                options.restraints.block_receptor = receptor.map(|text| text.parse().unwrap());
                options.restraints.block_ligand = ligand.map(|text| text.parse().unwrap());
            });
            ResidueRoles::new([&molecule, &molecule], [&[], &[]], &options)
        };
        let none = of(None, None).unwrap();
        assert!(none.reason.is_empty());
        assert_eq!(
            none.roles,
            [vec![ResidueRole::Free; 4], vec![ResidueRole::Free; 4]]
        );
        let both = of(Some("A:2-3"), Some("A:4")).unwrap();
        use ResidueRole::{Excluded, Free};
        assert_eq!(both.roles[0], [Free, Excluded, Excluded, Free]);
        assert_eq!(both.roles[1], [Free, Free, Free, Excluded]);
        assert_eq!(
            both.reason,
            "blocked: A:2-3 of the receptor; blocked: A:4 of the ligand"
        );
        let unknown = of(None, Some("A:4,A:9")).unwrap_err();
        assert_eq!(
            unknown.to_string(),
            "--block-ligand is A:9; it must be residues that the ligand has, among A:1-4"
        );
    }

    /// Residues that are both blocked and active are active.
    #[test]
    fn active_residues_have_their_role_and_an_entry() {
        let molecule = peptide(10.0);
        let options = DockOptions::default().changed(|options| {
            options.restraints.block_receptor = Some("A:3-4".parse().unwrap());
            options.restraints.active_receptor = Some("A:1,A:4".parse().unwrap());
            options.restraints.active_ligand = Some("A:2".parse().unwrap());
        });
        let roles = ResidueRoles::new([&molecule, &molecule], [&[], &[]], &options).unwrap();
        use ResidueRole::{Active, Excluded, Free};
        assert_eq!(roles.roles[0], [Active, Free, Excluded, Active]);
        assert_eq!(roles.roles[1], [Free, Active, Free, Free]);
        assert_eq!(roles.active, [vec![vec![0], vec![3]], vec![vec![1]]]);
    }

    /// Residues of a site are active beside those that are named so, and all others are blocked.
    #[test]
    fn a_site_blocks_all_other_residues() {
        let molecule = peptide(10.0);
        let of = |site: &str, active: Option<&str>| {
            let options = DockOptions::default().changed(|options| {
                options.restraints.site_ligand = Some(site.parse().unwrap());
                options.restraints.active_ligand = active.map(|text| text.parse().unwrap());
            });
            ResidueRoles::new([&molecule, &molecule], [&[], &[]], &options)
        };
        use ResidueRole::{Active, Excluded, Free};
        let site = of("A:2-3", None).unwrap();
        assert_eq!(
            site.roles,
            [vec![Free; 4], vec![Excluded, Active, Active, Excluded]]
        );
        assert_eq!(site.active, [vec![], vec![vec![1], vec![2]]]);
        assert_eq!(site.reason, "site: A:2-3 of the ligand");
        let both = of("A:2-3", Some("A:3-4")).unwrap();
        assert_eq!(both.roles[1], [Excluded, Active, Active, Active]);
        let unknown = of("A:9", None).unwrap_err().to_string();
        assert!(unknown.starts_with("--site-ligand is A:9"), "{unknown}");
    }

    /// Atoms outside of an exclusive site are excluded, unless all of an antibody may bind or the user says otherwise.
    #[test]
    fn atoms_outside_of_exclusive_sites_are_excluded() {
        let molecule = peptide(10.0);
        let site = |role: SiteRole| Site {
            role,
            residues: vec![vec![1], vec![2]],
            reason: "an antibody".to_owned(),
            record: serde_json::Value::Null,
        };
        let (exclusive, favoured) = (site(SiteRole::Exclusive), site(SiteRole::Favoured));
        let of = |sites: &[Site], change: fn(&mut DockOptions)| {
            let options = DockOptions::default().changed(change);
            ResidueRoles::new([&molecule, &molecule], [sites, &[]], &options).unwrap()
        };
        use ResidueRole::{Active, Excluded, Free};
        let found = of(std::slice::from_ref(&exclusive), |_| ());
        assert_eq!(
            found.roles,
            [vec![Excluded, Free, Free, Excluded], vec![Free; 4]]
        );
        assert_eq!(found.reason, "the receptor is an antibody");
        let named = of(std::slice::from_ref(&exclusive), |options| {
            options.restraints.active_receptor = Some("A:1".parse().unwrap());
        });
        assert_eq!(named.roles[0], [Active, Free, Free, Excluded]);
        let whole = of(&[exclusive], |options| {
            options.restraints.antibody = AntibodySurface::Whole;
        });
        for free in [whole, of(&[favoured], |_| ())] {
            assert_eq!(free.roles[0], [Free; 4]);
            assert!(free.reason.is_empty());
        }
    }
}
