//! Predictions as B values: an amino acid's is the mean over its heavy atoms. Predictors rate no ions, glycans,
//! cofactors and nucleic acids, whose B values remain those of the crystal.

use knotdock_structures::molecule::Molecule;

use super::{Prediction, PredictionFault, is_probability};
use crate::table_text::named_columns::{AtLine, listed};

/// The predictions of a molecule, amino acid by amino acid.
pub(super) fn read(molecule: &Molecule) -> Result<Vec<Prediction>, AtLine<PredictionFault>> {
    let atoms = &molecule.atoms;
    let (mut predictions, mut outside): (Vec<Prediction>, Vec<String>) = Default::default();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let chains = molecule.peptide_chains();
    let residues = chains
        .iter()
        .flat_map(|chain| chain.residues.iter().map(|residue| (chain.name, residue)));
    for (chain, residue) in residues {
        let is_heavy = |at: &usize| !atoms[*at].is_hydrogen();
        let heavy: Vec<usize> = residue.atoms.clone().filter(is_heavy).collect();
        if heavy.is_empty() {
            continue;
        }
        let values = || heavy.iter().map(|&at| atoms[at].b_factor);
        (low, high) = values().fold((low, high), |(low, high), value| {
            (value.min(low), value.max(high))
        });
        if values().all(is_probability) {
            let mean = values().sum::<f64>() / heavy.len() as f64;
            predictions.push((heavy, mean));
        } else {
            let chain = if chain.is_empty() { "_" } else { chain };
            outside.push(format!("{chain}:{}", residue.number));
        }
    }
    if !outside.is_empty() {
        let fault = PredictionFault::BValues {
            outside: outside.len(),
            residues: listed(outside.iter().map(String::as_str)),
            of: outside.len() + predictions.len(),
            low,
            high,
        };
        return Err(fault.in_file());
    }
    if predictions.is_empty() {
        return Err(PredictionFault::NoAminoAcid.in_file());
    }
    Ok(predictions)
}

#[cfg(test)]
mod tests {
    use super::*;
    use knotdock_structures::molecule::{InputSpec, ReadOptions, read_bytes};

    fn molecule(b_values: [f64; 4]) -> Molecule {
        let rows = [
            ("ATOM  ", " CA ", "GLY", 1, " C"),
            ("ATOM  ", " CB ", "ALA", 2, " C"),
            ("ATOM  ", " CA ", "ALA", 2, " C"),
            ("HETATM", "CA  ", " CA", 3, "CA"),
        ];
        let line = |((record, name, residue, number, element), b): ((_, _, _, _, _), f64)| {
            format!(
                "{record}    1 {name} {residue} A{number:>4}    {0:8.3}{0:8.3}{0:8.3}  1.00{b:6.2}          {element}\n",
                4.0 * b
            )
        };
        let text: String = rows.into_iter().zip(b_values).map(line).collect();
        let options = ReadOptions::default();
        read_bytes(&InputSpec::whole("x.pdb"), text.into(), &options).unwrap()
    }

    /// A calcium ion with its crystal's B value of 25 stopped a docking with predictions for every amino acid.
    #[test]
    fn ions_are_no_predictions() {
        let molecule = molecule([0.25, 0.5, 1.0, 25.0]);
        assert_eq!(molecule.atoms.len(), 4);
        let expected = [(vec![0], 0.25), (vec![1, 2], 0.75)];
        assert_eq!(read(&molecule).unwrap(), expected);
    }

    #[test]
    fn residues_out_of_range_are_named() {
        let fault = read(&molecule([0.25, 0.5, 7.0, 25.0])).unwrap_err().fault;
        assert_eq!(
            fault.to_string(),
            "the B values of 1 of 2 amino acids are no probabilities, which run from 0 to 1: A:2; all run from 0.25 to 7"
        );
        assert!(!fault.remedy().is_empty());
        let mut ion = molecule([0.25; 4]);
        ion.atoms.drain(..3);
        assert_eq!(read(&ion).unwrap_err().fault, PredictionFault::NoAminoAcid);
    }
}
