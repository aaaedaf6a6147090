"""Types of the options of `knotdock.dock`. Written by python/tools/make_options.py."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict


class DockOptions(TypedDict, total=False):
    """Options of every run."""

    waters: str | float | Sequence[object]
    """Waters: drop or keep [default: drop]"""

    hetatm: str | float | Sequence[object]
    """HETATM records but waters: no-additives drops known buffer and cryo additives, keep keeps all, drop
    leaves only modified amino acids [default: no-additives]"""

    drop_residue: str | Sequence[str]
    """Leave out the residues of these names, such as an inhibitor in the binding site, whatever their record;
    with commas between, or given again"""

    hydrogens: str | float | Sequence[object]
    """Hydrogens: drop (united-atom radii stand for them) or keep (all-atom radii for a molecule that has some)
    [default: drop]"""

    altloc: str | float | Sequence[object]
    """Alternate location of a residue: occupancy, the best occupied, or the name of one, such as A, where it is
    offered [default: occupancy]"""

    model: float | str
    """Model of a file that has several: 1 is the first, whatever number it carries. all reads all models as one
    molecule, as of a biological assembly (.pdb1). Chain A of its second model is then called A-2 [default:
    1]"""

    assembly: str | float | Sequence[object]
    """Build this biological assembly of a file that has it, such as 1; copies of chain A are called A-2, A-3
    ..., which is how FILE:A,A-2 picks them"""

    min_plddt: str | float | Sequence[object]
    """Of a predicted model leave out residues with a pLDDT below this, 0 to 100: 50 leaves out what is likely
    disordered. Where no file is known as a prediction, B values that can be pLDDT are taken for it"""

    sample_grid: str | float | Sequence[object]
    """Of meshes: nodes of the grid that each part is sampled on, as 2^18 or 262144 [default: 2^18]"""

    sample_weights: Literal["fitted", "unit"]
    """Of meshes: weights of the balls, those whose summed bumps come closest to one inside and to zero outside,
    or one [default: fitted]"""

    sampler: str | float | Sequence[object]
    """Of meshes: how a part becomes balls. lattice: balls of one radius; bi: those of Behandish and Ilieş'
    Algorithm 1, which count by volume [default: lattice]"""

    effects: str | float | Sequence[object]
    """Effects to score: auto takes those that the inputs call for; else any of shape, electrostatics, contact
    and restraint, with commas between them (shape is always on) [default: auto]"""

    lambda_: float | str
    """Penalty of overlap against the reward of contact (dimensionless) [default: 9]"""

    offset: float | str
    """Depth r0 of the skin, in Å; of meshes the gap that is looked for between the parts, by default twice the
    eps of both parts' sampling, at most twice the smaller feature size [default: 2.2]"""

    alpha: float | str
    """Exponent of the bump kernel (dimensionless): large values harden the balls, `inf` makes them sharp
    [default: 2]"""

    resolution: float | str
    """Finest detail that is ranked, in Å, of meshes in their unit as all lengths: the low-pass ends at 1/A
    cycles per Å; of meshes by default 2.045 times the offset [default: 4.5]"""

    pass_length: str | float | Sequence[object]
    """Coarsest detail that the low-pass touches, in Å: it takes nothing below 1/A cycles per Å; at least a
    hundredth above the resolution [default: 2 times the resolution]"""

    spacing: str | float | Sequence[object]
    """Spacing of the translation grid, in Å [default: half the resolution, or finer where the tolerance needs
    it]"""

    tolerance: float | str
    """Error of the fast path that is allowed, as a share of the best score. A smaller one lengthens the window
    of the kernel too, so that exact scores of runs with different tolerances differ [default: 0.01]"""

    core_weight: float | str
    """Weight in shape of atoms that no water reaches, against 1 for the others [default: 1]"""

    electrostatics_weight: float | str
    """Weight of the electrostatic energy: score per kcal/mol [default: 24]"""

    contact_weight: float | str
    """Weight of the contact potential: score per RT [default: 2]"""

    restraint_weight: float | str
    """Cost of a contact of a blocked atom: score [default: 1]"""

    fine_contact_weight: float | str
    """Weight of the fine contact potential, which scores poses where the contact effect is on: score per RT; 0
    leaves the term out [default: 2]"""

    atom_pair_weight: float | str
    """Weight of the atom pair potential, which scores poses where the contact effect is on: score per RT; 0
    leaves the term out [default: 1]"""

    relaxed_weight: float | str
    """Weight of the atom pair potential with a penalty on overlap, after a rigid move of at most 2 Å; it scores
    poses where the contact effect is on: score per RT; 0 leaves the term out [default: 3]"""

    active_weight: float | str
    """Score of a pose in which all active residues are in contact; other poses get their share of it: score; 0
    leaves the term out [default: 2000]"""

    unresolved_weight: float | str
    """Cost of an atom where unresolved residues of the other side are, in gaps of a chain or past its termini,
    times the share of their conformers there: score; 0 leaves the term out [default: 3]"""

    termini_weight: float | str
    """Cost of an atom near a terminus of its chain, or near a gap in it, that is in contact with the other
    side: score; 0 leaves the term out [default: 2]"""

    violation_weight: float | str
    """Cost of each Å by which a pose violates the distance restraints: score per Å; 0 leaves the term out
    [default: 400]"""

    interface_weight: float | str
    """Score of a residue in contact for each nat by which its log-odds to be in the interface exceed those of
    the mean: score per nat; 0 leaves the term out [default: 60]"""

    membrane_weight: float | str
    """Cost of each Å by which a pose lies in the membrane: score per Å; 0 leaves the term out [default: 50]"""

    contact_potential: str | os.PathLike[str]
    """Contact potential to use in place of the program's own, as scripts/potentials/contact_potential.py writes
    it"""

    fine_contact_potential: str | os.PathLike[str]
    """Fine contact potential to use in place of the program's own, as scripts/potentials/contact_potential.py
    --fine writes it"""

    atom_pair_potential: str | os.PathLike[str]
    """Atom pair potential to use in place of the program's own, as scripts/potentials/atom_pair_potential.py
    writes it"""

    ph: float | str
    """pH at which charges are assigned [default: 7]"""

    antibody: Literal["cdrs", "whole"]
    """What may touch of an antibody, which is detected from its sequence: cdrs, its complementarity-determining
    regions and what lies within 5 Å of them, or whole, all of it [default: cdrs]"""

    block_receptor: str | float | Sequence[object]
    """Residues of the receptor to keep free of contact: H:1-50,52,52A,L for a range with all that is inserted
    in it, a residue, an inserted one and a chain. A chain without a name is _; after a residue its chain's name
    may be left out, unless another chain is called so"""

    block_ligand: str | float | Sequence[object]
    """Residues of the ligand to keep free of contact, likewise"""

    active_receptor: str | float | Sequence[object]
    """Active residues of the receptor, thought to be in contact: poses that touch them rank higher, by
    --active-weight. In the search each contact of theirs earns a 250th of that, divided by their number"""

    active_ligand: str | float | Sequence[object]
    """Active residues of the ligand, likewise"""

    restraints: str | os.PathLike[str]
    """Distances that are known between receptor and ligand: a table (columns receptor, ligand, lower, target,
    upper, group; residues as A:57, atoms as A:57.CA) or a .tbl of HADDOCK and CNS. Poses that cannot satisfy
    them are not searched"""

    restraints_need: str | float | Sequence[object]
    """How many of the restraints a pose has to satisfy: a number, or a share such as 60%. Fewer than all, where
    some may be false [default: 100%]"""

    crosslink: str | float | Sequence[object]
    """The reagent of cross-links: rows of --restraints without an upper bound get that of its CA atoms. DSS or
    BS3: 30 Å"""

    interface_receptor: str | os.PathLike[str]
    """How likely each residue of the receptor is in the interface, as a predictor says: a table (columns chain,
    residue, probability), or bfactor for the B values of the receptor's file. Poses that touch the likely ones
    rank higher, by --interface-weight"""

    interface_ligand: str | os.PathLike[str]
    """The same of the ligand"""

    membrane: str | float | Sequence[object]
    """A membrane that no atom of the other molecule enters: receptor or ligand, whose file marks its planes as
    those of OPM and PPM do, or the lowest and highest z in Å of the receptor's file (--membrane=-15,15). Poses
    in it are not searched, but for what lies between the samples, which costs --membrane-weight"""

    peptidase_weight: float | str
    """What a pose earns in which the active site of a peptidase touches, else the share of its catalytic
    residues that does: score. Peptidases are detected from their sequence, and this counts where the contact
    effect is on, no residue is active and the other is neither peptidase nor antibody; 0 for none [default:
    500]"""

    rotations: float | str
    """Rotations of the ligand, near uniform over all: their number, or their angle. An angle such as 15deg
    stands for the field's count 3600 (15/D)^3, so that 6deg gives 56,250. With `dock --symmetry` axes, by
    default 900 over half a sphere or 90 across a ring's own [default: 3600]"""

    fine_rotations: str | float | Sequence[object]
    """Search again, among this many rotations (or this angle, likewise), about the best: their peaks take the
    place of the best rotations' own"""

    fine_share: float | str
    """Share of the finer rotations that are searched [default: 0.05]"""

    precision: Literal["single", "double"]
    """Floating-point type of the search: single or double, which allows tolerances from 1e-4 down to 1e-6. What
    is reported is in double precision either way [default: single]"""

    engine: Literal["cpu", "gpu"]
    """What correlates: cpu, or gpu, a graphics processor driven through Vulkan, Metal or Direct3D 12, in single
    precision; of several the environment variable WGPU_ADAPTER_NAME names one [default: cpu]"""

    per_rotation: float | str
    """Peaks kept of each rotation [default: 3]"""

    poses: float | str
    """Poses kept of all rotations [default: 2000]"""

    refine: str | float | Sequence[object]
    """Best poses to refine off the grid [default: 600 with shape alone, none beside other effects, where
    tighter fits make no better a ranking]"""

    symmetry: str | float | Sequence[object]
    """Dock copies of RECEPTOR, given without LIGAND, into a ring: C2, C3 and so on for 2, 3 and more copies
    about an axis. Where RECEPTOR is itself a ring of 2, 3 or more copies, D2, D3 and so on dock two such rings
    face to face. The option --rotations then counts axes, and each pose is where the second copy or ring goes.
    Residues that --block-receptor and --active-receptor name are those of every copy, or of both rings"""

    cluster_radius: float | str
    """RMSD within which poses form a cluster, in Å, over the ligand's CA atoms or a mesh's sample points; of
    meshes by default 2.273 times the offset [default: 5]"""

    sharp: Literal["auto", "on", "off"]
    """Fit the best poses at atomic resolution: auto ranks by these fits where one stands out as an exact fit
    does, on always, off never looks for them [default: auto]"""

    no_cluster: bool
    """List every pose, but for those within a step of the search of a better refined one; without this, one row
    a cluster, its best pose"""

    write_top: float | str
    """Complexes to write to top/ [default: 10]"""

    diagnostics: bool
    """Add the diagnostic columns to poses.csv"""

    no_report: bool
    """Write no report.html"""

    threads: str | float | Sequence[object]
    """Threads [default: all hardware threads]"""

    memory: str | float | Sequence[object]
    """Memory that the whole run may take, program, reading and sampling included, such as 800M (10^6) or 4GiB
    (2^30 bytes) [default: 80% of what is free]"""


class DockArguments(DockOptions, total=False):
    """Options of the command line that are not of every run."""

    config: str | os.PathLike[str]
    """Options from a file in TOML."""
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
