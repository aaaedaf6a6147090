//! Peptidases told by their sequence and fold, and the residues of their active sites.
//!
//! A peptidase cuts proteins, so a protein that binds it, an inhibitor above all, mostly does so at its active site. Six families (their
//! names are those of MEROPS, Rawlings et al., Nucleic Acids Res. 46 (2018) D624-D632) are told by the stretches of sequence about their catalytic
//! residues, known since long from alignments, and by these standing together in space; side chains may be turned, flipped or missing, and a nucleophile
//! mutated, modified or left out, as crystallographers have them. Families whose sites lie deep in a cleft (angiotensin-converting enzyme 2, neprilysin)
//! or that cut small things besides (lipases, esterases) are left alone.

use super::groups::{Residue, residue_runs};
use super::peptidase_families::{Anchor, FAMILIES};
use super::sequence::{letter, number, peptides};
use super::{Molecule, squared_distance};
use serde::Serialize;
use std::collections::BTreeSet;

/// Farthest apart in Å that the CA atoms of two catalytic residues stand: 6 to 9 in known structures.
const TOGETHER: f64 = 12.0;

/// The active site of a peptidase.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ActiveSite {
    /// The family, by its name in MEROPS; M10 stands for all metzincins.
    pub family: &'static str,
    /// An enzyme that the family is known by.
    pub known_by: &'static str,
    /// Catalytic residues, each as `chain:number` by the author's names, with the insertion code.
    pub residues: Vec<String>,
    /// The places of each one's atoms in the molecule.
    #[serde(skip)]
    pub atoms: Vec<Vec<usize>>,
}

/// A catalytic residue that was found, and where its CA stands (Å).
#[derive(Clone, Copy)]
struct Found<'a> {
    residue: &'a Residue<'a>,
    position: [f64; 3],
}

impl Molecule {
    /// The active sites of peptidases in this molecule, by family and then in file order; copies of an enzyme have one each.
    pub fn active_sites(&self) -> Vec<ActiveSite> {
        let groups = residue_runs(&self.atoms);
        let chains: Vec<(&[Residue<'_>], Vec<char>)> = peptides(&groups)
            .into_iter()
            .map(|chain| {
                let letters = chain.iter().map(|residue| letter(residue.known_as));
                (chain, letters.collect())
            })
            .collect();
        let mut sites = Vec::new();
        for family in &FAMILIES {
            let of = |anchor: &Anchor| self.places(anchor, &chains);
            let found: Vec<Vec<Vec<Found<'_>>>> = family.anchors.iter().map(of).collect();
            for catalytic in together(&found) {
                let name = |own: &Found<'_>| {
                    let (chain, ..) = own.residue.key;
                    format!("{chain}:{}", number(own.residue))
                };
                sites.push(ActiveSite {
                    family: family.name,
                    known_by: family.known_by,
                    residues: catalytic.iter().map(name).collect(),
                    atoms: catalytic
                        .iter()
                        .map(|own| own.residue.atoms.clone())
                        .collect(),
                });
            }
        }
        sites
    }

    /// The catalytic residues of each place where a stretch fits.
    fn places<'a>(
        &self,
        anchor: &Anchor,
        chains: &[(&'a [Residue<'a>], Vec<char>)],
    ) -> Vec<Vec<Found<'a>>> {
        let mut places = Vec::new();
        for (chain, sequence) in chains {
            for start in 0..sequence.len() {
                let rest = &sequence[start..];
                if anchor.stretches.iter().any(|stretch| fits(rest, stretch)) {
                    let found = |place: &usize| self.found(chain.get(start + place)?);
                    let catalytic: Option<Vec<Found<'_>>> =
                        anchor.catalytic.iter().map(found).collect();
                    places.extend(catalytic);
                }
            }
        }
        places
    }

    /// A residue that has a CA.
    fn found<'a>(&self, residue: &'a Residue<'a>) -> Option<Found<'a>> {
        let mut atoms = residue.atoms.iter().filter_map(|&at| self.atoms.get(at));
        let carbon = atoms.find(|atom| atom.name == "CA")?;
        Some(Found {
            residue,
            position: carbon.position,
        })
    }
}

/// Whether a sequence begins with a stretch.
fn fits(sequence: &[char], stretch: &[&str]) -> bool {
    sequence.len() >= stretch.len()
        && stretch
            .iter()
            .zip(sequence)
            .all(|(allowed, letter)| allowed.is_empty() || allowed.contains(*letter))
}

