//! Side chains of an interface, packed anew for one pose.
//!
//! [`Repacker`] takes the side chains near the other molecule, gives each its rotamers, and finds the states of least
//! energy together. Bond lengths, bond angles and all other atoms stay. The present state of every side chain is one
//! of its states, so the energy never rises; a side chain moves only where that gains more than
//! [`RepackOptions::threshold`].
//!
//! # Energy
//!
//! A sum of three terms, in units of about a kcal/mol:
//!
//! - **Contacts** of heavy atoms within 6 Å: 0.1 (x^12 - 2 x^6), at most 10, with x = (r + s) / d. Here r and s are the
//!   atoms' radii ([`knotdock_structures::molecule::Atom::radius`]), d their distance. The form is Lennard-Jones', with
//!   its least where the balls touch. It is bounded because states are few and the backbone stays.
//! - **Hydrogen bonds** of donors and acceptors: 1.5 (5 y^12 - 6 y^10) g h where negative, with y = 2.9 Å / d. The form
//!   is DREIDING's, Mayo, Olafson & Goddard, J. Phys. Chem. 94 (1990) 8897-8909, here for heavy atoms alone. At each
//!   atom g or h is cos^2 of the angle between the bond and its ideal direction, 0 past a right angle. With one bonded
//!   neighbour the ideal angle at the atom is 120 degrees; with more the bond lies opposite to them.
//! - **Rotamers**: -w times the logarithm of the probability relative to the backbone's most probable rotamer
//!   ([`knotdock_structures::molecule::log_probability`]).
//!
//! Pairs within a residue, and those with the C before and the N after it, are left to the third term, since they decide
//! how frequent rotamers are. Water is not in the energy: long side chains at the rim gain contacts too easily.
//!
//! # Search
//!
//! The first search is among the rotamers of each backbone and the present angles, with steps of 10 degrees in the
//! first two angles. Three more try steps of 8 and of 4 degrees about the result.
//!
//! In each search dead ends are eliminated, and components that share no energy are solved exactly (`packing`). Those
//! that are too entangled are annealed, with numbers that are the same in every run. Nothing depends on the number of
//! threads.

mod energy;
mod packing;
mod repack;
mod scene;
mod search;
mod sites;
#[cfg(test)]
mod tests;

pub use repack::{HeldResidue, RepackOptions, Repacked, RepackedResidue, Repacker};
