//! Scenes from files.

mod gltf;

pub use self::gltf::load_gltf;
