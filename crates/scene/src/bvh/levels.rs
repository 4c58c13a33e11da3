//! Nodes of a tree by their height, the order in which a GPU fits their boxes.

use super::node::BvhNode;

/// Sorts the nodes of a tree but the root by their height, those of leaves first. `order` lists all
/// of them, each before its children; `node` returns one by its number in the tree, with `first`
/// as the number of its first child.
pub(super) fn levels(order: &[u32], node: impl Fn(u32) -> BvhNode) -> Vec<Vec<u32>> {
    let mut heights = vec![0; order.len()];
    let mut levels: Vec<Vec<u32>> = Vec::new();
    for &index in order.iter().rev() {
        let bvh_node = node(index);
        if bvh_node.count == 0 {
            let first = bvh_node.first as usize;
            heights[index as usize] = 1 + heights[first].max(heights[first + 1]);
        }
        if index != 0 {
            let height: usize = heights[index as usize];
            levels.resize_with(levels.len().max(height + 1), Vec::new);
            levels[height].push(index);
        }
    }
    levels
}
