//! Gives binding numbers to the resource globals that are declared without `@group` and `@binding`.

use naga::AddressSpace;
use std::collections::BTreeSet;

/// Gives every resource global without binding numbers the next free ones of its group: group 0 for
/// imported modules, group 1 for the shader's own file. `is_imported` tells, for a byte offset in
/// the text, if it belongs to an imported module.
pub(super) fn assign_bindings(module: &mut naga::Module, is_imported: &dyn Fn(usize) -> bool) {
    let mut next = [0; 2];
    let mut taken: BTreeSet<(u32, u32)> = module
        .global_variables
        .iter()
        .filter_map(|(_, v)| v.binding.map(|b| (b.group, b.binding)))
        .collect();
    let global_variables = module.global_variables.iter();
    let handles: Vec<_> = global_variables.map(|(handle, _)| handle).collect();
    for handle in handles {
        let place = module.global_variables.get_span(handle).to_range();
        let at = place.map_or(0, |range| range.start);
        let variable = module.global_variables.get_mut(handle);
        let is_resource = matches!(
            variable.space,
            AddressSpace::Uniform | AddressSpace::Storage { .. } | AddressSpace::Handle
        );
        if !is_resource || variable.binding.is_some() {
            continue;
        }
        let group = u32::from(!is_imported(at));
        let binding = &mut next[group as usize];
        // No module has as many globals as there are numbers.
        while taken.contains(&(group, *binding)) {
            *binding += 1;
        }
        let binding = *binding;
        taken.insert((group, binding));
        variable.binding = Some(naga::ResourceBinding { group, binding });
    }
}
