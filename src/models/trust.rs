//! A word of trust for a pair of chains, by the confidence of its program, the agreement of models and the coordinates.
//!
//! Each of the three supports the interface, contradicts it, or leaves it open:
//!
//! | evidence | supports | contradicts |
//! |---|---|---|
//! | the larger of ipTM and ipSAE | [`TM_SUPPORTS`] or more | below [`TM_CONTRADICTS`] |
//! | pDockQ2; without PAE and ipTM, pDockQ | [`DOCKQ_SUPPORTS`] or more | below [`DOCKQ_CONTRADICTS`] |
//! | agreement with the other models | [`AGREEMENT_SUPPORTS`] or more, of at least [`MIN_MODELS`] models | below [`AGREEMENT_CONTRADICTS`] |
//! | coordinates | at least [`MIN_BURIED`] buried, an Sc of [`MIN_SC`], and at most [`MAX_CLASHES`] clashes per contact | no contact, or more clashes than contacts |
//!
//! Confidence, of the first two, supports if one does and none contradicts; it contradicts if one does and none
//! supports. The word is
//!
//! - `likely` if confidence and agreement are known, one of them supports, nothing contradicts, and the coordinates
//!   support,
//! - `doubtful` if something contradicts, and neither confidence nor agreement supports,
//! - `uncertain` otherwise.
//!
//! # Sources of the limits
//!
//! - ipTM: EMBL-EBI's online training on AlphaFold. ipSAE has the same scale, and disorder does not lower it.
//! - pDockQ2 and pDockQ estimate DockQ, whose classes acceptable and medium begin at 0.23 and 0.49 (Basu & Wallner, PLoS
//!   ONE 11 (2016) e0161879).
//! - Agreement: 500 systems of 20 AlphaFold-Multimer models each (github yzqiang18-code/afm-interface-reliability,
//!   docs/CONSISTENCY.md). Rank 1 is right in 111 of 130 systems above the one limit and in 69 of 181 below the other.
//!   The study has |A and B| / |A or B|, of the contacts of two models. Its 0.8 and 0.3 are 0.89 and 0.46 of
//!   2 |A and B| / (|A| + |B|).
//! - Coordinates: 101, 103 and 104 of 105 crystal complexes of the protein docking benchmark 5.5 meet the three limits,
//!   and 98 all of them; of each complex the pair of chains with most contacts counts.
//!
//! The word does not rank models: in the study, agreement distinguished systems, not the models of one.

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
/// Buried area in Å^2, both sides together, from which the coordinates support.
pub const MIN_BURIED: f64 = 900.0;
/// Shape complementarity from which the coordinates support.
pub const MIN_SC: f64 = 0.5;
/// Clashes per contact up to which the coordinates support.
pub const MAX_CLASHES: f64 = 0.1;

/// A word of trust in an interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trust {
    /// Confidence and agreement are known, one supports the interface, as the coordinates do, and nothing contradicts it.
    Likely,
    /// The evidence is open, incomplete or in conflict.
    Uncertain,
    /// Something contradicts the interface, and neither confidence nor agreement supports it.
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
        let known = [confidence, verdict];
        let supports = known.contains(&Some(Verdict::Supports));
        let contradicts = known.contains(&Some(Verdict::Contradicts));
        let trust = match (supports, contradicts || coordinates == Verdict::Contradicts) {
            (true, false) if !known.contains(&None) && coordinates == Verdict::Supports => {
                Trust::Likely
            }
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
        None => ("pDockQ", pair.scores.pdockq.filter(|_| tm.is_none())),
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
    let clashes = interface.clashes;
    let plural = if clashes == 1 { "" } else { "es" };
    let of_clashes = format!("{clashes} clash{plural} in {contacts} contacts");
    if clashes > contacts {
        return (Verdict::Contradicts, format!("contradict ({of_clashes})"));
    }
    let buried: f64 = interface.buried.iter().sum();
    let mut lacks = Vec::new();
    if buried < MIN_BURIED {
        lacks.push(format!("{buried:.0} Å² buried"));
    }
    match interface.shape_complementarity {
        Some(sc) if sc >= MIN_SC => (),
        Some(sc) => lacks.push(format!("Sc {sc:.2}")),
        None => lacks.push("no Sc".to_owned()),
    }
    if clashes as f64 > MAX_CLASHES * contacts as f64 {
        lacks.push(of_clashes);
    }
    match lacks.is_empty() {
        true => (Verdict::Supports, "support".to_owned()),
        false => (Verdict::Open, format!("open ({})", lacks.join(", "))),
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
            "confidence supports (ipTM 0.90, pDockQ2 0.70); agreement unknown (one model); coordinates support"
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

    /// Disorder lowers ipTM but not ipSAE; without PAE and ipTM, pDockQ counts.
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

    /// Coordinates never make an interface likely; small or badly fitting ones keep it from being so.
    #[test]
    fn coordinates_limit_the_word() {
        let found = |iptm, change: fn(&mut Interface)| {
            let mut pair = pair(Some(iptm), None, None);
            change(&mut pair.interface);
            let Assessment { trust, evidence } = Assessment::of(&pair, Some(0.7), 5);
            let (_, coordinates) = evidence.split_once("; coordinates ").unwrap();
            (trust, coordinates.to_owned())
        };
        for (change, text, words) in [
            (
                (|_| ()) as fn(&mut Interface),
                "support",
                [Trust::Likely, Trust::Uncertain],
            ),
            (
                |one| one.buried = [200.0, 200.0],
                "open (400 Å² buried)",
                [Trust::Uncertain; 2],
            ),
            (
                |one| (one.clashes, one.shape_complementarity) = (6, None),
                "open (no Sc, 6 clashes in 50 contacts)",
                [Trust::Uncertain; 2],
            ),
            (
                |one| one.clashes = 51,
                "contradict (51 clashes in 50 contacts)",
                [Trust::Uncertain, Trust::Doubtful],
            ),
            (
                |one| one.pairs.clear(),
                "contradict (no contact)",
                [Trust::Uncertain, Trust::Doubtful],
            ),
        ] {
            assert_eq!(found(0.9, change), (words[0], text.to_owned()));
            assert_eq!(found(0.7, change), (words[1], text.to_owned()));
        }
    }
}
