//! Antibodies told by their sequence, and the part of them that binds.
//!
//! A variable domain is what the crate immunum aligns to the consensus of heavy, kappa or lambda chains with a confidence of at least
//! its default; several may stand in one chain, as where H and L were merged or in a single-chain Fv. Its complementarity-determining
//! regions (CDRs) are residues that either IMGT's numbering (Lefranc et al., Dev. Comp. Immunol. 27 (2003) 55-77) or Kabat's (Sequences of
//! Proteins of Immunological Interest, 1991) counts among them: either alone misses residues that touch antigens. T-cell receptors are
//! left alone, since superantigens hold them by their frameworks.

use super::groups::{Residue, residue_runs};
use super::sequence::{letter, number, peptides};
use super::{Molecule, squared_distance};
use crate::neighbours::SpatialHash;
use immunum::numbering::region_for_position;
use immunum::types::{IG_CHAINS, Region};
use immunum::{Annotator, Chain, Scheme};
use serde::Serialize;

/// Distance in Å from the nearest atom of a CDR up to which an antibody's atoms count as part of what binds: the reach of a contact.
pub const PARATOPE_EDGE: f64 = 5.0;

/// Chain that a variable domain belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum VariableKind {
    /// Heavy chains, those of single-domain antibodies among them.
    Heavy,
    /// Kappa light chains.
    Kappa,
    /// Lambda light chains.
    Lambda,
}

impl VariableKind {
    fn of(chain: Chain) -> Option<Self> {
        match chain {
            Chain::IGH => Some(Self::Heavy),
            Chain::IGK => Some(Self::Kappa),
            Chain::IGL => Some(Self::Lambda),
            _ => None,
        }
    }

    /// The kind in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Heavy => "heavy",
            Self::Kappa => "kappa",
            Self::Lambda => "lambda",
        }
    }
}

/// A variable domain of an antibody.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariableDomain {
    /// Which chain it belongs to.
    pub kind: VariableKind,
    /// The file's name of the chain that it stands in; may be empty.
    pub chain: String,
    /// First and last residue: the author's number with its insertion code.
    pub residues: [String; 2],
    /// Residues of its three CDRs, in order, each by the author's number with its insertion code; those that the file lacks are missing here.
    pub cdrs: [Vec<String>; 3],
}

/// What an antibody is and where it binds.
#[derive(Clone, Debug, PartialEq)]
pub struct Antibody {
    /// Its variable domains, in file order.
    pub domains: Vec<VariableDomain>,
    /// For each atom of the molecule, whether it belongs to a CDR.
    pub determining: Vec<bool>,
    /// For each atom, whether it belongs to a CDR or lies within [`PARATOPE_EDGE`] of an atom that does.
    pub paratope: Vec<bool>,
}

impl Molecule {
    /// The variable domains of antibodies in this molecule; `None` where there is none.
    pub fn antibody(&self) -> Option<Antibody> {
        let groups = residue_runs(&self.atoms);
        let annotators = Annotators::new()?;
        let mut domains = Vec::new();
        let mut determining = vec![false; self.atoms.len()];
        for chain in peptides(&groups) {
            for (domain, regions) in annotators.variable_domains(chain) {
                for (residue, region) in chain.iter().zip(regions) {
                    if region.is_some() {
                        for &atom in &residue.atoms {
                            determining[atom] = true;
                        }
                    }
                }
                domains.push(domain);
            }
        }
        (!domains.is_empty()).then(|| Antibody {
            paratope: self.near(&determining, PARATOPE_EDGE),
            domains,
            determining,
        })
    }

    /// Whether each atom is one of the `chosen` or lies within `distance` (Å) of one.
    fn near(&self, chosen: &[bool], distance: f64) -> Vec<bool> {
        let positions = || self.atoms.iter().map(|atom| atom.position);
        let chosen: Vec<[f64; 3]> = positions()
            .zip(chosen)
            .filter_map(|(position, chosen)| chosen.then_some(position))
            .collect();
        let cells = SpatialHash::of_points(chosen.iter().copied(), distance);
        let is_near = |position: [f64; 3]| {
            cells
                .around(position)
                .copied()
                .any(|other| squared_distance(position, chosen[other]) <= distance * distance)
        };
        positions().map(is_near).collect()
    }
}

