"""Types of the options of `knotdock.dock`. Written by python/tools/make_options.py."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict


class DockOptions(TypedDict, total=False):
    """Options of every run."""

    waters: str | float | Sequence[object]
    """Waters: drop or keep. [default: drop]"""

    hetatm: str | float | Sequence[object]
    """Other HETATM records: no-additives, keep or drop. no-additives drops known buffer and cryo additives.
    keep keeps all. drop leaves only modified amino acids. [default: no-additives]"""

    drop_residue: str | Sequence[str]
    """Leave out the residues of these names, such as an inhibitor in the binding site. ATOM and HETATM records
    alike. Several names have commas between, or the option is given again."""

    hydrogens: str | float | Sequence[object]
    """Hydrogens: drop or keep. drop: united-atom radii stand for them. keep: a molecule that has some gets all-
    atom radii. [default: drop]"""

    altloc: str | float | Sequence[object]
    """Alternate location of each residue: occupancy, or a name such as A. occupancy takes the best occupied
    one. A name is taken where the residue has it. [default: occupancy]"""

    model: float | str
    """Model of a file that has several: 1 is the first, whatever number it carries. all reads all models as one
    molecule, as of a biological assembly (.pdb1). Chain A of its second model is then called A-2. [default:
    1]"""

    assembly: str | float | Sequence[object]
    """Build this biological assembly of a file that has it, such as 1. Copies of chain A are called A-2, A-3
    and so on, and FILE:A,A-2 picks them."""

    min_plddt: str | float | Sequence[object]
    """Leave out residues of a predicted model with a pLDDT below this, 0 to 100. 50 leaves out what is likely
    disordered. If neither file is known as a prediction, B values that can be pLDDT are taken for it."""

    sample_grid: str | float | Sequence[object]
    """Nodes of the grid on which each mesh is sampled, as 2^18 or 262144 [default: 2^18]."""

    sample_weights: Literal["fitted", "unit"]
    """Weights of the balls of meshes: fitted or unit [default: fitted]. fitted: the summed bumps come closest
    to one inside and to zero outside. unit: one each."""

    sampler: Literal["lattice", "bi"]
    """How a mesh becomes balls: lattice or bi [default: lattice]. lattice: balls of one radius. bi: the balls
    of Behandish and Ilieş' Algorithm 1, which count by volume."""

    effects: str | float | Sequence[object]
    """Effects that score: auto, or names with commas between. auto takes the effects that the inputs call for.
    The names are shape (always on), electrostatics, contact and restraint. [default: auto]"""

    lambda_: float | str
    """Penalty of overlap against the reward of contact. [default: 9]"""

    offset: float | str
    """Depth r0 of the skin. For meshes it is the gap that is looked for between the parts. Its default is then
    twice the eps of both parts' sampling, and at most twice the smaller feature size. The sampler `lattice`
    searches 0.65 of that too, and keeps the better gap, unless --offset, --resolution, --pass-length, --spacing
    or --budget is given. [default: 2.2]"""

    alpha: float | str
    """Exponent of the bump kernel: large values harden the balls, `inf` makes them sharp. [default: 2]"""

    resolution: float | str
    """Finest detail that is ranked: the low-pass ends at one cycle per this length. For meshes the default is
    2.045 times the offset. [default: 4.5]"""

    pass_length: str | float | Sequence[object]
    """Coarsest detail that the low-pass touches [default: 2 times the resolution]. It leaves whole what is
    below one cycle per this length, which is at least a hundredth above the resolution."""

    spacing: str | float | Sequence[object]
    """Spacing of the translation grid [default: half the resolution, or finer where the tolerance needs it]."""

    tolerance: float | str
    """Error of the fast path that is allowed, as a share of the best score. A smaller one also lengthens the
    window of the kernel. Exact scores of runs with different tolerances therefore differ. [default: 0.01]"""

    core_weight: float | str
    """Weight in shape of atoms that no water reaches, against 1 for the others. [default: 1]"""

    electrostatics_weight: float | str
    """Weight of the electrostatic energy: score per kcal/mol. [default: 24]"""

    contact_weight: float | str
    """Weight of the contact potential: score per RT. [default: 2]"""

    restraint_weight: float | str
    """Cost of a contact of a blocked atom: score. [default: 1]"""

    fine_contact_weight: float | str
    """Weight of the fine contact potential, which scores poses where the contact effect is on: score per RT; 0
    leaves the term out. [default: 2]"""

    atom_pair_weight: float | str
    """Weight of the atom pair potential, which scores poses where the contact effect is on: score per RT; 0
    leaves the term out. [default: 1]"""

    relaxed_weight: float | str
    """Weight of the atom pair potential with a penalty on overlap, after a rigid move of at most 2 Å; it scores
    poses where the contact effect is on: score per RT; 0 leaves the term out. [default: 3]"""

    active_weight: float | str
    """Score of a pose in which all active residues are in contact; other poses get their share of it: score; 0
    leaves the term out. [default: 2000]"""

    unresolved_weight: float | str
    """Cost of an atom where unresolved residues of the other side are, in gaps of a chain or past its termini,
    times the share of their conformers there: score; 0 leaves the term out. [default: 3]"""

    termini_weight: float | str
    """Cost of an atom near a terminus of its chain, or near a gap in it, that is in contact with the other
    side: score; 0 leaves the term out. [default: 2]"""

    violation_weight: float | str
    """Cost of each Å by which a pose violates the distance restraints: score per Å; 0 leaves the term out.
    [default: 400]"""

    interface_weight: float | str
    """Score of a residue in contact for each nat by which its log-odds to be in the interface exceed those of
    the mean: score per nat; 0 leaves the term out. [default: 5]"""

    membrane_weight: float | str
    """Cost of each Å by which a pose lies in the membrane: score per Å; 0 leaves the term out. [default: 50]"""

    contact_potential: str | os.PathLike[str]
    """Contact potential in place of the program's own. A table as scripts/potentials/contact_potential.py
    writes it."""

    fine_contact_potential: str | os.PathLike[str]
    """Fine contact potential in place of the program's own. A table as scripts/potentials/contact_potential.py
    --fine writes it."""

    atom_pair_potential: str | os.PathLike[str]
    """Atom pair potential in place of the program's own. A table as scripts/potentials/atom_pair_potential.py
    writes it."""

    ph: float | str
    """pH at which charges are assigned. [default: 7]"""

    antibody: Literal["cdrs", "whole"]
    """What may touch of an antibody: cdrs or whole. Antibodies are detected from their sequence. cdrs: the
    complementarity-determining regions and what lies within 5 Å of them. whole: all of it. [default: cdrs]"""

    block_receptor: str | float | Sequence[object]
    """Residues of the receptor that are not in contact, such as H:1-50,52A,L. H:1-50 is a range with all that
    is inserted in it, 52A an inserted residue, L a chain. A chain without a name is _. After a residue its
    chain's name may be left out, unless another chain has the residue's name."""

    block_ligand: str | float | Sequence[object]
    """Residues of the ligand that are not in contact. Written as those of --block-receptor."""

    active_receptor: str | float | Sequence[object]
    """Residues of the receptor that are thought to be in contact, such as A:57,189-195. Poses that touch them
    rank higher, by terms.active_weight. In the search each contact of theirs earns a 250th of that, divided by
    their number."""

    active_ligand: str | float | Sequence[object]
    """Residues of the ligand that are thought to be in contact. Written as those of --active-receptor."""

    site_receptor: str | float | Sequence[object]
    """Residues of the receptor among which the ligand binds, such as an epitope and its surroundings. They are
    active, and all other residues of the receptor are blocked. Written as those of --block-receptor."""

    site_ligand: str | float | Sequence[object]
    """Residues of the ligand among which the receptor binds. They are active, and all other residues of the
    ligand are blocked."""

    restraints: str | os.PathLike[str]
    """Distances that are known between receptor and ligand: a table, or a .tbl of HADDOCK and CNS. The columns
    of the table are receptor, ligand, lower, target, upper and group. Residues are written as A:57, atoms as
    A:57.CA. Poses that cannot satisfy the distances are not searched."""

    restraints_need: str | float | Sequence[object]
    """How many of the restraints a pose has to satisfy: a number, or a share such as 60%. Ask for fewer than
    all if some may be false. [default: 100%]"""

    tbl_bounds: Literal["widened", "written"]
    """Upper bounds of a .tbl: widened for the hydrogens that they count, or as written. HADDOCK sums over
    hydrogens, which are dropped here. widened: 2 Å is 2.78 Å between heavy atoms. Selections without hydrogens,
    such as name CA, keep their bounds. [default: widened]"""

    crosslink: str | float | Sequence[object]
    """Reagent of cross-links: DSS or BS3. Rows of --restraints without an upper bound get that of the reagent,
    between CA atoms. DSS and BS3: 30 Å."""

    interface_receptor: str | os.PathLike[str]
    """How likely each residue of the receptor is in the interface: a table, or bfactor. The columns of the
    table are chain, residue and probability, as a predictor gives them. bfactor reads the B values of the
    receptor's file. Poses that touch the likely residues rank higher, by terms.interface_weight."""

    interface_ligand: str | os.PathLike[str]
    """The same of the ligand."""

    membrane: str | float | Sequence[object]
    """A membrane that no atom of the other molecule enters: receptor, ligand or two heights z. receptor or
    ligand: that file marks the planes as OPM and PPM do. LOW,HIGH: the lowest and highest z in Å of the
    receptor's file (--membrane=-15,15). Poses in it are not searched. What lies between the samples costs
    terms.membrane_weight."""

    peptidase_weight: float | str
    """Score of a pose that touches the active site of a peptidase; 0 turns it off. A pose that touches some of
    the catalytic residues gets that share of it. Peptidases are detected from their sequence. This counts if
    the contact effect is on, no residue is active, and the other molecule is neither peptidase nor antibody.
    [default: 500]"""

    rotations: float | str
    """Rotations of the ligand, spread evenly over all: their number, or the angle between them, such as 15deg.
    An angle stands for a number, 3600 (15/D)^3, so that 6deg gives 56,250. By default a small ligand has fewer
    than 3600: 3600 (R/14)^3 if its radius of gyration R is below 14 Å, 1000 at the least. With --symmetry the
    option counts axes, by default 900 over half a sphere or 90 across a ring's own. [default: 3600]"""

    fine_rotations: str | float | Sequence[object]
    """Search again, among this many rotations, about the best: a number or an angle. Their peaks take the place
    of the best rotations' own. Meshes have 30,000, of which a share of 0.2 is searched, unless this option,
    --rotations, --fine-share or --budget is given."""

    fine_share: float | str
    """Share of the finer rotations that are searched. [default: 0.05]"""

    precision: Literal["single", "double"]
    """Floating-point type of the search: single or double. single allows tolerances down to 1e-4, double down
    to 1e-6. What is reported is in double precision either way. [default: single]"""

    engine: Literal["cpu", "gpu", "auto"]
    """What computes the correlations: cpu; gpu, a graphics processor; or auto, which takes one if it can. auto
    takes the CPU if there is no graphics processor, if it fails (with a warning), or if other options need the
    CPU; --budget, --accuracy and tradeoff refuse it. A graphics processor works through Vulkan, Metal or
    Direct3D 12, in single precision. If there are several, the environment variable WGPU_ADAPTER_NAME names
    one. [default: cpu]"""

    per_rotation: float | str
    """Peaks kept of each rotation. [default: 3]"""

    poses: float | str
    """Poses kept of all rotations. [default: 2000]"""

    refine: str | float | Sequence[object]
    """Best poses to refine off the grid [default: 600 with shape alone, else none]. Beside other effects
    tighter fits make no better a ranking."""

    symmetry: str | float | Sequence[object]
    """Dock copies of RECEPTOR into a ring: C2, C3 ..., or two rings: D2, D3 ... LIGAND is left out. C2, C3 and
    so on put 2, 3 and more copies about an axis. If RECEPTOR is itself a ring of 2, 3 or more copies, D2, D3
    and so on dock two such rings face to face. The option --rotations then counts axes, and each pose is where
    the second copy or ring goes. Residues that --block-receptor and --active-receptor name are those of every
    copy, or of both rings."""

    cluster_radius: float | str
    """RMSD within which poses form a cluster, over the ligand's CA atoms. The default is 9 if active residues,
    a site or restraints are given. For meshes the radius is over the sample points, and the default is 2.273
    times the offset. [default: 5]"""

    sharp: Literal["auto", "on", "off"]
    """Fit the best poses at atomic resolution: auto, on or off. auto ranks by these fits if one stands out as
    an exact fit does. on always ranks by them. off makes none. [default: auto]"""

    no_cluster: bool
    """List every pose, not the best one of each cluster. Refined poses within a step of the search of a better
    one are left out."""

    exact: float | str
    """Rows of poses.csv with exact scores: the best COUNT, or all. An exact score costs as much as a rotation
    of the search. Rows come in the order of the fast path's scores, whose error each run measures; those beyond
    COUNT have no exact columns. With --no-cluster, and in ensembles, all rows have them and are ordered by
    them. [default: 200]"""

    write_top: float | str
    """Complexes to write to top/. [default: 10]"""

    raw: bool
    """Write complexes as they were searched, with the clashes that a search forgives. By default their side
    chains are packed, and atoms that overlap are moved apart (`knotdock refine`), unless --budget is given.
    Ranks and scores are of the poses that were searched either way."""

    diagnostics: bool
    """Add the diagnostic columns to poses.csv."""

    no_report: bool
    """Write no report.html."""

    threads: str | float | Sequence[object]
    """Threads [default: all hardware threads]."""

    memory: str | float | Sequence[object]
    """Memory that the whole run may take, such as 800M or 4GiB [default: 80% of what is free]. Program, reading
    and sampling included. M is 10^6 bytes, GiB 2^30."""


class DockArguments(DockOptions, total=False):
    """Options of the command line that are not of every run."""

    preset: Literal["fast", "default", "thorough", "shape"]
    """Options by a name."""
    config: str | os.PathLike[str] | Sequence[str | os.PathLike[str]]
    """Options from files in TOML, or from lines such as `terms.contact_weight=1`; later ones win."""
    native: Any
    """The known complex, as inputs of `dock`."""
    native_receptor: Any
    """The receptor of the known complex, in a file of its own."""
    native_ligand: Any
    """The ligand of the known complex, in a file of its own."""
    native_chains: str | Sequence[str]
    """Chains of the known complex."""
    receptor_models: str
    """Models of the receptor's file that are docked: `all` or `1,3,5-10`."""
    ligand_models: str
    """Models of the ligand's file that are docked."""
    receptor_also: Any
    """A further conformation of the receptor."""
    ligand_also: Any
    """A further conformation of the ligand."""
    accuracy: float
    """Take the cheapest setting whose error is expected to be within this share of the best score."""
    budget: str | float
    """End within a time, such as `5s`."""
    force: bool
    """Replace the run in the directory, once the new one is done."""
