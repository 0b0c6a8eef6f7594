//! The order of solving, found before any number is computed: biconnected parts of the graph, and in each its blocks of links.
//!
//! In a part every row of a joint is matched with a freedom of one of its two links. A link waits for the link at the other end of each of its
//! rows; links that wait for each other in a circle are one block (Dulmage and Mendelsohn). The matching is of the links' own freedoms, not of
//! a tree's columns, since the blocks would depend on the tree.

/// A joint or a rod: the two links that it joins, and how many rows it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The links.
    pub between: [usize; 2],
    /// What it takes of the freedoms of one against the other.
    pub rows: usize,
}

impl Edge {
    /// The link at its other end.
    fn other(&self, link: usize) -> usize {
        if self.between[0] == link {
            self.between[1]
        } else {
            self.between[0]
        }
    }
}

/// Links that are solved together, and the edges that hold them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// The links, rising.
    pub links: Vec<usize>,
    /// The edges whose rows are solved, rising.
    pub edges: Vec<usize>,
}

/// Why a part has no order of solving: links that keep freedoms, or edges that hold links twice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unbalanced {
    /// Links with freedoms that no row takes, rising.
    Free(Vec<usize>),
    /// Edges with rows that no freedom is left for, rising.
    Held(Vec<usize>),
}

/// The edges of each biconnected part, rising; the parts from the root outwards.
///
/// A part is a set of edges any two of which lie on one cycle, or an edge that is on none (Hopcroft and Tarjan). Links that the root does not
/// reach are in no part.
pub fn biconnected_parts(links: usize, edges: &[Edge], root: usize) -> Vec<Vec<usize>> {
    let mut search = Search {
        edges,
        at: vec![Vec::new(); links],
        seen: vec![usize::MAX; links],
        low: vec![usize::MAX; links],
        count: 0,
        stack: Vec::new(),
        parts: Vec::new(),
    };
    for (e, edge) in edges.iter().enumerate() {
        for link in edge.between {
            search.at[link].push(e);
        }
    }
    search.visit(root, usize::MAX);
    // a part is complete before the one that leads to it
    search.parts.reverse();
    search.parts
}

/// Depth-first search for the links that join parts.
struct Search<'a> {
    edges: &'a [Edge],
    /// The edges at each link.
    at: Vec<Vec<usize>>,
    /// When each link was reached, and the earliest that is reached from beyond it.
    seen: Vec<usize>,
    low: Vec<usize>,
    count: usize,
    stack: Vec<usize>,
    parts: Vec<Vec<usize>>,
}

impl Search<'_> {
    fn visit(&mut self, link: usize, from: usize) {
        self.seen[link] = self.count;
        self.low[link] = self.count;
        self.count += 1;
        for e in self.at[link].clone() {
            let next = self.edges[e].other(link);
            if e == from || next == link {
                continue;
            }
            if self.seen[next] == usize::MAX {
                let below = self.stack.len();
                self.stack.push(e);
                self.visit(next, e);
                self.low[link] = self.low[link].min(self.low[next]);
                if self.low[next] >= self.seen[link] {
                    let mut part = self.stack.split_off(below);
                    part.sort_unstable();
                    self.parts.push(part);
                }
            } else if self.seen[next] < self.seen[link] {
                self.stack.push(e);
                self.low[link] = self.low[link].min(self.seen[next]);
            }
        }
    }
}

/// The blocks of edges among links of so many freedoms each, those first that others wait for; known links have none.
pub fn blocks(edges: &[Edge], known: &[bool], freedoms: usize) -> Result<Vec<Block>, Unbalanced> {
    let mut links: Vec<usize> = edges
        .iter()
        .flat_map(|e| e.between)
        .filter(|&l| !known[l])
        .collect();
    links.sort_unstable();
    links.dedup();
    let matching = Matching::of(edges, known, freedoms);
    let short: Vec<usize> = (0..edges.len()).filter(|&e| matching.unmatched[e] > 0).collect();
    if !short.is_empty() {
        return Err(Unbalanced::Held(short));
    }
    let idle: Vec<usize> = links
        .iter()
        .copied()
        .filter(|&l| matching.of_link[l].len() < freedoms)
        .collect();
    if !idle.is_empty() {
        return Err(Unbalanced::Free(idle));
    }
    let waits: Vec<Vec<usize>> = (0..known.len())
        .map(|link| {
            let ends = matching.of_link[link].iter().map(|&e| edges[e].other(link));
            ends.filter(|&l| !known[l]).collect()
        })
        .collect();
    let circles = circles(&links, &waits);
    Ok(circles
        .into_iter()
        .map(|mut links| {
            let mut own: Vec<usize> = links
                .iter()
                .flat_map(|&l| matching.of_link[l].iter().copied())
                .collect();
            own.sort_unstable();
            own.dedup();
            links.sort_unstable();
            Block { links, edges: own }
        })
        .collect())
}

/// Rows given to the freedoms of links.
struct Matching<'a> {
    edges: &'a [Edge],
    known: &'a [bool],
    freedoms: usize,
    /// The edge of each row that a link was given.
    of_link: Vec<Vec<usize>>,
    /// How many rows of each edge have no freedom.
    unmatched: Vec<usize>,
}

