//! The elements of a PLY file.

use super::colors::NO_COLOR;
use super::header::{Element, Fault, Header, Kind};
use super::layout::{Layout, Place};
use super::numbers::{Field, Numbers, existing};
use crate::load::group::NONE;

/// Colours of vertices or faces, with alpha, as numbers of the file; those without alpha have 1.
#[derive(Default)]
pub(super) struct Colors {
    pub(super) list: Vec<[f64; 4]>,
    /// Types of red and of alpha, where there are any.
    pub(super) kind: Option<Kind>,
    pub(super) alpha: Option<Kind>,
}

impl Colors {
    fn new(element: &Element, layout: &Layout) -> Self {
        let kind = |place| layout.kind(element, place);
        Self { list: Vec::new(), kind: kind(Place::Color(0)), alpha: kind(Place::Alpha) }
    }

    pub(super) fn is_given(&self) -> bool {
        self.kind.is_some() || self.alpha.is_some()
    }
}

/// All that is read.
#[derive(Default)]
pub(super) struct Body {
    pub(super) positions: Vec<[f64; 3]>,
    pub(super) normals: Vec<[f64; 3]>,
    /// With v upwards.
    pub(super) uvs: Vec<[f64; 2]>,
    pub(super) colors: Colors,
    /// Vertices of all faces, and where those of each face end.
    pub(super) corners: Vec<u32>,
    pub(super) ends: Vec<u32>,
    pub(super) face_colors: Colors,
    /// Texture coordinates of corners, and where those of each face begin; [`NONE`] without any, and beyond the end.
    pub(super) corner_uvs: Vec<[f64; 2]>,
    pub(super) uv_starts: Vec<u32>,
    /// Images of faces; may end early.
    pub(super) textures: Vec<u32>,
    /// Faces with fewer than three corners, which are not in the lists, and the first.
    pub(super) small: (usize, u64),
    /// Faces with another number of texture coordinates than of corners.
    pub(super) unmatched: usize,
    /// Numbers or bytes behind the last element.
    pub(super) rest: usize,
}

impl Body {
    /// Reads it.
    ///
    /// # Errors
    /// The line of a text, 0 otherwise, and what is wrong.
    pub(super) fn read(bytes: &[u8], header: &Header) -> Result<Self, Fault> {
        let mut body = Self::default();
        let mut numbers = Numbers::new(bytes, header.length, header.encoding);
        let vertices =
            header.elements.iter().find(|element| element.name == "vertex").map_or(0, |element| element.count);
        for element in &header.elements {
            let layout = Layout::of(element);
            match element.name.as_str() {
                "vertex" => body.vertices(&mut numbers, element, &layout)?,
                "face" => body.faces(&mut numbers, element, &layout, vertices)?,
                "tristrips" => body.strips(&mut numbers, element, &layout, vertices)?,
                _ => {
                    for index in 0..element.count {
                        numbers.begin(&element.name, index);
                        (0..element.properties.len()).try_for_each(|at| skip(&mut numbers, element, at))?;
                    }
                }
            }
        }
        body.rest = numbers.rest()?;
        Ok(body)
    }

