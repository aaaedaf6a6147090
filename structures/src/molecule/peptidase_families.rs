//! The families of peptidases that are told by sequence, and by what.

/// Letters allowed at each place of a stretch; none stands for any.
pub(super) type Stretch = &'static [&'static str];

/// A conserved stretch about catalytic residues.
pub(super) struct Anchor {
    /// What it may look like; of several that fit at one place the first counts.
    pub(super) stretches: &'static [Stretch],
    /// Places of the catalytic residues in it.
    pub(super) catalytic: &'static [usize],
}

/// A family of peptidases.
pub(super) struct Family {
    /// Name in MEROPS; M10 stands for all metzincins.
    pub(super) name: &'static str,
    /// An enzyme of it that the field knows.
    pub(super) known_by: &'static str,
    /// What its members have, all of it.
    pub(super) anchors: &'static [Anchor],
}

/// About the aspartates of pepsin's family, one from each half of the fold.
const ASPARTATE: Anchor = Anchor {
    stretches: &[&["LIVMFYA", "D", "TS", "G", "TSA"]],
    catalytic: &[1],
};

/// The families that are told.
pub(super) const FAMILIES: [Family; 6] = [
    Family {
        name: "S1",
        known_by: "trypsin",
        anchors: &[
            Anchor {
                stretches: &[&["ST", "A", "AGST", "H", "C"]],
                catalytic: &[3],
            },
            // Where the serine was left out of the file, for what it was bound to, its neighbour stands for it.
            Anchor {
                stretches: &[&["G", "D", "", "G", "GS"], &["G", "D", "G", "G"]],
                catalytic: &[2],
            },
        ],
    },
    Family {
        name: "S8",
        known_by: "subtilisin",
        anchors: &[
            Anchor {
                stretches: &[&["H", "G", "STN", "", "VIC", "AS", "G"]],
                catalytic: &[0],
            },
            Anchor {
                stretches: &[
                    &["G", "T", "", "MAQS", "AS", "", "PA"],
                    &["G", "T", "MAQS", "AS", "", "PA"],
                ],
                catalytic: &[2],
            },
        ],
    },
    Family {
        name: "C1",
        known_by: "papain",
        anchors: &[
            Anchor {
                stretches: &[&["Q", "", "", "C", "G", "SAC", "", "WYF"]],
                catalytic: &[6],
            },
            Anchor {
                stretches: &[&["H", "AG", "VIL"]],
                catalytic: &[0],
            },
        ],
    },
    Family {
        name: "A1",
        known_by: "pepsin",
        anchors: &[ASPARTATE, ASPARTATE],
    },
    Family {
        name: "M10",
        known_by: "collagenase",
        anchors: &[Anchor {
            stretches: &[&["H", "E", "", "", "H", "", "", "G", "", "", "H"]],
            catalytic: &[0, 1],
        }],
    },
    Family {
        name: "M14",
        known_by: "carboxypeptidase A",
        anchors: &[
            Anchor {
                stretches: &[&["H", "STAG", "", "E", "", "LIVMF", "STAG"]],
                catalytic: &[0, 3],
            },
            Anchor {
                stretches: &[&[
                    "H", "STAG", "", "", "", "LIVM", "", "", "LIVMFYW", "P", "FYW",
                ]],
                catalytic: &[0],
            },
        ],
    },
];
