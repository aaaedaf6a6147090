//! Antibodies, detected from their sequence, and the part of them that binds.
//!
//! A variable domain is a segment that the crate immunum aligns to the consensus of heavy, kappa or lambda chains with a
//! confidence of at least its default. One chain may have several, as where H and L were merged or in a
//! single-chain Fv.
//!
//! Complementarity-determining regions (CDRs) are the residues that either of two numberings counts among them: IMGT's
//! (Lefranc et al., Dev. Comp. Immunol. 27 (2003) 55-77) or Kabat's (Sequences of Proteins of Immunological Interest,
//! 1991). Either alone misses residues that touch antigens.
//!
//! T-cell receptors do not count as antibodies, since superantigens hold them by their frameworks.

use std::sync::LazyLock;

use immunum::numbering::region_for_position;
use immunum::types::{IG_CHAINS, Region};
use immunum::{Annotator, Chain, Scheme};
use knotdock_structures::molecule::{Molecule, PeptideChain};
use knotdock_structures::neighbours::SpatialHash;
use serde::Serialize;
use serde_json::json;

use super::{Findings, Prior, Site, SiteRole};

/// Distance in Å from the nearest atom of a CDR up to which an antibody's atoms belong to the paratope: the reach of a
/// contact.
const PARATOPE_EDGE: f64 = 5.0;

/// A variable domain of an antibody.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct VariableDomain {
    /// Kind of its chain: heavy (of single-domain antibodies, too), kappa or lambda.
    kind: &'static str,
    /// The file's name of its chain; may be empty.
    chain: String,
    /// First and last residue: the author's number with its insertion code.
    residues: [String; 2],
    /// Resolved residues of its three CDRs, in order, each by the author's number with its insertion code.
    cdrs: [Vec<String>; 3],
}

/// An antibody: its variable domains and its binding site.
#[derive(Clone, Debug, PartialEq)]
struct Antibody {
    /// Its variable domains, in file order.
    domains: Vec<VariableDomain>,
    /// For each atom of the molecule, whether it belongs to a CDR.
    determining: Vec<bool>,
    /// For each atom, whether it is within [`PARATOPE_EDGE`] of an atom of a CDR, or is one.
    paratope: Vec<bool>,
}

impl Antibody {
    /// The variable domains of antibodies in a molecule; `None` if there is none.
    fn of(molecule: &Molecule) -> Option<Self> {
        let mut domains = Vec::new();
        let mut determining = vec![false; molecule.atoms.len()];
        for chain in molecule.peptide_chains() {
            for (domain, regions) in variable_domains(&chain) {
                for (residue, region) in chain.residues.iter().zip(regions) {
                    if region.is_some() {
                        determining[residue.atoms.clone()].fill(true);
                    }
                }
                domains.push(domain);
            }
        }
        (!domains.is_empty()).then(|| Self {
            paratope: near(molecule, &determining, PARATOPE_EDGE),
            domains,
            determining,
        })
    }

    /// The variable domains in words.
    fn domains_in_words(&self) -> String {
        let words = |domain: &VariableDomain| {
            let [first, last] = &domain.residues;
            format!("{} {}:{first}-{last}", domain.kind, domain.chain)
        };
        let domains = self.domains.iter().map(words);
        domains.collect::<Vec<_>>().join(", ")
    }

    /// Its domains and its site, in words.
    fn reason(&self) -> String {
        format!(
            "an antibody ({}), which binds by its CDRs and what lies within {PARATOPE_EDGE} Å of them",
            self.domains_in_words()
        )
    }
}

/// Antibodies bind by their CDRs and the atoms around them.
pub(super) struct AntibodyPrior;

impl Prior for AntibodyPrior {
    fn sites(&self, molecule: &Molecule) -> Vec<Site> {
        let site = |antibody: Antibody| Site {
            role: SiteRole::Exclusive,
            residues: molecule.atoms_by_residue(&antibody.paratope),
            reason: antibody.reason(),
            record: json!(antibody.domains),
        };
        Antibody::of(molecule).map(site).into_iter().collect()
    }

    fn entry_name(&self) -> &'static str {
        "antibody"
    }

    fn findings(&self, molecule: &Molecule) -> Findings {
        let antibody = Antibody::of(molecule);
        Findings {
            lines: antibody.as_ref().map_or(Vec::new(), lines),
            entry: json!(antibody.map(|antibody| antibody.domains)),
        }
    }
}

/// Domains and CDRs, a line each.
fn lines(antibody: &Antibody) -> Vec<String> {
    let domains = antibody.domains_in_words();
    let mut lines = vec![format!("Variable domains of an antibody: {domains}")];
    for domain in &antibody.domains {
        let cdrs = domain.cdrs.iter().map(|cdr| match cdr.as_slice() {
            [] => "none".to_owned(),
            [only] => only.clone(),
            [first, .., last] => format!("{first}-{last}"),
        });
        let cdrs = cdrs.collect::<Vec<_>>().join(", ");
        lines.push(format!("CDRs of {} {}: {cdrs}", domain.kind, domain.chain));
    }
    lines
}

/// Whether each atom is one of the `chosen` or lies within `distance` (Å) of one.
fn near(molecule: &Molecule, chosen: &[bool], distance: f64) -> Vec<bool> {
    let positions = || molecule.atoms.iter().map(|atom| atom.position);
    let chosen = positions().zip(chosen).filter(|(_, chosen)| **chosen);
    let chosen: Vec<[f64; 3]> = chosen.map(|(position, _)| position).collect();
    let cells = SpatialHash::of_points(chosen.iter().copied(), distance);
    let is_near = |position: [f64; 3]| {
        cells.around(position).any(|&other| {
            let along = |axis: usize| (position[axis] - chosen[other][axis]).powi(2);
            (0..3).map(along).sum::<f64>() <= distance * distance
        })
    };
    positions().map(is_near).collect()
}