    fn vertices<'a>(&mut self, numbers: &mut Numbers<'a>, element: &'a Element, layout: &Layout) -> Result<(), Fault> {
        let has = |place| layout.kind(element, place).is_some();
        let count = element.count as usize;
        if !has(Place::Position(0)) && count > 0 {
            return Err(("its vertices have no x, y and z".to_owned(), 0));
        }
        let of = |is_given: bool| if is_given { count } else { 0 };
        self.colors = Colors::new(element, layout);
        self.positions = vec![[0.0; 3]; count];
        self.normals = vec![[0.0; 3]; of(has(Place::Normal(0)))];
        self.uvs = vec![[0.0; 2]; of(has(Place::Uv(0)))];
        self.colors.list = vec![[1.0; 4]; of(self.colors.is_given())];
        let has_lists = element.properties.iter().any(|property| property.length.is_some());
        let stride = element.properties.iter().map(|property| property.kind.bytes()).sum();
        if let Some(rows) = numbers.rows(count, stride).filter(|_| !has_lists) {
            let fields = |part: fn(Place) -> Option<usize>| -> Vec<Field> {
                let starts = element.properties.iter().scan(0, |end, property| {
                    *end += property.kind.bytes();
                    Some((*end - property.kind.bytes(), property.kind))
                });
                let placed = starts.zip(&layout.places);
                placed.filter_map(|((from, kind), place)| Some((from, kind, part((*place)?)?))).collect()
            };
            rows.read(
                &mut self.positions,
                &fields(|place| if let Place::Position(axis) = place { Some(axis) } else { None }),
            );
            rows.read(
                &mut self.normals,
                &fields(|place| if let Place::Normal(axis) = place { Some(axis) } else { None }),
            );
            rows.read(&mut self.uvs, &fields(|place| if let Place::Uv(axis) = place { Some(axis) } else { None }));
            let channel = |place| match place {
                Place::Color(channel) => Some(channel),
                Place::Alpha => Some(3),
                _ => None,
            };
            rows.read(&mut self.colors.list, &fields(channel));
            return skip_rows(numbers, count, stride);
        }
        for index in 0..count {
            numbers.begin(&element.name, index as u64);
            for (at, place) in layout.places.iter().enumerate() {
                let number = match place {
                    Some(_) => numbers.float(element.properties[at].kind)?,
                    None => {
                        skip(numbers, element, at)?;
                        continue;
                    }
                };
                match *place {
                    Some(Place::Position(axis)) => self.positions[index][axis] = number,
                    Some(Place::Normal(axis)) => self.normals[index][axis] = number,
                    Some(Place::Uv(axis)) => self.uvs[index][axis] = number,
                    Some(Place::Color(channel)) => self.colors.list[index][channel] = number,
                    Some(Place::Alpha) => self.colors.list[index][3] = number,
                    _ => {}
                }
            }
        }
        Ok(())
    }

    fn faces<'a>(
        &mut self,
        numbers: &mut Numbers<'a>,
        element: &'a Element,
        layout: &Layout,
        vertices: u64,
    ) -> Result<(), Fault> {
        if layout.kind(element, Place::Indices).is_none() && element.count > 0 {
            return Err(("its faces have no list vertex_indices".to_owned(), 0));
        }
        self.face_colors = Colors::new(element, layout);
        if self.polygons(numbers, element, layout, vertices)? {
            return Ok(());
        }
        for index in 0..element.count {
            numbers.begin(&element.name, index);
            let (first, first_uv) = (self.corners.len(), self.corner_uvs.len());
            let (mut color, mut texture, mut coordinates) = ([1.0; 4], NONE, 0);
            for (at, place) in layout.places.iter().enumerate() {
                let property = &element.properties[at];
                match (*place, property.length) {
                    (Some(Place::Indices), Some(length)) => {
                        for _ in 0..numbers.length(length)? {
                            let number = numbers.float(property.kind)?;
                            self.corners.push(vertex(numbers, number, vertices)?);
                        }
                    }
                    (Some(Place::Corners), Some(length)) => {
                        coordinates = numbers.length(length)?;
                        for _ in 0..coordinates / 2 {
                            let uv = [numbers.float(property.kind)?, numbers.float(property.kind)?];
                            self.corner_uvs.push(uv);
                        }
                        numbers.skip(property.kind, coordinates % 2)?;
                    }
                    (Some(Place::Color(channel)), _) => color[channel] = numbers.float(property.kind)?,
                    (Some(Place::Alpha), _) => color[3] = numbers.float(property.kind)?,
                    (Some(Place::Texture), _) => {
                        let number = numbers.float(property.kind)?;
                        texture = if (0.0..f64::from(NONE)).contains(&number) { number as u32 } else { NONE };
                    }
                    _ => skip(numbers, element, at)?,
                }
            }
            let count = self.corners.len() - first;
            let is_matched = coordinates == 2 * count;
            self.unmatched += usize::from(!is_matched && coordinates > 0);
            if count < 3 || !is_matched {
                self.corner_uvs.truncate(first_uv);
            }
            if count < 3 {
                self.corners.truncate(first);
                self.small = if self.small.0 == 0 { (1, index) } else { (self.small.0 + 1, self.small.1) };
                continue;
            }
            if is_matched {
                self.uv_starts.resize(self.ends.len(), NONE);
                self.uv_starts.push(first_uv as u32);
            }
            if texture != NONE {
                self.textures.resize(self.ends.len(), NONE);
                self.textures.push(texture);
            }
            if self.face_colors.is_given() {
                // Strips, which have none, are white.
                self.face_colors.list.resize(self.ends.len(), NO_COLOR);
                self.face_colors.list.push(color);
            }
            self.ends.push(self.corners.len() as u32);
        }
        Ok(())
    }

    /// Reads the faces of a binary file that have nothing but equally many vertices; returns false for others, and where
    /// anything is wrong, without having read any.
    fn polygons(
        &mut self,
        numbers: &mut Numbers<'_>,
        element: &Element,
        layout: &Layout,
        vertices: u64,
    ) -> Result<bool, Fault> {
        let ([property], [Some(Place::Indices)]) = (element.properties.as_slice(), layout.places.as_slice()) else {
            return Ok(false);
        };
        let Some(length) = property.length else { return Ok(false) };
        let mut first = vec![[0.0]];
        let Some(row) = numbers.rows(1, length.bytes()) else { return Ok(false) };
        row.read(&mut first, &[(0, length, 0)]);
        let sides = first[0][0] as usize;
        let (count, stride) = (element.count as usize, length.bytes() + sides.saturating_mul(property.kind.bytes()));
        let rows = numbers.rows(count, stride).filter(|_| sides >= 3);
        let Some(corners) = rows.and_then(|rows| rows.polygons([length, property.kind], sides, vertices)) else {
            return Ok(false);
        };
        let start = self.corners.len();
        self.ends.extend((1..=count).map(|face| (start + face * sides) as u32));
        if start == 0 {
            self.corners = corners
        } else {
            self.corners.extend(corners)
        }
        skip_rows(numbers, count, stride)?;
        Ok(true)
    }

    fn strips<'a>(
        &mut self,
        numbers: &mut Numbers<'a>,
        element: &'a Element,
        layout: &Layout,
        vertices: u64,
    ) -> Result<(), Fault> {
        for index in 0..element.count {
            numbers.begin(&element.name, index);
            for (at, place) in layout.places.iter().enumerate() {
                let property = &element.properties[at];
                let (Some(Place::Indices), Some(length)) = (place, property.length) else {
                    skip(numbers, element, at)?;
                    continue;
                };
                // The last two vertices, and how many of a strip were read.
                let (mut last, mut read) = ([0; 2], 0);
                for _ in 0..numbers.length(length)? {
                    let number = numbers.float(property.kind)?;
                    // A negative index ends a strip, and every other triangle of a strip is reversed.
                    if number < 0.0 {
                        read = 0;
                        continue;
                    }
                    let next = vertex(numbers, number, vertices)?;
                    if read >= 2 {
                        let [a, b] = if read % 2 == 0 { last } else { [last[1], last[0]] };
                        self.corners.extend([a, b, next]);
                        self.ends.push(self.corners.len() as u32);
                    }
                    (last, read) = ([last[1], next], read + 1);
                }
            }
        }
        Ok(())
    }
}

/// Checks the index of a vertex.
fn vertex(numbers: &Numbers<'_>, number: f64, vertices: u64) -> Result<u32, Fault> {
    existing(number, vertices).ok_or_else(|| {
        numbers.fault(&format!("it refers to vertex {number}, but there are {vertices}, numbered from 0"))
    })
}

fn skip_rows(numbers: &mut Numbers<'_>, count: usize, stride: usize) -> Result<(), Fault> {
    numbers.skip(Kind::U8, count * stride)
}

fn skip(numbers: &mut Numbers<'_>, element: &Element, at: usize) -> Result<(), Fault> {
    let property = &element.properties[at];
    let count = property.length.map_or(Ok(1), |length| numbers.length(length))?;
    numbers.skip(property.kind, count)
}