/// One place of every anchor, all of whose catalytic residues stand together, in each way that there is.
fn together<'a>(found: &[Vec<Vec<Found<'a>>>]) -> Vec<Vec<Found<'a>>> {
    let near = |a: &Found<'_>, b: &Found<'_>| {
        let square = squared_distance(a.position, b.position);
        a.residue.atoms != b.residue.atoms && square <= TOGETHER * TOGETHER
    };
    let mut ways: Vec<Vec<Found<'_>>> = vec![Vec::new()];
    for places in found {
        let with = |way: &Vec<Found<'a>>| -> Vec<Vec<Found<'a>>> {
            let fit = |place: &&Vec<Found<'a>>| {
                let all = |own: &Found<'a>| place.iter().all(|other| near(own, other));
                way.iter().all(all)
            };
            let places = places.iter().filter(fit);
            places
                .map(|place| [way.as_slice(), place].concat())
                .collect()
        };
        ways = ways.iter().flat_map(with).collect();
    }
    // Where two anchors are alike, each way comes in either order.
    let mut seen = BTreeSet::new();
    ways.retain(|way| {
        let atoms = way.iter().map(|found| found.residue.atoms.first().copied());
        seen.insert(atoms.collect::<BTreeSet<_>>())
    });
    ways
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::{Atom, Format, sequence};

    /// Backbones of a chain, numbered from `first`, with `bent` of them all at one place and the others far from it and from each other.
    fn chain(chain: &str, sequence: &str, first: i64, bent: &[i64]) -> Vec<Atom> {
        let position = |number: i64| {
            if bent.contains(&number) {
                [number as f64 / 100.0, 0.0, 0.0]
            } else {
                [100.0 * number as f64, 50.0, 0.0]
            }
        };
        sequence::tests::chain(chain, sequence, first, &["N", "CA", "C"], position)
    }

    /// Family and residues of each site.
    fn sites(atoms: Vec<Atom>) -> Vec<(&'static str, Vec<String>)> {
        let sites = Molecule::new(atoms, Format::Pdb).active_sites();
        let told = |site: ActiveSite| {
            assert_eq!(site.atoms.len(), site.residues.len());
            (site.family, site.residues)
        };
        sites.into_iter().map(told).collect()
    }

    fn named(residues: &[&str]) -> Vec<String> {
        residues.iter().map(|name| (*name).to_owned()).collect()
    }

    /// The stretches about the catalytic residues of an enzyme of each family, by its usual numbers: chymotrypsin, subtilisin BPN', papain,
    /// pepsin, collagenase of fibroblasts and carboxypeptidase A.
    #[test]
    fn an_enzyme_of_each_family_is_told() {
        type Piece = (&'static str, i64);
        let enzymes: [(&str, &[Piece], &[&str]); 6] = [
            (
                "S1",
                &[("WVVTAAHCGVTTSD", 51), ("SCMGDSGGPLVC", 190)],
                &["A:57", "A:195"],
            ),
            (
                "S8",
                &[("DNNSHGTHVAGTVA", 60), ("NGTSMASPHVAG", 218)],
                &["A:64", "A:221"],
            ),
            (
                "C1",
                &[("NQGSCGSCWAFSA", 18), ("VDHAVAAVGYN", 157)],
                &["A:25", "A:159"],
            ),
            (
                "A1",
                &[("TVIFDTGSSNLWV", 28), ("AIVDTGTSLLTG", 212)],
                &["A:32", "A:215"],
            ),
            ("M10", &[("AAHELGHSLGLSHS", 216)], &["A:218", "A:219"]),
            (
                "M14",
                &[("IHSREWITQA", 68), ("HSYSQLLLYPYGY", 196)],
                &["A:69", "A:72", "A:196"],
            ),
        ];
        for (family, pieces, residues) in enzymes {
            let numbers: Vec<i64> = residues.iter().map(|r| r[2..].parse().unwrap()).collect();
            let atoms = |bent: &[i64]| {
                let pieces = pieces.iter();
                let pieces = pieces.map(|(piece, first)| chain("A", piece, *first, bent));
                pieces.collect::<Vec<_>>().concat()
            };
            assert_eq!(sites(atoms(&numbers)), [(family, named(residues))]);
            // The same stretches of a chain whose catalytic residues stand apart are chance.
            if pieces.len() > 1 {
                assert_eq!(sites(atoms(&numbers[..1])), [], "{family}");
            }
        }
    }

    /// Their relatives by the same stretches: urokinase, a peptidase of Streptomyces, furin, proteinase K, cathepsins B, L and D, the protease of HIV (of a family
    /// next to A1), ADAM17 and carboxypeptidase B.
    #[test]
    fn relatives_are_told_by_the_same() {
        for (family, stretches) in [
            ("S1", &["WVISATHCFIDY", "CQGDSGGPLVC"][..]),
            ("S1", &["ALTAGHCTNI", "CAQPGDSGGSLF"]),
            ("S8", &["DNRHGTRCAGEVA", "THTGTSASAPLAA"]),
            ("S8", &["RNGHGTHCAGTIG", "SISGTSMATPHVA"]),
            ("C1", &["RDQGSCGSCWAFGA", "MGGHAIRILGWG"]),
            ("C1", &["KNQGQCGSCWAFSA", "LDHGVLVVGYG"]),
            ("A1", &["TVVFDTGSSNLWV", "AIVDTGTSLMVG"]),
            ("A1", &["EALLDTGADDTVL", "EALLDTGADDTVL"]),
            ("M10", &["VTTHELGHNFGAEHD"]),
            ("M14", &["CGFHAREWISPA", "HSYSQMMIYPYSY"]),
        ] {
            let names = ["A", "B"].iter().zip(stretches);
            let near: Vec<i64> = (1..20).collect();
            let atoms = names.map(|(name, stretch)| chain(name, stretch, 1, &near));
            let found = sites(atoms.collect::<Vec<_>>().concat());
            let families: Vec<&str> = found.iter().map(|(family, _)| *family).collect();
            assert_eq!(families, [family], "{stretches:?}");
        }
    }

    /// As its activated form has it, in chains of their own; with the serine mutated, modified or left out; and two copies, whose
    /// residues go with the nearer.
    #[test]
    fn sites_span_chains_and_do_without_the_serine() {
        let base = || chain("B", "WVVTAAHCGVTTSD", 51, &[57]);
        let with = |serine: &str, bent| sites([base(), chain("C", serine, 190, bent)].concat());
        let expected = [("S1", named(&["B:57", "C:195"]))];
        assert_eq!(with("SCMGDSGGPLVC", &[195]), expected);
        assert_eq!(with("SCMGDAGGPLVC", &[195]), expected);
        assert_eq!(with("SCMGDXGGPLVC", &[195]), expected);
        assert_eq!(with("SCMGDGGPLVC", &[195]), expected);
        assert_eq!(with("SCMGESGGPLVC", &[195]), []);
        let far: Vec<Atom> = [base(), chain("C", "SCMGDSGGPLVC", 190, &[195])]
            .concat()
            .into_iter()
            .map(|mut atom| {
                atom.chain = if atom.chain == "B" { "E" } else { "F" }.to_owned();
                atom.position[2] += 40.0;
                atom
            })
            .collect();
        let near = [base(), chain("C", "SCMGDSGGPLVC", 190, &[195])].concat();
        assert_eq!(
            sites([near, far].concat()),
            [
                ("S1", named(&["B:57", "C:195"])),
                ("S1", named(&["E:57", "F:195"]))
            ]
        );
    }

    /// Hen egg-white lysozyme, an enzyme that cuts no proteins; a residue without its CA; nothing at all.
    #[test]
    fn what_is_no_peptidase_has_none() {
        let lysozyme = "KVFGRCELAAAMKRHGLDNYRGYSLGNWVCAAKFESNFNTQATNRNTDGSTDYGILQINSRWWCNDGRTPGSRNLCNIPCSALLSSDITASVNCAKKIVSDGNGMNAWVAWRGTDVQAWIRGCRL";
        let all: Vec<i64> = (1..130).collect();
        assert_eq!(sites(chain("A", lysozyme, 1, &all)), []);
        let mut atoms = chain("A", "AAHELGHSLGLSHS", 216, &[218, 219]);
        atoms.retain(|atom| atom.residue_number != 218 || atom.name != "CA");
        assert_eq!(sites(atoms), []);
        assert_eq!(sites(Vec::new()), []);
    }
}
