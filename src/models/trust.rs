//! A word of trust for a pair of chains, by the confidence of its program, the agreement of models and the coordinates.
//!
//! Each of the three supports the interface, contradicts it, or leaves it open:
//!
//! | evidence | supports | contradicts | source of the limits |
//! |---|---|---|---|
//! | the larger of ipTM and ipSAE | [`TM_SUPPORTS`] or more | below [`TM_CONTRADICTS`] | EMBL-EBI's course on AlphaFold, for ipTM; ipSAE has the same scale |
//! | pDockQ2, or pDockQ without PAE | [`DOCKQ_SUPPORTS`] or more | below [`DOCKQ_CONTRADICTS`] | both estimate DockQ, whose classes medium and acceptable begin there (Basu & Wallner, PLoS ONE 11 (2016) e0161879) |
//! | agreement with the other models | [`AGREEMENT_SUPPORTS`] or more, of at least [`MIN_MODELS`] models | below [`AGREEMENT_CONTRADICTS`] | 500 systems of 20 AlphaFold-Multimer models (github yzqiang18-code/afm-interface-reliability): rank 1 is right in 85% of those above, 38% of those below |
//! | coordinates | | a buried area below [`MIN_BURIED`], an Sc below [`MIN_SC`], or more clashes than [`MAX_CLASHES`] per contact | met by 101, 103 and 104 of 105 crystal complexes of the protein docking benchmark 5.5, and together by 98 (of each complex the pair of chains with most contacts) |
//!
//! Confidence, of the first two, supports if one does and none contradicts; it contradicts if one does and none
//! supports. The word is
//!
//! - `likely` if confidence and agreement are known, one of them supports and nothing contradicts,
//! - `doubtful` if something contradicts and nothing supports,
//! - `uncertain` otherwise.
//!
//! The study gives agreement as the share of the contacts of two models that both have, |A and B| / |A or B|. Its 0.3 and
//! 0.8 are 0.46 and 0.89 of 2 |A and B| / (|A| + |B|). The word does not rank models: in the study agreement
//! distinguished systems, not the models of one.

use super::ChainPair;

/// ipTM and ipSAE from which they support an interface.
pub const TM_SUPPORTS: f64 = 0.8;
/// ipTM and ipSAE below which they contradict an interface.
pub const TM_CONTRADICTS: f64 = 0.6;
/// Estimate of DockQ from which it supports an interface.
pub const DOCKQ_SUPPORTS: f64 = 0.49;
/// Estimate of DockQ below which it contradicts an interface.
pub const DOCKQ_CONTRADICTS: f64 = 0.23;
/// Agreement from which it supports an interface.
pub const AGREEMENT_SUPPORTS: f64 = 0.89;
/// Agreement below which it contradicts an interface.
pub const AGREEMENT_CONTRADICTS: f64 = 0.46;
/// Fewest models whose agreement supports an interface.
pub const MIN_MODELS: usize = 5;
/// Buried area in Å^2, both sides together, below which the coordinates contradict.
pub const MIN_BURIED: f64 = 900.0;
/// Shape complementarity below which the coordinates contradict.
pub const MIN_SC: f64 = 0.5;
/// Clashes per contact above which the coordinates contradict.
pub const MAX_CLASHES: f64 = 0.1;

/// A word of trust in an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trust {
    /// Confidence and agreement are known, one supports the interface, and nothing contradicts it.
    Likely,
    /// The evidence is open, incomplete or in conflict.
    Uncertain,
    /// Something contradicts the interface, and nothing supports it.
    Doubtful,
}

impl Trust {
    /// The word in tables: `likely`, `uncertain` or `doubtful`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Likely => "likely",
            Self::Uncertain => "uncertain",
            Self::Doubtful => "doubtful",
        }
    }
}

/// Effect of a piece of evidence on the trust in an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Supports,
    Open,
    Contradicts,
}

impl Verdict {
    fn of(value: f64, contradicts: f64, supports: f64) -> Self {
        if value >= supports {
            Self::Supports
        } else if value < contradicts {
            Self::Contradicts
        } else {
            Self::Open
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Supports => "supports",
            Self::Open => "open",
            Self::Contradicts => "contradicts",
        }
    }
}

/// A word of trust with its evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Assessment {
    /// The word.
    pub trust: Trust,
    /// Verdicts of confidence, agreement and coordinates with their figures, as text.
    pub evidence: String,
}

