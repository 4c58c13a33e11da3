//! Finds the edges that others imply: the transitive reduction of an acyclic graph.

use petgraph::{adj::UnweightedList, algo::tred::dag_transitive_reduction_closure};

/// Returns the edges that are implied, as a longer path leads from their first to their second
/// node. `edges` must be sorted and lead from smaller to greater node numbers, which are below
/// `nodes`.
pub(crate) fn implied(nodes: usize, edges: &[[usize; 2]]) -> Vec<[usize; 2]> {
    let mut graph = UnweightedList::<usize>::with_capacity(nodes);
    for _ in 0..nodes {
        graph.add_node();
    }
    for &[from, to] in edges {
        graph.add_edge(from, to, ());
    }
    let (needed, _) = dag_transitive_reduction_closure(&graph);
    let edges = edges.iter().copied();
    let edges = edges.filter(|&[from, to]| !needed.contains_edge(from, to));
    edges.collect()
}

#[cfg(test)]
mod tests {
    use super::implied;

    /// ```text
    /// 0 ─▶ 1 ─▶ 2 ─▶ 3     and 0 ─▶ 2, 0 ─▶ 3, 1 ─▶ 3; 4 stands alone
    /// ```
    #[test]
    fn an_edge_beside_a_longer_path_is_implied() {
        let edges = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
        assert_eq!(implied(5, &edges), [[0, 2], [0, 3], [1, 3]]);
        assert!(implied(3, &[[0, 1], [0, 2]]).is_empty());
        // Beyond one word of bits.
        let chain = (0..199).map(|pass| [pass, pass + 1]);
        let mut edges: Vec<_> = chain.chain([[0, 199]]).collect();
        edges.sort_unstable();
        assert_eq!(implied(200, &edges), [[0, 199]]);
    }
}