/// Numbering by IMGT and by Kabat, made once: that takes longer than the numbering of a chain.
static ANNOTATORS: LazyLock<[Annotator; 2]> = LazyLock::new(|| {
    // Errors are of chains that a scheme lacks and of confidences out of range.
    [Scheme::IMGT, Scheme::Kabat].map(|scheme| {
        Annotator::new(IG_CHAINS, scheme, None)
            .unwrap_or_else(|error| unreachable!("numbering of antibodies: {error}"))
    })
});

/// The variable domains of one chain, each with the CDR (0 to 2) of this domain that each residue of the chain belongs to.
fn variable_domains(chain: &PeptideChain<'_>) -> Vec<(VariableDomain, Vec<Option<usize>>)> {
    let sequence = chain.sequence();
    let residues = &chain.residues;
    // A chain that is too short or too long for an antibody is an error, as is one without a domain.
    let numbered = ANNOTATORS
        .each_ref()
        .map(|one| one.number_domains(&sequence));
    let [Ok(imgt), Ok(kabat)] = numbered else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for domain in &imgt {
        let kind = match domain.chain {
            Chain::IGH => "heavy",
            Chain::IGK => "kappa",
            Chain::IGL => "lambda",
            _ => continue,
        };
        let span = domain.query_start..=domain.query_end;
        let mut regions = vec![None; residues.len()];
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
        let label = |place: usize| {
            let residue = residues.get(place);
            residue.map_or(String::new(), |residue| residue.number.clone())
        };
        let cdrs = std::array::from_fn(|cdr| {
            let own = (0..residues.len()).filter(|&place| regions[place] == Some(cdr));
            own.map(label).collect()
        });
        found.push((
            VariableDomain {
                kind,
                chain: chain.name.to_owned(),
                residues: [label(domain.query_start), label(domain.query_end)],
                cdrs,
            },
            regions,
        ));
    }
    found
}

/// The CDR of a region, from 0.
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
    use crate::priors::test_chains;
    use knotdock_structures::molecule::{Atom, Format};

    /// Variable domains of trastuzumab (its heavy and its kappa chain).
    const HEAVY: &str = "EVQLVESGGGLVQPGGSLRLSCAASGFNIKDTYIHWVRQAPGKGLEWVARIYPTNGYTRYADSVKGRFTISADTSKNTAYLQMNSL\
        RAEDTAVYYCSRWGGDGFYAMDYWGQGTLVTVSS";
    const KAPPA: &str = "DIQMTQSPSSLSASVGDRVTITCRASQDVNTAVAWYQQKPGKAPKLLIYSASFLYSGVPSRFSGSRSGTDFTLTISSLQPEDFATYYCQQHYTTPPTFGQGTKVEIK";
    /// Hen egg-white lysozyme, which they have nothing in common with.
    const LYSOZYME: &str = "KVFGRCELAAAMKRHGLDNYRGYSLGNWVCAAKFESNFNTQATNRNTDGSTDYGILQINSRWWCNDGRTPGSRNLCNIPCSAL\
        LSSDITASVNCAKKIVSDGNGMNAWVAWRGTDVQAWIRGCRL";

    /// Alpha carbons 3.8 Å apart on a line, numbered from `first`.
    fn chain(name: &str, sequence: &str, first: i64) -> Vec<Atom> {
        let position = |number: i64| [3.8 * number as f64, 0.0, 0.0];
        test_chains::chain(name, sequence, first, &["CA"], position)
    }

    /// The CDRs of each domain as letters of `sequence`, whose first residue has number 1.
    fn letters(domain: &VariableDomain, sequence: &str) -> [String; 3] {
        let letter = |number: &String| sequence.chars().nth(number.parse::<usize>().unwrap() - 1);
        domain
            .cdrs
            .clone()
            .map(|cdr| cdr.iter().filter_map(letter).collect())
    }

    /// Kabat's regions of trastuzumab as published with it (Carter et al., PNAS 89 (1992) 4285-4289), H1 and H3 longer
    /// at their beginnings by IMGT's.
    #[test]
    fn the_regions_of_a_known_antibody() {
        let atoms = [chain("H", HEAVY, 1), chain("L", KAPPA, 1)].concat();
        let antibody = Antibody::of(&Molecule::new(atoms, Format::Pdb)).unwrap();
        let [heavy, kappa] = &antibody.domains[..] else {
            panic!("{:?}", antibody.domains);
        };
        assert_eq!((heavy.kind, heavy.chain.as_str()), ("heavy", "H"));
        assert_eq!((kappa.kind, kappa.chain.as_str()), ("kappa", "L"));
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
        let antibody = Antibody::of(&Molecule::new(merged.concat(), Format::Pdb)).unwrap();
        let kinds: Vec<&str> = antibody.domains.iter().map(|domain| domain.kind).collect();
        assert_eq!(kinds, ["kappa", "heavy"]);
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
        let is_antibody =
            |atoms: Vec<Atom>| Antibody::of(&Molecule::new(atoms, Format::Pdb)).is_some();
        assert!(is_antibody(chain("A", HEAVY, 1)));
        assert!(!is_antibody(chain("A", LYSOZYME, 1)));
        assert!(!is_antibody(chain("A", &HEAVY[..28], 1)));
        assert!(!is_antibody(chain("A", &LYSOZYME.repeat(90), 1)));
        assert!(!is_antibody(Vec::new()));
    }
}
