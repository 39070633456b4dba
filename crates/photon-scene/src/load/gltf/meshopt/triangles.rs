//! Mode 1: triangles that share edges and vertices with those before.

use super::stream::{Stream, TRUNCATED, split, unzigzag};

/// Length of the tail, a table of frequent codes.
const TAIL: usize = 16;

/// The last 16 entries.
struct Recent<T> {
    entries: [T; 16],
    pushed: usize,
}

impl<T: Copy + Default> Recent<T> {
    fn new() -> Self {
        Self { entries: [T::default(); 16], pushed: 0 }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.pushed % 16] = entry;
        self.pushed += 1;
    }

    /// The entry pushed `age` entries before the last one.
    fn get(&self, age: usize) -> Result<T, &'static str> {
        let at = self.pushed.checked_sub(age + 1).filter(|_| age < 16);
        at.map(|at| self.entries[at % 16]).ok_or("it refers to an edge or vertex before the first one")
    }
}

struct Decoder<'a> {
    data: Stream<'a>,
    /// The next vertex that was not used yet.
    next: u32,
    /// The vertex that was last given by a difference.
    last: u32,
    edges: Recent<[u32; 2]>,
    vertices: Recent<u32>,
}

/// Decodes `count` indices, a multiple of 3.
pub(super) fn decode(bytes: &[u8], count: usize) -> Result<Vec<u32>, &'static str> {
    let (&header, rest) = bytes.split_first().ok_or(TRUNCATED)?;
    if header != 0xe1 {
        return Err("its first byte is not that of triangles");
    }
    let (mut data, table) = split(rest, TAIL)?;
    let is_valid = |entry: &u8| entry & 15 != 15 && entry >> 4 != 15;
    if !table.iter().all(is_valid) || table[14..] != [0, 0] {
        return Err("its table of codes is damaged");
    }
    let codes = data.take(count / 3)?;
    let (edges, vertices) = (Recent::new(), Recent::new());
    let mut decoder = Decoder { data, next: 0, last: 0, edges, vertices };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        let triangle = match (code >> 4, code & 15) {
            (15, low @ 14..) => decoder.explicit(low == 14)?,
            (15, low) => {
                let entry = table[usize::from(low)];
                decoder.corner_triangle(None, entry)?
            }
            (age, third) => decoder.edge_triangle(usize::from(age), third)?,
        };
        indices.extend(triangle);
    }
    decoder.data.end()?;
    Ok(indices)
}

impl Decoder<'_> {
    fn new_vertex(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    /// A vertex given by its difference to the last such one.
    fn far_vertex(&mut self) -> Result<u32, &'static str> {
        self.last = self.last.wrapping_add(unzigzag(self.data.number()?));
        Ok(self.last)
    }

    /// A triangle at a recent edge.
    fn edge_triangle(&mut self, age: usize, third: u8) -> Result<[u32; 3], &'static str> {
        let [a, b] = self.edges.get(age)?;
        let c = match third {
            0 => self.new_vertex(),
            1..=12 => self.vertices.get(usize::from(third))?,
            13 | 14 => {
                self.last = if third == 13 { self.last.wrapping_sub(1) } else { self.last.wrapping_add(1) };
                self.last
            }
            _ => self.far_vertex()?,
        };
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        if !(1..=12).contains(&third) {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle whose code follows; its first vertex is new or follows too.
    fn explicit(&mut self, is_first_new: bool) -> Result<[u32; 3], &'static str> {
        let code = self.data.byte()?;
        if code == 0 {
            self.next = 0;
        }
        let first = if is_first_new { None } else { Some(self.far_vertex()?) };
        self.corner_triangle(first, code)
    }

    /// A triangle by its first vertex, a new one if `None`, and a code of four bits for each of the two others.
    fn corner_triangle(&mut self, first: Option<u32>, code: u8) -> Result<[u32; 3], &'static str> {
        let a = match first {
            Some(first) => first,
            None => self.new_vertex(),
        };
        // Recent vertices are counted from before this triangle.
        let mut vertex = |code: u8| match code {
            0 => Ok(self.new_vertex()),
            15 => self.far_vertex(),
            _ => self.vertices.get(usize::from(code) - 1),
        };
        let (b_code, c_code) = (code >> 4, code & 15);
        let b = vertex(b_code)?;
        let c = vertex(c_code)?;
        for edge in [[b, a], [c, b], [a, c]] {
            self.edges.push(edge);
        }
        self.vertices.push(a);
        for (vertex, code) in [(b, b_code), (c, c_code)] {
            if code == 0 || code == 15 {
                self.vertices.push(vertex);
            }
        }
        Ok([a, b, c])
    }
}