impl Assessment {
    /// Assesses a pair of chains with its agreement with the other ones of `models`.
    pub fn of(pair: &ChainPair, agreement: Option<f64>, models: usize) -> Self {
        let (confidence, confidence_text) = confidence(pair);
        let verdict = agreement.map(|value| {
            match Verdict::of(value, AGREEMENT_CONTRADICTS, AGREEMENT_SUPPORTS) {
                Verdict::Supports if models < MIN_MODELS => Verdict::Open,
                verdict => verdict,
            }
        });
        let agreement_text = match (agreement, verdict) {
            (Some(value), Some(verdict)) => {
                format!("{} ({value:.2} of {models} models)", verdict.name())
            }
            _ => "unknown (one model)".to_owned(),
        };
        let (coordinates, coordinates_text) = coordinates(pair);
        let all = [confidence, verdict, Some(coordinates)];
        let has = |wanted: Verdict| all.contains(&Some(wanted));
        let trust = match (has(Verdict::Supports), has(Verdict::Contradicts)) {
            (true, false) if all.iter().all(Option::is_some) => Trust::Likely,
            (false, true) => Trust::Doubtful,
            _ => Trust::Uncertain,
        };
        Self {
            trust,
            evidence: format!(
                "confidence {confidence_text}; agreement {agreement_text}; coordinates {coordinates_text}"
            ),
        }
    }
}

fn larger(both: [f64; 2]) -> f64 {
    both[0].max(both[1])
}

fn confidence(pair: &ChainPair) -> (Option<Verdict>, String) {
    let ipsae = pair.scores.ipsae.map(larger);
    let (tm_name, tm) = match (pair.iptm, ipsae) {
        (Some(iptm), Some(ipsae)) if ipsae > iptm => ("ipSAE", Some(ipsae)),
        (None, Some(ipsae)) => ("ipSAE", Some(ipsae)),
        (iptm, _) => ("ipTM", iptm),
    };
    let (dockq_name, dockq) = match pair.scores.pdockq2 {
        Some(both) => ("pDockQ2", Some(larger(both))),
        None => ("pDockQ", pair.scores.pdockq),
    };
    let known = [
        (tm_name, tm, TM_CONTRADICTS, TM_SUPPORTS),
        (dockq_name, dockq, DOCKQ_CONTRADICTS, DOCKQ_SUPPORTS),
    ];
    let known: Vec<(&str, f64, Verdict)> = known
        .into_iter()
        .filter_map(|(name, value, low, high)| {
            value.map(|value| (name, value, Verdict::of(value, low, high)))
        })
        .collect();
    if known.is_empty() {
        return (None, "unknown".to_owned());
    }
    let has = |wanted: Verdict| known.iter().any(|(.., verdict)| *verdict == wanted);
    let verdict = match (has(Verdict::Supports), has(Verdict::Contradicts)) {
        (true, false) => Verdict::Supports,
        (false, true) => Verdict::Contradicts,
        _ => Verdict::Open,
    };
    let figures = known
        .iter()
        .map(|(name, value, _)| format!("{name} {value:.2}"));
    let figures = figures.collect::<Vec<_>>().join(", ");
    (Some(verdict), format!("{} ({figures})", verdict.name()))
}

