//! Weight of a term: the option that holds it, and what it multiplies.

/// Weight of a term. The user sets it by an option.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    /// Name of the option: lower case with `-` between words, ending in `-weight`.
    pub option: &'static str,
    /// Description of the option: the quantity that the weight multiplies.
    pub help: &'static str,
    /// Unit of the weight.
    pub unit: &'static str,
    /// Value if the option is left out.
    pub default: f64,
}