impl<'a> Matching<'a> {
    fn of(edges: &'a [Edge], known: &'a [bool], freedoms: usize) -> Self {
        let mut matching = Self {
            edges,
            known,
            freedoms,
            of_link: vec![Vec::new(); known.len()],
            unmatched: vec![0; edges.len()],
        };
        for (e, edge) in edges.iter().enumerate() {
            for _ in 0..edge.rows {
                let mut tried = vec![false; known.len()];
                if !matching.place(e, &mut tried) {
                    matching.unmatched[e] += 1;
                }
            }
        }
        matching
    }

    /// Gives a row of an edge to one of its links, from which another row may have to move on.
    fn place(&mut self, edge: usize, tried: &mut [bool]) -> bool {
        for link in self.edges[edge].between {
            if self.known[link] || std::mem::replace(&mut tried[link], true) {
                continue;
            }
            if self.of_link[link].len() < self.freedoms {
                self.of_link[link].push(edge);
                return true;
            }
            for k in 0..self.of_link[link].len() {
                let other = self.of_link[link][k];
                if self.place(other, tried) {
                    self.of_link[link][k] = edge;
                    return true;
                }
            }
        }
        false
    }
}

/// Links that wait for each other in a circle, those first that others wait for (Tarjan).
fn circles(links: &[usize], waits: &[Vec<usize>]) -> Vec<Vec<usize>> {
    struct Walk<'a> {
        waits: &'a [Vec<usize>],
        seen: Vec<usize>,
        low: Vec<usize>,
        count: usize,
        stack: Vec<usize>,
        on_stack: Vec<bool>,
        out: Vec<Vec<usize>>,
    }
    impl Walk<'_> {
        fn visit(&mut self, link: usize) {
            (self.seen[link], self.low[link]) = (self.count, self.count);
            self.count += 1;
            self.stack.push(link);
            self.on_stack[link] = true;
            for &next in &self.waits[link] {
                if self.seen[next] == usize::MAX {
                    self.visit(next);
                    self.low[link] = self.low[link].min(self.low[next]);
                } else if self.on_stack[next] {
                    self.low[link] = self.low[link].min(self.seen[next]);
                }
            }
            if self.low[link] == self.seen[link] {
                let first = self.stack.iter().rposition(|&l| l == link).unwrap_or(0);
                let circle = self.stack.split_off(first);
                for &l in &circle {
                    self.on_stack[l] = false;
                }
                self.out.push(circle);
            }
        }
    }
    let count = waits.len();
    let mut walk = Walk {
        waits,
        seen: vec![usize::MAX; count],
        low: vec![usize::MAX; count],
        count: 0,
        stack: Vec::new(),
        on_stack: vec![false; count],
        out: Vec::new(),
    };
    for &link in links {
        if walk.seen[link] == usize::MAX {
            walk.visit(link);
        }
    }
    walk.out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pins(pairs: &[[usize; 2]]) -> Vec<Edge> {
        pairs.iter().map(|&between| Edge { between, rows: 2 }).collect()
    }

    fn sizes(edges: &[Edge], links: usize) -> Vec<usize> {
        let mut known = vec![false; links];
        known[0] = true;
        let blocks = blocks(edges, &known, 3).unwrap();
        blocks.iter().map(|b| b.links.len()).collect()
    }

    // links: 0 is the ground with the crank welded to it

    #[test]
    fn a_watt_six_bar_is_two_dyads() {
        // coupler 1, rocker 2 (ternary), links 3 and 4
        let edges = pins(&[[0, 1], [1, 2], [2, 0], [2, 3], [3, 4], [4, 0]]);
        assert_eq!(sizes(&edges, 5), [2, 2]);
    }

    #[test]
    fn a_stephenson_driven_at_its_dyad_is_one_block_of_four() {
        // ternary links 1 and 2, each on the ground's link, between them links 3 and 4
        let edges = pins(&[[0, 1], [0, 2], [1, 3], [3, 2], [1, 4], [4, 2]]);
        assert_eq!(sizes(&edges, 5), [4]);
    }

    #[test]
    fn blocks_come_in_the_order_in_which_they_are_solved() {
        let edges = pins(&[[3, 4], [4, 0], [2, 3], [0, 1], [1, 2], [2, 0]]);
        let blocks = blocks(&edges, &[true, false, false, false, false], 3).unwrap();
        assert_eq!(blocks[0].links, [1, 2]);
        assert_eq!(blocks[0].edges, [3, 4, 5]);
        assert_eq!(blocks[1].edges, [0, 1, 2]);
    }

    #[test]
    fn links_that_keep_a_freedom_and_rows_that_are_too_many_are_named() {
        let open = pins(&[[0, 1], [1, 2], [2, 3], [3, 0]]);
        let known = [true, false, false, false];
        assert!(matches!(blocks(&open, &known, 3), Err(Unbalanced::Free(_))));
        let held = pins(&[[0, 1], [1, 0]]);
        assert_eq!(blocks(&held, &[true, false], 3), Err(Unbalanced::Held(vec![1])));
    }

    #[test]
    fn parts_meet_in_one_link() {
        // two rings that share link 2, and a link that hangs on it
        let edges = pins(&[[0, 1], [1, 2], [2, 0], [2, 3], [3, 4], [4, 2], [2, 5]]);
        let parts = biconnected_parts(6, &edges, 0);
        assert_eq!(parts[0], [0, 1, 2]);
        let mut others = parts[1..].to_vec();
        others.sort();
        assert_eq!(others, [vec![3, 4, 5], vec![6]]);
    }
}
