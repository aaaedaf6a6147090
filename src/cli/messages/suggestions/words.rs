//! The words, each with what to use here.

/// Words for one thing, and what to use here.
pub(in crate::cli) struct Suggestion {
    /// Words, without leading dashes, `-` between parts.
    pub words: &'static [&'static str],
    /// What to use, in a sentence without a full stop.
    pub instead: &'static str,
}

const fn suggestion(words: &'static [&'static str], instead: &'static str) -> Suggestion {
    Suggestion { words, instead }
}

/// Words of options.
pub(in crate::cli) const OPTIONS: [Suggestion; 26] = [
    suggestion(
        &[
            "restraint",
            "restraints-file",
            "air",
            "airs",
            "ambig",
            "ambig-fname",
            "unambig",
            "tbl",
            "distance-restraints",
            "contacts",
            "crosslinks",
            "xl",
        ],
        "known distances come from `--restraints FILE`, a table or a .tbl (cross-links with `--crosslink DSS`); residues \
         known to be in contact are named with `--active-receptor A:57,A:189-195` and `--active-ligand`",
    ),
    suggestion(
        &[
            "active",
            "active-residues",
            "attract-receptor",
            "attract-ligand",
            "attract",
            "attraction",
            "interface",
            "interface-residues",
            "hotspots",
            "binding-site",
            "binding-residues",
            "site",
            "passive",
            "passive-residues",
            "epitope",
            "paratope",
        ],
        "name residues that are known to be in contact with `--active-receptor` and `--active-ligand`",
    ),
    suggestion(
        &[
            "block",
            "blocked",
            "blocking",
            "exclude",
            "excluded",
            "non-interface",
            "repel",
            "mask",
        ],
        "name residues that are to stay free of contact with `--block-receptor` and `--block-ligand`",
    ),
    suggestion(
        &[
            "receptor", "ligand", "rec", "lig", "r", "l", "pdb", "pdb1", "pdb2", "input", "i",
            "mobile", "target", "static",
        ],
        "files are given without an option, the receptor first: `knotdock dock RECEPTOR LIGAND`",
    ),
    suggestion(
        &[
            "chain",
            "chains",
            "receptor-chain",
            "receptor-chains",
            "ligand-chain",
            "ligand-chains",
            "select",
            "selection",
        ],
        "chains are picked behind the file's name: `antibody.pdb:H,L`",
    ),
    suggestion(
        &[
            "cores",
            "core",
            "ncores",
            "n-cores",
            "nproc",
            "ncpu",
            "cpu",
            "cpus",
            "num-threads",
            "nthreads",
            "jobs",
            "np",
            "t",
            "workers",
            "processes",
        ],
        "use `--threads N`",
    ),
    suggestion(
        &["gpu", "cuda", "device", "opencl", "vulkan", "use-gpu"],
        "use `--engine gpu`",
    ),
    suggestion(
        &[
            "seed",
            "random-seed",
            "rng-seed",
            "iniseed",
            "random",
            "deterministic",
            "reproducible",
        ],
        "no seed is needed: nothing is random, and the same input and options give the same bytes (but with --budget)",
    ),
    suggestion(
        &[
            "out",
            "outdir",
            "out-dir",
            "output-dir",
            "output-directory",
            "outfile",
            "prefix",
            "output-prefix",
            "run-dir",
            "workdir",
            "directory",
            "dir",
        ],
        "use `-o DIR`",
    ),
    suggestion(
        &["overwrite", "replace", "clobber", "f"],
        "use `--force`, which replaces an earlier run in the directory",
    ),
    suggestion(
        &["repeat", "restore", "from"],
        "use `--rerun RUN.JSON`, which repeats the run that wrote that file",
    ),
    suggestion(
        &["settings", "params", "parameters", "options", "toml"],
        "use `--config FILE.toml`, which gives options of `knotdock dock` by a file",
    ),
    suggestion(
        &["resume", "restart", "continue"],
        "one run is not resumed; `knotdock batch` called again docks only the pairs that are left",
    ),
    suggestion(
        &[
            "angle-step",
            "rotation-step",
            "rotational-step",
            "angular-step",
            "rotational-sampling",
            "sampling-angle",
            "degrees",
            "step",
        ],
        "use `--rotations 15deg`, or `--rotations N`",
    ),
    suggestion(
        &[
            "swarms",
            "glowworms",
            "steps",
            "generations",
            "population",
            "sampling",
            "samples",
            "decoys",
            "n-rotations",
            "num-rotations",
            "nrot",
            "orientations",
        ],
        "use `--rotations N` for how densely to search, and `--poses N` for how many poses to keep",
    ),
    suggestion(
        &[
            "models",
            "n-models",
            "nposes",
            "num-poses",
            "n-poses",
            "number-of-poses",
            "num-predictions",
            "top-poses",
            "nout",
            "n",
        ],
        "use `--poses N` for how many poses to keep, and `--write-top N` for how many complexes to write",
    ),
    suggestion(
        &[
            "top",
            "topn",
            "top-n",
            "save",
            "write",
            "write-pdb",
            "write-complexes",
            "n-complexes",
        ],
        "use `--write-top N`; `knotdock export RUN --rank 37` writes further complexes of a run",
    ),
    suggestion(
        &[
            "grid",
            "voxel",
            "voxel-size",
            "grid-size",
            "grid-spacing",
            "grid-step",
            "cell",
        ],
        "use `--spacing LENGTH` for the grid, or `--resolution LENGTH` for what is ranked",
    ),
    suggestion(
        &[
            "cluster",
            "clustering",
            "cluster-cutoff",
            "clust-cutoff",
            "rmsd",
            "rmsd-cutoff",
            "clustfcc",
            "clustrmsd",
        ],
        "use `--cluster-radius LENGTH`; `--no-cluster` lists every pose",
    ),
    suggestion(
        &[
            "reference",
            "reference-fname",
            "ref",
            "crystal",
            "bound",
            "truth",
            "complex",
            "known",
        ],
        "use `--native COMPLEX`, which compares each pose with a known complex",
    ),
    suggestion(
        &[
            "score",
            "scoring",
            "scoring-function",
            "energy",
            "terms",
            "potential",
            "potentials",
            "vdw",
            "elec",
            "electrostatics",
            "desolvation",
            "contact",
        ],
        "use `--effects shape,electrostatics,contact` for what scores, and `--config FILE` for its weights and potentials",
    ),
    suggestion(
        &[
            "tolerate", "softness", "soft", "overlap", "penalty", "clash", "clashes",
        ],
        "use `--lambda X`, the weight of overlap against contact",
    ),
    suggestion(
        &["ensemble", "multi-model", "nmr", "conformers"],
        "use `--receptor-models all` or `--ligand-models all` for the models of a file, and `--receptor-also FILE` or `--ligand-also FILE` for further files",
    ),
    suggestion(
        &[
            "symm",
            "cn",
            "c2",
            "homodimer",
            "oligomer",
            "multimer",
            "ncs",
        ],
        "use `--symmetry C2` (or C3, D2 ...) with one file",
    ),
    suggestion(
        &[
            "time",
            "timeout",
            "time-limit",
            "max-time",
            "walltime",
            "deadline",
        ],
        "use `--budget TIME`, such as `--budget 5min`",
    ),
    suggestion(
        &[
            "water",
            "keep-water",
            "remove-water",
            "no-water",
            "keep-het",
            "het",
            "hetatms",
            "noh",
            "no-hydrogens",
            "keep-hydrogens",
            "addh",
        ],
        "use `--waters`, `--hetatm` or `--hydrogens`, each with keep or drop",
    ),
];

