//! Sheen as a record.

use photon_core::SheenLayer;

use crate::describe::MaterialDesc;

/// The record of a material; its textures are given by their uses.
pub(super) fn record(material: &MaterialDesc, color_texture: u32, roughness_texture: u32) -> SheenLayer {
    SheenLayer {
        color: material.sheen_color.map(|part| part as f32),
        roughness: material.sheen_roughness as f32,
        color_texture,
        roughness_texture,
        ..SheenLayer::NONE
    }
}
