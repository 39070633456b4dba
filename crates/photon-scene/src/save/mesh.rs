//! Meshes and their vertex attributes as glTF.

use serde_json::{Value, json};

use super::{File, singles};
use crate::error::SceneError;
use crate::extras::{Extras, PrimitiveExtras, standard};
use crate::mesh::Mesh;

const FLOATS: u32 = 5126;
const UNSIGNED: u32 = 5125;

impl File {
    pub(super) fn mesh(&mut self, mesh: &Mesh) -> Result<(), SceneError> {
        let name = &*mesh.name;
        let what = || format!("mesh '{name}'");
        // Vertices that no triangle uses may be NaN, which glTF does not allow.
        let is_finite = |at: &[f64; 3]| at.iter().all(|part| part.is_finite());
        let positions: Vec<[f64; 3]> =
            mesh.positions.iter().map(|at| if is_finite(at) { *at } else { [0.0; 3] }).collect();
        let rounded: Vec<[f32; 3]> = positions.iter().map(|at| singles(*at, what)).collect::<Result<_, _>>()?;
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for at in &rounded {
            for axis in 0..3 {
                low[axis] = low[axis].min(at[axis]);
                high[axis] = high[axis].max(at[axis]);
            }
        }
        let view = self.view(rounded.iter().flatten().flat_map(|c| c.to_le_bytes()));
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOATS, "type": "VEC3", "count": rounded.len(), "min": low, "max": high
        }));
        let view = self.view(mesh.triangles.iter().flatten().flat_map(|index| index.to_le_bytes()));
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED, "type": "SCALAR", "count": 3 * mesh.triangles.len()
        }));
        let mut attributes = json!({ "POSITION": self.accessors.len() - 2 });
        let mut primitive = json!({ "indices": self.accessors.len() - 1, "material": mesh.material.0 });
        let mut extras = PrimitiveExtras { positions: self.exact(&positions, &rounded), ..PrimitiveExtras::default() };
        let given = &mesh.attributes;
        extras.normals = self.attribute(&mut attributes, "NORMAL", &given.normals, standard::normal);
        extras.tangents = self.attribute(&mut attributes, "TANGENT", &given.tangents, standard::tangent);
        if given.normals.is_empty() && !given.tangents.is_empty() && extras.tangents.is_none() {
            // glTF ignores tangents without normals, unless these values say that they count.
            extras.tangents = Some(self.exact_view(&given.tangents));
        }
        extras.colors = self.attribute(&mut attributes, "COLOR_0", &given.colors, standard::color);
        for (set, uvs) in given.uvs.iter().enumerate() {
            // glTF does not allow gaps between sets.
            let zeros = vec![[0.0; 2]; if uvs.is_empty() { mesh.positions.len() } else { 0 }];
            let uvs = if uvs.is_empty() { &zeros } else { uvs };
            let exact = self.attribute(&mut attributes, &format!("TEXCOORD_{set}"), uvs, standard::uv);
            extras.uvs.extend(exact.map(|view| (set.to_string(), view)));
        }
        primitive["attributes"] = attributes;
        if extras != PrimitiveExtras::default() {
            primitive["extras"] = json!(Extras { photonmap: extras });
        }
        self.nodes.push(json!({ "name": name, "mesh": self.meshes.len() }));
        self.meshes.push(json!({ "name": name, "primitives": [primitive] }));
        Ok(())
    }

    /// Adds an attribute in single precision, and returns the view of its exact values if these differ.
    fn attribute<const N: usize>(
        &mut self,
        attributes: &mut Value,
        name: &str,
        values: &[[f64; N]],
        standard: fn([f64; N]) -> [f32; N],
    ) -> Option<usize> {
        if values.is_empty() {
            return None;
        }
        let rounded: Vec<[f32; N]> = values.iter().map(|value| standard(*value)).collect();
        let view = self.view(rounded.iter().flatten().flat_map(|c| c.to_le_bytes()));
        let shape = format!("VEC{N}");
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOATS, "type": shape, "count": values.len()
        }));
        attributes[name] = json!(self.accessors.len() - 1);
        self.exact(values, &rounded)
    }

    /// A view of the values in double precision, unless the rounded ones are the same.
    fn exact<const N: usize>(&mut self, values: &[[f64; N]], rounded: &[[f32; N]]) -> Option<usize> {
        let is_exact = |(exact, rounded): (&[f64; N], &[f32; N])| {
            rounded.map(|c| f64::from(c).to_bits()) == exact.map(f64::to_bits)
        };
        if values.iter().zip(rounded).all(is_exact) {
            return None;
        }
        Some(self.exact_view(values))
    }

    /// A view of the values in double precision.
    fn exact_view<const N: usize>(&mut self, values: &[[f64; N]]) -> usize {
        self.view(values.iter().flatten().flat_map(|c| c.to_le_bytes()))
    }
}
