//! Peptidases, detected from their sequence and fold, and the residues of their active sites.
//!
//! A peptidase cuts proteins, so a protein that binds it, an inhibitor above all, mostly does so at its active site.
//!
//! Six families are detected from the segments of sequence about their catalytic residues, and from their distances
//! (`peptidase_families.csv` has the table). Side chains have no effect: in structures they may be turned, flipped or
//! missing, and a nucleophile mutated, modified or left out.
//!
//! Families with sites deep in a cleft (angiotensin-converting enzyme 2, neprilysin) or with small substrates besides
//! (lipases, esterases) are left out.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::LazyLock;

use knotdock_structures::molecule::{Molecule, PeptideChain};
use serde::Serialize;
use serde_json::json;

use super::{Findings, Prior, Site, SiteRole};

/// Largest distance in Å of the CA atoms of two catalytic residues; known structures have 6 to 9.
const TOGETHER: f64 = 12.0;

/// The active site of a peptidase.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
struct ActiveSite {
    /// The family, by its name in MEROPS; M10 represents all metzincins.
    family: &'static str,
    /// An enzyme that the family is known by.
    known_by: &'static str,
    /// Catalytic residues, each as `chain:number` by the author's names, with the insertion code.
    residues: Vec<String>,
    /// The indices of the atoms of each catalytic residue in the molecule.
    #[serde(skip)]
    atoms: Vec<Vec<usize>>,
}

impl ActiveSite {
    /// The active sites of peptidases in a molecule, by family and then in file order; copies of an enzyme have one
    /// each.
    fn all(molecule: &Molecule) -> Vec<Self> {
        let chains = molecule.peptide_chains();
        let sequence = |chain: &PeptideChain<'_>| chain.sequence().chars().collect();
        let chains: Vec<_> = chains
            .iter()
            .map(|chain| (chain, sequence(chain)))
            .collect();
        let mut sites = Vec::new();
        for family in FAMILIES.iter() {
            let of = |anchor: &Anchor| places(molecule, anchor, &chains);
            let found: Vec<Vec<Vec<CatalyticResidue>>> = family.anchors.iter().map(of).collect();
            for catalytic in together(&found) {
                let atoms = catalytic.iter().map(|own| own.atoms.clone().collect());
                sites.push(Self {
                    family: &family.name,
                    known_by: &family.known_by,
                    atoms: atoms.collect(),
                    residues: catalytic.into_iter().map(|own| own.name).collect(),
                });
            }
        }
        sites
    }

    /// The family and the catalytic residues in words.
    fn in_words(&self) -> String {
        format!(
            "of family {} like {} (catalytic {})",
            self.family,
            self.known_by,
            self.residues.join(", ")
        )
    }

    /// Several sites in words.
    fn all_in_words(sites: &[Self]) -> String {
        let words: Vec<String> = sites.iter().map(Self::in_words).collect();
        words.join("; ")
    }
}

/// Peptidases bind proteins at their active sites.
pub(super) struct PeptidasePrior;

impl Prior for PeptidasePrior {
    fn sites(&self, molecule: &Molecule) -> Vec<Site> {
        let site = |site: ActiveSite| Site {
            role: SiteRole::Favoured,
            reason: format!("a peptidase, {}", site.in_words()),
            record: json!(site),
            residues: site.atoms,
        };
        ActiveSite::all(molecule).into_iter().map(site).collect()
    }

    fn entry_name(&self) -> &'static str {
        "active_sites"
    }

    fn findings(&self, molecule: &Molecule) -> Findings {
        let sites = ActiveSite::all(molecule);
        let words = ActiveSite::all_in_words(&sites);
        let lines = (!sites.is_empty()).then(|| format!("A peptidase, {words}"));
        Findings {
            entry: json!(sites),
            lines: lines.into_iter().collect(),
        }
    }
}

/// A catalytic residue of a molecule.
#[derive(Clone, Debug)]
struct CatalyticResidue {
    /// `chain:number` by the author's names.
    name: String,
    /// The indices of its atoms in the molecule.
    atoms: Range<usize>,
    /// Position of its CA, in Å.
    position: [f64; 3],
}