/// Words of commands.
pub(in crate::cli) const COMMANDS: [Suggestion; 10] = [
    suggestion(
        &[
            "docking", "run", "search", "predict", "global", "zdock", "megadock",
        ],
        "use `knotdock dock RECEPTOR LIGAND`",
    ),
    suggestion(
        &[
            "rmsd",
            "capri",
            "caprieval",
            "dockq",
            "eval",
            "analyze",
            "analyse",
            "analysis",
            "compare",
            "assess",
            "validate",
        ],
        "use `knotdock evaluate RUN --native COMPLEX`",
    ),
    suggestion(
        &["rescore", "rescoring", "scoring", "energy"],
        "use `knotdock score RECEPTOR LIGAND --pose QW,QX,QY,QZ,TX,TY,TZ`",
    ),
    suggestion(
        &[
            "info", "check", "prepare", "prep", "clean", "read", "summary", "topoaa", "setup",
        ],
        "use `knotdock inspect FILE`; files need no preparation",
    ),
    suggestion(
        &[
            "build", "complex", "extract", "generate", "decoygen", "create", "write", "pdb", "top",
        ],
        "use `knotdock export RUN --rank 37,40-45`",
    ),
    suggestion(
        &["screen", "screening", "table", "pairs", "many", "benchmark"],
        "use `knotdock batch PAIRS.CSV`",
    ),
    suggestion(
        &[
            "voxelize",
            "voxelise",
            "spheres",
            "sphere",
            "decompose",
            "mesh",
            "cover",
            "pack",
        ],
        "use `knotdock sample MESH`",
    ),
    suggestion(
        &["sweep", "accuracy", "convergence", "scan"],
        "use `knotdock tradeoff RECEPTOR LIGAND`",
    ),
    suggestion(
        &["rerun", "repeat", "resume", "restart"],
        "use `knotdock dock --rerun RUN.JSON`",
    ),
    suggestion(
        &["tune", "bench", "speed", "timing"],
        "use `knotdock calibrate`, which measures how fast this machine is",
    ),
];