/// Both numberings, ready for any chain: to make one takes longer than to number a chain that is no antibody's.
struct Annotators {
    imgt: Annotator,
    kabat: Annotator,
}

impl Annotators {
    fn new() -> Option<Self> {
        let of = |scheme| Annotator::new(IG_CHAINS, scheme, None).ok();
        Some(Self {
            imgt: of(Scheme::IMGT)?,
            kabat: of(Scheme::Kabat)?,
        })
    }

    /// The variable domains of one chain, each with the CDR (0 to 2) that each of the chain's residues belongs to, if to one of this domain.
    fn variable_domains(&self, chain: &[Residue<'_>]) -> Vec<(VariableDomain, Vec<Option<usize>>)> {
        let sequence: String = chain
            .iter()
            .map(|residue| letter(residue.known_as))
            .collect();
        // A chain too short, or longer than any antibody's, is an error of the search, as is one without a domain.
        let numbered = |annotator: &Annotator| annotator.number_domains(&sequence).ok();
        let (Some(imgt), Some(kabat)) = (numbered(&self.imgt), numbered(&self.kabat)) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for domain in &imgt {
            let Some(kind) = VariableKind::of(domain.chain) else {
                continue;
            };
            let span = domain.query_start..=domain.query_end;
            let mut regions = vec![None; chain.len()];
            for numbering in [domain].into_iter().chain(&kabat) {
                let places = (numbering.query_start..).zip(&numbering.positions);
                for (place, position) in places.filter(|(place, _)| span.contains(place)) {
                    let region =
                        region_for_position(position.number, numbering.scheme, numbering.chain);
                    if let (Some(cdr), Some(own)) = (region.and_then(cdr), regions.get_mut(place)) {
                        *own = Some(cdr);
                    }
                }
            }
            let label = |place: usize| chain.get(place).map_or(String::new(), number);
            let cdrs = std::array::from_fn(|cdr| {
                let own = (0..chain.len()).filter(|&place| regions[place] == Some(cdr));
                own.map(label).collect()
            });
            let first = chain.get(domain.query_start);
            found.push((
                VariableDomain {
                    kind,
                    chain: first.map_or(String::new(), |residue| residue.key.0.to_owned()),
                    residues: [label(domain.query_start), label(domain.query_end)],
                    cdrs,
                },
                regions,
            ));
        }
        found
    }
}

/// Which CDR a region is, from 0.
fn cdr(region: Region) -> Option<usize> {
    match region {
        Region::CDR1 => Some(0),
        Region::CDR2 => Some(1),
        Region::CDR3 => Some(2),
        Region::FR1 | Region::FR2 | Region::FR3 | Region::FR4 => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecule::{Atom, Format, sequence};

    /// Variable domains of trastuzumab (its heavy and its kappa chain).
    const HEAVY: &str = "EVQLVESGGGLVQPGGSLRLSCAASGFNIKDTYIHWVRQAPGKGLEWVARIYPTNGYTRYADSVKGRFTISADTSKNTAYLQMNSLRAEDTAVYYCSRWGGDGFYAMDYWGQGTLVTVSS";
    const KAPPA: &str = "DIQMTQSPSSLSASVGDRVTITCRASQDVNTAVAWYQQKPGKAPKLLIYSASFLYSGVPSRFSGSRSGTDFTLTISSLQPEDFATYYCQQHYTTPPTFGQGTKVEIK";
    /// Hen egg-white lysozyme, which they have nothing in common with.
    const LYSOZYME: &str = "KVFGRCELAAAMKRHGLDNYRGYSLGNWVCAAKFESNFNTQATNRNTDGSTDYGILQINSRWWCNDGRTPGSRNLCNIPCSALLSSDITASVNCAKKIVSDGNGMNAWVAWRGTDVQAWIRGCRL";

    /// Alpha carbons 3.8 Å apart on a line, numbered from `first`.
    fn chain(name: &str, sequence: &str, first: i64) -> Vec<Atom> {
        let position = |number: i64| [3.8 * number as f64, 0.0, 0.0];
        sequence::tests::chain(name, sequence, first, &["CA"], position)
    }

    /// The CDRs of each domain as letters of `sequence`, whose first residue has number 1.
    fn letters(domain: &VariableDomain, sequence: &str) -> [String; 3] {
        let letter = |number: &String| sequence.chars().nth(number.parse::<usize>().unwrap() - 1);
        domain
            .cdrs
            .clone()
            .map(|cdr| cdr.iter().filter_map(letter).collect())
    }

    /// Kabat's regions of trastuzumab as published with it (Carter et al., PNAS 89 (1992) 4285-4289), H1 and H3 longer at their beginnings by IMGT's.
    #[test]
    fn the_regions_of_a_known_antibody() {
        let atoms = [chain("H", HEAVY, 1), chain("L", KAPPA, 1)].concat();
        let antibody = Molecule::new(atoms, Format::Pdb).antibody().unwrap();
        let [heavy, kappa] = &antibody.domains[..] else {
            panic!("{:?}", antibody.domains);
        };
        assert_eq!(
            (heavy.kind, heavy.chain.as_str()),
            (VariableKind::Heavy, "H")
        );
        assert_eq!(
            (kappa.kind, kappa.chain.as_str()),
            (VariableKind::Kappa, "L")
        );
        assert_eq!(heavy.residues, ["1", "120"]);
        assert_eq!(
            letters(heavy, HEAVY),
            ["GFNIKDTYIH", "RIYPTNGYTRYADSVKG", "SRWGGDGFYAMDY"]
        );
        assert_eq!(
            letters(kappa, KAPPA),
            ["RASQDVNTAVA", "SASFLYS", "QQHYTTPPT"]
        );
        let count = |marks: &[bool]| marks.iter().filter(|mark| **mark).count();
        assert_eq!(count(&antibody.determining), 40 + 27);
        // On a line 3.8 Å apart each region has one more on either side.
        let edges: usize = 2 * 6;
        let together = count(&antibody.paratope);
        assert!(together >= 40 + 27 + edges, "{together}");
        assert!(
            antibody
                .determining
                .iter()
                .zip(&antibody.paratope)
                .all(|(own, near)| !own || *near)
        );
    }

    /// Chains merged under one name whose numbers begin again, with more of the protein before, between and after.
    #[test]
    fn domains_are_found_within_a_chain() {
        let merged = [
            chain("A", LYSOZYME, 1),
            chain("A", KAPPA, 1),
            chain("A", LYSOZYME, 200),
            chain("A", HEAVY, 1),
            chain("A", LYSOZYME, 400),
        ];
        let antibody = Molecule::new(merged.concat(), Format::Pdb)
            .antibody()
            .unwrap();
        let kinds: Vec<VariableKind> = antibody.domains.iter().map(|domain| domain.kind).collect();
        assert_eq!(kinds, [VariableKind::Kappa, VariableKind::Heavy]);
        assert_eq!(letters(&antibody.domains[1], HEAVY)[2], "SRWGGDGFYAMDY");
        assert_eq!(
            antibody.determining.iter().filter(|own| **own).count(),
            40 + 27
        );
        assert!(!antibody.determining[..LYSOZYME.len()].contains(&true));
    }

    /// A single domain is an antibody too; an enzyme, a scrap of a domain and no protein at all are none.
    #[test]
    fn what_is_no_antibody_is_left_alone() {
        let is_antibody = |atoms: Vec<Atom>| Molecule::new(atoms, Format::Pdb).antibody().is_some();
        assert!(is_antibody(chain("A", HEAVY, 1)));
        assert!(!is_antibody(chain("A", LYSOZYME, 1)));
        assert!(!is_antibody(chain("A", &HEAVY[..28], 1)));
        assert!(!is_antibody(chain("A", &LYSOZYME.repeat(90), 1)));
        assert!(!is_antibody(Vec::new()));
    }
}