/// The catalytic residues of each place where a pattern of an anchor fits.
fn places(
    molecule: &Molecule,
    anchor: &Anchor,
    chains: &[(&PeptideChain<'_>, Vec<char>)],
) -> Vec<Vec<CatalyticResidue>> {
    let mut places = Vec::new();
    for (chain, sequence) in chains {
        for start in 0..sequence.len() {
            let rest = &sequence[start..];
            if anchor.patterns.iter().any(|pattern| fits(rest, pattern)) {
                let found = |place: &usize| catalytic_residue(molecule, chain, start + place);
                let catalytic: Option<Vec<CatalyticResidue>> =
                    anchor.catalytic.iter().map(found).collect();
                places.extend(catalytic);
            }
        }
    }
    places
}

/// A residue of a chain, if it has a CA.
fn catalytic_residue(
    molecule: &Molecule,
    chain: &PeptideChain<'_>,
    place: usize,
) -> Option<CatalyticResidue> {
    let residue = chain.residues.get(place)?;
    let mut atoms = molecule.atoms[residue.atoms.clone()].iter();
    let carbon = atoms.find(|atom| atom.name == "CA")?;
    Some(CatalyticResidue {
        name: format!("{}:{}", chain.name, residue.number),
        atoms: residue.atoms.clone(),
        position: carbon.position,
    })
}

/// Whether a sequence begins with a pattern.
fn fits(sequence: &[char], pattern: &[String]) -> bool {
    let mut places = pattern.iter().zip(sequence);
    sequence.len() >= pattern.len()
        && places.all(|(allowed, letter)| allowed.is_empty() || allowed.contains(*letter))
}

/// Every combination of one place per anchor in which all catalytic residues are near each other.
fn together(found: &[Vec<Vec<CatalyticResidue>>]) -> Vec<Vec<CatalyticResidue>> {
    let near = |a: &CatalyticResidue, b: &CatalyticResidue| {
        let along = |axis: usize| (a.position[axis] - b.position[axis]).powi(2);
        a.atoms != b.atoms && (0..3).map(along).sum::<f64>() <= TOGETHER * TOGETHER
    };
    let mut ways: Vec<Vec<CatalyticResidue>> = vec![Vec::new()];
    for places in found {
        let with = |way: &Vec<CatalyticResidue>| -> Vec<Vec<CatalyticResidue>> {
            let fit = |place: &&Vec<CatalyticResidue>| {
                let all = |own: &CatalyticResidue| place.iter().all(|other| near(own, other));
                way.iter().all(all)
            };
            let places = places.iter().filter(fit);
            places.map(|place| [&way[..], place].concat()).collect()
        };
        ways = ways.iter().flat_map(with).collect();
    }
    // If two anchors are alike, each way comes in either order.
    let mut seen = BTreeSet::new();
    ways.retain(|way| {
        let atoms = way.iter().map(|found| found.atoms.start);
        seen.insert(atoms.collect::<BTreeSet<_>>())
    });
    ways
}

/// The table; its head describes the columns and their sources.
const TABLE: &str = include_str!("peptidase_families.csv");

/// Amino acids allowed at each place of a segment; none stands for any.
type Pattern = Vec<String>;

/// A conserved segment about catalytic residues.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Anchor {
    /// Forms of the segment; the first of several that fit at one place counts.
    pub patterns: Vec<Pattern>,
    /// Places of the catalytic residues in it, from 0.
    pub catalytic: Vec<usize>,
}

/// A family of peptidases.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Family {
    /// Name in MEROPS.
    pub name: String,
    /// An enzyme of it that the field knows.
    pub known_by: String,
    /// Segments that its members have, all of them.
    pub anchors: Vec<Anchor>,
}

/// The families, in the order of the table.
static FAMILIES: LazyLock<Vec<Family>> = LazyLock::new(|| {
    // The table is part of the program, and a test reads it.
    parse(TABLE).unwrap_or_else(|| unreachable!("the table of peptidase families"))
});

