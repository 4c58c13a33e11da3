//! Which edges others imply: the transitive reduction of an acyclic graph.

use std::collections::BTreeSet;

/// The edges that a longer path replaces. Every edge leads to a greater number.
pub(crate) fn implied(nodes: usize, edges: &[[usize; 2]]) -> BTreeSet<[usize; 2]> {
    let mut next: Vec<Vec<usize>> = vec![Vec::new(); nodes];
    for &[from, to] in edges {
        next[from].push(to);
    }
    let mut implied = BTreeSet::new();
    // Nodes reached from each node, one bit per node.
    let mut reached: Vec<Vec<u64>> = vec![vec![0; nodes.div_ceil(64)]; nodes];
    for from in (0..nodes).rev() {
        let mut mine = std::mem::take(&mut reached[from]);
        next[from].sort_unstable();
        for &to in &next[from] {
            if mine[to / 64] >> (to % 64) & 1 == 1 {
                implied.insert([from, to]);
                continue;
            }
            mine[to / 64] |= 1 << (to % 64);
            for (bits, more) in mine.iter_mut().zip(&reached[to]) {
                *bits |= more;
            }
        }
        reached[from] = mine;
    }
    implied
}

#[cfg(test)]
mod tests {
    use super::implied;

    /// ```text
    /// 0 ─▶ 1 ─▶ 2 ─▶ 3     and 0 ─▶ 2, 0 ─▶ 3, 1 ─▶ 3; 4 stands alone
    /// ```
    #[test]
    fn an_edge_beside_a_longer_path_is_implied() {
        let edges = [[0, 1], [1, 2], [2, 3], [0, 2], [0, 3], [1, 3]];
        let found: Vec<_> = implied(5, &edges).into_iter().collect();
        assert_eq!(found, [[0, 2], [0, 3], [1, 3]]);
        assert!(implied(3, &[[0, 1], [0, 2]]).is_empty());
        // Beyond one word of bits.
        let chain: Vec<_> = (0..199)
            .map(|pass| [pass, pass + 1])
            .chain([[0, 199]])
            .collect();
        let found: Vec<_> = implied(200, &chain).into_iter().collect();
        assert_eq!(found, [[0, 199]]);
    }
}