fn coordinates(pair: &ChainPair) -> (Verdict, String) {
    let interface = &pair.interface;
    let contacts = interface.pairs.len();
    if contacts == 0 {
        return (Verdict::Contradicts, "contradict (no contact)".to_owned());
    }
    let buried: f64 = interface.buried.iter().sum();
    let mut faults = Vec::new();
    if buried < MIN_BURIED {
        faults.push(format!("{buried:.0} Å² buried"));
    }
    match interface.shape_complementarity {
        Some(sc) if sc >= MIN_SC => (),
        Some(sc) => faults.push(format!("Sc {sc:.2}")),
        None => faults.push("no Sc".to_owned()),
    }
    if interface.clashes as f64 > MAX_CLASHES * contacts as f64 {
        faults.push(format!(
            "{} clashes in {contacts} contacts",
            interface.clashes
        ));
    }
    match faults.is_empty() {
        true => (Verdict::Open, "fit".to_owned()),
        false => (
            Verdict::Contradicts,
            format!("contradict ({})", faults.join(", ")),
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interface::{Contact, Interface, ResidueName};
    use crate::models::scores::PairScores;

    /// A pair of chains by ipTM, ipSAE and pDockQ2, with an interface as in crystals.
    fn pair(iptm: Option<f64>, ipsae: Option<f64>, pdockq2: Option<f64>) -> ChainPair {
        let residue = ResidueName {
            chain: "A".to_owned(),
            number: "1".to_owned(),
            name: "ALA".to_owned(),
        };
        let contact = Contact {
            residues: [residue.clone(), residue],
            distance: 4.0,
            hydrogen_bonds: 0,
            hydrogen_bond_distance: None,
            salt_bridge: false,
        };
        ChainPair {
            chains: ["A", "B"].map(str::to_owned),
            sequences: ["", ""].map(str::to_owned),
            iptm,
            scores: PairScores {
                ipsae: ipsae.map(|one| [0.0, one]),
                pdockq: Some(0.3),
                pdockq2: pdockq2.map(|one| [one, 0.0]),
                ..PairScores::default()
            },
            interface: Interface {
                pairs: vec![contact; 50],
                residues: [20, 20],
                hydrogen_bonds: 0,
                salt_bridges: 0,
                clashes: 0,
                buried: [800.0, 800.0],
                shape_complementarity: Some(0.7),
            },
        }
    }

    fn trust(pair: &ChainPair, agreement: f64, models: usize) -> Trust {
        Assessment::of(pair, Some(agreement), models).trust
    }

    #[test]
    fn words_follow_from_the_verdicts() {
        let sure = pair(Some(0.9), None, Some(0.7));
        let open = pair(Some(0.7), None, Some(0.3));
        let weak = pair(Some(0.3), None, Some(0.1));
        for (pair, agreement, models, word) in [
            (&sure, 0.95, 5, Trust::Likely),
            (&sure, 0.70, 5, Trust::Likely),
            (&sure, 0.95, 4, Trust::Likely),
            (&sure, 0.20, 5, Trust::Uncertain),
            (&open, 0.95, 5, Trust::Likely),
            // Few models agree easily.
            (&open, 0.95, 4, Trust::Uncertain),
            (&open, 0.70, 5, Trust::Uncertain),
            (&open, 0.20, 5, Trust::Doubtful),
            (&weak, 0.95, 5, Trust::Uncertain),
            (&weak, 0.70, 5, Trust::Doubtful),
            (&weak, 0.20, 5, Trust::Doubtful),
        ] {
            assert_eq!(trust(pair, agreement, models), word, "{agreement} {models}");
        }
        // The limits themselves.
        assert_eq!(trust(&open, AGREEMENT_SUPPORTS, MIN_MODELS), Trust::Likely);
        assert_eq!(
            trust(&open, AGREEMENT_CONTRADICTS, MIN_MODELS),
            Trust::Uncertain
        );
    }

    /// Missing evidence limits the word, and is reported.
    #[test]
    fn likely_needs_confidence_and_agreement() {
        let single = Assessment::of(&pair(Some(0.9), None, Some(0.7)), None, 1);
        assert_eq!(single.trust, Trust::Uncertain);
        assert_eq!(
            single.evidence,
            "confidence supports (ipTM 0.90, pDockQ2 0.70); agreement unknown (one model); coordinates fit"
        );
        let mut bare = pair(None, None, None);
        bare.scores.pdockq = None;
        let bare = Assessment::of(&bare, Some(0.95), 5);
        assert_eq!(bare.trust, Trust::Uncertain);
        assert!(
            bare.evidence
                .starts_with("confidence unknown; agreement supports (0.95 of 5 models)")
        );
    }

    /// Disorder lowers ipTM but not ipSAE; pDockQ stands in for pDockQ2 without PAE.
    #[test]
    fn confidence_is_of_two_kinds() {
        let evidence = |pair: &ChainPair| Assessment::of(pair, None, 1).evidence;
        let disordered = evidence(&pair(Some(0.4), Some(0.85), Some(0.6)));
        assert!(disordered.starts_with("confidence supports (ipSAE 0.85, pDockQ2 0.60)"));
        let conflict = evidence(&pair(Some(0.9), Some(0.7), Some(0.1)));
        assert!(conflict.starts_with("confidence open (ipTM 0.90, pDockQ2 0.10)"));
        let by_plddt = evidence(&pair(None, None, None));
        assert!(by_plddt.starts_with("confidence open (pDockQ 0.30)"));
    }

    #[test]
    fn coordinates_only_contradict() {
        let sure = pair(Some(0.9), None, Some(0.7));
        let faulty = |change: fn(&mut Interface)| {
            let mut pair = sure.clone();
            change(&mut pair.interface);
            let found = Assessment::of(&pair, Some(0.95), 5);
            assert_eq!(found.trust, Trust::Uncertain);
            found.evidence
        };
        assert!(faulty(|one| one.pairs.clear()).ends_with("coordinates contradict (no contact)"));
        let small = faulty(|one| one.buried = [200.0, 200.0]);
        assert!(small.ends_with("coordinates contradict (400 Å² buried)"));
        let clashing = faulty(|one| (one.clashes, one.shape_complementarity) = (100, None));
        assert!(clashing.ends_with("coordinates contradict (no Sc, 100 clashes in 50 contacts)"));
    }
}
