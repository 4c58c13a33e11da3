//! Params that change nothing.

use super::plan::Plan;
use crate::{document::params::ParamValue, link::pass::LinkedPass};

impl Plan {
    /// The params that were asked for and change nothing here: with their defaults a frame would do
    /// the same, and shaders read the same values. A `fit` of shadow maps does not, say, where the
    /// light has but one.
    pub fn idle_params(&self) -> Vec<&str> {
        let by_default = |name: &&String| {
            let others = self.with(|request| {
                request.params.remove(*name);
            });
            others.is_ok_and(|others| {
                self.values.get(*name) != others.values.get(*name) && self.does_the_same_as(&others)
            })
        };
        let asked = self.request.params.keys();
        asked.filter(by_default).map(String::as_str).collect()
    }

    /// True if a frame would do the same with another value of a param. False for a value that it
    /// cannot have.
    pub fn is_same_with(&self, name: &str, value: ParamValue) -> bool {
        self.with_param(name, value)
            .is_ok_and(|other| self.does_the_same_as(&other))
    }

    fn does_the_same_as(&self, other: &Self) -> bool {
        let resources = |plan: &Self| {
            let live = plan.schedule.lifetimes.keys();
            live.map(|id| plan.resource(*id).kind.clone())
                .collect::<Vec<_>>()
        };
        self.readable == other.readable
            && self.live().count() == other.live().count()
            && self.live().zip(other.live()).all(is_same_pass)
            && resources(self) == resources(other)
    }
}

fn is_same_pass((one, other): (&LinkedPass, &LinkedPass)) -> bool {
    let params = |pass: &LinkedPass| {
        let steps = pass.steps.iter();
        steps
            .map(|step| step.params().map(<[u8]>::to_vec))
            .collect::<Vec<_>>()
    };
    one.name.value == other.name.value
        && (one.enabled, &one.run) == (other.enabled, &other.run)
        && one.steps == other.steps
        && params(one) == params(other)
}