/// The families of a table; `None` if a row cannot be read.
fn parse(table: &str) -> Option<Vec<Family>> {
    let mut families: Vec<Family> = Vec::new();
    let mut rows = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(table.as_bytes());
    for record in rows.records() {
        let record = record.ok()?;
        let fields: Vec<&str> = record.iter().collect();
        let [name, known_by, patterns, catalytic] = fields[..] else {
            return None;
        };
        let anchor = anchor(patterns, catalytic)?;
        match families.last_mut() {
            Some(family) if family.name == name => family.anchors.push(anchor),
            _ => families.push(Family {
                name: name.to_owned(),
                known_by: known_by.to_owned(),
                anchors: vec![anchor],
            }),
        }
    }
    Some(families)
}

fn anchor(patterns: &str, catalytic: &str) -> Option<Anchor> {
    let pattern = |pattern: &str| pattern.trim().split('-').map(allowed).collect();
    let patterns: Vec<Pattern> = patterns.split('|').map(pattern).collect::<Option<_>>()?;
    let shortest = patterns.iter().map(Vec::len).min().unwrap_or(0);
    let place = |text: &str| {
        let place = text.parse::<usize>().ok()?.checked_sub(1);
        place.filter(|place| *place < shortest)
    };
    let places = catalytic.split_whitespace().map(place);
    let catalytic: Vec<usize> = places.collect::<Option<_>>()?;
    (!catalytic.is_empty()).then_some(Anchor {
        patterns,
        catalytic,
    })
}

