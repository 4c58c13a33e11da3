//! Facts about the adapter that a plan is made for.

/// Facts about an adapter, by which a document may choose how it does its work; its results must
/// not depend on them. Expressions read them as `adapter.software` and `adapter.subgroup_size`. The
/// default is a GPU of which nothing else is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AdapterFacts {
    /// True if the adapter runs shaders on the CPU.
    pub is_software: bool,
    /// Least number of threads of a subgroup, 0 if that is not known.
    pub subgroup_size: u32,
}