/// The amino acids allowed at one place of a pattern: `x`, one letter, or letters in brackets.
fn allowed(place: &str) -> Option<String> {
    let inner = place
        .strip_prefix('[')
        .and_then(|rest| rest.strip_suffix(']'));
    let letters = inner.unwrap_or(place);
    let are_letters = letters.chars().all(|letter| letter.is_ascii_uppercase());
    match letters {
        "x" => Some(String::new()),
        "" => None,
        _ if are_letters && (letters.len() == 1 || place != letters) => Some(letters.to_owned()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::priors::test_chains;
    use knotdock_structures::molecule::{Atom, Format};

    /// Backbones of a chain, numbered from `first`, with `bent` of them all at one place and the others far from it and
    /// from each other.
    fn chain(chain: &str, sequence: &str, first: i64, bent: &[i64]) -> Vec<Atom> {
        let position = |number: i64| {
            if bent.contains(&number) {
                [number as f64 / 100.0, 0.0, 0.0]
            } else {
                [100.0 * number as f64, 50.0, 0.0]
            }
        };
        test_chains::chain(chain, sequence, first, &["N", "CA", "C"], position)
    }

    /// Family and residues of each site.
    fn sites(atoms: Vec<Atom>) -> Vec<(&'static str, Vec<String>)> {
        let sites = ActiveSite::all(&Molecule::new(atoms, Format::Pdb));
        let shown = |site: ActiveSite| {
            assert_eq!(site.atoms.len(), site.residues.len());
            (site.family, site.residues)
        };
        sites.into_iter().map(shown).collect()
    }

    fn named(residues: &[&str]) -> Vec<String> {
        residues.iter().map(|name| (*name).to_owned()).collect()
    }

    /// The segments about the catalytic residues of an enzyme of each family, by its usual numbers: chymotrypsin,
    /// subtilisin BPN', papain, pepsin, collagenase of fibroblasts and carboxypeptidase A.
    #[test]
    fn an_enzyme_of_each_family_is_detected() {
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
            // The same segments of a chain whose catalytic residues are not together are chance.
            if pieces.len() > 1 {
                assert_eq!(sites(atoms(&numbers[..1])), [], "{family}");
            }
        }
    }

    /// Whole enzymes with their catalytic residues in crystal numbering: family, number of the first residue,
    /// sequence, residues.
    ///
    /// Bovine chymotrypsinogen A (UniProt P00766), subtilisin BPN' (PDB 2SNI, chain E), papain (P00784), porcine
    /// pepsin A (P00791), the protease of HIV-1 as a dimer, the catalytic domain of human collagenase MMP-1 (P03956,
    /// from residue 99 on) and bovine carboxypeptidase A (P00730).
    const ENZYMES: [(&str, i64, &str, &[&str]); 7] = [
        (
            "S1",
            1,
            "CGVPAIQPVLSGLSRIVNGEEAVPGSWPWQVSLQDKTGFHFCGGSLINENWVVTAAHCGVTTSDVVVAGEFDQGSSSEKIQKLKIAKVFKNSKYNSLTIN\
             NDITLLKLSTAASFSQTVSAVCLPSASDDFAAGTTCVTTGWGLTRYTNANTPDRLQQASLPLLSNTNCKKYWGTKIKDAMICAGASGVSSCMGDSGGPLV\
             CKKNGAWTLVGIVSWGSSTCSTSTPGVYARVTALVNWVQQTLAAN",
            &["A:57", "A:195"],
        ),
        (
            "S8",
            1,
            "AQSVPYGVSQIKAPALHSQGYTGSNVKVAVIDSGIDSSHPDLKVAGGASMVPSETNPFQDNNSHGTHVAGTVAALNNSIGVLGVAPSASLYAVKVLGADG\
             SGQYSWIINGIEWAIANNMDVINMSLGGPSGSAALKAAVDKAVASGVVVVAAAGNEGTSGSSSTVGYPGKYPSVIAVGAVDSSNQRASFSSVGPELDVMA\
             PGVSIQSTLPGNKYGAYNGTSMASPHVAGAAALILSKHPNWTNTQVRSSLENTTTKLGDSFYYGKGLINVQAAAQ",
            &["A:64", "A:221"],
        ),
        (
            "C1",
            1,
            "IPEYVDWRQKGAVTPVKNQGSCGSCWAFSAVVTIEGIIKIRTGNLNQYSEQELLDCDRRSYGCNGGYPWSALQLVAQYGIHYRNTYPYEGVQRYCRSREK\
             GPYAAKTDGVRQVQPYNQGALLYSIANQPVSVVLQAAGKDFQLYRGGIFVGPCGNKVDHAVAAVGYGPNYILIKNSWGTGWGENGYIRIKRGTGNSYGVC\
             GLYTSSFYPVKN",
            &["A:25", "A:159"],
        ),
        (
            "A1",
            1,
            "IGDEPLENYLDTEYFGTIGIGTPAQDFTVIFDTGSSNLWVPSVYCSSLACSDHNQFNPDDSSTFEATSQELSITYGTGSMTGILGYDTVQVGGISDTNQI\
             FGLSETEPGSFLYYAPFDGILGLAYPSISASGATPVFDNLWDQGLVSQDLFSVYLSSNDDSGSVVLLGGIDSSYYTGSLNWVPVSVEGYWQITLDSITMD\
             GETIACSGGCQAIVDTGTSLLTGPTSAIANIQSDIGASENSDGEMVISCSSIASLPDIVFTINGVQYPLSPSAYILQDDDSCTSGFEGMDVPTSSGELWI\
             LGDVFIRQYYTVFDRANNKVGLAPVA",
            &["A:32", "A:215"],
        ),
        (
            "A1",
            1,
            "PQITLWQRPLVTIKIGGQLKEALLDTGADDTVLEEMSLPGRWKPKMIGGIGGFIKVRQYDQILIEICGHKAIGTVLVGPTPVNIIGRNLLTQIGCTLNF",
            &["A:25", "B:25"],
        ),
        (
            "M10",
            99,
            "RFVLTEGNPRWEQTHLTYRIENYTPDLPRADVDHAIEKAFQLWSNVTPLTFTKVSEGQADIMISFVRGDHRDNSPFDGPGGNLAHAFQPGPGIGGDAHFD\
             EDERWTNNFREYNLHRVAAHELGHSLGLSHSTDIGALMYPSYTFSGDVQLAQDDIDGIQAIYG",
            &["A:218", "A:219"],
        ),
        (
            "M14",
            1,
            "ARSTNTFNYATYHTLDEIYDFMDLLVAEHPQLVSKLQIGRSYEGRPIYVLKFSTGGSNRPAIWIDLGIHSREWITQATGVWFAKKFTEDYGQDPSFTAIL\
             DSMDIFLEIVTNPDGFAFTHSQNRLWRKTRSVTSSSLCVGVDANRNWDAGFGKAGASSSPCSETYHGKYANSEVEVKSIVDFVKDHGNFKAFLSIHSYSQ\
             LLLYPYGYTTQSIPDKTELNQVAKSAVAALKSLYGTSYKYGSIITTIYQASGGSIDWSYNQGIKYSFTFELRDTGRYGFLLPASQIIPTAQETWLGVLTI\
             MEHTVNN",
            &["A:69", "A:72", "A:196"],
        ),
    ];

    /// In each whole enzyme the patterns fit at the catalytic residues that its crystal structure shows, and nowhere
    /// else.
    ///
    /// All residues stand together here, so the patterns alone decide.
    #[test]
    fn catalytic_residues_of_whole_enzymes_are_those_of_crystal_structures() {
        for (family, first, sequence, residues) in ENZYMES {
            let last = first + sequence.len() as i64;
            let all: Vec<i64> = (first..last).collect();
            let mut atoms = chain("A", sequence, first, &all);
            if residues.contains(&"B:25") {
                atoms.extend(chain("B", sequence, first, &all));
            }
            assert_eq!(sites(atoms), [(family, named(residues))]);
        }
    }

    /// Their relatives by the same segments: urokinase, a peptidase of Streptomyces, furin, proteinase K, cathepsins
    /// B, L and D, the protease of HIV (of a family next to A1), ADAM17 and carboxypeptidase B.
    #[test]
    fn relatives_are_detected_by_the_same() {
        for (family, segments) in [
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
            let names = ["A", "B"].iter().zip(segments);
            let near: Vec<i64> = (1..20).collect();
            let atoms = names.map(|(name, segment)| chain(name, segment, 1, &near));
            let found = sites(atoms.collect::<Vec<_>>().concat());
            let families: Vec<&str> = found.iter().map(|(family, _)| *family).collect();
            assert_eq!(families, [family], "{segments:?}");
        }
    }

    /// Residues in separate chains, as in the activated form; the serine mutated, modified or left out; and two copies,
    /// whose residues go with the nearer.
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
        let lysozyme = "KVFGRCELAAAMKRHGLDNYRGYSLGNWVCAAKFESNFNTQATNRNTDGSTDYGILQINSRWWCNDGRTPGSRNLCNIPCSALLSSD\
            ITASVNCAKKIVSDGNGMNAWVAWRGTDVQAWIRGCRL";
        let all: Vec<i64> = (1..130).collect();
        assert_eq!(sites(chain("A", lysozyme, 1, &all)), []);
        let mut atoms = chain("A", "AAHELGHSLGLSHS", 216, &[218, 219]);
        atoms.retain(|atom| atom.residue_number != 218 || atom.name != "CA");
        assert_eq!(sites(atoms), []);
        assert_eq!(sites(Vec::new()), []);
    }

    #[test]
    fn the_table_is_read() {
        let families = parse(TABLE).unwrap();
        let names: Vec<&str> = families.iter().map(|family| family.name.as_str()).collect();
        assert_eq!(names, ["S1", "S8", "C1", "A1", "M10", "M14"]);
        let serine = &families[0].anchors[1];
        assert_eq!(serine.patterns[0], ["G", "D", "", "G", "GS"]);
        assert_eq!(serine.patterns[1].len(), 4);
        assert_eq!(serine.catalytic, [2]);
        assert_eq!(families[5].anchors[0].catalytic, [0, 3]);
    }

    #[test]
    fn a_row_that_cannot_be_read_is_refused() {
        let families = |row: &str| {
            parse(&format!(
                "# comment\nfamily,known_by,patterns,catalytic\nS1,a,H-x,1\n{row}\n"
            ))
        };
        assert!(families("S1,trypsin,H-E,2").is_some());
        for row in [
            "S1,trypsin,H-E,3",
            "S1,trypsin,H-E | H,2",
            "S1,trypsin,H-E,one",
            "S1,trypsin,H-E,",
            "S1,trypsin,H--E,1",
            "S1,trypsin,H-ST,1",
            "S1,trypsin,H-[St],1",
            "S1,trypsin,H-E",
        ] {
            assert_eq!(families(row), None, "{row}");
        }
    }
}
